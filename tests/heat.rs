//! Heat in solids: bars whose temperatures are known, what is kept, and what is refused.

use super::decks::run_with;

/// A slab of 40 x 6 x 6 points, repeated in y and z, from x = -1 to 1 that conducts heat with k = ρc = 1; `FIXES` and `RUN` are filled in.
const BAR: &str = "\
units si
atom_style peri
boundary s p p
lattice sc 0.05 origin 0.5 0.5 0.5
region bar block -20 20 0 6 0 6
region world block -21 21 0 6 0 6
create_box 1 world
region lo block INF -18.9 INF INF INF INF
region hi block 18.9 INF INF INF INF INF
region mid block -1 1 INF INF INF INF
create_atoms 1 region bar
set group all volume $(0.05^3)
group lo region lo
group hi region hi
group mid region mid
group ends union lo hi
material m E 1e9 nu 0.25 rho 1 conductivity 1 heat_capacity 1
pair_style peri/pmb
pair_coeff * * material m horizon 2.015
peri_modify volume full
fix p all property/atom temperature heatflow
compute t all property/atom temperature
compute mid mid reduce ave c_t
thermo 1000
FIXES
thermo_style custom step time c_mid f_h f_h[1] f_h[2] f_h[3] f_h[5] f_h[6]
thermo_modify format float %23.17g
RUN
";

fn deck(fixes: &str, run: &str) -> String {
    BAR.replace("FIXES", fixes).replace("RUN", run)
}

/// The last row of the step table.
fn last_row(deck: &str, words: &[&str]) -> Vec<f64> {
    let (text, well) = run_with(deck, words);
    assert!(well, "{text}");
    let number = |line: &str| line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
    text.lines().filter_map(number).rfind(|row: &Vec<f64>| row.len() == 9).unwrap_or_else(|| panic!("{text}"))
}

/// Layers as deep as bonds reach are held at 1 from x = ±1 on: the middle follows 1 − Σ (4/π) (−1)^n/(2n + 1) exp(−(2n + 1)² π²/4 Fo).
#[test]
fn a_slab_between_held_faces() {
    let skin = |text: String| {
        text.replace("-20 20", "-22.5 22.5")
            .replace("-21 21", "-23 23")
            .replace("18.9", "19.5")
            .replace("0.05 origin 0.5", "0.05 origin 0.0")
    };
    let table = [("run 200", 0.050695), ("run 400", 0.227688), ("run 1000", 0.629223)];
    // An implicit step of 1/200 of the time is of first order: 2.5 % of the small temperature of the first number.
    for (words, numbers) in [("implicit no", &table[..]), ("implicit yes theta 1", &table[1..])] {
        for (run, expected) in numbers {
            let fixes = format!("fix h all heat/peri {words}\nfix b ends heat/held 1");
            let row = last_row(&skin(deck(&fixes, &format!("timestep 5e-4\n{run}"))), &[]);
            // Measured 1.1 % and 0.7 % at 20 spacings between middle and face: bonds of the outermost free layer see 1 in all held
            // layers, where an odd continuation would be beyond it.
            assert!((row[2] / expected - 1.0).abs() < 0.012, "{words}: {} {expected}", row[2]);
            // What came from the held particles is what the body has; linear systems are solved to 1e-10.
            assert!((row[3] - row[4]).abs() < 1e-10 * row[3], "{row:?}");
        }
    }
}

/// A film of Bi = 1 on both ends: at Fo = 1 the middle is at 0.533861 (first root 0.8603 of ζ tan ζ = 1, three terms).
#[test]
fn a_slab_in_a_fluid() {
    let fixes = "set group all temperature 1.0\nfix h all heat/peri\n\
                 fix b lo heat/convect 1 0 area $(0.3^2)\nfix c hi heat/convect 1 0 area $(0.3^2)";
    for run in ["timestep 5e-4\nrun 2000", "timestep 1e-2\nrun 100"] {
        let row = last_row(&deck(fixes, run), &[]);
        // The film acts at the middles of the outermost layer, half a spacing below the surface: 2 % here, of first order.
        assert!((row[2] / 0.533861 - 1.0).abs() < 0.02, "{run}: {}", row[2]);
        assert!((row[3] - 0.18 - row[6]).abs() < 1e-9 * row[3], "{row:?}");
    }
}

/// A flux into a long bar: at the surface 2Q/k √(αt/π) = 0.25231 for Q = k = 1 and αt = 0.05, far from the other end.
#[test]
fn a_flux_into_a_long_bar() {
    let fixes = "region first block INF -18.9 INF INF INF INF\ngroup first region first\n\
                 fix h all heat/peri\nfix b first heat/flux 1 area $(0.3^2)\ncompute first first reduce ave c_t";
    let text = deck(fixes, "timestep 5e-4\nrun 100").replace("c_mid", "c_first");
    let row = last_row(&text, &[]);
    // The middle of the first layer is half a spacing below the surface, where the gradient is Q/k.
    let surface = row[2] + 0.025;
    assert!((surface / 0.252313 - 1.0).abs() < 0.02, "{surface}");
    assert!(
        (row[3] - 0.05 * 0.09).abs() < 1e-12 * row[3] && (row[5] - row[3]).abs() < 1e-12 * row[3],
        "{row:?}"
    );
}

/// An insulated bar keeps its heat to rounding: explicit, implicit, in sub-steps.
#[test]
fn an_insulated_bar_keeps_its_heat() {
    let start = "variable t0 atom 1+sin(3*x)+y\nset group all temperature v_t0\n";
    for (words, run) in [
        ("implicit no every 1", "timestep 1e-4\nrun 4000"),
        ("implicit no every 7", "timestep 1e-3\nrun 700"),
        ("implicit yes", "timestep 1e-2\nrun 100"),
    ] {
        let fixes = format!("{start}fix h all heat/peri {words}");
        let text = deck(&fixes, &format!("run 0\nprint \"first $(f_h:%23.17g)\"\n{run}"));
        let (out, well) = run_with(&text, &[]);
        assert!(well, "{out}");
        let first: f64 = out.lines().find_map(|l| l.strip_prefix("first ")).unwrap().trim().parse().unwrap();
        let last = last_row(&text, &[])[3];
        // 1,440 particles in up to 4,000 steps: the rounding of each sum is 1e-16 of it.
        assert!((last / first - 1.0).abs() < 1e-12, "{words}: {first} {last}");
    }
}

/// Threads, layouts, runs cut in two and restart files.
#[test]
fn the_same_numbers_however_it_is_run() {
    let fixes = "fix h all heat/peri every 3\nfix b lo heat/held 1";
    let whole = deck(fixes, "timestep 1e-4\nrun 100");
    let row = last_row(&whole, &["-threads", "1"]);
    for threads in ["2", "4"] {
        assert_eq!(row, last_row(&whole, &["-threads", threads]));
    }
    assert_eq!(row, last_row(&deck(fixes, "timestep 1e-4\nrun 40\nrun 60"), &[]));
    let implicit = deck("fix h all heat/peri\nfix b lo heat/held 1", "timestep 1e-2\nrun 10");
    assert_eq!(last_row(&implicit, &["-threads", "1"]), last_row(&implicit, &["-threads", "4"]));
}

/// What cannot be is refused by name, where it stands.
#[test]
fn what_is_refused() {
    let refused = |fixes: &str, what: &str| {
        let (text, well) = run_with(&deck(fixes, "run 1"), &[]);
        assert!(!well && text.contains(what), "{fixes}: {text}");
    };
    refused("fix h all heat/peri\nfix f lo heat/flow constant 1", "changes the temperature of");
    refused(
        "fix h all heat/peri\nfix b lo heat/held 1\nfix c lo heat/flux 1 area 1",
        "holds its temperature",
    );
    refused("fix h mid heat/peri\nfix b lo heat/held 1", "heat is conducted in 0 of the 36 particles");
    refused("fix h all heat/peri theta 0.2", "theta lies between");
    refused("fix h all heat/peri cracks 2", "cracks lies between");
    refused("fix b lo heat/flux 1", "the area of the surface is missing");
    let (text, well) = run_with(&deck("fix h all heat/peri", "run 1").replace("conductivity 1 ", ""), &[]);
    assert!(!well && text.contains("has no conductivity"), "{text}");
    let (text, well) = run_with(
        &deck("fix h all heat/peri", "run 1")
            .replace("fix p all", "#")
            .replace("compute", "#")
            .replace("c_mid", "time"),
        &[],
    );
    assert!(!well && text.contains("needs particles with temperature"), "{text}");
}

/// What is held is at its value from the first step on, however the step is made: as if it had been set before, but for the heat that this takes.
#[test]
fn what_is_held_jumps_at_once() {
    for words in ["implicit no", "implicit yes theta 1", "implicit yes theta 0.5"] {
        let fixes = format!("fix h all heat/peri {words}\nfix b ends heat/held 1");
        let run = "timestep 5e-3\nrun 20";
        let jumps = last_row(&deck(&fixes, run), &[]);
        let set = last_row(&deck(&format!("set group ends temperature 1\n{fixes}"), run), &[]);
        // Linear systems are solved to 1e-10.
        assert!(jumps[2] > 0.01 && (jumps[2] - set[2]).abs() < 1e-9, "{words}: {jumps:?} {set:?}");
        assert!((jumps[3] - jumps[4]).abs() < 1e-9 * jumps[3], "{words}: {jumps:?}");
    }
}

/// Grains that conduct heat, some of which come later and have sources; `FIXES` and `RUN` are filled in.
const GRAINS: &str = "\
units si
atom_style sphere
boundary f f f
region box block -0.02 0.02 -0.02 0.02 0 0.06 units box
region slot block -0.012 0.012 -0.012 0.012 0.03 0.055 units box
create_box 1 box
neighbor 0.001 bin
pair_style granular
pair_coeff * * hertz/material 5e6 0.7 0.45 damping coeff_restitution tangential mindlin NULL NULL 0.5 slip spring heat contact 100
FIXES
fix flow all heat/flow constant 10 source d_power
fix floor all wall/gran coeff 1 zplane 0 NULL
fix sides all wall/gran coeff 1 zcylinder 0.02 0 0
fix move all nve/sphere
fix down all gravity 9.81 vector 0 0 -1
mixture m mass 4711 sphere 1 0.004 2500 1.0
fix ins all insert m pack region slot number 40 every 1000 inside yes seed 4711
timestep 2e-5
compute t all property/atom temperature
compute sum all reduce sum c_t
compute hi all reduce max c_t
compute lo all reduce min c_t
compute sq all reduce sumsq c_t
compute p all property/atom d_power
compute watts all reduce sum c_p
thermo 1000
thermo_style custom step atoms c_sum f_flow c_hi c_lo c_watts c_sq time
thermo_modify format float %23.17g
RUN
";

fn grains(fixes: &str, run: &str) -> String {
    GRAINS.replace("FIXES", fixes).replace("RUN", run)
}

/// Temperature of 300 K, also of those that come later, and a power of 0.
const BEGIN: &str =
    "fix warm all property/atom temperature initial 300\nfix heat all property/atom heatflow d_power";

#[test]
fn grains_that_come_later_have_the_initial_temperature() {
    let deck = grains(BEGIN, "run 1\nset group all temperature 500\nrun 7999");
    let row = last_row(&deck, &["-threads", "1"]);
    // 40 grains at 500 K and as many as there are more at 300 K; walls without a temperature take no heat.
    let (more, capacity) = (row[1] - 40.0, 4.0 / 3.0 * std::f64::consts::PI * 8e-9 * 2500.0 * 10.0);
    assert!(more > 20.0, "{row:?}");
    let heat = capacity * (40.0 * 500.0 + more * 300.0);
    // Sums of 8,000 steps.
    assert!(
        (row[3] / heat - 1.0).abs() < 1e-11 && (row[2] * capacity / heat - 1.0).abs() < 1e-11,
        "{row:?} {heat}"
    );
    assert!(row[4] <= 500.0 && row[5] >= 300.0, "{row:?}");
    // Where hot ones touch cold ones the squares fall.
    assert!(row[7] < 40.0 * 500.0 * 500.0 + more * 300.0 * 300.0 - 1e3, "{row:?}");
    for threads in ["2", "4"] {
        assert_eq!(row, last_row(&deck, &["-threads", threads]));
    }
    assert_eq!(
        row,
        last_row(&grains(BEGIN, "run 1\nset group all temperature 500\nrun 4000\nrun 3999"), &[])
    );
    // Zeros without the word, as LAMMPS has them.
    let zeros = "fix warm all property/atom temperature heatflow d_power";
    let row = last_row(&grains(zeros, "run 1\nset group all temperature 500\nrun 2999"), &[]);
    assert_eq!((row[1] > 40.0, row[5]), (true, 0.0));
}

#[test]
fn sources_of_grains_heat_them() {
    let run = "run 1\nset group all d_power 0.25\nrun 999";
    let row = last_row(&grains(BEGIN, run), &[]);
    let capacity = 4.0 / 3.0 * std::f64::consts::PI * 8e-9 * 2500.0 * 10.0;
    // 40 grains, 0.25 W each for 999 steps of 20 µs.
    let heat = 40.0 * (capacity * 300.0 + 0.25 * 999.0 * 2e-5);
    assert!((row[1], row[6]) == (40.0, 10.0) && (row[3] / heat - 1.0).abs() < 1e-12, "{row:?} {heat}");
}

#[test]
fn a_restart_keeps_temperatures_and_sources() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("half.restart").display().to_string();
    let start = "run 1\nset group all temperature 500 d_power 0.25\nrun 1499";
    let whole = last_row(&grains(BEGIN, &format!("{start}\nrun 1000")), &[]);
    last_row(&grains(BEGIN, &format!("{start}\nwrite_restart {file}")), &[]);
    let again = grains(BEGIN, "run 1000").replace("create_box 1 box\n", &format!("read_restart {file}\n"));
    assert_eq!(whole, last_row(&again, &[]));
}

/// LIGGGHTS has the circle of the overlap on walls, whatever the area between grains is: 50.1012228415 W at 500 K for a grain of 4 mm
/// radius that lies 10 µm deep.
#[test]
fn walls_conduct_through_the_circle() {
    for area in ["", "area constant 1e-6", "area projection"] {
        let deck = format!(
            "units si\natom_style sphere\nboundary f f f\nregion b block -0.05 0.05 -0.05 0.05 -0.05 0.05 units box\n\
             create_box 1 b\npair_style granular\n\
             pair_coeff * * hertz/material 5e6 0.7 0.45 damping coeff_restitution tangential none heat contact 100 {area}\n\
             create_atoms 1 single -0.03601 0 0 units box\nset atom 1 diameter 0.008 density 8000\n\
             fix p all property/atom temperature heatflow initial 300\nfix f all heat/flow constant 10\n\
             fix w all wall/gran coeff 1 xplane -0.04 NULL temperature 800\nfix cold all wall/gran coeff 1 yplane -0.004 NULL\n\
             compute q all property/atom heatflow\ncompute s all reduce sum c_q\ntimestep 2.5e-5\nneighbor 0.002 bin\n\
             run 1\nprint \"flow $(c_s:%.12g) $(f_w[7]:%.12g)\"\n"
        );
        let (text, well) = run_with(&deck, &[]);
        assert!(well && text.contains("flow 50.1012228415 -50.1012228415"), "{area}: {text}");
    }
}
