//! Grains that fix insert makes: counts, places and first steps as in LIGGGHTS, from which the numbers come.
//!
//! LIGGGHTS-PUBLIC 3.8.0 (Debian) as a black box, with decks of our own in which templates, distributions and `fix insert/pack|stream|rate/region`
//! say the same. Random numbers differ: counts, masses of streams of one kind, steps and the rule of the flight are compared.

use crate::decks::{run_in, run_with};
use std::path::Path;

/// A box of 0.2 m and grains of 5 MPa.
const HEAD: &str = "units si\natom_style sphere\nboundary f f f\nregion reg block -0.1 0.1 -0.1 0.1 -0.1 0.1 units box\n\
    create_box 1 reg\nneighbor 0.002 bin\nneigh_modify delay 0\ntimestep 1e-5\npair_style granular\n\
    pair_coeff * * hertz/material 5e6 0.7 0.45 damping coeff_restitution tangential mindlin NULL 1.0 0.5\n\
    region bc block -.06 .06 -.06 .06 -.06 .06 units box\nfix integ all nve/sphere\n";

/// 5 and 8 mm of radius, 0.3 and 0.7 of the mass.
const MASS: &str = "mixture m mass 32452843 sphere 1 0.01 2500 0.3 sphere 1 0.016 2500 0.7\n";
const NUMBER: &str = "mixture m number 32452843 sphere 1 0.01 2500 0.3 sphere 1 0.016 2500 0.7\n";

/// What a deck writes, and the rows of numbers in it.
fn rows(deck: &str) -> (String, Vec<Vec<f64>>) {
    let (text, good) = run_with(deck, &[]);
    assert!(good, "{text}");
    let numbers = |line: &str| line.split_whitespace().map(|w| w.parse().ok()).collect::<Option<Vec<f64>>>();
    let rows = text.lines().filter_map(numbers).filter(|row| row.len() > 1).collect();
    (text, rows)
}

/// Number and mass that `pack` puts into the region, and what else the run writes.
fn packed(mixture: &str, words: &str) -> (String, [f64; 2]) {
    let deck = format!(
        "{HEAD}{mixture}fix ins all insert m pack region bc {words} tries 200 seed 32452867\n\
         thermo_style custom step atoms f_ins[1] f_ins[2]\nrun 1\n"
    );
    let (text, rows) = rows(&deck);
    let last = rows.last().unwrap();
    assert_eq!(last[1], last[2]);
    (text, [last[2], last[3]])
}

// 5 mm: 1.308997e-3 kg, 8 mm: 5.361651e-3 kg; mean by mass shares 2.779780e-3 kg and 1.111912e-6 m³. Of 100 there are 63 small and 36
// large ones for sure (LIGGGHTS: 63 + 37 is 0.28084791 kg).
#[test]
fn a_region_is_filled_to_a_number_mass_or_share() {
    let [small, large] = [1.308_996_94e-3, 5.361_651_47e-3];
    let (text, [n, mass]) = packed(MASS, "number 100");
    assert!(!text.contains("warning"), "{text}");
    let of_large = (mass - 100.0 * small) / (large - small);
    assert!(n == 100.0 && (of_large - 36.0).abs().min((of_large - 37.0).abs()) < 1e-4, "{n} {mass}");
    // 107.92 grains: LIGGGHTS 108.
    let (_, [n, _]) = packed(MASS, "mass 0.3 inside yes");
    assert!((107.0..=108.0).contains(&n), "{n}");
    // 388.5 grains: LIGGGHTS 389; by number 261.
    let (_, [n, mass]) = packed(MASS, "share 0.25 inside yes");
    assert!((388.0..=389.0).contains(&n) && (mass / 2500.0 / 1.728e-3 - 0.25).abs() < 2e-3, "{n} {mass}");
    let (_, [n, _]) = packed(NUMBER, "share 0.25 inside yes");
    assert!((260.0..=261.0).contains(&n), "{n}");
    // LIGGGHTS finds places for 242 of 1088 in 200 attempts each.
    let (text, [n, _]) = packed(MASS, "share 0.7 inside yes");
    assert!(
        (200.0..=280.0).contains(&n) && text.contains("found no place in 200 attempts each, from step 1"),
        "{n} {text}"
    );
}

// The bed of LIGGGHTS' tutorial `packing`: 0.25 of 0.1 x 0.1 x 0.15 m³ are 337.256 grains, 337 or 338 (LIGGGHTS 338); they grow by
// (0.67/0.25)^(1/3) to radii of 6.945150 and 11.112239 mm, here in 125 parts. A compute that the fix has read shows them before the change.
#[test]
fn a_bed_grows() {
    let deck = "units si\natom_style sphere\nboundary m m m\nregion reg block -0.05 0.05 -0.05 0.05 0. 0.15 units box\ncreate_box 1 reg\n\
        neighbor 0.002 bin\ntimestep 1e-5\npair_style granular\n\
        pair_coeff * * hertz/material 5e6 0.3 0.45 damping coeff_restitution tangential mindlin NULL 1.0 0.5\n\
        mixture m mass 32452843 sphere 1 0.01 2500 0.3 sphere 1 0.016 2500 0.7\nfix ins all insert m pack region reg share 0.25 tries 200\n\
        run 1\nunfix ins\nvariable g equal (0.67/0.25)^(40/(3.*5000))\n\
        compute rad all property/atom radius\nvariable d atom v_g*2.*c_rad\nfix grow all adapt 40 atom diameter v_d\n\
        compute most all reduce max c_rad\ncompute least all reduce min c_rad\nthermo_style custom step atoms c_most c_least\n\
        thermo 5000\nrun 4999\n";
    let (_, rows) = rows(deck);
    let last = rows.last().unwrap();
    assert!((337.0..=338.0).contains(&last[1]), "{last:?}");
    // Printed digits.
    assert!((last[2] - 0.011_112_239).abs() < 1e-9 && (last[3] - 0.006_945_150).abs() < 1e-9, "{last:?}");
}

// LIGGGHTS: 60 at step 1, none until half of them are deleted at step 12, and 60 again at step 16.
#[test]
fn a_region_is_filled_up_again() {
    let deck = format!(
        "{HEAD}{MASS}fix ins all insert m pack region bc number 60 inside yes every 5 tries 200\n\
         thermo_style custom step atoms f_ins\nthermo 1\nrun 12\nregion kill block -.1 0 -.1 .1 -.1 .1 units box\n\
         delete_atoms region kill compress no\nrun 12\n"
    );
    let (_, rows) = rows(&deck);
    let of = |step: f64| rows.iter().rfind(|row| row[0] == step).unwrap();
    let left = of(12.0)[1];
    assert!(of(0.0)[1] == 0.0 && (1..12).all(|step| of(f64::from(step))[1..] == [60.0, 60.0]));
    assert!(left < 45.0 && (13..16).all(|step| of(f64::from(step))[1] == left), "{left}");
    assert!((16..=24).all(|step| of(f64::from(step))[1..] == [60.0, 120.0 - left]));
}

// 1000 grains a second, every 1000 steps of 1e-5 s: 10 each, up to 25.
#[test]
fn a_rate_is_kept() {
    let deck = format!(
        "{HEAD}{NUMBER}fix ins all insert m rate region bc number 25 rate 1000 every 1000 start 3\n\
         thermo_style custom step atoms f_ins\nthermo 1\nrun 2010\n"
    );
    let (_, rows) = rows(&deck);
    let of = |step: usize| rows[step][2];
    assert_eq!([2, 3, 1002, 1003, 2002, 2003].map(of), [0.0, 10.0, 10.0, 20.0, 20.0, 25.0]);
}

/// A square of 60 mm across z.
const FACE: &str = "solid m\n facet normal 0 0 0\n  outer loop\n   vertex -0.03 -0.03 0\n   vertex 0.03 -0.03 0\n   vertex 0.03 0.03 0\n  endloop\n \
    endfacet\n facet normal 0 0 0\n  outer loop\n   vertex -0.03 -0.03 0\n   vertex 0.03 0.03 0\n   vertex -0.03 0.03 0\n  endloop\n endfacet\nendsolid m\n";

/// A grain in a step: x y z vx vy vz wz fz.
type Grain = [f64; 8];

/// Runs a stream of grains of 4 mm under gravity: rows of the table (step, atoms, number, mass), and the grains of each step by id.
fn stream(folder: &Path, words: &str, more: &[&str]) -> (Vec<Vec<f64>>, Vec<Vec<Option<Grain>>>) {
    std::fs::write(folder.join("face.stl"), FACE).unwrap();
    let head = HEAD.replace("1e-5", "1e-4");
    let deck = format!(
        "{head}mixture m number 32452843 sphere 1 0.004 2500 1\n\
         fix ins all insert m stream face face.stl {words} tries 100 seed 32452867 inside yes omega 0 0 3\n\
         fix g all gravity 9.81 vector 0 0 -1\nthermo_style custom step atoms f_ins[1] f_ins[2]\nthermo 1\nthermo_modify lost ignore\n\
         dump d all custom 1 grains.dump id x y z vx vy vz omegaz fz\ndump_modify d format float %.17g sort id\nrun 1200\n"
    );
    let (text, good) = run_in(folder, &deck, more);
    assert!(good, "{text}");
    let numbers = |line: &str| line.split_whitespace().map(|w| w.parse().ok()).collect::<Option<Vec<f64>>>();
    let table = text.lines().filter_map(numbers).filter(|row| row.len() == 4).collect();
    let dump = std::fs::read_to_string(folder.join("grains.dump")).unwrap();
    let mut steps: Vec<Vec<Option<Grain>>> = vec![];
    for line in dump.lines() {
        if line == "ITEM: TIMESTEP" {
            steps.push(vec![]);
        }
        let Some(row) = numbers(line).filter(|row| row.len() == 9) else { continue };
        let (id, last) = (row[0] as usize, steps.last_mut().unwrap());
        last.resize(last.len().max(id + 1), None);
        last[id] = Some(std::array::from_fn(|k| row[k + 1]));
    }
    (table, steps)
}

fn atoms(table: &[Vec<f64>], step: usize) -> f64 {
    table[step][2]
}

// LIGGGHTS: 10 grains every 500 steps; up to the face each keeps x and y and 1 m/s along z without a force; the last step before its centre
// passes ends with its own velocity and spin and still without a force.
#[test]
fn grains_fly_to_the_face_and_pass_it_with_their_own_velocity() {
    let folder = tempfile::tempdir().unwrap();
    let words = "number 60 rate 200 length 0.05 vel 0.5 0 -1 uniform 0.1 0.2 0.3";
    let (table, steps) = stream(folder.path(), words, &[]);
    let counts: Vec<f64> = [0, 1, 500, 501, 1000, 1001, 1200].map(|step| atoms(&table, step)).to_vec();
    assert_eq!(counts, [0.0, 10.0, 10.0, 20.0, 20.0, 30.0, 30.0]);
    let (g, dt, mass) = (9.81, 1e-4, 4.0 / 3.0 * std::f64::consts::PI * 0.002_f64.powi(3) * 2500.0);
    assert!((table[1][3] - 10.0 * mass).abs() < 1e-11, "printed digits");
    let (mut least, mut most, mut fast) = (f64::INFINITY, 0.0_f64, vec![]);
    for id in 1..=10 {
        let at = |step: usize| steps[step][id].unwrap();
        let first = at(1);
        assert!(first[0].abs() <= 0.028 && first[1].abs() <= 0.028);
        (least, most) = (least.min(first[2]), most.max(first[2]));
        // Steps of 0.1 mm.
        let last = 1 + (first[2] / 1e-4).floor() as usize;
        for step in 1..last {
            let flies: Grain =
                [first[0], first[1], first[2] - 1e-4 * (step - 1) as f64, 0.0, 0.0, -1.0, 0.0, 0.0];
            let off = (0..8).map(|k| (at(step)[k] - flies[k]).abs()).fold(0.0, f64::max);
            // Sums of some hundred steps of 1e-4.
            assert!(off < 1e-15, "{id} {step} {:?} {flies:?}", at(step));
        }
        let [.., z, vx, vy, vz, spin, force] = at(last);
        assert!(z >= 0.0 && at(last + 1)[2] < 0.0 && force == 0.0 && spin == 3.0, "{id} {:?}", at(last));
        assert!((vx - 0.5).abs() <= 0.1 && vy.abs() <= 0.2 && (vz + 1.0).abs() <= 0.3);
        fast.push(vz);
        // From there on it falls: velocity Verlet, without a first half kick.
        let n = 5.0;
        let later = at(last + 5);
        let fallen = vz * n * dt - g * dt * dt * n * (n - 1.0) / 2.0;
        assert!(
            (later[5] - (vz - g * dt * (n - 0.5))).abs() < 1e-12 && (later[2] - z - fallen).abs() < 1e-12
        );
        assert!((later[7] / (-mass * g) - 1.0).abs() < 1e-12, "{later:?}");
    }
    assert!(least >= 0.002 && most <= 0.048 && most - least > 0.02, "{least} {most}");
    assert!(fast.iter().any(|v| (v + 1.0).abs() > 0.05));
    // One process and two threads write the same bytes.
    let whole = std::fs::read(folder.path().join("grains.dump")).unwrap();
    stream(folder.path(), words, &["-threads", "1"]);
    assert!(std::fs::read(folder.path().join("grains.dump")).unwrap() == whole);
}

// LIGGGHTS: 0.003 kg are 35 grains, 12 or 11 of 11.94 at a time; with `insert_every 600 duration 300` 12 at steps 1 and 601 on 30 mm.
#[test]
fn streams_end_and_have_gaps() {
    let folder = tempfile::tempdir().unwrap();
    let (table, _) = stream(folder.path(), "mass 0.003 massrate 0.02 length 0.05 vel 0 0 -1", &[]);
    assert!((11.0..=12.0).contains(&atoms(&table, 1)) && (22.0..=24.0).contains(&atoms(&table, 501)));
    assert!((33.0..=35.0).contains(&atoms(&table, 1001)), "{}", atoms(&table, 1001));
    // Upwards: the stream comes from below the face.
    let (table, steps) = stream(folder.path(), "number 20 rate 200 every 600 during 300 vel 0 0 1", &[]);
    assert_eq!([1, 600, 601, 1200].map(|step| atoms(&table, step)), [12.0, 12.0, 20.0, 20.0]);
    let z = (1..=12).map(|id| steps[1][id].unwrap()[2]);
    assert!(z.clone().all(|z| (-0.028..=-0.002).contains(&z)) && z.fold(0.0, f64::min) < -0.015);
}

#[test]
fn mistakes_are_named() {
    let refused = |line: &str| {
        let (text, good) = run_with(&format!("{HEAD}{MASS}{line}\nrun 1\n"), &[]);
        assert!(!good && text.contains("error[PG"), "{line}: {text}");
        text
    };
    for (words, what) in [
        ("n pack region bc number 5", "there is no mixture `n`"),
        ("m pack number 5", "`pack` needs `region ID`"),
        ("m pack region bc", "`pack` needs one of"),
        ("m pack region bc number 5 share 0.3", "`pack` needs one of"),
        ("m pack region bc number INF", "filled up to an amount"),
        ("m pack region bc share 1.5", "below 1"),
        ("m pack region bc number 5 rate 3", "`rate` belongs to `rate` and `stream`"),
        ("m rate region bc number 5 rate 3", "`rate` needs `every N`"),
        ("m rate region bc number 5 mass 3 rate 3 every 5", "`rate` needs one of"),
        ("m rate region bc number 5 rate 3 massrate 3 every 5", "`rate` needs one of"),
        ("m stream number 5 rate 3 every 5", "`stream` needs `face ID`"),
        ("m stream face integ number 5 rate 3 every 5 vel 0 0 1", "has no surface"),
        ("m stream face none.stl number 5 rate 3 every 5 vel 0 0 1", "none.stl"),
        ("m pack region nowhere number 5", "nowhere"),
        ("m pack region bc number 5 vel 0 0", "vz"),
        ("m fill region bc number 5", "fill"),
    ] {
        let text = refused(&format!("fix ins all insert {words}"));
        assert!(text.contains(what), "{words}: {text}");
    }
    let text = refused(
        "region out block -.06 .06 -.06 .06 -.06 .06 units box side out\nfix ins all insert m pack region out number 5",
    );
    assert!(text.contains("no box around it"), "{text}");
}
