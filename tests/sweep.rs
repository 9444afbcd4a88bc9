//! `perigrain sweep` from outside: tables, resumption after a kill, what fails and what is refused.

use perigrain::sweep::{self, Deck, Job, Outcome, Settings, State, Sweep, Watch};
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::atomic::AtomicBool;

/// A block that flies, and is done at once.
const DECK: &str = "\
variable        v index 1
variable        seed index 1
units           si
atom_style      peri
boundary        s s s
lattice         sc 0.001
region          block block 0 4 0 4 0 4
create_box      1 block
create_atoms    1 region block
set             group all density 2500
set             group all volume 1e-9
pair_style      peri/pmb
pair_coeff      * * 2e21 0.0030001 0.004 0.0
velocity        all create $v ${seed}
fix             1 all nve
compute         k all ke
dump            1 all custom 5 run.dump id x vx
timestep        1e-8
thermo_style    custom step pe
run             10
";

fn sweep(folder: &Path, args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_perigrain"));
    command.arg("sweep").args(args).current_dir(folder).stdin(Stdio::null());
    command.output().unwrap()
}

fn output_of(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned() + &String::from_utf8_lossy(&o.stderr)
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The number of runs that a journal says were begun.
fn begun(folder: &Path) -> usize {
    read(folder, "in.x.sweep/journal").lines().filter(|l| l.contains(" begin\t")).count()
}

fn with_deck(deck: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.x"), deck).unwrap();
    folder
}

#[test]
fn every_combination_is_run_and_has_a_row() {
    let folder = with_deck(DECK);
    let at = folder.path();
    let args = ["in.x", "-each", "v", "10", "20", "-each", "seed", "1..3", "-report", "c_k", "v_v"];
    let o = sweep(at, &args);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    let table = read(at, "in.x.sweep/table.csv");
    let rows: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
    assert_eq!(rows[0].join(","), "run,v,seed,status,steps,atoms,step,pe,c_k,v_v,problem");
    assert_eq!(rows.len(), 7);
    let head: Vec<String> = rows[1..].iter().map(|r| r[..7].join(" ")).collect();
    assert_eq!(head[0], "1 10 1 ok 10 125 10");
    assert_eq!(head[5], "6 20 3 ok 10 125 10");
    // The same numbers as the deck gives by itself.
    let alone = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["in.x", "-var", "v", "20", "-var", "seed", "3", "-log", "alone.log"])
        .current_dir(at)
        .output()
        .unwrap();
    assert!(alone.status.success());
    assert_eq!(read(at, "run.dump"), read(at, "in.x.sweep/0006-v=20-seed=3/run.dump"));
    let ke: f64 = rows[6][8].parse().unwrap();
    assert!(ke > 0.0 && rows[6][9] == "20", "{table}");
    let log = read(at, "in.x.sweep/0002-v=10-seed=2/log.lammps");
    assert!(log.contains("Loop time") && log.contains("Total wall time"), "{log}");
    assert!(!at.join("in.x.sweep/0002-v=10-seed=2/output").exists());
    assert!(output_of(&o).contains("6 runs ok"), "{}", output_of(&o));

    // Nothing is left to do, and nothing is done.
    let o = sweep(at, &args);
    assert!(o.status.success() && output_of(&o).contains("6 of 6 runs are done"), "{}", output_of(&o));
    assert_eq!((read(at, "in.x.sweep/table.csv"), begun(at)), (table.clone(), 6));
    let o = sweep(at, &["in.x.sweep", "-status"]);
    assert!(output_of(&o).contains("in.x, 6 runs ok, not at work"), "{}", output_of(&o));
    let anew = sweep(at, &[&args[..], &["-anew", "-jobs", "1", "-screen", "none"]].concat());
    assert_eq!((anew.status.code(), output_of(&anew).as_str()), (Some(0), ""));
    assert_eq!(
        (read(at, "in.x.sweep/table.csv"), begun(at)),
        (table, 6),
        "the same bytes, one after the other"
    );
}

#[test]
fn tied_lists_and_tables_make_one_run_per_line() {
    let folder = with_deck("variable a index 0\nvariable b index 0\nprint \"$a-$b\" file said\nquit\n");
    let at = folder.path();
    let o = sweep(at, &["in.x", "-each", "a", "1", "2", "-each", "b", "3", "4", "-zip", "a", "b"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    assert_eq!(read(at, "in.x.sweep/0002-a=2-b=4/said"), "2-4\n");
    fs::write(at.join("runs.csv"), "a,b\n1,\"x, y\"\n2,z\n").unwrap();
    let o = sweep(at, &["in.x", "-table", "runs.csv", "-out", "t"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    assert_eq!(read(at, "t/0001-a=1-b=x_-y/said"), "1-x, y\n");
    assert!(read(at, "t/table.csv").contains("1,1,\"x, y\",ok,0,0,"));

    fs::write(at.join("runs.csv"), "a,b\n1,2\n3\n").unwrap();
    let o = sweep(at, &["in.x", "-table", "runs.csv", "-out", "u"]);
    assert!(o.status.code() == Some(1) && output_of(&o).contains("runs.csv:3:1"), "{}", output_of(&o));
    let o = sweep(at, &["in.x", "-each", "a", "1", "2", "-each", "b", "3", "-zip", "a", "b", "-out", "u"]);
    assert!(o.status.code() == Some(2) && output_of(&o).contains("equally long"), "{}", output_of(&o));
    assert!(!at.join("u").exists());
}

#[test]
fn a_failing_run_is_one_line_and_the_rest_continues() {
    let deck =
        "variable f index a\nvariable n index 1\nprint \"x\" file $f\nif \"$n == 2\" then \"quit 3\"\nquit\n";
    let folder = with_deck(deck);
    let at = folder.path();
    // A disk that is full, a folder that is not there, a status.
    let args = [
        "in.x",
        "-each",
        "f",
        "ok",
        "/dev/full",
        "no/such",
        "-each",
        "n",
        "1",
        "2",
        "-jobs",
        "2",
        "-retry",
        "1",
    ];
    let o = sweep(at, &args);
    assert_eq!(o.status.code(), Some(1), "{}", output_of(&o));
    let table = read(at, "in.x.sweep/table.csv");
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(rows.len(), 6);
    assert!(rows[0].starts_with("1,ok,1,ok,"), "{table}");
    assert!(rows[1].starts_with("2,ok,2,failed,") && rows[1].contains("quit 3"), "{table}");
    assert!(
        rows[2].contains("failed") && rows[2].contains("in.x:3: error[PG0118]: cannot write `/dev/full`"),
        "{table}"
    );
    assert!(rows[4].contains("no/such"), "{table}");
    assert_eq!(begun(at), 1 + 5 * 2, "each tried twice");
    let log = read(at, "in.x.sweep/0005-f=no_such-n=1/log.lammps");
    assert!(log.contains("in.x:3:"), "{log}");
    // What has failed is tried again, what went well is not.
    let o = sweep(at, &args[..args.len() - 2]);
    assert!(o.status.code() == Some(1) && begun(at) == 11 + 5, "{}", output_of(&o));
}

#[test]
fn a_run_that_is_killed_takes_no_other_with_it() {
    let deck =
        "variable n index 1\nif \"$n == 2\" then \"shell exec sh ../../kill.sh\"\nprint \"$n\" file n\n";
    let folder = with_deck(deck);
    fs::write(folder.path().join("kill.sh"), "kill -9 $PPID\n").unwrap();
    let o = sweep(folder.path(), &["in.x", "-each", "n", "1..3"]);
    assert_eq!(o.status.code(), Some(1), "{}", output_of(&o));
    let table = read(folder.path(), "in.x.sweep/table.csv");
    assert!(table.contains("2,2,failed,0,0,the process crashed (signal 9)"), "{table}");
    assert!(table.contains("\n3,3,ok"), "{table}");
}

#[test]
fn what_changed_since_is_refused_with_its_place() {
    let deck = "variable n index 1\ninclude more.in\nprint \"$n $m\" file said\n";
    let folder = with_deck(deck);
    let at = folder.path();
    fs::write(at.join("more.in"), "variable m index 7\n").unwrap();
    let args = ["in.x", "-each", "n", "1", "2"];
    assert!(sweep(at, &args).status.success());
    assert_eq!(read(at, "in.x.sweep/0002-n=2/said"), "2 7\n", "what is read lies beside the deck");
    let table = read(at, "in.x.sweep/table.csv");
    let refused = |args: &[&str], why: &str| {
        let o = sweep(at, args);
        let text = output_of(&o);
        assert!(o.status.code() == Some(1) && text.contains(why) && text.contains("-anew"), "{text}");
        assert_eq!(read(at, "in.x.sweep/table.csv"), table);
    };
    refused(&["in.x", "-each", "n", "1", "3"], "run 2 is n=2, not n=3");
    refused(
        &["in.x", "-each", "n", "1", "2", "-compat", "lammps"],
        "switches were none, they are `-compat lammps/2026`",
    );
    fs::write(at.join("more.in"), "variable m index 8\n").unwrap();
    refused(&args, "more.in` has changed since run 1 read it");
    fs::write(at.join("more.in"), "variable m index 7\n").unwrap();
    fs::write(at.join("in.x"), deck.replace("$m\"", "$m !\"")).unwrap();
    refused(&args, "line 3 was `print \"$n $m\" file said`, is `print \"$n $m !\" file said`");
    let o = sweep(at, &[&args[..], &["-anew"]].concat());
    assert!(o.status.success(), "{}", output_of(&o));
    assert_eq!(read(at, "in.x.sweep/0002-n=2/said"), "2 7 !\n");
}

#[test]
fn a_torn_journal_is_named_and_its_lost_runs_are_made_again() {
    let folder = with_deck("variable n index 1\nprint \"$n\" append ../ran\n");
    let at = folder.path();
    let args = ["in.x", "-each", "n", "1", "2", "3", "-jobs", "1"];
    assert!(sweep(at, &args).status.success());
    let (journal, table) = (read(at, "in.x.sweep/journal"), read(at, "in.x.sweep/table.csv"));
    // The end of run 1 is damaged, and a last line was never finished.
    fs::write(at.join("in.x.sweep/journal"), journal.replacen(" end\t0", " eNd\t0", 1) + "12345678 beg")
        .unwrap();
    let o = sweep(at, &args);
    assert!(
        o.status.success() && output_of(&o).contains("journal`, line 3, is damaged"),
        "{}",
        output_of(&o)
    );
    assert!(output_of(&o).contains("3 of 3"), "the run had left its result: {}", output_of(&o));
    fs::remove_file(at.join("in.x.sweep/0001-n=1/.result")).unwrap();
    fs::write(at.join("in.x.sweep/journal"), journal.replacen(" end\t0", " eNd\t0", 1)).unwrap();
    let o = sweep(at, &args);
    assert!(o.status.success() && output_of(&o).contains("2 of 3"), "{}", output_of(&o));
    assert_eq!(
        (read(at, "in.x.sweep/table.csv"), read(at, "in.x.sweep/ran").as_str()),
        (table, "1\n2\n3\n1\n")
    );
    fs::write(at.join("in.x.sweep/journal"), journal.replacen("sweep", "swEEp", 1)).unwrap();
    let o = sweep(at, &args);
    assert!(o.status.code() == Some(1) && output_of(&o).contains("journal`, line 1"), "{}", output_of(&o));
    fs::write(at.join("in.x.sweep/journal"), "").unwrap();
    let o = sweep(at, &args);
    assert!(o.status.code() == Some(1) && output_of(&o).contains("is in the way"), "{}", output_of(&o));
}

#[test]
fn what_would_fail_in_every_run_is_reported_before_the_first() {
    let folder = with_deck(DECK);
    let at = folder.path();
    for (args, why) in [
        (&["in.x", "-each", "sed", "1", "2"][..], "never uses the variable `sed`"),
        (&["in.x", "-each", "seed", "1", "2", "-report", "c_kk"], "did you mean `c_k`?"),
        (&["in.x", "-each", "seed", "1", "2", "-report", "f_1["], "error"),
        (&["in.none", "-each", "seed", "1"], "cannot read the deck `in.none`"),
        (&["in.x", "-each", "seed", "x", "y"], "in.x:14"),
    ] {
        let o = sweep(at, args);
        assert!(o.status.code() == Some(1) && output_of(&o).contains(why), "{args:?}: {}", output_of(&o));
    }
    for args in [&["in.x"][..], &["in.x", "-each", "v"], &["in.x", "-each", "v", "1", "-each", "v", "2"]] {
        assert_eq!(sweep(at, args).status.code(), Some(2), "{args:?}");
    }
    assert_eq!(fs::read_dir(at).unwrap().count(), 1, "nothing is left behind");
    let o = sweep(at, &["nowhere", "-status"]);
    assert!(o.status.code() == Some(1) && output_of(&o).contains("nowhere"), "{}", output_of(&o));
}

#[test]
fn one_sweep_at_a_time_works_in_a_folder() {
    let folder = with_deck("variable n index 1\nprint \"$n\"\nshell sleep 3\n");
    let at = folder.path();
    let args = ["sweep", "in.x", "-each", "n", "1", "2", "-jobs", "2", "-screen", "none"];
    let mut first = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(args)
        .current_dir(at)
        .stdin(Stdio::null())
        .spawn()
        .unwrap();
    while !at.join("in.x.sweep/0002-n=2/log.lammps").exists() {
        assert!(first.try_wait().unwrap().is_none(), "ended by itself");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    let status = output_of(&sweep(at, &["in.x.sweep", "-status"]));
    assert!(status.contains("0 runs ok, 2 left, at work on 2"), "{status}");
    let o = sweep(at, &args[1..]);
    assert!(
        o.status.code() == Some(1) && output_of(&o).contains("another sweep is at work in `in.x.sweep`"),
        "{}",
        output_of(&o)
    );
    // The sweep gets a request to end: nothing was done.
    Command::new("kill").args(["-TERM", &first.id().to_string()]).status().unwrap();
    assert_eq!(first.wait().unwrap().code(), Some(130));
    assert!(output_of(&sweep(at, &["in.x.sweep", "-status"])).contains("0 runs ok, 2 left, not at work"));
}

/// Kills sweeps with signal 9 at moments that are as good as random, and starts them again.
#[cfg(unix)]
#[test]
fn a_sweep_killed_at_any_moment_continues_and_repeats_no_finished_run() {
    let deck = format!("{DECK}print \"$v ${{seed}}\" append ../ran\n");
    let folder = with_deck(&deck);
    let at = folder.path();
    let args = [
        "in.x", "-each", "v", "10", "20", "-each", "seed", "1..12", "-report", "c_k", "-threads", "1",
        "-screen", "none",
    ];
    let whole = sweep(at, &[&args[..], &["-out", "whole"]].concat());
    assert_eq!(whole.status.code(), Some(0), "{}", output_of(&whole));
    let mut kills = 0;
    for round in 0..20u64 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_perigrain"))
            .arg("sweep")
            .args(args)
            .current_dir(at)
            .stdin(Stdio::null())
            .spawn()
            .unwrap();
        // Between 0 and 60 ms, in no order.
        std::thread::sleep(std::time::Duration::from_millis(round * 7919 % 61));
        child.kill().unwrap();
        kills += usize::from(child.wait().unwrap().code().is_none());
    }
    assert!(kills > 0, "killed while at work");
    let o = sweep(at, &args);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    assert_eq!(read(at, "in.x.sweep/table.csv"), read(at, "whole/table.csv"));
    let journal = read(at, "in.x.sweep/journal");
    for run in 0..24 {
        let ends = journal.lines().filter(|l| l.contains(&format!(" end\t{run}\t"))).count();
        assert_eq!(ends, 1, "run {run}:\n{journal}");
        let last = journal.lines().rfind(|l| l.ends_with(&format!(" begin\t{run}"))).unwrap();
        let end = journal.lines().position(|l| l.contains(&format!(" end\t{run}\t"))).unwrap();
        assert!(
            journal.lines().position(|l| l == last).unwrap() < end,
            "begun again after its end:\n{journal}"
        );
        let (v, seed) = (10 * (1 + run / 12), 1 + run % 12);
        let home = format!("{:04}-v={v}-seed={seed}", run + 1);
        let dump = |of: &str| read(at, &format!("{of}/{home}/run.dump"));
        assert_eq!(dump("in.x.sweep"), dump("whole"), "{home}");
    }
}

#[test]
fn a_deck_may_carry_its_values() {
    let deck = "sweep each n 1..3 each w a b report v_n\nprint \"$n$w\" file said\n";
    let folder = with_deck(deck);
    let at = folder.path();
    let program = |args: &[&str]| {
        Command::new(env!("CARGO_BIN_EXE_perigrain")).args(args).current_dir(at).output().unwrap()
    };
    let alone = output_of(&program(&["in.x", "-log", "none"]));
    assert!(alone.contains("One of 6 runs, n=1 w=a: `perigrain sweep` makes all of them\n1a\n"), "{alone}");
    let o = sweep(at, &["in.x"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    assert_eq!(read(at, "in.x.sweep/0006-n=3-w=b/said"), "3b\n");
    assert!(
        read(at, "in.x.sweep/table.csv")
            .starts_with("run,n,w,status,steps,atoms,v_n,problem\n1,1,a,ok,0,0,1,\n")
    );
    assert!(!read(at, "in.x.sweep/0006-n=3-w=b/log.lammps").contains("One of"));
    let o = sweep(at, &["in.x", "-each", "n", "7", "-out", "other"]);
    assert_eq!(o.status.code(), Some(0), "{}", output_of(&o));
    assert_eq!(
        read(at, "other/0001-n=7/said"),
        "7a\n",
        "the command line's lists take the place of the deck's"
    );

    // Only one of the runs is wrong.
    let deck = "sweep each n 1..3\nif \"$n == 2\" then \"unita si\"\n";
    fs::write(at.join("in.y"), deck).unwrap();
    let o = program(&["check", "in.y"]);
    assert!(o.status.code() == Some(1) && output_of(&o).contains("this is so with n=2"), "{}", output_of(&o));
    let o = sweep(at, &["in.y"]);
    assert!(o.status.code() == Some(1) && output_of(&o).contains("2 runs ok, 1 failed"), "{}", output_of(&o));
    for (line, why) in [
        ("sweep", "each, zip, table or report"),
        ("sweep each n", "in.z:1:"),
        ("sweep every n 1", "known here: each zip table report"),
        ("sweep each n 1 2 each m 1 zip n m", "equally long"),
        ("sweep table runs.csv", "cannot be read"),
        ("sweep report pe", "needs values"),
        ("sweep each n 1\nsweep each n 2", "one `sweep` line"),
    ] {
        fs::write(at.join("in.z"), format!("{line}\nprint $n\n")).unwrap();
        for o in [program(&["check", "in.z"]), program(&["in.z", "-log", "none"]), sweep(at, &["in.z"])] {
            assert!(o.status.code() == Some(1) && output_of(&o).contains(why), "{line}: {}", output_of(&o));
        }
    }
}

/// Ends a sweep after its first run.
struct Impatient<'a>(&'a AtomicBool, Vec<usize>);

impl Watch for Impatient<'_> {
    fn ended(&mut self, job: usize, outcome: &Outcome, state: &State) {
        assert!(outcome.is_ok() && state.ok == 1 && state.left.is_some(), "{outcome:?}");
        self.1.push(job);
        self.0.store(true, std::sync::atomic::Ordering::Relaxed);
    }
}

#[test]
fn jobs_give_outcomes_from_rust() {
    let folder = tempfile::tempdir().unwrap();
    let job = |v: &str| Job { vars: vec![("v".into(), v.into())] };
    let mut sweep = Sweep {
        deck: Deck { name: "in.x".into(), text: DECK.into(), folder: folder.path().into() },
        jobs: vec![job("10"), job("20")],
        report: vec!["c_k".into()],
        settings: Settings::default(),
        folder: folder.path().join("out"),
        at_once: 1,
        threads: 2,
        retry: 0,
        program: env!("CARGO_BIN_EXE_perigrain").into(),
        reports_progress: true,
        ranks: None,
    };
    assert!(sweep::look_ahead(&sweep).problems.is_empty());
    let stop = AtomicBool::new(false);
    let mut watch = Impatient(&stop, vec![]);
    let some = sweep::execute(&sweep, false, &mut watch, &stop).unwrap();
    assert!(some.interrupted && !some.all_ok() && watch.1 == [0]);
    assert_eq!(some.outcomes.iter().flatten().count(), 1);
    let all = sweep::execute(&sweep, false, &mut (), &AtomicBool::new(false)).unwrap();
    assert!(all.all_ok());
    let of = |k: usize| all.outcomes[k].as_ref().unwrap();
    assert_eq!((of(1).steps, of(1).atoms, of(1).threads), (10, 125, 2));
    assert!(of(1).loop_seconds > 0.0 && of(1).seconds > of(1).loop_seconds);
    assert_eq!(of(1).value("step"), Some(10.0));
    assert!(of(0).value("c_k").unwrap() > 0.0 && of(0).value("c_nothing").is_none());
    let standing = sweep::look(&sweep.folder).unwrap();
    assert_eq!((standing.deck.as_str(), standing.jobs.len(), standing.running), ("in.x", 2, None));
    sweep.jobs.pop();
    let other = sweep::execute(&sweep, false, &mut (), &AtomicBool::new(false)).unwrap_err();
    assert!(other.0[0].message.contains("it has 2 runs, not 1"), "{other}");
}
