//! The program from outside: where the deck comes from, switches, exit codes, what is left behind.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const SCENE: &str = include_str!("scripts/scene.in");

fn perigrain(folder: &Path, args: &[&str], stdin: &str) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    // A program that ends before it has read everything is no failure here.
    let _ = child.stdin.take().unwrap().write_all(stdin.as_bytes());
    child.wait_with_output().unwrap()
}

fn out(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned()
}

fn err(o: &Output) -> String {
    String::from_utf8_lossy(&o.stderr).into_owned()
}

#[test]
fn a_deck_is_an_argument_a_switch_or_standard_input() {
    let folder = tempfile::tempdir().unwrap();
    let deck = "print \"seven is $(3+4:%.6g)\"\n";
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    for (args, stdin) in
        [(&["in.deck"][..], ""), (&["-in", "in.deck"], ""), (&["run", "in.deck"], ""), (&[], deck)]
    {
        let o = perigrain(folder.path(), args, stdin);
        assert_eq!(o.status.code(), Some(0), "{args:?}: {}", err(&o));
        assert!(out(&o).lines().any(|l| l == "seven is 7"), "{args:?}: {}", out(&o));
    }
    assert!(fs::read_to_string(folder.path().join("log.lammps")).unwrap().contains("seven is 7"));
}

#[test]
fn screen_log_echo_and_variables_follow_the_switches() {
    let folder = tempfile::tempdir().unwrap();
    let args =
        ["-log", "a.log", "-screen", "none", "-echo", "none", "-var", "v", "35", "70", "-nc", "-sf", "omp"];
    let o = perigrain(folder.path(), &args, "variable v index 1\nprint \"v = $v\"\n");
    assert_eq!((o.status.code(), out(&o).as_str()), (Some(0), ""));
    let log = fs::read_to_string(folder.path().join("a.log")).unwrap();
    assert!(log.contains("v = 35") && !log.contains("variable v"), "{log}");
    let o = perigrain(folder.path(), &["-log", "none", "-echo", "screen"], "print \"text\"\n");
    assert!(out(&o).contains("print \"text\""), "{}", out(&o));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "only a.log");
}

#[test]
fn exit_codes_show_how_it_ended() {
    let folder = tempfile::tempdir().unwrap();
    let code = |args: &[&str], deck: &str| perigrain(folder.path(), args, deck).status.code();
    assert_eq!(code(&["-log", "none"], "quit 3\n"), Some(3));
    assert_eq!(code(&["-log", "none"], "unita si\n"), Some(1));
    assert_eq!(code(&["in.missing"], ""), Some(1));
    assert_eq!(code(&["-log", "no/such/folder/log"], ""), Some(1));
    assert_eq!(code(&["-unknown"], ""), Some(2));
    assert_eq!(code(&["explain", "PG9999"], ""), Some(2));
    assert_eq!(code(&["explain", "PG0102"], ""), Some(0));
    assert_eq!(code(&["-help"], ""), Some(0));
    assert_eq!(code(&["-version"], ""), Some(0));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "nothing is left behind");
}

#[test]
fn the_version_shows_the_build_and_the_lanes_in_use() {
    let folder = tempfile::tempdir().unwrap();
    for switch in ["-version", "--version", "-V"] {
        let o = perigrain(folder.path(), &[switch], "");
        let line = out(&o);
        let (head, tail) = line.trim_end().split_once(") ").unwrap();
        let (name, commit) = head.split_once(" (").unwrap();
        assert_eq!(name, concat!("perigrain ", env!("CARGO_PKG_VERSION")));
        // Tests are debug builds, but for `cargo test --release`.
        assert_eq!(commit == "debug build", cfg!(debug_assertions), "{line}");
        let (target, lanes) = tail.split_once(", ").unwrap();
        assert!(target.starts_with(std::env::consts::ARCH), "{line}");
        assert!(["avx512", "avx2", "portable"].contains(&lanes), "{line}");
    }
}

#[test]
fn a_refusal_stands_in_the_log_too() {
    let folder = tempfile::tempdir().unwrap();
    let o = perigrain(folder.path(), &["-log", "a.log"], "units si\npair_sytle peri/pmb\n");
    let shown = "error[PG0102]: unknown command `pair_sytle`\n  --> <stdin>:2:1\n";
    assert!(err(&o).contains(shown) && err(&o).contains("did you mean `pair_style`?"), "{}", err(&o));
    assert!(!err(&o).contains('\u{1b}'), "colours belong on a terminal");
    assert!(fs::read_to_string(folder.path().join("a.log")).unwrap().contains(shown));
}

#[test]
fn plans_are_printed_measured_and_drawn() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), format!("{SCENE}run 3\n")).unwrap();
    let print = |args: &[&str]| {
        let o = perigrain(folder.path(), args, "");
        assert_eq!(o.status.code(), Some(0), "{args:?}: {}", err(&o));
        out(&o)
    };
    let plan = print(&["plan", "in.deck"]);
    assert!(
        plan.contains("pair peri/pmb") && plan.contains("fix 1 nve") && plan.contains("left out"),
        "{plan}"
    );
    assert!(print(&["plan", "--dot", "in.deck"]).starts_with("digraph"));
    assert!(print(&["check", "in.deck"]).ends_with('\n'));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "looking at a deck leaves nothing");
    let measured = print(&["plan", "--measure", "in.deck", "-log", "none"]);
    assert!(measured.contains("3 calls"), "{measured}");
}

#[test]
fn a_plan_writes_no_file_and_overwrites_none() {
    let folder = tempfile::tempdir().unwrap();
    let outputs = "\
        dump 1 all custom 1 run.dump id x\nrestart 1 run.*.restart\n\
        fix 2 all ave/time 1 1 1 v_a file run.means\nfix 3 all print 1 \"$(step)\" file run.print\n\
        print \"not shown\" file run.said\nlog run.log\nrun 3\nwrite_dump all image run.png type type\n\
        write_data run.data\nwrite_restart run.restart\ninfo system out overwrite run.info\n\
        clear\nread_restart run.restart\nfix 1 all nve\nrun 3\n\
        clear\nread_restart run.3.restart\nfix 1 all nve\nrun 2\n\
        clear\nunits si\natom_style peri\nboundary s s s\nread_data run.data\npair_style peri/pmb\n\
        pair_coeff * * 2e21 0.0030001 0.004 0.0\nfix 1 all nve\nrun 3\n";
    fs::write(folder.path().join("in.deck"), format!("{SCENE}variable a equal step\n{outputs}")).unwrap();
    // What an earlier run left.
    fs::write(folder.path().join("run.restart"), "old").unwrap();
    let o = perigrain(folder.path(), &["plan", "in.deck"], "");
    assert_eq!(o.status.code(), Some(0), "{}", err(&o));
    // Three of the four runs have the same plan, which is printed once.
    let plans_text = out(&o);
    let plans = plans_text.lines().filter(|l| l.trim() == "initial integrate").count();
    assert!(
        plans == 2 && plans_text.contains("used once") && plans_text.contains("used 3 times"),
        "{plans_text}"
    );
    assert!(
        !plans_text.contains("not shown") && !plans_text.contains("what only a run determines"),
        "{plans_text}"
    );
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
    assert_eq!(fs::read_to_string(folder.path().join("run.restart")).unwrap(), "old");
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_the_run_at_a_whole_step_with_all_files_closed() {
    // A process started by `nohup` passes on that hangups are ignored, and the program heeds that.
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status
        .lines()
        .find_map(|l| l.strip_prefix("SigIgn:"))
        .map_or(0, |mask| u64::from_str_radix(mask.trim(), 16).expect("a mask of signals is hexadecimal"));
    for (signal, number) in [("-INT", 2), ("-TERM", 15), ("-HUP", 1)] {
        if ignored >> (number - 1) & 1 == 0 {
            ended_by(signal);
        }
    }
}

/// What a run that a signal has ended leaves behind: whole files, and a last restart file that continues as if nothing had
/// happened.
#[cfg(unix)]
fn ended_by(signal: &str) {
    let folder = tempfile::tempdir().unwrap();
    let output = "thermo 100\nthermo_modify flush yes\nrestart 1000000000 r.*\n";
    let deck =
        format!("{SCENE}dump 1 all custom 100 a.dump id x\n{output}run 100000000\nprint \"not reached\"\n");
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["in.deck", "-screen", "none", "-threads", "1"])
        .current_dir(folder.path())
        .spawn()
        .unwrap();
    let log = folder.path().join("log.lammps");
    let table = |text: &str| text.lines().skip_while(|l| !l.trim_start().starts_with("Step")).count();
    // The run is on its way when the table has a few rows.
    while table(&fs::read_to_string(&log).unwrap_or_default()) < 4 {
        assert!(child.try_wait().unwrap().is_none(), "ended by itself");
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
    let log = fs::read_to_string(log).unwrap();
    assert!(log.contains("Loop time of") && !log.contains("not reached"), "{log}");
    let dump = fs::read_to_string(folder.path().join("a.dump")).unwrap();
    assert!(dump.ends_with('\n'));
    let rows = dump.rsplit("ITEM: ATOMS").next().unwrap().lines().skip(1).count();
    assert_eq!(rows, 125, "the last snapshot is whole");

    // ten steps more from the last restart file, and as many as that in one go
    let (_, step) = log.split_once("Interrupted at step ").unwrap();
    let step = step.split(':').next().unwrap().parse::<i64>().unwrap();
    let state = "print \"state $(step) $(x[1]:%.17g) $(ke:%.17g) $(pe:%.17g)\"\n";
    let (_, fix) = SCENE.split_once("fix ").unwrap();
    let whole = format!("{SCENE}run {}\n{state}", step + 10);
    let rest = format!("read_restart r.{step}\nfix {}\nrun 10\n{state}", fix.lines().next().unwrap());
    let [whole, rest] = [("whole", whole), ("rest", rest)].map(|(name, text)| {
        fs::write(folder.path().join(name), text).unwrap();
        let o = perigrain(folder.path(), &[name, "-log", "none", "-threads", "1"], "");
        assert_eq!(o.status.code(), Some(0), "{}", err(&o));
        out(&o).lines().find(|l| l.starts_with("state ")).unwrap().to_string()
    });
    assert_eq!(whole, rest, "{signal}");
}

#[test]
fn as_many_threads_as_openmp_may_have() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), "info communication\n").unwrap();
    let run = |allowed: &str, args: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
        let command = command.args(["in.deck", "-log", "none"]).args(args);
        command.current_dir(folder.path()).env("OMP_NUM_THREADS", allowed).output().unwrap()
    };
    for (allowed, args, obtained) in [("3", &[][..], 3), ("3,2", &[], 3), ("3", &["-threads", "2"], 2)] {
        let o = run(allowed, args);
        assert!(out(&o).contains(&format!("Nthreads = {obtained}\n")), "{allowed} {args:?}: {}", out(&o));
        assert_eq!(err(&o), "");
    }
    let o = run("many", &[]);
    assert!(err(&o).contains("OMP_NUM_THREADS is `many`") && o.status.success(), "{}", err(&o));
}
