//! The tutorials of LIGGGHTS, from where Debian's package `liggghts-doc` puts them: run from a temporary copy, skipped where it is not
//! installed.

use super::{perigrain, printed};
use std::fs;
use std::path::{Path, PathBuf};

const FOLDER: &str = "/usr/share/doc/liggghts/examples/LIGGGHTS/Tutorials_public";

/// Tutorials that run to their end: folder, deck, how many grains there are then. LIGGGHTS 3.8.0 has the same numbers, but for
/// places that come from random numbers: 1355 of movingMeshGran's 1500, 827 of chute_wear's that stay in the box.
const RUN: &[(&str, &str, std::ops::RangeInclusive<usize>)] = &[
    ("packing", "in.packing", 337..=338),
    ("contactModels", "in.newModels", 1800..=1800),
    ("contactModels", "in.oldModels", 1000..=1000),
    ("cohesion", "in.cohesion", 1000..=1000),
    ("cohesion", "in.noCohesion", 1000..=1000),
    ("hysteresis", "in.noHysteresis", 1000..=1000),
    ("hysteresis", "in.hysteresis", 1000..=1000),
    ("insert_stream", "in.insert_stream", 1200..=1200),
    ("meshGran", "in.meshGran", 500..=500),
    ("movingMeshGran", "in.movingMeshGran", 1250..=1450),
    ("conveyor", "in.conveyor", 382..=382),
    ("chute_wear", "in.chute_wear", 800..=860),
    ("ParScale/fluidizedBedTempParScale", "in.liggghts_init", 10..=10),
];

/// Tutorials that cannot be run here, with a word of the one error.
const REFUSED: &[(&str, &str, &str)] = &[
    ("superquadric", "in.particle_particle", "superquadric"),
    ("sph_1", "in.sph_1", "a fluid of particles"),
    ("sph_2", "in.sph_2", "a fluid of particles"),
    ("hydrogel_multicontact", "in.hydrogel_multicontact", "multicontact"),
];

/// A copy of a tutorial in a folder of its own.
fn copy(name: &str) -> Option<tempfile::TempDir> {
    let from = Path::new(FOLDER).join(name);
    if !from.is_dir() {
        println!("skipped: {} is not there (Debian's package liggghts-doc)", from.display());
        return None;
    }
    let there = tempfile::tempdir().unwrap();
    copy_all(&from, there.path());
    for more in ["post", "post/restart", "restart"] {
        fs::create_dir_all(there.path().join(more)).unwrap();
    }
    Some(there)
}

fn copy_all(from: &Path, to: &Path) {
    for entry in fs::read_dir(from).unwrap().map(|e| e.unwrap()) {
        let new: PathBuf = to.join(entry.file_name());
        if entry.path().is_dir() {
            fs::create_dir_all(&new).unwrap();
            copy_all(&entry.path(), &new);
        } else {
            fs::copy(entry.path(), new).unwrap();
        }
    }
}

#[test]
fn tutorials_run_to_their_end() {
    for (name, deck, grains) in RUN {
        let Some(there) = copy(name) else { return };
        let out = perigrain(there.path(), &["-in", deck, "-log", "none"]);
        let text = printed(&out);
        assert!(out.status.success(), "{deck}: {}", &text[text.len().saturating_sub(2000)..]);
        let last = text.lines().rev().find(|l| l.starts_with("Loop time")).unwrap();
        let found = last.split_whitespace().rev().nth(1).unwrap().parse().unwrap();
        assert!(grains.contains(&found), "{deck}: {last}");
    }
}

/// The second deck continues from the restart file that the first one has written.
#[test]
fn a_stream_continues_in_another_deck() {
    let Some(there) = copy("insert_stream") else { return };
    for (deck, grains) in [("in.insert_stream", 1200), ("in.insert_stream_reset_timestep", 1800)] {
        let text = printed(&perigrain(there.path(), &["-in", deck, "-log", "none"]));
        assert!(text.contains(&format!("with {grains} atoms")), "{deck}: {text}");
    }
}

#[test]
fn what_cannot_be_run_has_one_error() {
    for (name, deck, word) in REFUSED {
        let Some(there) = copy(name) else { return };
        let text = printed(&perigrain(there.path(), &["check", deck]));
        assert_eq!(text.matches("error[").count(), 1, "{deck}: {text}");
        assert!(text.contains(word), "{deck}: {text}");
    }
}
