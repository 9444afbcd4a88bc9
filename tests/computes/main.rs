//! Computes in small decks against LAMMPS' numbers.
//!
//! `golden/NAME.txt` holds the thermo table that LAMMPS 22Jul2025 prints for `NAME.in`, 15 digits per number.

mod continuum;
mod pairs;
#[path = "../common/thermo.rs"]
mod thermo;

use perigrain::session::set_threads;
use std::fs;
use std::path::Path;
use thermo::{run, run_in};

/// Differences, as shares of the largest number of a column, that the order of additions explains: some thousand
/// terms per sum, and some tens of steps that carry a few ulp on.
const TOLERANCE: f64 = 1e-12;

fn agrees(name: &str) {
    thermo::agrees("computes", name, TOLERANCE, |deck| run(name, deck, true).1);
}

#[test]
fn profiles_are_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/computes/golden/profiles");
    run_in(folder.path(), "profiles", include_str!("profiles.in"), true);
    let mut files = 0;
    for entry in fs::read_dir(golden).unwrap() {
        let entry = entry.unwrap();
        let ours = fs::read_to_string(folder.path().join(entry.file_name())).unwrap();
        assert_eq!(ours, fs::read_to_string(entry.path()).unwrap(), "{:?}", entry.file_name());
        files += 1;
    }
    assert_eq!(files, 10);
    agrees("profiles");
}

// A run cut inside an average continues it.
#[test]
fn a_profile_of_a_run_cut_in_two_is_that_of_one() {
    let last = |runs: &str| {
        let folder = tempfile::tempdir().unwrap();
        run_in(folder.path(), "cut", &include_str!("profiles.in").replace("run 40", runs), false);
        ["1.txt", "2.txt", "4.txt", "9.txt"].map(|f| fs::read_to_string(folder.path().join(f)).unwrap())
    };
    assert_eq!(last("run 40"), last("run 17\nrun 23"));
}

// In the step in which a bond breaks its pair does not act yet.
#[test]
fn bonds_that_break_under_pressure_agree() {
    agrees("parted");
}

#[test]
fn groups_that_lose_particles_agree() {
    agrees("emptied");
}

#[test]
fn chunks_agree() {
    agrees("chunks");
}

#[test]
fn the_family_of_chunks_agrees() {
    agrees("family");
}

#[test]
fn temperatures_without_flows_agree() {
    agrees("temperatures");
}

#[test]
fn critical_stretches_agree() {
    agrees("critical");
}

#[test]
fn groups_of_grains_agree() {
    agrees("groups");
}

#[test]
fn pairs_of_a_solid_agree() {
    // A stretch is the small difference of two lengths: their rounding counts some hundred times in forces.
    thermo::agrees("computes", "solid", 1e-11, |deck| run("solid", deck, true).1);
}

#[test]
fn rigid_bodies_agree() {
    agrees("rigids");
}

#[test]
fn a_box_that_is_stretched_agrees() {
    agrees("stretched");
}

#[test]
fn a_gas_agrees() {
    agrees("gas");
}

#[test]
fn threads_leave_every_bit_as_it_is() {
    let _alone = super::threads::alone();
    let deck = include_str!("gas.in").replace("%.15g", "%.17g");
    set_threads(1);
    let (_, one) = run("one", &deck, false);
    let torn = include_str!("torn.in");
    let (_, damage) = run("torn", torn, false);
    assert_eq!(damage.len(), 402);
    set_threads(3);
    assert_eq!(one, run("three", &deck, false).1);
    // Threads that write into each other's cells rarely do so in the same moment: 400 steps are a hundred chances.
    set_threads(2);
    for _ in 0..4 {
        assert_eq!(damage, run("torn", torn, false).1);
    }
}

#[test]
fn contacts_agree() {
    agrees("contacts");
}
