//! The tutorials of LIGGGHTS, from where Debian's package `liggghts-doc` puts them: run from a temporary copy, skipped where it is not
//! installed.

use super::{perigrain, printed};
use std::fs;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

const FOLDER: &str = "/usr/share/doc/liggghts/examples/LIGGGHTS/Tutorials_public";

/// One test for each tutorial that runs to its end: folder, deck, how many grains there are then. LIGGGHTS 3.8.0 has the same numbers,
/// but for places that come from random numbers: 1355 of movingMeshGran's 1500, 827 of chute_wear's that stay in the box.
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

/// Spheres of hydrogel that a piston presses together: no random numbers, so that forces on its surface are those of LIGGGHTS 3.8.0.
#[test]
fn a_piston_feels_the_force_of_the_real_one() {
    let Some(there) = copy("hydrogel_multicontact") else { return };
    let file = there.path().join("in.hydrogel_default");
    let deck = fs::read_to_string(&file).unwrap();
    // Down to the deepest place, without files for pictures.
    let first = deck.split("# relax piston").next().unwrap();
    let lines = first.lines().filter(|line| !line.starts_with("dump"));
    fs::write(&file, lines.map(|line| format!("{line}\n")).collect::<String>()).unwrap();
    let text = printed(&perigrain(there.path(), &["-in", "in.hydrogel_default", "-log", "none"]));
    let found = fs::read_to_string(there.path().join("post/piston_force_default.txt")).expect(&text);
    let rows: Vec<Vec<f64>> = found.lines().filter_map(super::reading::numbers).collect();
    for (step, force) in [(6100.0, 0.272146), (12100.0, 1.14743), (18100.0, 2.66962), (24100.0, 4.64251)] {
        let row = rows.iter().find(|row| row[0] == step).expect("the step");
        // Six printed digits; what is left of two programs' rounding grows with the number of contacts.
        assert!((row[3] / force - 1.0).abs() < 1e-5, "{row:?} instead of {force}");
    }
}

/// Rows of the step table.
fn table(text: &str) -> Vec<&str> {
    text.lines().filter(|l| super::reading::numbers(l).is_some_and(|row| row.len() > 3)).collect()
}

#[test]
fn a_translated_tutorial_has_its_bits() {
    for (name, deck) in [("packing", "in.packing"), ("meshGran", "in.meshGran"), ("conveyor", "in.conveyor")]
    {
        let Some(there) = copy(name) else { return };
        let out = perigrain(there.path(), &["translate", deck, "-o", "in.native"]);
        assert!(out.status.success(), "{}", printed(&out));
        let both = [deck, "in.native"]
            .map(|deck| printed(&perigrain(there.path(), &["-in", deck, "-log", "none", "-threads", "1"])));
        assert!(table(&both[0]).len() > 10 && !both[1].contains("PG0305"), "{}", both[1]);
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
