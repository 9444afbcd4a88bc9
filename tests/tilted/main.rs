//! Boxes that lean, at rest and sheared, against LAMMPS' numbers, and against themselves in pieces and on several threads.
//!
//! `golden/NAME.txt` holds the thermo table that LAMMPS 22Jul2025 prints for `NAME.in`, 15 digits per number, other files of that
//! name what it writes.

use super::fixes::thermo::{self, run, run_in};
use perigrain::session::{Session, set_threads};
use std::fs;
use std::path::Path;

/// LAMMPS turns places into fractions of the box and back at every rebuild of its lists: an ulp each time, which collisions
/// make some hundred times larger in these decks.
const TOLERANCE: f64 = 1e-10;

/// Compares a deck's thermo table with LAMMPS', and the files that it writes word by word.
fn agrees(name: &str, files: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    thermo::agrees("tilted", name, TOLERANCE, |deck| {
        let _alone = super::folder();
        std::env::set_current_dir(&folder).unwrap();
        let (_, ours) = run_in(folder.path(), name, deck, true);
        std::env::set_current_dir("/").unwrap();
        ours
    });
    for file in files {
        let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/tilted/golden").join(file);
        let ours = fs::read_to_string(folder.path().join(file)).unwrap();
        let golden = fs::read_to_string(golden).unwrap();
        assert_eq!(ours.lines().count(), golden.lines().count(), "{file}");
        for (row, (ours, golden)) in ours.lines().zip(golden.lines()).enumerate() {
            let same = |(a, b): (&str, &str)| match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(a), Ok(b)) => (a - b).abs() <= 1e-6 * b.abs().max(1e-4),
                _ => a == b,
            };
            let (a, b) = (ours.split_whitespace(), golden.split_whitespace());
            let alike = a.clone().count() == b.clone().count() && a.zip(b).all(same);
            assert!(alike, "{file}, line {}: {ours}\nis not {golden}", row + 1);
        }
    }
}

#[test]
fn grains_in_a_leaning_box_agree() {
    agrees("grains", &["grains.dump", "grains.yaml", "grains.chunk"]);
}

#[test]
fn grains_in_a_sheared_box_agree_past_its_flips() {
    agrees("sheared", &["sheared.dump"]);
}

#[test]
fn grains_whose_lists_outlast_rebuilds_of_a_sheared_box_agree() {
    agrees("flowing", &[]);
    // Lists made 30 steps before this end have followed particles moved around the box since.
    let deck = include_str!("flowing.in").replace("run 300", "run 280");
    let (session, _) = run("flowing", &deck, true);
    let kept = &session.world.rebuild.kept;
    assert!(kept.outlasted > 3 && !kept.turns.is_empty(), "{} rebuilds", kept.outlasted);
}

#[test]
fn a_box_that_leans_too_far_at_the_end_of_a_run_is_flipped_in_the_next_one() {
    agrees("later", &[]);
}

#[test]
fn places_that_move_along_with_the_box_agree() {
    agrees("remapped", &["remapped.dump"]);
}

#[test]
fn all_ways_of_tilts_agree() {
    agrees("ways", &[]);
}

#[test]
fn grains_between_faces_that_do_not_repeat_agree() {
    agrees("open", &[]);
}

#[test]
fn boxes_made_and_changed_agree() {
    agrees("boxes", &[]);
}

#[test]
fn solids_without_end_agree() {
    agrees("solid", &[]);
}

/// `sheared.in` until its run, which is this.
fn sheared(runs: &str) -> String {
    let deck = include_str!("sheared.in");
    let kept = |l: &&str| !["run ", "dump", "thermo"].iter().any(|w| l.starts_with(w));
    format!("{}\nthermo 50\n{runs}\n", deck.lines().filter(kept).collect::<Vec<_>>().join("\n"))
}

/// Places, velocities and box, to the bit.
fn state(s: &Session) -> (Vec<[f64; 3]>, Vec<[f64; 3]>, String) {
    let p = &s.world.particles;
    let order = |list: &[[f64; 3]]| {
        let mut rows: Vec<_> = p.tag.iter().copied().zip(list.iter().copied()).collect();
        rows.sort_by_key(|r| r.0);
        rows.into_iter().map(|r| r.1).collect()
    };
    (order(&p.x), order(&p.v), format!("{:?}", s.world.domain))
}

// The box is flipped first at step 113 and again 500 steps later.
#[test]
fn a_shear_continues_from_a_restart_file_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    for first in [60, 112, 113, 150] {
        let one = sheared(&format!("run {first}\nwrite_restart ${{dir}}/mid\nrun 60"));
        let (one, _) = run_in(folder.path(), "one", &one, false);
        let two = "read_restart ${dir}/mid\nfix 1 all nve/sphere\nfix 2 all deform 1 xy erate 2.0 remap v\n\
                   compute m all msd\ncompute t all temp/deform\ntimestep 0.002\nrun 60\n";
        let (two, _) = run_in(folder.path(), "two", two, false);
        assert_eq!(state(&one), state(&two), "{first}");
    }
}

// 1728 grains are one chunk more or less for each thread.
#[test]
fn threads_leave_every_bit_of_a_shear_as_it_is() {
    let deck = sheared("run 130").replace("prism 0 4 0 4 0 4", "prism 0 12 0 12 0 12");
    let _alone = super::threads::alone();
    let states = [1, 2, 7].map(|threads| {
        set_threads(threads);
        state(&run("threads", &deck, false).0)
    });
    set_threads(1);
    assert_eq!(states[0], states[1]);
    assert_eq!(states[0], states[2]);
}
