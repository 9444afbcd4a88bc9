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
    old_models: "contactModels", "in.oldModels", 1000..=1000;
    cohesion: "cohesion", "in.cohesion", 1000..=1000;
    no_cohesion: "cohesion", "in.noCohesion", 1000..=1000;
    hysteresis: "hysteresis", "in.hysteresis", 1000..=1000;
    no_hysteresis: "hysteresis", "in.noHysteresis", 1000..=1000;
    mesh_gran: "meshGran", "in.meshGran", 500..=500;
    conveyor: "conveyor", "in.conveyor", 382..=382;
    mesh_tet: "mesh_tet", "in.mesh_tet", 14583..=14583;
    multisphere: "multisphere_stone_restitution", "in.multisphere", 50..=100;
    fluidized_bed_before_its_partner: "ParScale/fluidizedBedTempParScale", "in.liggghts_init", 10..=10;
}

/// The longest ones, five to twelve seconds of the processor each; shortened ones run in any case.
#[test]
#[ignore = "half a minute: `./check --tutorials`"]
fn long_ones() {
    runs_to_its_end("movingMeshGran", "in.movingMeshGran", 1250..=1450);
    runs_to_its_end("chute_wear", "in.chute_wear", 800..=860);
    runs_to_its_end("contactModels", "in.newModels", 1800..=1800);
    runs_to_its_end("hydrogel_multicontact", "in.hydrogel_default", 513..=515);
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

/// Rows of thermo output, and place and temperature of each grain at the end.
type Heated = (Vec<Vec<f64>>, Vec<[f64; 2]>);

/// Runs a tutorial about heat. Rows of its step table, and x and temperature of each grain at the end.
fn heated(name: &str) -> Option<Heated> {
    let there = copy(name)?;
    let deck = fs::read_to_string(there.path().join("in.heatGran")).unwrap();
    let more = "\nwrite_dump all custom last.txt x f_Temp[0] modify format line \"%.12g %.12g\"\n";
    fs::write(there.path().join("in.short"), deck + more).unwrap();
    let text = printed(&perigrain(there.path(), &["-in", "in.short", "-log", "none"]));
    let rows = table(&text).iter().filter_map(|l| super::reading::numbers(l)).collect();
    let last = fs::read_to_string(there.path().join("last.txt")).unwrap_or_else(|e| panic!("{e}: {text}"));
    let grains = last.lines().filter_map(super::reading::numbers).filter(|row| row.len() == 2);
    let grains: Vec<[f64; 2]> = grains.map(|row| [row[0], row[1]]).collect();
    Some((rows, grains[3..].to_vec()))
}

/// The mass of a grain times its specific heat [J/K]: 4/3 π 4 mm³ 8000 kg/m³ 10 J/(kg K).
const CAPACITY: f64 = 4.0 / 3.0 * std::f64::consts::PI * 64e-9 * 8000.0 * 10.0;

#[test]
fn a_hot_half_of_a_bed_warms_the_other() {
    let Some((rows, grains)) = heated("heatTransfer_1") else { return };
    let hot = grains.len() as f64;
    // 889.9 grains are 25 % of the region: LIGGGHTS inserts 890.
    assert!((889.0..=890.0).contains(&hot), "{hot}");
    // Without heat from outside: all at 300 K, then some at 800 K.
    let start = hot * CAPACITY * 300.0;
    assert!((total(&rows, 1.0) / start - 1.0).abs() < 1e-7 && (total(&rows, 2e4) / start - 1.0).abs() < 1e-7);
    let last = rows.last().unwrap()[4];
    let warmed = (last / CAPACITY - hot * 300.0) / 500.0;
    // 445 in LIGGGHTS; half a bed of random places.
    assert!((warmed - warmed.round()).abs() < 1e-3 && (warmed - 445.0).abs() < 30.0, "{warmed}");
    let mean = grains.iter().map(|g| g[1]).sum::<f64>() / hot;
    assert!((mean * hot * CAPACITY / last - 1.0).abs() < 1e-7, "{mean}");
    // LIGGGHTS: halves at 680.5 K and 419.5 K, scatter 146.8 K, from beds of other random places.
    let half = |warm: bool| {
        let of: Vec<f64> = grains.iter().filter(|g| (g[0] > 0.0) == warm).map(|g| g[1]).collect();
        of.iter().sum::<f64>() / of.len() as f64
    };
    let scatter = (grains.iter().map(|g| (g[1] - mean).powi(2)).sum::<f64>() / hot).sqrt();
    assert!((half(true) - half(false) - 261.0).abs() < 15.0, "{} {}", half(true), half(false));
    assert!((scatter - 146.8).abs() < 7.0, "{scatter}");
}

#[test]
#[ignore = "seconds: `./check --tutorials`"]
fn sources_of_heat_add_up() {
    let Some((rows, grains)) = heated("heatTransfer_2") else { return };
    let (before, last) = (total(&rows, 2e4), total(&rows, 5e4));
    assert!((before / (grains.len() as f64 * CAPACITY * 300.0) - 1.0).abs() < 1e-7);
    // ±1.5 W for 30,000 steps of 25 µs, in as many grains more on one side than on the other.
    let more = (last - before) / (1.5 * 30_000.0 * 25e-6);
    assert!((more - more.round()).abs() < 1e-2 && more.abs() < 60.0, "{more}");
    // In grains at the ends, which touch few others: 248.25 K and 351.75 K in LIGGGHTS.
    let [lo, hi] = [f64::min, f64::max].map(|of| grains.iter().map(|g| g[1]).reduce(of).unwrap());
    assert!((lo - 248.0).abs() < 3.0 && (hi - 352.0).abs() < 3.0, "{lo} {hi}");
}

/// The heat of all grains, where the step table has this step first.
fn total(rows: &[Vec<f64>], step: f64) -> f64 {
    rows.iter().find(|row| row[0] == step && row[1] > 0.0).unwrap()[4]
}

/// Spheres of hydrogel that a piston presses together: no random numbers, so that forces on its surface are those of LIGGGHTS 3.8.0.
#[test]
fn a_piston_feels_the_force_of_the_real_one() {
    let Some(there) = copy("hydrogel_multicontact") else { return };
    // Down to the deepest place, without files for pictures.
    let file = there.path().join("in.hydrogel_default");
    let deck = fs::read_to_string(&file).unwrap();
    let lines = deck.split("# relax piston").next().unwrap().lines().filter(|l| !l.starts_with("dump"));
    fs::write(&file, lines.map(|line| format!("{line}\n")).collect::<String>()).unwrap();
    let out = perigrain(there.path(), &["-in", "in.hydrogel_default", "-log", "none"]);
    let text = printed(&out);
    assert!(out.status.success(), "{}", &text[text.len().saturating_sub(2000)..]);
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

/// A deck with runs of so many steps at most, and growth in as many; of a run `upto` three times as many.
fn shortened(deck: &str, most: u64) -> String {
    let line = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let number = words.get(1).and_then(|n| n.parse::<f64>().ok());
        match (words.first(), number) {
            (Some(&"run"), Some(n)) if n > most as f64 => {
                let upto = words.get(2) == Some(&"upto");
                line.replacen(words[1], &(if upto { 3 * most } else { most }).to_string(), 1)
            }
            (Some(&"variable"), _) if ["growts", "relaxts", "ts_move"].contains(&words[1]) => {
                format!("variable {} equal {most}", words[1])
            }
            _ => line.to_string(),
        }
    };
    deck.lines().map(|l| line(l) + "\n").collect()
}

/// What a run has written below `post`, by name, without restart files, which hold the text of the deck.
fn written(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = fs::read_dir(folder.join("post"))
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|path| path.is_file() && path.extension().is_none_or(|end| end != "restart"))
        .map(|path| (path.file_name().unwrap().to_string_lossy().into_owned(), fs::read(&path).unwrap()))
        .collect();
    files.sort();
    files
}

/// Each tutorial with a length of its runs in which grains meet, and how many files it writes at least.
const TRANSLATED: &[(&str, &str, u64, usize)] = &[
    ("packing", "in.packing", 700, 2),
    ("cohesion", "in.noCohesion", 1000, 1),
    ("cohesion", "in.cohesion", 1000, 1),
    ("contactModels", "in.newModels", 400, 1),
    ("contactModels", "in.oldModels", 400, 1),
    ("hysteresis", "in.hysteresis", 1000, 1),
    ("hysteresis", "in.noHysteresis", 1000, 1),
    ("insert_stream", "in.insert_stream", 1000, 1),
    ("insert_stream", "in.insert_stream_reset_timestep", 1000, 1),
    ("meshGran", "in.meshGran", 1200, 4),
    ("movingMeshGran", "in.movingMeshGran", 600, 4),
    ("conveyor", "in.conveyor", 1200, 2),
    ("chute_wear", "in.chute_wear", 1000, 2),
    ("hydrogel_multicontact", "in.hydrogel_default", 2000, 1),
    ("ParScale/fluidizedBedTempParScale", "in.liggghts_init", 1000, 1),
    ("multisphere_stone_restitution", "in.multisphere", 2000, 1),
    ("mesh_tet", "in.mesh_tet", 100, 0),
    ("heatTransfer_1", "in.heatGran", 1000, 1),
    ("heatTransfer_2", "in.heatGran", 1000, 1),
];

#[test]
fn a_translated_tutorial_has_its_bits() {
    for (name, deck, steps, files) in TRANSLATED {
        let Some(there) = copy(name) else { return };
        if deck.ends_with("reset_timestep") {
            // It continues from the restart file of the other one.
            let first = fs::read_to_string(there.path().join("in.insert_stream")).unwrap();
            fs::write(there.path().join("in.first"), shortened(&first, *steps)).unwrap();
            let out = perigrain(there.path(), &["-in", "in.first", "-log", "none"]);
            assert!(out.status.success(), "{}", printed(&out));
        }
        let text = shortened(&fs::read_to_string(there.path().join(deck)).unwrap(), *steps);
        fs::write(there.path().join(deck), text).unwrap();
        let out = perigrain(there.path(), &["translate", deck, "-o", "in.native"]);
        assert!(out.status.success(), "{name}: {}", printed(&out));
        let other = tempfile::tempdir().unwrap();
        copy_all(there.path(), other.path());
        let run = |folder: &Path, deck: &str| {
            let out = perigrain(folder, &["-in", deck, "-log", "none", "-threads", "1"]);
            let text = printed(&out);
            assert!(out.status.success(), "{name}, {deck}: {}", &text[text.len().saturating_sub(2000)..]);
            (text, written(folder))
        };
        let (own, own_files) = run(there.path(), deck);
        let (native, native_files) = run(other.path(), "in.native");
        assert!(!native.contains("PG0305"), "{name}: {native}");
        assert!(!table(&own).is_empty() && own_files.len() >= *files, "{name}: {} files", own_files.len());
        assert_eq!(table(&own), table(&native), "{name}");
        let names = |files: &[(String, Vec<u8>)]| files.iter().map(|f| f.0.clone()).collect::<Vec<_>>();
        assert_eq!(names(&own_files), names(&native_files), "{name}");
        let same = own_files.iter().zip(&native_files).all(|(a, b)| a == b);
        assert!(same, "{name}: a file differs");
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

/// ParScale, which computes temperatures inside grains, is not there; LIGGGHTS of Debian stops at these decks, too.
#[test]
fn decks_that_need_a_partner_have_one_error() {
    let Some(there) = copy("ParScale/fluidizedBedTempParScale") else { return };
    perigrain(there.path(), &["-in", "in.liggghts_init", "-log", "none"]);
    let text = printed(&perigrain(there.path(), &["check", "in.liggghts_run"]));
    assert_eq!(text.matches("error[").count(), 1, "{text}");
    assert!(text.contains("`couple/pascal`, a coupling to another program"), "{text}");
    // A size at random comes first, then the partner; nothing follows from either.
    let Some(there) = copy("ParScale/heatTransferBed_paScal") else { return };
    let text = printed(&perigrain(there.path(), &["check", "in.liggghts"]));
    assert_eq!(text.matches("error[").count(), 2, "{text}");
    assert!(text.contains("a random size or density") && text.contains("`couple/pascal`"), "{text}");
    let text = printed(&perigrain(there.path(), &["-in", "in.liggghts", "-log", "none"]));
    assert_eq!(text.matches("error[").count(), 1, "{text}");
}
