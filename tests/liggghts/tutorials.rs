//! The tutorials of LIGGGHTS, from where Debian's package `liggghts-doc` puts them: run from a temporary copy, skipped where it is not
//! installed.

use super::{perigrain, printed};
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

const FOLDER: &str = "/usr/share/doc/liggghts/examples/LIGGGHTS/Tutorials_public";

/// One test for each tutorial that runs to its end: folder, deck, how many grains there are then. LIGGGHTS 3.8.0 has the same numbers,
/// but for places that come from random numbers: 1355 of movingMeshGran's 1500, 827 of chute_wear's that stay in the box, two
/// stones of multisphere, where 1.28 fill the share of the volume,
/// and 13121 grains of mesh_tet, where sites on the surface do not belong to the region.
macro_rules! tutorials {
    ($($name:ident: $folder:literal, $deck:literal, $grains:expr;)*) => {
        $(#[test]
        fn $name() {
            runs_to_its_end($folder, $deck, $grains);
        })*
    };
}

tutorials! {
    packing: "packing", "in.packing", 337..=338;
    new_models: "contactModels", "in.newModels", 1800..=1800;
    old_models: "contactModels", "in.oldModels", 1000..=1000;
    cohesion: "cohesion", "in.cohesion", 1000..=1000;
    no_cohesion: "cohesion", "in.noCohesion", 1000..=1000;
    hysteresis: "hysteresis", "in.hysteresis", 1000..=1000;
    no_hysteresis: "hysteresis", "in.noHysteresis", 1000..=1000;
    mesh_gran: "meshGran", "in.meshGran", 500..=500;
    moving_mesh_gran: "movingMeshGran", "in.movingMeshGran", 1250..=1450;
    conveyor: "conveyor", "in.conveyor", 382..=382;
    chute_wear: "chute_wear", "in.chute_wear", 800..=860;
    mesh_tet: "mesh_tet", "in.mesh_tet", 14583..=14583;
    multisphere: "multisphere_stone_restitution", "in.multisphere", 50..=100;
    fluidized_bed_before_its_partner: "ParScale/fluidizedBedTempParScale", "in.liggghts_init", 10..=10;
}

/// Tutorials that cannot be run here, with a word of the one error.
const REFUSED: &[(&str, &str, &str)] = &[
    ("superquadric", "in.particle_particle", "superquadric"),
    ("sph_1", "in.sph_1", "fluids are not in perigrain"),
    ("sph_2", "in.sph_2", "fluids are not in perigrain"),
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

fn runs_to_its_end(name: &str, deck: &str, grains: RangeInclusive<usize>) {
    let Some(there) = copy(name) else { return };
    let out = perigrain(there.path(), &["-in", deck, "-log", "none"]);
    let text = printed(&out);
    assert!(out.status.success(), "{deck}: {}", &text[text.len().saturating_sub(2000)..]);
    let last = text.lines().rev().find(|l| l.starts_with("Loop time")).unwrap();
    let found = last.split_whitespace().rev().nth(1).unwrap().parse().unwrap();
    assert!(grains.contains(&found), "{deck}: {last}");
}

/// Rows of the step table.
fn table(text: &str) -> Vec<&str> {
    text.lines().filter(|l| super::reading::numbers(l).is_some_and(|row| row.len() > 3)).collect()
}

/// Tutorials of few seconds that use different parts of the dialect.
const TRANSLATED: &[(&str, &str)] = &[
    ("packing", "in.packing"),
    ("meshGran", "in.meshGran"),
    ("conveyor", "in.conveyor"),
    ("multisphere_stone_restitution", "in.multisphere"),
    ("mesh_tet", "in.mesh_tet"),
];

#[test]
fn a_translated_tutorial_has_its_bits() {
    for (name, deck) in TRANSLATED {
        let Some(there) = copy(name) else { return };
        let out = perigrain(there.path(), &["translate", deck, "-o", "in.native"]);
        assert!(out.status.success(), "{}", printed(&out));
        let both = [*deck, "in.native"]
            .map(|deck| printed(&perigrain(there.path(), &["-in", deck, "-log", "none", "-threads", "1"])));
        assert!(table(&both[0]).len() > 3 && !both[1].contains("PG0305"), "{}", both[1]);
        assert_eq!(table(&both[0]), table(&both[1]), "{name}");
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
