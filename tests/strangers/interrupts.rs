//! K5: What an interrupt leaves behind is what `write_restart` writes at that step; all long work sees one stop flag.

use super::text;
use crate::restart::scenes::{self, SCENES, Scene};
use crate::restart::{bits, memory, rows};
use perigrain::output::log::{Buffer, Log};
use perigrain::session::{Made, Options, Session, Watch};
use perigrain::world::World;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Sets the stop flag once a step is made, as a signal does at a moment of its own.
struct At {
    step: i64,
    stop: Arc<AtomicBool>,
}

impl Watch for At {
    fn step(&mut self, made: &Made) {
        if made.step >= self.step {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
}

/// Executes a deck, `DIR` being the folder, and interrupts it at the first whole step from a step on. The scene at its end, its
/// output, and whether it was interrupted.
fn work(folder: &Path, deck: &str, list: bool, interrupt: Option<i64>) -> (World, String, bool) {
    let screen = Buffer::default();
    let log = Log::new(Some(Box::new(screen.clone())));
    let mut session = Session::new(Options { log, force_list: list, ..Options::default() }).unwrap();
    if let Some(step) = interrupt {
        let stop = session.stop_flag();
        session.set_watch(Box::new(At { step, stop }));
    }
    let deck = deck.replace("DIR", folder.to_str().unwrap());
    let ending =
        session.run_text("in.deck", &deck).unwrap_or_else(|e| panic!("{deck}\n{e}\n{}", screen.text()));
    (session.world, screen.text(), ending.interrupted)
}

/// Grains that lean on triangles.
const ON_MESH: &str = "pair_style gran/hooke/history 5000.0 NULL 20.0 NULL 0.5 1\npair_coeff * *\n\
    fix low all wall/mesh granular hertz 5000.0 20.0 tangential linear_history 2000.0 0.5 0.4 mesh DIR/floor.stl\n\
    neighbor 0.1 bin\nneigh_modify every 1 delay 0 check yes\nfix 1 all nve/sphere\n\
    fix 2 all gravity 1.0 vector 0.2 0 -1\ntimestep 0.002\ncompute er all erotate/sphere\n\
    thermo_style custom step time ke c_er press\nthermo_modify format float %24.17g norm no\nthermo 5\n";
/// Two triangles below the pile.
const FLOOR: &str = "solid floor\nfacet normal 0 0 1\nouter loop\nvertex -9 -9 0.5\nvertex 19 -9 0.5\nvertex -9 19 0.5\nendloop\n\
    endfacet\nfacet normal 0 0 1\nouter loop\nvertex 19 -9 0.5\nvertex 19 19 0.5\nvertex -9 19 0.5\nendloop\nendfacet\nendsolid floor\n";

/// Pairs of grains of the pile as rigid bodies, one kind of fix or the other.
const BODIES: &str = "units lj\natom_style hybrid sphere bond\nboundary p p s\nlattice sc 1.0\n\
    region world block 0 4 0 4 0 9 units box\ncreate_box 1 world\nregion fill block 0.3 3.9 0.3 3.9 0.6 3.5 units box\n\
    lattice sc 1.2\ncreate_atoms 1 region fill\nset group all diameter 1.15\nset group all density 1.2\n\
    set atom 1*2 mol 1\nset atom 3*4 mol 2\nset atom 8*9 mol 3\n\
    variable u0 atom 0.9*sin(2.0*y+z)\nvelocity all set v_u0 0.2 -0.5\n";
const RIGID: &str = "group a id 1 2\ngroup b id 3 4\ngroup c id 8 9\ngroup stiff union a b c\ngroup loose subtract all stiff\n\
    pair_style gran/hooke/history 5000.0 NULL 20.0 NULL 0.5 1\npair_coeff * *\n\
    neigh_modify exclude molecule/intra stiff\nfix 3 stiff rigid group 3 a b c\nfix 1 loose nve/sphere\n\
    fix 2 all gravity 1.0 vector 0.2 0 -1\nneighbor 0.1 bin\ntimestep 0.002\n\
    thermo_style custom step time ke press\nthermo_modify format float %24.17g norm no\nthermo 5\n";
const RIGID_SMALL: &str = "group stiff id 1 2 3 4 8 9\ngroup loose subtract all stiff\n\
    pair_style gran/hooke/history 5000.0 NULL 20.0 NULL 0.5 1\npair_coeff * *\n\
    neigh_modify exclude molecule/intra stiff\nfix 3 stiff rigid/small molecule\nfix 1 loose nve/sphere\n\
    fix 2 all gravity 1.0 vector 0.2 0 -1\nneighbor 0.1 bin\ntimestep 0.002\n\
    thermo_style custom step time ke press\nthermo_modify format float %24.17g norm no\nthermo 5\n";

/// The pile in a box that leans.
const LEANING: &str = "units lj\natom_style sphere\nboundary p p p\nlattice sc 1.0\n\
    region world prism 0 4 0 4 0 4 0.8 0.2 0.3 units box\ncreate_box 1 world\nlattice sc 1.0\ncreate_atoms 1 box\n\
    set group all diameter 1.03\nset group all density 1.2\n\
    variable u0 atom 0.9*sin(2.0*y+z)\nvelocity all set v_u0 0.2 -0.5\n";

/// The ball on the plate, which moves in three short steps to one of the ball.
const STAGGERED: &str = "pair_style hybrid/overlay peri/pmb granular\n\
    pair_coeff * * granular hertz/material 5.0e9 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4\n\
    pair_coeff 1 1 peri/pmb material glass horizon 3.01\n\
    pair_coeff 2 2 granular hertz/material 5.0e9 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4\n\
    neighbor 0.0005 bin\nfix 1 plate nve\nfix 2 ball nve/sphere\nrun_style staggered m 3\n\
    compute dmg all damage/atom\ncompute dsum all reduce sum c_dmg\n\
    thermo_style custom step time dt ke c_dsum\nthermo_modify format float %24.17g\nthermo 5\n";

/// What the scenes of `tests/restart` leave out.
const MORE: [Scene; 5] = [
    Scene { name: "mesh", make: scenes::PILE, again: ON_MESH, steps: 120, list: false },
    Scene { name: "rigid", make: BODIES, again: RIGID, steps: 120, list: false },
    Scene { name: "rigid/small", make: BODIES, again: RIGID_SMALL, steps: 120, list: false },
    Scene { name: "leaning", make: LEANING, again: scenes::STIFF_AGAIN, steps: 120, list: false },
    Scene { name: "staggered", make: scenes::IMPACT, again: STAGGERED, steps: 60, list: false },
];

/// The file is that of `write_restart` at this step, byte by byte; a run that continues from it has the bits of an uninterrupted
/// run, in all columns, contacts, bonds and rows.
fn is_whole(s: &Scene) {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("floor.stl"), FLOOR).unwrap();
    let (name, make, again, list) = (s.name, s.make, s.again, s.list);
    // Two steps follow at most before the end: neither of them is a multiple of 5, which rows and averages know.
    let asked = s.steps / 20 * 10 + 1;
    let deck =
        format!("{make}{again}restart 1000000 DIR/cut.*.restart\nrun {}\nprint never\n", s.steps * 1000);
    let (left, printed, interrupted) = work(folder, &deck, list, Some(asked));
    let end = left.clock.step;
    assert!(interrupted && (asked + 1..=asked + 2).contains(&end), "{name}: ended at {end}\n{printed}");
    assert!(
        printed.contains(&format!("Interrupted at step {end}")) && !printed.contains("never"),
        "{name}\n{printed}"
    );

    work(folder, &format!("{make}{again}run {end}\nwrite_restart DIR/written\n"), list, None);
    let file = |name: &str| fs::read(folder.join(name)).unwrap();
    let (cut, written) = (file(&format!("cut.{end}.restart")), file("written"));
    assert!(cut == written, "{name}: the interrupt's file is not that of write_restart");

    let (whole, output_of, _) = work(folder, &format!("{make}{again}run {}\n", end + 20), list, None);
    let on = format!("read_restart DIR/cut.{end}.restart\n{again}run 20\n");
    let (gone_on, printed, _) = work(folder, &on, list, None);
    assert!(!printed.contains("computed anew"), "{name}\n{printed}");
    assert!(bits(&gone_on) == bits(&whole), "{name}: other bits");
    assert!(memory(&gone_on) == memory(&whole), "{name}: contacts, bonds or fixes differ");
    let later = |printed: &str| rows(printed).into_iter().filter(|(step, _)| *step > end).collect::<Vec<_>>();
    assert!(!later(&output_of).is_empty() && later(&output_of) == later(&printed), "{name}: other rows");
}

#[test]
fn the_file_of_an_interrupt_is_that_of_write_restart_in_every_family() {
    SCENES.iter().chain(&MORE).for_each(is_whole);
}

/// Beads whose bonds along edges and diagonals cannot all have their length at rest.
const FRUSTRATED: &str = "atom_style bond\nlattice sc 1.0\nregion world block -3 7 -3 7 -3 7\nregion f block 0 3.1 0 3.1 0 3.1\n\
    create_box 1 world bond/types 1 extra/bond/per/atom 20 extra/special/per/atom 60\ncreate_atoms 1 region f\nmass 1 1\n\
    pair_style zero 3\npair_coeff * *\nbond_style harmonic\nbond_coeff 1 50 1.0\ncreate_bonds many all all 1 0.5 1.5\n\
    displace_atoms all random 0.2 0.2 0.2 4711\nfix 1 all nve\ntimestep 0.01\nthermo_style custom step pe press\n\
    thermo_modify format float %24.17g\nthermo 3\n";

#[test]
fn a_minimization_that_is_interrupted_leaves_the_file_of_write_restart() {
    for style in ["cg", "sd", "fire", "quickmin"] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let make = format!("{FRUSTRATED}min_style {style}\n");
        let deck = format!("{make}restart 2 DIR/each.*.restart\nminimize 0 0 500 5000\n");
        let (left, printed, interrupted) = work(folder, &deck, false, Some(4));
        let end = left.clock.step;
        assert!(interrupted && end == 5 && printed.contains("Interrupted at step 5"), "{style}\n{printed}");
        work(folder, &format!("{make}minimize 0 0 {end} 5000\nwrite_restart DIR/written\n"), false, None);
        let (cut, written) = (fs::read(folder.join("each.5.restart")), fs::read(folder.join("written")));
        assert!(
            cut.unwrap() == written.unwrap(),
            "{style}: the interrupt's file is not that of write_restart"
        );
        // Files on the way hold the deck's time step, whatever the minimizer makes of it, and forces that the next run
        // computes anew as after a minimization that was made to its end.
        let saved = perigrain::output::restart::read(&folder.join("each.4.restart")).unwrap();
        assert_eq!((saved.world.clock.dt, saved.ran, saved.standing), (0.01, false, false), "{style}");
    }
}

#[test]
fn a_signal_between_two_runs_leaves_what_the_last_one_left() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let make = format!("{}{}", scenes::PILE, scenes::PILE_AGAIN);
    // The flag is set in the last step: the run is over, and no line follows.
    let deck = format!("{make}restart 1000 DIR/cut.*.restart\nrun 33\nprint never\nrun 10\n");
    let (_, printed, interrupted) = work(folder, &deck, false, Some(33));
    assert!(
        interrupted && printed.contains("Interrupted behind in.deck:") && !printed.contains("\nnever"),
        "{printed}"
    );
    work(folder, &format!("{make}run 33\nwrite_restart DIR/written\n"), false, None);
    let file = |name: &str| fs::read(folder.join(name)).unwrap();
    assert!(file("cut.33.restart") == file("written"));
}

/// Two grains that stick, of which the upper one is drawn to and fro (the trial's `sigterm_contacts`).
const STICK: &str = "units si\natom_style sphere\nboundary f f f\nregion w block -0.02 0.02 -0.02 0.02 -0.02 0.03 units box\n\
    create_box 1 w\ncreate_atoms 1 single 0 0 0 units box\ncreate_atoms 1 single 0 0 0.0099987 units box\n\
    set group all diameter 0.01 density 2500\ngroup top id 2\n";
const STICK_AGAIN: &str = "pair_style gran/hooke/history 1e4 NULL 50 NULL 0.9 1\npair_coeff * *\nfix 1 top nve\n\
    fix g top gravity 9.81 vector 0 0 -1\nvariable f equal 0.004*sin(time*20)\nfix a top addforce v_f 0 0\n\
    timestep 1e-6\nvariable fx equal fx[2]\nvariable fz equal fz[2]\nthermo_style custom step v_fx v_fz v_f\n\
    thermo_modify norm no format float %.17g\n";

/// The program at work on a deck of a folder, on one thread.
fn program(folder: &Path, deck: &str, arguments: &[&str]) -> Child {
    fs::write(folder.join("in.deck"), deck).unwrap();
    Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["-in", "in.deck", "-threads", "1"])
        .args(arguments)
        .current_dir(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Waits until a log holds the row of a step.
fn await_row(folder: &Path, log: &str, step: &str) {
    let began = Instant::now();
    let log = || fs::read_to_string(folder.join(log)).unwrap_or_default();
    while !log().lines().any(|l| l.split_whitespace().next() == Some(step)) {
        assert!(began.elapsed() < Duration::from_secs(60), "no row of step {step} in\n{}", log());
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[cfg(unix)]
#[test]
fn a_signal_or_a_limit_of_time_leaves_the_springs_of_pairs() {
    for arguments in [&["-screen", "none"][..], &["-screen", "none", "-timeout", "1"]] {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let deck =
            format!("{STICK}{STICK_AGAIN}thermo 1000\nrestart 1000000000 r.*.restart\nrun 4000000000\n");
        let child = program(folder, &deck, arguments);
        if arguments.len() == 2 {
            // Rows are in the log during the run.
            await_row(folder, "log.lammps", "5000");
            terminate(&child);
        }
        let output = child.wait_with_output().unwrap();
        assert_eq!(
            output.status.code(),
            Some(if arguments.len() == 2 { 130 } else { 0 }),
            "{}",
            text(&output)
        );
        let left = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
        let left: Vec<i64> =
            left.filter_map(|n| n.strip_prefix("r.")?.strip_suffix(".restart")?.parse().ok()).collect();
        let [end] = left[..] else { panic!("{left:?}\n{}", text(&output)) };
        let deck = format!("{STICK}{STICK_AGAIN}thermo 1000\nrun {end}\nwrite_restart written\n");
        let written = program(folder, &deck, &["-log", "none"]).wait_with_output().unwrap();
        assert!(written.status.success(), "{}", text(&written));
        let (cut, written) = (format!("r.{end}.restart"), "written");
        let file = |name: &str| fs::read(folder.join(name)).unwrap();
        assert!(file(&cut) == file(written), "{arguments:?}: other files at step {end}");
    }
}

/// Requests a process to end, as `kill` does.
#[cfg(unix)]
fn terminate(child: &Child) {
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
}

#[cfg(unix)]
#[test]
fn partitions_end_at_whole_steps_when_their_program_is_stopped() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let deck = format!(
        "{STICK}{STICK_AGAIN}thermo 1000\nvariable w uloop 2\n\
        restart 1000000000 r$w.*.restart\nrun 4000000000\n"
    );
    let child = program(folder, &deck, &["-partition", "2x1"]);
    for log in ["log.lammps.0", "log.lammps.1"] {
        await_row(folder, log, "5000");
    }
    terminate(&child);
    // As a queue does that reaches some processes twice: it is one request.
    terminate(&child);
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", text(&output));
    let left = fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let left: Vec<String> = left.filter(|n| n.ends_with(".restart")).collect();
    assert_eq!(left.len(), 2, "{left:?}\n{}", text(&output));
}

/// Decks with a line that would take days, or a loop without an end, by name.
const ENDLESS: [(&str, &str); 7] = [
    (
        "calibrate ste",
        "units si\natom_style hybrid sphere bond\nboundary f f f\nlattice fcc 1.4142e-3\n\
        region b block -0.1 2.9 -0.1 2.9 -0.1 2.9\ncreate_box 1 b bond/types 1 extra/bond/per/atom 12\n\
        create_atoms 1 box\nset group all diameter 1e-3\nspecial_bonds lj/coul 0 1 1\n\
        create_bonds many all all 1 0.9e-3 1.1e-3\nbond_style harmonic\nbond_coeff 1 2.5e5 1e-3\n\
        calibrate ste a all axis z order 1000000000 slabs auto\nprint never\n",
    ),
    (
        "create_atoms random",
        "units lj\natom_style sphere\nregion w block 0 9 0 9 0 9\ncreate_box 1 w\n\
        create_atoms 1 random 100000 4711 NULL overlap 1 maxtry 1000000\nprint never\n",
    ),
    (
        "create_atoms pack",
        "units lj\natom_style sphere\nregion w block 0 90 0 90 0 90\ncreate_box 1 w\n\
        create_atoms 1 pack w 0.64 77 sizes mono 1 rounds 1000000000\nprint never\n",
    ),
    ("shell", "shell (sleep 86413; true); true\nprint never\n"),
    (
        "respa",
        "units lj\natom_style sphere\nregion w block 0 12 0 12 0 8\ncreate_box 1 w\ncreate_atoms 1 single 4 4 4\n\
        pair_style gran/hooke 1000 NULL 5 NULL 0.5 1\npair_coeff * *\nfix 1 all nve/sphere\ntimestep 1e-9\n\
        run_style respa 2 1000000\nrun 1000\nprint never\n",
    ),
    (
        "pictures",
        "units lj\nregion w block 0 24 0 24 0 24\ncreate_box 1 w\nlattice sc 1\ncreate_atoms 1 box\nmass 1 1\n\
        dump p all image 1 DIR/p.*.png type 12 size 4000 3000\npair_style none\nfix 1 all nve\nrun 1000\nprint never\n",
    ),
    (
        "a loop around clear",
        "label again\nclear\nunits lj\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\njump SELF again\n",
    ),
];

#[test]
fn all_long_work_ends_at_a_signal() {
    for (name, deck) in ENDLESS {
        let screen = Buffer::default();
        let log = Log::new(Some(Box::new(screen.clone())));
        let mut session = Session::new(Options { log, ..Options::default() }).unwrap();
        let stop = session.stop_flag();
        let waiter = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(150));
            stop.store(true, Ordering::Relaxed);
            Instant::now()
        });
        let folder = tempfile::tempdir().unwrap();
        let ending = session.run_text("in.deck", &deck.replace("DIR", folder.path().to_str().unwrap()));
        let late = waiter.join().unwrap().elapsed();
        let printed = screen.text();
        assert!(ending.is_ok_and(|e| e.interrupted) && !printed.contains("never"), "{name}\n{printed}");
        assert!(printed.contains("Interrupted "), "{name}\n{printed}");
        // Half a second between two looks, two seconds to end a long step, and a machine that is busy with other tests.
        assert!(late < Duration::from_secs(8), "{name}: {late:?}");
    }
    // What a shell has started ends with it.
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let words = processes.filter_map(|p| fs::read_to_string(p.path().join("cmdline")).ok());
    assert!(!words.into_iter().any(|words| words.starts_with("sleep\u{0}86413")), "a command is left");
}

#[test]
fn a_limit_of_time_ends_lines_too() {
    for (name, deck) in [ENDLESS[0], ENDLESS[6]] {
        let folder = tempfile::tempdir().unwrap();
        let began = Instant::now();
        let output =
            program(folder.path(), deck, &["-log", "none", "-timeout", "1"]).wait_with_output().unwrap();
        let printed = text(&output);
        assert_eq!(output.status.code(), Some(1), "{name}\n{printed}");
        assert!(
            printed.contains("PG0209") && printed.contains("the limit of `-timeout` has passed"),
            "{name}\n{printed}"
        );
        // A second, and two more that lines are given.
        assert!(began.elapsed() > Duration::from_millis(2900), "{name}: {:?}", began.elapsed());
    }
}

/// The program's output for a deck under some arguments.
fn output_of(deck: &str, arguments: &[&str]) -> Output {
    let folder = tempfile::tempdir().unwrap();
    program(folder.path(), deck, &[&["-log", "none"], arguments].concat()).wait_with_output().unwrap()
}

#[test]
fn short_steps_count_and_have_a_bound() {
    let refused = output_of(&ENDLESS[4].1.replace("respa 2 1000000", "respa 3 2000 4000"), &[]);
    let printed = text(&refused);
    assert!(
        printed.contains("8000000 of the shortest steps would fill one of the longest, 1000000 may"),
        "{printed}"
    );
    let deck = ENDLESS[4].1.replace("respa 2 1000000\nrun 1000", "respa 2 4\nrun 3");
    let counted = output_of(&deck, &["-safe", "-limit", "steps", "11"]);
    assert!(
        text(&counted).contains("3 steps of 4 short ones each after 0 would be more than the 11"),
        "{}",
        text(&counted)
    );
    assert!(output_of(&deck, &["-safe", "-limit", "steps", "12"]).status.success());
}

#[cfg(unix)]
#[test]
fn a_file_that_outgrows_its_limit_is_an_error_of_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let deck = format!("{}{}restart 3 r.*.restart\nrun 10\n", scenes::PILE, scenes::PILE_AGAIN);
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    // A pile's restart file takes 30 KB and more; 16 blocks are 8 or 16 KB, by the shell.
    let line = format!("ulimit -f 16; exec {} -in in.deck -threads 1", env!("CARGO_BIN_EXE_perigrain"));
    let output = Command::new("sh").args(["-c", &line]).current_dir(folder.path()).output().unwrap();
    let printed = text(&output);
    assert_eq!(output.status.code(), Some(1), "{printed}");
    assert!(printed.contains("cannot write `r.3.restart`: File too large"), "{printed}");
    let names = fs::read_dir(folder.path()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    let names: Vec<String> = names.collect();
    assert!(names.iter().all(|n| !n.ends_with(".part") && !n.ends_with(".restart")), "{names:?}");
    let log = fs::read_to_string(folder.path().join("log.lammps")).unwrap();
    assert!(log.contains("PG0118") || log.contains("File too large"), "{log}");
}
