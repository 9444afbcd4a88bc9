//! Tables of contacts with walls, walls of surfaces of several types, and files of grains that pass, beside LIGGGHTS 3.8.0.

use super::{close, folder, head, ran, table};
use crate::decks::run_in;
use std::fs;

/// Four grains of two types between and on two plates of two types.
const TWO: &str = "\
atom_style granular
boundary f f f
newton off
units si
region reg block -0.06 0.06 -0.06 0.06 -0.06 0.06 units box
create_box 2 reg
neighbor 0.002 bin
neigh_modify delay 0
fix m1 all property/global youngsModulus peratomtype 5.e6 2.e7
fix m2 all property/global poissonsRatio peratomtype 0.45 0.3
fix m3 all property/global coefficientRestitution peratomtypepair 2 0.7 0.5 0.5 0.9
fix m4 all property/global coefficientFriction peratomtypepair 2 0.5 0.2 0.2 0.7
timestep 1e-5
pair_style gran model hertz tangential history
pair_coeff * *
create_atoms 1 single 0.001 0.002 0.00499 units box
set atom 1 diameter 0.01 density 2500 vx 0.1 vy 0.05 vz -0.02 omegax 3 omegay 5 omegaz 7
create_atoms 2 single 0.02 0.01 -0.00498 units box
set atom 2 diameter 0.01 density 2500 vx 0.1 vy 0.05 vz 0.02
create_atoms 1 single -0.02 -0.01 0.00498 units box
set atom 3 diameter 0.01 density 2500 vx 0.1 vy 0.05 vz -0.02
create_atoms 1 single -0.02 -0.01 -0.01502 units box
set atom 4 diameter 0.01 density 2500 vx 0.1 vy 0.05 vz 0.02
fix pl all mesh/surface file plate.stl type 2 move 0 0 -0.01
fix fm all mesh/surface/stress file flow.stl type 1
fix w all wall/gran model hertz tangential history mesh n_meshes 2 meshes pl fm
fix integ all nve/sphere
compute d all wall/gran/local id force torque delta
dump e all local 20 table.dump c_d[1] c_d[2] c_d[3] c_d[4] c_d[5] c_d[6] c_d[7] c_d[8] c_d[9] c_d[10]
dump_modify e format \"%.10g %.10g %.10g %.10g %.10g %.10g %.10g %.10g %.10g %.10g\"
thermo_style custom step atoms ke f_fm[1] f_fm[3]
thermo_modify format float %.10g
thermo 10
run 20
";

/// The real program's rows of step 20, by mesh, triangle and grain; ten digits.
const CONTACTS: [[f64; 10]; 3] = [
    [
        1.0,
        0.0,
        2.0,
        -0.01074209955,
        -0.005371049774,
        -0.06005016202,
        2.679320377e-05,
        -5.358640753e-05,
        0.0,
        2.310352851e-05,
    ],
    [
        1.0,
        1.0,
        1.0,
        -0.007667147732,
        -0.006640178009,
        0.02028567163,
        -3.315525907e-05,
        3.82830504e-05,
        0.0,
        1.374390205e-05,
    ],
    [
        1.0,
        1.0,
        3.0,
        -0.01725961246,
        -0.008629806232,
        0.03859366673,
        -4.304778985e-05,
        8.60955797e-05,
        0.0,
        2.346317072e-05,
    ],
];

#[test]
fn a_wall_of_two_types_and_its_contacts() {
    let mut tables = vec![];
    for ranks in ["1", "2"] {
        let place = tempfile::tempdir().unwrap();
        for file in ["plate.stl", "flow.stl"] {
            fs::copy(folder().join(file), place.path().join(file)).unwrap();
        }
        let (text, well) = run_in(place.path(), TWO, &["-ranks", ranks]);
        assert!(well, "{text}");
        // Energy and the force on the second plate, of the real program; ten digits.
        let own = table(&text, 4);
        close("two types", 20, &own[&20], &[4.0, 3.177021614e-05, 0.03573424465, 0.001284985949], 1e-9);
        tables.push(fs::read_to_string(place.path().join("table.dump")).unwrap());
    }
    assert_eq!(tables[0], tables[1]);
    let rows: Vec<Vec<f64>> = tables[0]
        .rsplit("ITEM: ")
        .next()
        .unwrap()
        .lines()
        .skip(1)
        .map(|line| line.split_whitespace().map(|w| w.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), CONTACTS.len());
    for (own, theirs) in rows.iter().zip(&CONTACTS) {
        close("contacts", 20, own, theirs, 2e-9);
    }
}

/// Two grains of 4 mm fall, one of them again after it has been sent up; the second list stands behind the first in the file.
fn passing(words: &str) -> String {
    format!(
        "{}create_atoms 1 single 0.00123456789 -0.0123456 0.01 units box\ncreate_atoms 1 single 0.01 0 0.01 units box\n\
         set group all diameter 0.0041234567 density 2500\nset atom 1 vx 1.23456789e-7 vy 0.01234567 vz -1\n\
         set atom 2 vz -12.3456789\nfix fm all surface flow.stl type 1\n\
         fix mf all massflow/mesh mesh fm vec_side 0. 0. -1. {words}\nfix i all nve/sphere\nthermo_modify lost ignore\nrun 200\nset atom 1 vz 1.\n\
         run 200\nset atom 1 vz -1\nrun 200\n",
        head(0.06, 1e-4, 0.7)
    )
}

#[test]
fn grains_that_pass_are_listed() {
    // As the real program writes it, but for the diameter of the second grain, which was 0.004 there.
    let wanted = "# ID time  diameter x y z u v w  (ex ey ez, color)\n\
                  2  0.0009  0.004123 0.01    0 -0.001111    0    0 -12.35\n\
                  1  0.0101  0.004123 0.001235 -0.01222 -0.0001 1.235e-07 0.01235   -1\n\
                  1  0.0501  0.004123 0.001235 -0.01173 -0.0001 1.235e-07 0.01235   -1\n";
    let (_, place) = ran(&passing("file passed.txt writeTime"));
    let file = place.path().join("passed.txt");
    assert_eq!(fs::read_to_string(&file).unwrap(), wanted);
    let (text, well) = run_in(place.path(), &passing("append passed.txt count once"), &[]);
    assert!(well, "{text}");
    let untimed = "# ID diameter x y z u v w  (ex ey ez, color)\n\
                   2 0.004123 0.01    0 -0.001111    0    0 -12.35\n\
                   1 0.004123 0.001235 -0.01222 -0.0001 1.235e-07 0.01235   -1\n";
    assert_eq!(fs::read_to_string(&file).unwrap(), format!("{wanted}{untimed}"));
    let (text, well) = run_in(place.path(), &passing("writeTime"), &[]);
    assert!(!well && text.contains("add `file NAME`"), "{text}");
}

#[test]
fn a_side_along_the_face_and_a_bent_face_are_refused() {
    for (from, to, word) in [
        ("vec_side 0. 0. -1.", "vec_side 1 0 0", "`vec_side` lies in triangle 1"),
        ("flow.stl type 1", "bent.stl type 1 planar", "is not planar: triangle"),
    ] {
        let place = tempfile::tempdir().unwrap();
        let flow = fs::read_to_string(folder().join("flow.stl")).unwrap();
        // The last corner of the second triangle, 4 mm above the first one's plane.
        fs::write(
            place.path().join("bent.stl"),
            flow.replace("vertex -0.03 0.03 0", "vertex -0.03 0.03 0.004"),
        )
        .unwrap();
        fs::write(place.path().join("flow.stl"), flow).unwrap();
        let (text, well) = run_in(place.path(), &passing("").replace(from, to), &[]);
        assert!(!well && text.contains(word), "{text}");
        assert_eq!(text.matches("error[").count(), 1, "{text}");
    }
}
