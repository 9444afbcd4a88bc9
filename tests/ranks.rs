//! Several ranks run one deck: what they write has the bytes of one process, and one that fails or dies ends them all.

mod grains;
mod rigid;

use crate::examples;
use crate::restart::scenes::{SCENES, Scene};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const PERIGRAIN: &str = env!("CARGO_BIN_EXE_perigrain");

/// Launchers set these; tests of one process run without.
const LAUNCHED: [&str; 3] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MPI_LOCALNRANKS"];

pub fn start(folder: &Path, program: &str, args: &[&str]) -> Child {
    let mut command = Command::new(program);
    for key in LAUNCHED {
        command.env_remove(key);
    }
    // Containers may forbid a process to read another one's memory, of which Open MPI would complain.
    command.env("OMPI_MCA_btl_vader_single_copy_mechanism", "none");
    command
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn perigrain(folder: &Path, args: &[&str]) -> Output {
    start(folder, PERIGRAIN, args).wait_with_output().unwrap()
}

pub fn output_of(o: &Output) -> String {
    String::from_utf8_lossy(&o.stdout).into_owned() + &String::from_utf8_lossy(&o.stderr)
}

/// Lines with time, processes and memory; nothing in a run follows from them.
fn is_of_this_run(line: &str) -> bool {
    // An example keeps a time in `Td`.
    const BEGINNINGS: [&str; 8] = [
        "perigrain ",
        "Loop time",
        "Performance",
        "Total wall",
        "Per MPI rank",
        "seconds ",
        "ranks: ",
        "variable        Td ",
    ];
    const PARTS: [&str; 4] = ["% CPU", "CPU = ", " | ", "[s]"];
    BEGINNINGS.iter().any(|b| line.starts_with(b)) || PARTS.iter().any(|p| line.contains(p))
}

/// A line without its numbers of seconds, of calculations that would fit `in a run`, and of how many `times faster` they are: examples of
/// statics print these beside what they compare.
fn without_times(line: &str) -> String {
    let words: Vec<&str> = line.split(' ').collect();
    let is_time = |k: usize| match &words[k + 1..] {
        ["s" | "s,", ..] | ["in", "a", "run", ..] | ["times", "faster", ..] => {
            words[k].parse::<f64>().is_ok()
        }
        _ => false,
    };
    (0..words.len()).map(|k| if is_time(k) { "#" } else { words[k] }).collect::<Vec<_>>().join(" ")
}

/// All files of a folder; of logs only what does not depend on time.
pub fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let file = |e: fs::DirEntry| {
        let name = e.file_name().into_string().unwrap();
        let bytes = fs::read(e.path()).unwrap();
        let bytes = match name.starts_with("log") {
            false => bytes,
            true => {
                let text = String::from_utf8(bytes).unwrap();
                let lines = text.lines().filter(|l| !is_of_this_run(l)).map(without_times);
                lines.collect::<Vec<_>>().join("\n").into_bytes()
            }
        };
        (name, bytes)
    };
    fs::read_dir(folder).unwrap().map(|e| file(e.unwrap())).collect()
}

/// What a deck leaves behind under these words, in a folder of its own.
pub fn left_by(deck: &str, words: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let o = perigrain(folder.path(), &[&["-in", "in.deck", "-screen", "none"], words].concat());
    assert!(o.status.success(), "{words:?}: {}\n{deck}", output_of(&o));
    files(folder.path())
}

pub fn same(one: &BTreeMap<String, Vec<u8>>, other: &BTreeMap<String, Vec<u8>>, what: &str) {
    let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(one), names(other), "{what}");
    for (name, bytes) in one {
        let (a, b) = (String::from_utf8_lossy(bytes), String::from_utf8_lossy(&other[name]));
        let line = a.lines().zip(b.lines()).find(|(a, b)| a != b);
        assert!(*bytes == other[name], "{what}: {name} differs: {line:?}");
    }
}

/// What makes a scene; bodies have more planes than elsewhere, so that they have several tiles, which are dealt out.
fn made(scene: &Scene) -> String {
    let deep = [
        ("block 0 7 0 5 0 5", "block 0 7 0 5 0 23"),
        ("-0.006 0.006 -0.003 0.009", "-0.006 0.006 -0.025 0.009"),
        ("-0.0035 0.0035 -0.001 0.001", "-0.0035 0.0035 -0.0225 0.001"),
    ];
    deep.iter().fold(scene.make.to_string(), |make, (few, more)| make.replace(few, more))
}

/// A scene with everything that is written, and read back.
pub fn deck_of(scene: &Scene) -> String {
    format!(
        "{}{}dump all all custom 7 dump.*.txt id type x y z vx vy vz\ndump_modify all format float %.17g\n\
         restart 11 often.*.restart\nrun {}\nwrite_restart end.restart\nwrite_data end.data\n",
        made(scene),
        scene.again,
        scene.steps.min(24)
    )
}

#[test]
fn every_family_has_the_same_bytes_on_any_number_of_ranks() {
    for (k, scene) in SCENES.iter().enumerate() {
        let list: &[&str] = if scene.list { &["-layout", "list"] } else { &[] };
        let deck = deck_of(scene);
        let alone = left_by(&deck, &[&["-threads", "1"], list].concat());
        // Each scene on one of these numbers; all numbers come several times.
        let (ranks, threads) = [("2", "1"), ("3", "1"), ("2", "2"), ("5", "1")][k % 4];
        let several = left_by(&deck, &[&["-ranks", ranks, "-threads", threads], list].concat());
        same(&alone, &several, &format!("{} on {ranks} ranks of {threads} threads", scene.name));
    }
}

#[test]
fn particles_come_and_go_while_bodies_are_shared_out() {
    let scene = &SCENES[0];
    let goes = "fix go all evaporate 4 3 part 8311\nregion part block 0 0.002 0 0.003 0 0.02 units box\n";
    let comes = "region drop block 0 0.005 0 0.004 0.028 0.03 units box\nfix come all deposit 3 1 5 77 region drop id next\n";
    let (region, fix) = (goes.lines().nth(1).unwrap(), goes.lines().next().unwrap());
    for (what, lines) in [("evaporate", format!("{region}\n{fix}\n")), ("deposit", comes.to_string())] {
        let made = made(scene).replacen("region blk", "region all block -5 15 -5 15 -5 35\nregion blk", 1);
        let made = made.replace("create_box 1 blk", "create_box 1 all");
        let deck = format!(
            "{made}{}{lines}dump all all custom 4 dump.*.txt id type x y z vx vy vz\n\
             dump_modify all format float %.17g\nrun 40\nwrite_restart end.restart\n",
            scene.again
        );
        let alone = left_by(&deck, &["-threads", "1"]);
        same(&alone, &left_by(&deck, &["-ranks", "3", "-threads", "1"]), what);
    }
}

/// Smooth walls and one that throws back, and their numbers in log and dumps; one that a particle runs through ends all ranks with the same
/// words.
#[test]
fn walls_act_on_a_ranks_own_particles() {
    let scene = &SCENES[0];
    let walls = "fix low all wall/harmonic xlo -0.001 1e14 1 0.0015 units box\nfix back all wall/reflect xhi 0.00702 units box\n\
                 region around block -0.01 0.02 -0.001 0.0065 -0.5 0.5 units box\n\
                 fix sides all wall/region around harmonic 1e14 1 0.0015\n\
                 thermo_style custom step ke f_low f_low[1] f_sides f_sides[2]\n";
    let deck = format!("{}{}{walls}thermo 10\n", made(scene), scene.again);
    let whole = format!(
        "{deck}dump all all custom 20 dump.*.txt id x y z vx fx\ndump_modify all format float %.17g\nrun 40\n"
    );
    let alone = left_by(&whole, &["-threads", "1"]);
    same(&alone, &left_by(&whole, &["-ranks", "3", "-threads", "1"]), "walls");
    let folder = tempfile::tempdir().unwrap();
    let quiet = format!("{deck}run 40\n");
    let path = folder.path().join("in.deck");
    fs::write(&path, quiet).unwrap();
    let ops = measured(folder.path(), &["in.deck"]);
    let walls =
        ops.iter().filter(|(op, rows, gathers)| op.contains("wall/") && rows == "own" && *gathers == 0);
    assert_eq!(walls.count(), 3, "{ops:?}");
    let through =
        format!("{deck}fix end all wall/harmonic xhi 0.0082 1 1 0.001 units box\nunfix back\nrun 4000\n");
    fs::write(&path, through).unwrap();
    let ends = |words: &[&str]| {
        let o =
            perigrain(folder.path(), &[&["-in", "in.deck", "-log", "none", "-threads", "1"], words].concat());
        assert!(!o.status.success());
        String::from_utf8(o.stderr).unwrap()
    };
    let alone = ends(&[]);
    assert!(alone.contains("has reached the wall `xhi`"), "{alone}");
    assert_eq!(alone, ends(&["-ranks", "3"]));
}

#[test]
fn forces_are_all_known_where_energies_of_particles_are() {
    let scene = &SCENES[0];
    let deck = format!(
        "{}{}compute e all pe/atom\ncompute s all stress/atom NULL\ndump all all custom 5 dump.*.txt id fx fy fz c_e c_s[1]\n\
         dump_modify all format float %.17g\nthermo 3\nrun 20\n",
        made(scene),
        scene.again
    );
    let alone = left_by(&deck, &["-threads", "1"]);
    same(&alone, &left_by(&deck, &["-ranks", "2", "-threads", "1"]), "energies of particles");
}

/// What acts in every step of a measured plan on ranks: op, of which rows, how often all rows of something were handed to all in quiet
/// steps.
fn exchanged(printed: &str) -> Vec<(String, String, u64)> {
    let of = |line: &str| {
        let (op, rest) = line.trim().split_once("every step")?;
        let (rows, rest) = rest.split_once(" rows: ")?;
        let rows = rows.rsplit(' ').next()?.to_string();
        let gathers = rest.split(' ').next()?.parse().ok()?;
        Some((op.trim().to_string(), rows, gathers))
    };
    printed.lines().filter_map(of).collect()
}

/// The measured plans of a deck's runs on three ranks.
fn measured(folder: &Path, words: &[&str]) -> Vec<(String, String, u64)> {
    measured_on("3", folder, words)
}

/// The same on so many.
fn measured_on(ranks: &str, folder: &Path, words: &[&str]) -> Vec<(String, String, u64)> {
    let o = perigrain(folder, &[&["plan", "--measure", "-ranks", ranks, "-threads", "1"], words].concat());
    assert!(o.status.success(), "{words:?}: {}", output_of(&o));
    exchanged(&output_of(&o))
}

#[test]
fn bodies_are_shared_out_and_quiet_steps_gather_nothing() {
    let mut shared = vec![];
    for scene in &SCENES {
        let folder = tempfile::tempdir().unwrap();
        let deck = format!("{}{}thermo 10\nrun 20\n", made(scene), scene.again);
        fs::write(folder.path().join("in.deck"), deck).unwrap();
        let list: &[&str] = if scene.list { &["-layout", "list"] } else { &[] };
        let ops = measured(folder.path(), &[&["in.deck"], list].concat());
        for (op, rows, gathers) in &ops {
            assert_eq!(*gathers, 0, "{}: `{op}` needs {rows} rows", scene.name);
        }
        shared.extend((!ops.is_empty()).then_some(scene.name));
    }
    // Bonds with history, grains and beams are processed by all ranks alike.
    assert_eq!(
        shared,
        [
            "lattice",
            "list",
            "scattered",
            "scattered, list",
            "lps",
            "shaped",
            "own horizons",
            "averages",
            "impact"
        ]
    );
}

#[test]
#[ignore = "takes minutes: `./check --ranks`"]
fn every_example_has_the_same_bytes_on_any_number_of_ranks() {
    for (deck, args) in examples::short_forms() {
        let folder = |words: &[&str]| {
            let folder = tempfile::tempdir().unwrap();
            let words: Vec<&str> =
                [&["-in", deck.to_str().unwrap(), "-screen", "none", "-threads", "1"], words]
                    .concat()
                    .into_iter()
                    .chain(args.split_whitespace())
                    .collect();
            let o = perigrain(folder.path(), &words);
            assert!(o.status.success(), "{words:?}: {}", output_of(&o));
            files(folder.path())
        };
        let alone = folder(&[]);
        for ranks in ["2", "3", "5"] {
            same(&alone, &folder(&["-ranks", ranks]), &format!("{} {args} on {ranks} ranks", deck.display()));
        }
    }
}

/// Examples of solids whose steps gather nothing on ranks, but where contacts are listed or near pairs searched anew; the last one has two
/// tiles.
const QUIET: [(&str, &str); 12] = [
    ("brittle_glass", "3"),
    ("crack_branching", "3"),
    ("ct_fracture", "3"),
    ("fragmenting_cylinder", "3"),
    ("hertz_half_space", "3"),
    ("kalthoff_winkler", "3"),
    ("laminate_erosion", "3"),
    ("meshed_gear", "3"),
    ("mode_one", "3"),
    ("multi_impact", "3"),
    ("plate_impact", "3"),
    ("rubber_cube", "2"),
];

#[test]
#[ignore = "takes minutes: `./check --ranks`"]
fn quiet_steps_of_examples_gather_nothing() {
    for (name, ranks) in QUIET {
        let mut forms = examples::short_forms().into_iter();
        let of = |deck: &Path| deck.parent().is_some_and(|folder| folder.ends_with(name));
        let (deck, args) = forms.find(|(deck, _)| of(deck)).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let words = [deck.to_str().unwrap()].into_iter().chain(args.split_whitespace()).collect::<Vec<_>>();
        let ops = measured_on(ranks, folder.path(), &words);
        assert!(!ops.is_empty(), "{name}: nothing is shared out");
        for (op, rows, gathers) in ops {
            let looks = ["reneighbor", "pair peri/", "pair granular"].iter().any(|look| op.starts_with(look));
            assert!(looks || gathers == 0, "{name}: `{op}` needs {rows} rows, {gathers} gathers");
        }
    }
}

#[test]
fn what_is_read_back_is_the_first_ranks() {
    let scene = &SCENES[0];
    let deck = format!(
        "{}{}variable where getenv PWD\nshell mkdir made\nshell echo 'variable n equal 4' > made/more.in\ninclude made/more.in\n\
         dump d all custom 2 d.lammpstrj id type x y z\nrun $n\nundump d\nwrite_restart a.restart\nclear\n\
         read_restart a.restart\n{}if \"$(is_file(a.restart))\" then \"print 'there is one'\"\n\
         variable t timer\nvariable late equal \"step*(time>0)\"\nprint \"$(v_late)\" file printed\n\
         rerun d.lammpstrj dump x y z\nprint \"$(cpu*0) ${{where}}\" append printed screen no\nshell rm -f made/more.in nothing\nshell rmdir made\n",
        scene.make, scene.again, scene.again
    );
    let without_folder = |mut files: BTreeMap<String, Vec<u8>>| {
        let printed = String::from_utf8(files.remove("printed").unwrap()).unwrap();
        // The second line names the folder of the run, the first rank's.
        assert_eq!(printed.lines().count(), 2, "{printed}");
        files.insert("printed".into(), printed.lines().next().unwrap().into());
        files.retain(|name, _| !name.starts_with("log"));
        files
    };
    let alone = without_folder(left_by(&deck, &["-threads", "1"]));
    same(&alone, &without_folder(left_by(&deck, &["-ranks", "3", "-threads", "1"])), "files read back");
}

#[test]
fn a_mistake_is_reported_once() {
    let folder = tempfile::tempdir().unwrap();
    for (deck, code, part) in [
        ("units si\nregoin a block 0 1 0 1 0 1\n", 1, "did you mean"),
        ("read_data nothing.data\n", 1, "nothing.data"),
        ("read_restart nothing.restart\n", 1, "nothing.restart"),
        ("log no/such/folder\n", 1, "create the folder"),
        ("quit 3\n", 3, ""),
    ] {
        fs::write(folder.path().join("in.deck"), deck).unwrap();
        let alone = perigrain(folder.path(), &["-in", "in.deck", "-threads", "1"]);
        let several = perigrain(folder.path(), &["-in", "in.deck", "-ranks", "3", "-threads", "1"]);
        assert_eq!(several.status.code(), Some(code), "{deck}: {}", output_of(&several));
        assert!(output_of(&several).contains(part), "{}", output_of(&several));
        assert_eq!(alone.stderr, several.stderr, "{deck}");
    }
    let o = perigrain(folder.path(), &["-ranks", "9999", "-in", "in.deck"]);
    assert!(o.status.code() == Some(2) && output_of(&o).contains("at most 256"), "{}", output_of(&o));
}

/// A deck that runs until something ends it, and leaves a restart file.
const ENDLESS: &str = "run 1000000000\n";

fn endless() -> String {
    let scene = SCENES.iter().find(|s| s.name == "pile").unwrap_or(&SCENES[1]);
    format!("{}{}thermo 1000\nrestart 1000000 a.restart b.restart\n{ENDLESS}", scene.make, scene.again)
}

/// The processes that this one has started.
pub fn children(parent: u32) -> Vec<u32> {
    let of = |pid: u32| -> Option<u32> {
        let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
        stat.rsplit_once(')')?.1.split_whitespace().nth(1)?.parse().ok()
    };
    let pids = fs::read_dir("/proc")
        .unwrap()
        .filter_map(|e| e.unwrap().file_name().into_string().ok()?.parse().ok());
    pids.filter(|pid| of(*pid) == Some(parent)).collect()
}

pub fn wait_for(what: &str, mut there: impl FnMut() -> bool) {
    let begin = Instant::now();
    while !there() {
        assert!(begin.elapsed() < Duration::from_secs(60), "{what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

pub fn signal(name: &str, pid: u32) {
    assert!(Command::new("kill").args([name, &pid.to_string()]).status().unwrap().success());
}

#[cfg(target_os = "linux")]
#[test]
fn a_rank_that_is_killed_ends_all_and_is_named() {
    for victim in [0, 1, 2] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("in.deck"), endless()).unwrap();
        let first = start(folder.path(), PERIGRAIN, &["-in", "in.deck", "-ranks", "3", "-threads", "1"]);
        let mut ranks = vec![first.id()];
        wait_for("ranks begin", || {
            ranks = [vec![first.id()], children(first.id())].concat();
            ranks.len() == 3
                && fs::read_to_string(folder.path().join("log.lammps"))
                    .is_ok_and(|t| t.contains("\n      1000 ") || t.contains(" 1000 "))
        });
        ranks[1..].sort();
        let begin = Instant::now();
        signal("-9", ranks[victim]);
        let o = first.wait_with_output().unwrap();
        assert!(!o.status.success() && begin.elapsed() < Duration::from_secs(10));
        if victim > 0 {
            assert!(output_of(&o).contains(&format!("rank {victim} has ended")), "{}", output_of(&o));
        }
        wait_for("all are gone", || {
            ranks.iter().all(|pid| {
                !Path::new(&format!("/proc/{pid}/exe")).exists()
                    || fs::read_link(format!("/proc/{pid}/exe")).is_err()
            })
        });
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_request_to_end_at_any_rank_leaves_the_restart_file_of_one_step() {
    for asked in [0, 2] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("in.deck"), endless()).unwrap();
        let first = start(folder.path(), PERIGRAIN, &["-in", "in.deck", "-ranks", "3", "-threads", "1"]);
        let mut ranks = vec![];
        wait_for("ranks begin", || {
            ranks = [vec![first.id()], children(first.id())].concat();
            ranks.len() == 3
                && fs::read_to_string(folder.path().join("log.lammps")).is_ok_and(|t| t.contains(" 1000 "))
        });
        signal("-TERM", ranks[asked]);
        let o = first.wait_with_output().unwrap();
        assert_eq!(o.status.code(), Some(130), "{}", output_of(&o));
        assert!(output_of(&o).contains("Interrupted"), "{}", output_of(&o));
        assert!(folder.path().join("a.restart").exists(), "{}", output_of(&o));
    }
}

#[test]
fn processes_of_a_launcher_that_cannot_join_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("in.deck"), "print hello\n").unwrap();
    fs::write(folder.path().join("log.lammps"), "an earlier log\n").unwrap();
    let launched = |args: &[&str], mpi: &str| {
        let mut command = Command::new(PERIGRAIN);
        command.args(args).current_dir(folder.path()).stdin(Stdio::null());
        command.env("OMPI_COMM_WORLD_SIZE", "2").env("OMPI_COMM_WORLD_RANK", "0").env("PERIGRAIN_MPI", mpi);
        command.output().unwrap()
    };
    let o = launched(&["-in", "in.deck"], "/no/such/libmpi.so");
    assert_eq!(o.status.code(), Some(2));
    let words = output_of(&o);
    assert!(
        words.contains("error: Open MPI has started 2 processes, which cannot join")
            && words.contains("PERIGRAIN_MPI=none"),
        "{words}"
    );
    assert_eq!(fs::read_to_string(folder.path().join("log.lammps")).unwrap(), "an earlier log\n");
    // A library that is none.
    let o = launched(&["-in", "in.deck"], "libc.so.6");
    assert!(
        o.status.code() == Some(2) && output_of(&o).contains("has no MPI_Init_thread"),
        "{}",
        output_of(&o)
    );
    for (args, why) in [
        (&["check", "in.deck"][..], "this is work for one"),
        (&["-in", "in.deck", "-ranks", "2"], "`-ranks` would start more of them"),
        (&["repl"], "lines are typed into one"),
    ] {
        let o = launched(args, "");
        assert!(o.status.code() == Some(2) && output_of(&o).contains(why), "{args:?}: {}", output_of(&o));
    }
    let o = launched(&["-in", "in.deck"], "none");
    assert!(o.status.success() && output_of(&o).contains("hello"), "each by itself: {}", output_of(&o));
}

/// Where the launchers of Debian's packages are.
pub const LAUNCHERS: [(&str, &[&str], &str); 2] = [
    ("/usr/bin/mpirun.openmpi", &["--allow-run-as-root", "--oversubscribe"], "Open MPI"),
    ("/usr/bin/mpiexec.mpich", &[], "MPICH"),
];

/// Whether this launcher is there and starts something: machines that allow no sockets or no shared memory cannot.
pub fn works((launcher, own, _): &(&str, &[&str], &str)) -> bool {
    let start = || {
        let folder = tempfile::tempdir().unwrap();
        start(folder.path(), launcher, &[*own, &["-n", "2", "true"]].concat()).wait_with_output().unwrap()
    };
    let works = Path::new(launcher).exists() && start().status.success();
    if !works {
        eprintln!("skipped: {launcher} is not there, or starts no processes here");
    }
    works
}

#[test]
fn real_launchers_have_the_same_bytes() {
    for (launcher, own, library) in LAUNCHERS.into_iter().filter(works) {
        for scene in SCENES.iter().step_by(5) {
            let list: &[&str] = if scene.list { &["-layout", "list"] } else { &[] };
            let deck = deck_of(scene);
            let alone = left_by(&deck, &[&["-threads", "1"], list].concat());
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("in.deck"), &deck).unwrap();
            let words =
                [own, &["-n", "2", PERIGRAIN, "-in", "in.deck", "-screen", "none", "-threads", "1"], list]
                    .concat();
            let o = start(folder.path(), launcher, &words).wait_with_output().unwrap();
            assert!(o.status.success(), "{launcher}: {}", output_of(&o));
            same(&alone, &files(folder.path()), &format!("{} by {launcher}", scene.name));
        }
        let folder = tempfile::tempdir().unwrap();
        let o = start(folder.path(), launcher, &[own, &["-n", "3", PERIGRAIN, "ranks"]].concat())
            .wait_with_output()
            .unwrap();
        assert!(
            output_of(&o).contains(library) && output_of(&o).contains("3 ranks on 1 host"),
            "{}",
            output_of(&o)
        );
        // Processes with another environment run the deck of the first one.
        fs::write(folder.path().join("in.deck"), "variable a getenv OWN\nprint \"OWN is $a\"\n").unwrap();
        let one = |own: &'static str| ["-n", "1", "env", own, PERIGRAIN, "-in", "in.deck"];
        let words = [own, &one("OWN=1"), &[":"], &one("OWN=2")].concat();
        let o = start(folder.path(), launcher, &words).wait_with_output().unwrap();
        assert!(o.status.success() && output_of(&o).matches("OWN is 1").count() == 1, "{}", output_of(&o));
        // One that was started with other words does not.
        let words = [own, &one("OWN=1"), &[":"], &one("OWN=2"), &["-var", "x", "1"]].concat();
        let o = start(folder.path(), launcher, &words).wait_with_output().unwrap();
        assert!(
            !o.status.success() && output_of(&o).matches("was started with other words").count() == 1,
            "{}",
            output_of(&o)
        );
    }
}

#[test]
fn nothing_is_linked_against_mpi() {
    let o = Command::new("ldd").arg(PERIGRAIN).output();
    if let Ok(o) = o {
        assert!(!output_of(&o).contains("mpi"), "{}", output_of(&o));
    }
}
