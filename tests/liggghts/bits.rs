//! Bits of decks of LIGGGHTS: the same on any number of threads and ranks, in a run cut in two, and behind a restart file.

use super::{perigrain, printed};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// A rectangle in text STL.
fn plate(corners: [[f64; 3]; 4]) -> String {
    let [a, b, c, d] = corners.map(|p| format!("vertex {} {} {}\n", p[0], p[1], p[2]));
    let face =
        |p: &str, q: &str, r: &str| format!("facet normal 0 0 0\nouter loop\n{p}{q}{r}endloop\nendfacet\n");
    format!("solid made\n{}{}endsolid made\n", face(&a, &b, &c), face(&a, &c, &d))
}

/// A square across z.
fn level(half: f64, z: f64) -> String {
    plate([[-half, -half, z], [half, -half, z], [half, half, z], [-half, half, z]])
}

/// What makes the scene: a bed of 75 grains of two types.
const MADE: &str = "region reg block -0.05 0.05 -0.05 0.05 -0.02 0.12 units box\ncreate_box 2 reg\nlattice sc 0.0082\n\
    region bed block -0.018 0.018 -0.018 0.018 0.004 0.024\ncreate_atoms 1 region bed\nset group all density 2500 diameter 0.008\n\
    region odd block -0.018 0 -0.018 0.018 0 0.03\nset region odd type 2\n";

/// What acts in it: a floor that shakes, a side that a servo presses on the bed, a stream onto it, a face that counts, and a wall that
/// turns. Springs across contacts and against rolling, cohesion.
const ACTS: &str = "neighbor 0.001 bin\nneigh_modify delay 0\ntimestep 0.00001\n\
    fix m1 all property/global youngsModulus peratomtype 5.e6 8.e6\nfix m2 all property/global poissonsRatio peratomtype 0.45 0.3\n\
    fix m3 all property/global coefficientRestitution peratomtypepair 2 0.5 0.6 0.6 0.7\n\
    fix m4 all property/global coefficientFriction peratomtypepair 2 0.5 0.3 0.3 0.4\n\
    fix m5 all property/global coefficientRollingFriction peratomtypepair 2 0.1 0.1 0.1 0.2\n\
    fix m6 all property/global coefficientRollingViscousDamping peratomtypepair 2 0.3 0.3 0.3 0.3\n\
    fix m7 all property/global cohesionEnergyDensity peratomtypepair 2 2.e4 1.e4 1.e4 2.e4\n\
    pair_style gran model hertz tangential history cohesion sjkr rolling_friction epsd\npair_coeff * *\n\
    fix integr all nve/sphere\nfix grav all gravity 9.81 vector 0.0 0.0 -1.0\n\
    fix floor all mesh/surface file floor.stl type 1\nfix side all mesh/surface/stress/servo file side.stl type 2 com 0. 0. 0. &\n\
    ctrlPV force axis 1. 0. 0. target_val -0.3 vel_max 0.2 kp 0.2 ki 5.\n\
    fix walls all wall/gran model hertz tangential history cohesion sjkr rolling_friction epsd mesh n_meshes 2 meshes floor side\n\
    fix shake all move/mesh mesh floor wiggle amplitude 0. 0. 0.0003 period 0.01\n\
    fix drum all wall/gran model hertz tangential history primitive type 1 zcylinder 0.027 0. 0. shear y 0.3\n\
    fix lid all mesh/surface file lid.stl type 1\nfix gate all mesh/surface file gate.stl type 1\n\
    fix flow all massflow/mesh mesh gate vec_side 0. 0. -1.\n\
    fix pt all particletemplate/sphere 15485863 atom_type 1 density constant 2500 radius constant 0.003\n\
    fix pd all particledistribution/discrete 15485867 1 pt 1.0\n\
    fix ins all insert/stream seed 32452843 distributiontemplate pd nparticles 40 particlerate 2000 overlapcheck yes vel uniform 0. 0. -1.5 0.1 0.1 0.1 &\n\
    insertion_face lid extrude_length 0.012\n\
    thermo_style custom step atoms ke f_flow[1] f_flow[2] f_side[1] f_side[7] f_ins[1]\nthermo_modify format float %.17g\nthermo 200\n";

const HEAD: &str = "atom_style granular\natom_modify map array\nboundary f f f\nnewton off\ncommunicate single vel yes\nunits si\n";
const END: &str = "write_dump all custom end.dump id type x y z vx vy vz omegax omegay omegaz fx fy fz tqx tqy tqz modify sort id format float %.17g\n";

/// Rows of the step table by step, and the dump at the end.
type Left = (BTreeMap<String, String>, String);

/// Runs a deck in a folder that has the surfaces.
fn left_by(folder: &Path, deck: &str, words: &[&str]) -> Left {
    let side = plate([
        [0.0215, -0.025, -0.01],
        [0.0215, 0.025, -0.01],
        [0.0215, 0.025, 0.05],
        [0.0215, -0.025, 0.05],
    ]);
    for (name, text) in [
        ("floor", level(0.04, -0.0005)),
        ("lid", level(0.014, 0.06)),
        ("gate", level(0.04, 0.045)),
        ("side", side),
    ] {
        fs::write(folder.join(format!("{name}.stl")), text).unwrap();
    }
    fs::write(folder.join("in.deck"), deck).unwrap();
    let out = perigrain(folder, &[&["-in", "in.deck", "-log", "none"], words].concat());
    let text = printed(&out);
    assert!(out.status.success(), "{words:?}: {text}");
    let row = |line: &&str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.len() == 8 && words.iter().all(|w| w.parse::<f64>().is_ok())
    };
    let rows = text
        .lines()
        .filter(row)
        .map(|line| (line.split_whitespace().next().unwrap().to_string(), line.to_string()));
    (rows.collect(), fs::read_to_string(folder.join("end.dump")).unwrap())
}

/// The rows from this step on are the same, and so is the end.
fn same(a: &Left, b: &Left, from: usize, what: &str) {
    for (step, row) in a.0.iter().filter(|(step, _)| step.parse::<usize>().unwrap() >= from) {
        assert_eq!(b.0.get(step), Some(row), "{what}");
    }
    assert!(a.1 == b.1, "{what}: another end");
}

#[test]
fn threads_ranks_cuts_and_restarts_keep_every_bit() {
    let place = tempfile::tempdir().unwrap();
    let deck = |run: &str| format!("{HEAD}{MADE}{ACTS}{run}{END}");
    let whole = left_by(place.path(), &deck("run 2400\n"), &["-threads", "1"]);
    let last: Vec<f64> = whole.0["2400"].split_whitespace().map(|w| w.parse().unwrap()).collect();
    // Everything takes part: 40 grains have come, some have passed the gate, others are on their way to the face, and the side presses.
    let halfway: Vec<f64> = whole.0["1000"].split_whitespace().map(|w| w.parse().unwrap()).collect();
    assert!(last[7] == 40.0 && halfway[7] < 40.0 && last[4] > 5.0 && last[4] < 40.0, "{:?}", whole.0);
    assert!(last[5] > 0.05 && last[6] != 0.0, "{:?}", whole.0);
    for words in [&["-threads", "2"][..], &["-threads", "7"], &["-ranks", "3", "-threads", "1"]] {
        same(&whole, &left_by(place.path(), &deck("run 2400\n"), words), 0, &format!("{words:?}"));
    }
    same(&whole, &left_by(place.path(), &deck("run 1000\nrun 1400\n"), &[]), 0, "two runs");
    left_by(place.path(), &deck("run 1000\nwrite_restart half.restart\n"), &[]);
    for words in [&["-threads", "1"][..], &["-ranks", "3"]] {
        let rest =
            left_by(place.path(), &format!("{HEAD}read_restart half.restart\n{ACTS}run 1400\n{END}"), words);
        same(&whole, &rest, 1200, &format!("a restart, {words:?}"));
    }
}

/// Of a hundred grains that fall through a face, ten are lifted above it and fall again: they count again, or once (acceptance 19).
#[test]
fn a_hundred_grains_pass_and_ten_of_them_again() {
    for (count, wanted) in [("", 110.0), ("count multiple", 110.0), ("count once", 100.0)] {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("gate.stl"), level(0.04, 0.0)).unwrap();
        let deck = format!(
            "{HEAD}region reg block -0.05 0.05 -0.05 0.05 -0.05 0.05 units box\ncreate_box 1 reg\nlattice sc 0.004\n\
             region ten block 0 0.0379 0 0.0379 0.0039 0.0041\ncreate_atoms 1 region ten\nset group all density 2500 diameter 0.002\n\
             neighbor 0.001 bin\ntimestep 0.0001\nfix m1 all property/global youngsModulus peratomtype 5.e6\n\
             fix m2 all property/global poissonsRatio peratomtype 0.45\nfix m3 all property/global coefficientRestitution peratomtypepair 1 0.5\n\
             pair_style gran model hertz\npair_coeff * *\nvelocity all set 0 0 -1\nfix integr all nve/sphere\n\
             fix gate all mesh/surface file gate.stl type 1\nfix flow all massflow/mesh mesh gate vec_side 0. 0. -1. {count}\n\
             thermo_style custom step atoms f_flow[1] f_flow[2] f_flow[3] f_flow[4]\nthermo 100\nrun 100\n\
             region some block -0.001 0.001 -1 1 -1 1\ngroup some region some\nvelocity some set 0 0 1\nrun 100\n\
             velocity some set 0 0 -1\nrun 100\n"
        );
        fs::write(place.path().join("in.deck"), deck).unwrap();
        let text = printed(&perigrain(place.path(), &["-in", "in.deck", "-log", "none"]));
        let rows: Vec<Vec<f64>> =
            text.lines().filter_map(super::reading::numbers).filter(|row| row.len() == 6).collect();
        let last = rows.last().unwrap_or_else(|| panic!("{text}"));
        assert_eq!((last[1], last[3]), (100.0, wanted), "{count}: {text}");
        // The mass of those that count.
        let one = 4.0 / 3.0 * std::f64::consts::PI * 0.001f64.powi(3) * 2500.0;
        assert!((last[2] / (wanted * one) - 1.0).abs() < 1e-7, "{last:?}: eight digits");
    }
}
