//! A run cut in two by a restart file has the bits of one run: bonds, contacts, fixes with state, in every layout.

mod forged;
mod kill;
mod refusals;
pub mod scenes;

use perigrain::output::log::{Buffer, Log};
use perigrain::session::{Options, Session};
use perigrain::world::World;
use scenes::*;
use std::path::Path;

/// Executes a deck, `DIR` being the folder; the world at the end and all output.
fn run(folder: &Path, deck: &str, list: bool) -> (World, String) {
    let screen = Buffer::default();
    let options =
        Options { log: Log::new(Some(Box::new(screen.clone()))), force_list: list, ..Options::default() };
    let mut session = Session::new(options).unwrap();
    let deck = deck.replace("DIR", folder.to_str().unwrap());
    session.run_text("in.deck", &deck).unwrap_or_else(|e| panic!("{deck}\n{e}\n{}", screen.text()));
    (session.world, screen.text())
}

/// Thermo rows by step.
pub fn rows(printed: &str) -> Vec<(i64, String)> {
    let numbers =
        |l: &&str| l.split_whitespace().count() > 1 && l.split_whitespace().all(|w| w.parse::<f64>().is_ok());
    printed
        .lines()
        .filter(numbers)
        .map(|l| (l.split_whitespace().next().unwrap().parse().unwrap(), l.to_string()))
        .collect()
}

pub fn bits(w: &World) -> Vec<u64> {
    let p = &w.particles;
    let vectors = [&p.x, &p.v, &p.f, &p.omega, &p.torque, &p.x0].into_iter().flatten().flatten();
    let scalars = [&p.mass, &p.radius, &p.volume].into_iter().flatten();
    let clock = [w.clock.time(), w.clock.dt, w.clock.step as f64];
    vectors.chain(scalars).map(|a| a.to_bits()).chain(clock.map(f64::to_bits)).collect()
}

/// Broken bonds and history, as text.
pub fn memory(w: &World) -> String {
    let bonds = w.families.as_ref().map(|f| {
        let alive: Vec<_> = f.lattices.iter().map(|b| &b.alive).collect();
        format!("{alive:?} {:?} {:?}", f.list.alive, f.damaged)
    });
    let state: Vec<_> = w.memo.iter().filter(|(name, _)| !name.text().starts_with("restart/")).collect();
    format!("{bonds:?} {:?} {:?} {state:?} {:?}", w.contacts, w.wall_contacts, w.particles.image)
}

#[test]
fn a_run_cut_in_two_has_the_bits_of_one() {
    for s in &SCENES {
        let folder = tempfile::tempdir().unwrap();
        let (half, steps) = (s.steps / 2 + 3, s.steps);
        let (make, again) = (s.make, s.again);
        let (whole, printed) = run(folder.path(), &format!("{make}{again}run {steps}"), s.list);
        let whole_rows = rows(&printed);
        // There is something to lose: broken bonds, or springs of contacts.
        let broken = whole.families.as_ref().is_some_and(|f| f.damaged.iter().any(|h| *h));
        let touching = whole.contacts.values().chain(whole.wall_contacts.values());
        let springs = touching.flat_map(|c| &c.history).any(|h| *h != 0.0);
        // Of rain: the streams of random numbers.
        let streams = !whole.memo.is_empty();
        let at_stake = match s.name {
            "rain" | "stream" => streams,
            // Of 184 bonds some are gone, and some were made between ends that stand otherwise.
            name if name.starts_with("beams") => {
                (5..180).contains(&whole.bonds.len()) && !whole.bonds.turned.is_empty()
            }
            name if name.ends_with("pile") => springs,
            _ => broken,
        };
        assert!(at_stake, "{}", s.name);
        // Files are written on the way, and the run they come from is not disturbed.
        let watched = format!(
            "{make}{again}restart {half} DIR/a.*.restart\nrestart 7 DIR/even.restart DIR/odd.restart\nrun {steps}"
        );
        let (same, _) = run(folder.path(), &watched, s.list);
        assert!(bits(&same) == bits(&whole), "{}: writing changes the run", s.name);
        // Between two runs, with a file that is not on a multiple of anything.
        let written = format!("{make}{again}run {half}\nwrite_restart DIR/between.restart\nrun 1\n");
        run(folder.path(), &written, s.list);

        let last_turn = steps / 7 * 7;
        let turn = if (steps / 7) % 2 == 1 { "even" } else { "odd" };
        for (file, step) in [
            (format!("a.{half}.restart"), half),
            ("a.*.restart".to_string(), half),
            ("between.restart".to_string(), half),
            (format!("{turn}.restart"), last_turn),
        ] {
            let deck = format!("read_restart DIR/{file}\n{again}run {steps} upto");
            let (cut, printed) = run(folder.path(), &deck, s.list);
            let what = format!("{}, {file}", s.name);
            assert!(!printed.contains("computed anew"), "{what}: {printed}");
            assert!(bits(&cut) == bits(&whole), "{what}: other bits");
            assert!(memory(&cut) == memory(&whole), "{what}: bonds, contacts or fixes differ");
            let rest: Vec<_> = whole_rows.iter().filter(|(k, _)| *k > step).cloned().collect();
            let got: Vec<_> = rows(&printed).into_iter().filter(|(k, _)| *k > step).collect();
            assert!(!rest.is_empty());
            assert_eq!(got, rest, "{what}");
        }
    }
}

#[test]
fn the_first_row_shows_what_the_last_one_showed() {
    for s in &SCENES {
        let folder = tempfile::tempdir().unwrap();
        let (make, again) = (s.make, s.again);
        let deck = format!("{make}{again}run {}\nwrite_restart DIR/a", s.steps / 2);
        let (_, before) = run(folder.path(), &deck, s.list);
        let (_, after) = run(folder.path(), &format!("read_restart DIR/a\n{again}run 0"), s.list);
        assert_eq!(rows(&before).last(), rows(&after).first(), "{}", s.name);
    }
}

#[test]
fn a_scene_from_which_all_have_gone_continues() {
    let folder = tempfile::tempdir().unwrap();
    let again = "pair_style gran/hooke/history 200 NULL 5 NULL 0.5 1\npair_coeff * *\nfix 1 all nve/sphere\n";
    let deck = format!(
        "atom_style sphere\nregion b block 0 9 0 9 0 9\ncreate_box 1 b\ncreate_atoms 1 single 5 5 5\n{again}\
         fix e all evaporate 1 5 b 4711\nrun 3\nunfix e\nrun 2\nwrite_restart DIR/a"
    );
    run(folder.path(), &deck, false);
    let (w, _) = run(folder.path(), &format!("read_restart DIR/a\n{again}run 3"), false);
    assert_eq!((w.n(), w.clock.step), (0, 8));
}

#[test]
fn other_declarations_compute_forces_anew_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &format!("{BLOCK}{BLOCK_AGAIN}run 10\nwrite_restart DIR/a"), false);
    for (line, why) in [
        ("fix 2 all viscous 0.1\n", "was not written under `fix 2 all viscous 0.1`"),
        ("pair_coeff 1 1 1.7e21 0.0030001 0.0015 0.25\n", "was not written under `pair_coeff"),
        ("velocity all zero linear\n", "particles or bonds are not those"),
        ("timestep 1e-8\n", "settings, particles or bonds"),
        ("unfix 1\nfix 1 all nve/noforce\n", "was not written under `fix 1 all nve/noforce`"),
        ("unfix 1\n", "was written under `fix 1 all nve`"),
    ] {
        let (_, printed) =
            run(folder.path(), &format!("read_restart DIR/a\n{BLOCK_AGAIN}{line}run 1"), false);
        assert!(printed.contains("forces are computed anew") && printed.contains(why), "{line}: {printed}");
    }
    // What does not touch forces does not count.
    let harmless =
        "group left id 1 2 3\nregion r block 0 1 0 1 0 1\ncompute e all ke\nvariable a equal ke\nthermo 1\n";
    let (_, printed) =
        run(folder.path(), &format!("read_restart DIR/a\n{BLOCK_AGAIN}{harmless}run 1"), false);
    assert!(!printed.contains("computed anew"), "{printed}");
    // Nor does a lattice that came after the pair's lines, which are repeated behind the file that has it.
    let later = format!("{BLOCK}{BLOCK_AGAIN}lattice sc 0.002\nrun 10\nwrite_restart DIR/b");
    run(folder.path(), &later, false);
    let (_, printed) = run(folder.path(), &format!("read_restart DIR/b\n{BLOCK_AGAIN}run 1"), false);
    assert!(!printed.contains("computed anew"), "{printed}");
}

#[test]
fn the_pair_style_comes_with_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, _) =
        run(folder.path(), &format!("{BLOCK}{BLOCK_AGAIN}run 10\nwrite_restart DIR/a\nrun 10"), false);
    let (cut, printed) = run(folder.path(), "read_restart DIR/a\nfix 1 all nve\nrun 10", false);
    assert!(printed.contains("restoring pair style peri/pmb"), "{printed}");
    assert!(bits(&whole) == bits(&cut));
    // From a file to a file.
    let (twice, _) = run(
        folder.path(),
        "read_restart DIR/a\nfix 1 all nve\nrun 4\nwrite_restart DIR/b\nclear\nread_restart DIR/b\nfix 1 all nve\nrun 6",
        false,
    );
    assert!(bits(&whole) == bits(&twice));
}

#[test]
fn coefficients_that_a_fix_has_changed_come_with_the_file() {
    const CHAIN: &str = "atom_style bond\natom_modify map array\nregion b block 0 20 0 20 0 20\n\
        create_box 1 b bond/types 1 extra/bond/per/atom 3 extra/special/per/atom 6\ncreate_atoms 1 single 1 1 1\n\
        create_atoms 1 single 2 1 1\ncreate_atoms 1 single 3.1 1 1\nmass 1 1\npair_style zero 3\npair_coeff * *\n\
        bond_style harmonic\nbond_coeff 1 50 1.0\ncreate_bonds single/bond 1 1 2\ncreate_bonds single/bond 1 2 3\n";
    for words in ["", " scale yes", " reset yes"] {
        let again = format!(
            "variable k equal 2+step\nfix a all adapt 5 bond harmonic k 1 v_k{words}\nfix 1 all nve\n\
             thermo_style custom step ebond\nthermo_modify format float %24.17g\nthermo 1\n"
        );
        let folder = tempfile::tempdir().unwrap();
        let whole = format!(
            "{CHAIN}{again}restart 7 DIR/mid.restart DIR/other.restart\nrun 13\nwrite_restart DIR/end"
        );
        let (_, printed) = run(folder.path(), &whole, false);
        let (whole, more) = run(folder.path(), &format!("{CHAIN}{again}run 13\nrun 7"), false);
        let from =
            |file: &str| run(folder.path(), &format!("read_restart DIR/{file}\n{again}run 20 upto"), false);
        let (end, rest) = from("end");
        assert!(bits(&end) == bits(&whole), "{words}: after the run\n{more}\n{rest}");
        let deck = format!("read_restart DIR/mid.restart\n{again}run 13 upto");
        let (_, rest) = run(folder.path(), &deck, false);
        assert_eq!(
            rows(&rest).last(),
            rows(&printed).last(),
            "{words}: in the middle of a run\n{printed}\n{rest}"
        );
    }
}

#[test]
fn regions_and_materials_may_be_declared_again_once() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &format!("{IMPACT}{IMPACT_AGAIN}run 0\nwrite_restart DIR/a"), false);
    let again = "region plate sphere 0 0 0 1\nmaterial glass E 7e10 nu 0.25 rho 2235\n";
    run(folder.path(), &format!("read_restart DIR/a\n{again}"), false);
    let mut session = Session::new(Options::default()).unwrap();
    let deck = format!("read_restart {}/a\n{again}{again}", folder.path().display());
    assert!(session.run_text("in.deck", &deck).unwrap_err().to_string().contains("exists already"));
}

#[test]
fn unclaimed_state_is_dropped_with_a_note() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &format!("{PILE}{PILE_AGAIN}run 10\nwrite_restart DIR/a"), false);
    let (world, printed) = run(folder.path(), "read_restart DIR/a\nfix 9 all nve/sphere\nrun 1", false);
    assert!(printed.contains("holds state of move/3, which no fix or compute has claimed"), "{printed}");
    assert!(world.memo.is_empty() && world.columns.names().is_empty());
}
