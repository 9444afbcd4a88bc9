//! Grains of several spheres in native words: how they bounce, stream, continue and fill regions up.

use super::{perigrain, printed, reading};
use std::fs;
use std::path::Path;

/// A box of 0.2 m, grains of 5 MPa without friction or damping, and a clump of three spheres.
const HEAD: &str = "units si\natom_style sphere\nboundary f f f\nregion reg block -0.1 0.1 -0.1 0.1 -0.1 0.1 units box\n\
    create_box 1 reg\nneighbor 0.002 bin\ntimestep 1e-5\npair_style granular\n\
    pair_coeff * * hertz/material 5e6 0.0 0.45 damping none tangential linear_nohistory 0 0\n\
    fix mol all property/atom mol\nneigh_modify exclude molecule/intra all\n\
    clump c 1 spheres 0 0 0 0.005 0.005 0 0 0.004 0.01 0 0.001 0.003\nmixture m mass 32452843 mol c 2500 1\n\
    fix r all rigid/small molecule mol c\n";

/// What a deck prints, in a folder, with more words for the program.
fn run(there: &Path, deck: &str, words: &[&str]) -> String {
    fs::write(there.join("in.deck"), deck).unwrap();
    let out = perigrain(there, &[&["-in", "in.deck", "-log", "none"], words].concat());
    let text = printed(&out);
    assert!(out.status.success(), "{text}");
    text
}

/// Rows of `count` numbers.
fn rows(text: &str, count: usize) -> Vec<Vec<f64>> {
    text.lines().filter_map(reading::numbers).filter(|row| row.len() == count).collect()
}

// Without friction and damping the energies of motion, rotation and height sum to the same before and after the floor: its spring holds
// some of it meanwhile.
#[test]
fn a_clump_bounces_without_loss() {
    let there = tempfile::tempdir().unwrap();
    let deck = format!(
        "{HEAD}fix g all gravity 9.81 vector 0 0 -1\nfix floor all wall/gran granular hertz/material 5e6 0.0 0.45 damping none tangential \
         linear_nohistory 0 0 zplane -0.1 NULL\n\
         region high block -.01 .01 -.01 .01 -0.08 -0.07 units box\n\
         fix ins all insert m pack region high number 1 vel 0 0 -0.3 omega 10 20 30 orientation random\n\
         compute kt all ke/rigid r\ncompute kr all erotate/rigid r\ncompute b all rigid/local r mass zu\ncompute z all reduce sum c_b[2] inputs local\n\
         compute m all reduce sum c_b[1] inputs local\nvariable e equal c_kt+c_kr+c_m*9.81*(c_z+0.1)\n\
         thermo_style custom step c_kt c_kr v_e c_m\nthermo 100\nthermo_modify format float %.10g\nrun 8000\n"
    );
    let rows = rows(&run(there.path(), &deck, &[]), 5);
    let energy = |k: usize| rows[k][3];
    let first = energy(2);
    // It spins faster after the floor, and the mass is that of the union: less than that of the three spheres, 2.262e-3 kg.
    let spin = rows.iter().map(|row| row[2]).fold(0.0, f64::max);
    assert!(spin > 1.5 * rows[2][2], "{rows:?}");
    assert!(rows[2][4] < 2.2e-3 && rows[2][4] > 1.309e-3, "{}", rows[2][4]);
    let free: Vec<f64> =
        rows[2..].iter().map(|row| row[3]).filter(|e| (e / first - 1.0).abs() < 1e-3).collect();
    assert!(free.len() > 60 && (energy(rows.len() - 1) / first - 1.0).abs() < 1e-3, "{first} {rows:?}");
}

/// A stream of clumps to a face, slantwise and spinning.
const STREAM: &str = "print \"\"\"solid f\nfacet normal 0 0 1\nouter loop\nvertex -.04 -.04 0\nvertex .04 -.04 0\nvertex .04 .04 0\nendloop\n\
    endfacet\nfacet normal 0 0 1\nouter loop\nvertex -.04 -.04 0\nvertex .04 .04 0\nvertex -.04 .04 0\nendloop\nendfacet\nendsolid f\"\"\" \
    file face.stl screen no\nfix g all gravity 9.81 vector 0 0 -1\n\
    fix ins all insert m stream face face.stl number 20 rate 2000 length 0.03 vel 0.2 0 -1 omega 10 20 30 orientation random\n";

// The part of the velocity across the face leads to it; there each grain gets all of it and its spin. v_z -1 in the last step before the
// face, and gravity from then on.
#[test]
fn clumps_of_a_stream_fly_to_the_face_and_get_their_motion_there() {
    let there = tempfile::tempdir().unwrap();
    let deck = format!(
        "{HEAD}{STREAM}compute b all rigid/local r zu vx vy vz omegax omegay omegaz mol\n\
         dump d all local 100 bodies.txt c_b[1] c_b[2] c_b[3] c_b[4] c_b[5] c_b[6] c_b[7] c_b[8]\nrun 2000\n"
    );
    run(there.path(), &deck, &[]);
    let frames = reading::dump(&fs::read_to_string(there.path().join("bodies.txt")).unwrap());
    let (mut above, mut below) = (0, 0);
    for row in frames.values().flat_map(|frame| &frame.rows) {
        let [z, vx, vy, vz] = [row[0], row[1], row[2], row[3]];
        if z > 1e-4 {
            assert!(vx.abs() < 1e-14 && vy.abs() < 1e-14 && (vz + 1.0).abs() < 1e-14, "{row:?}");
            // Rounding of places, in radii of 1 cm.
            assert!(row[4..7].iter().all(|o| o.abs() < 1e-11), "{row:?}");
            above += 1;
        } else if z < -1e-4 {
            // Below the face it falls: v² - 1 = 2 g |z|, to the step in which it passes.
            assert!((vz * vz - 1.0 - 2.0 * 9.81 * z.abs()).abs() < 4e-4, "{row:?}");
            assert!((vx - 0.2).abs() < 1e-3, "{row:?}");
            below += 1;
        }
    }
    assert!(above > 20 && below > 20, "{above} {below}");
}

#[test]
fn streams_of_clumps_continue_and_have_the_same_bits_for_any_threads() {
    let there = tempfile::tempdir().unwrap();
    let ends =
        "thermo_style custom step atoms ke f_ins[1] f_ins[2]\nthermo 500\nthermo_modify format float %.17g\n";
    let last = |text: &str| rows(text, 5).pop().unwrap();
    let deck = format!("{HEAD}{STREAM}{ends}run 2000\n");
    let whole = last(&run(there.path(), &deck, &["-threads", "1"]));
    assert_eq!(whole, last(&run(there.path(), &deck, &["-threads", "3"])));
    let deck = format!("{HEAD}{STREAM}{ends}run 900\nwrite_restart half.restart\nrun 1100\n");
    assert_eq!(whole, last(&run(there.path(), &deck, &[])));
    let lines: Vec<&str> = HEAD.lines().chain(STREAM.lines()).collect();
    let from = lines.iter().position(|l| l.starts_with("neighbor")).unwrap();
    let rest: Vec<&str> = lines[from..].iter().copied().filter(|l| !l.starts_with("timestep")).collect();
    let deck = format!("read_restart half.restart\n{}\n{ends}run 1100\n", rest.join("\n"));
    assert_eq!(whole, last(&run(there.path(), &deck, &[])));
}

// LIGGGHTS 3.8.0 with three of such grains in the region: to a number of 5 two more, to 0.02 kg what is missing by their whole masses.
#[test]
fn grains_of_several_spheres_count_as_one_in_a_region() {
    let there = tempfile::tempdir().unwrap();
    for (words, least, most) in [("number 5", 2.0, 2.0), ("mass 0.02", 3.0, 4.0), ("share 0.005", 3.0, 4.0)] {
        let deck = format!(
            "{}region bc block -.06 .06 -.06 .06 -.06 .06 units box\nclump d 1 spheres 0 0 0 .005 .005 0 0 .005 .01 0 0 .005\n\
             mixture n number 17 mol d 2500 1\nunfix r\nfix r all rigid/small molecule mol c mol d\n\
             fix one all insert n pack region bc number 3 inside yes\nrun 2\nfix two all insert n pack region bc {words} seed 4711\n\
             thermo_style custom step f_one[1] f_two[1] f_two[2] atoms\nrun 2\n",
            HEAD
        );
        let row = rows(&run(there.path(), &deck, &[]), 5).pop().unwrap();
        assert!(row[1] == 3.0 && (least..=most).contains(&row[2]), "{words}: {row:?}");
        // Specification: 3.108867730e-3 kg each; the table prints eight digits.
        assert!(
            (row[3] / row[2] / 3.108867730e-3 - 1.0).abs() < 1e-7 && row[4] == 3.0 * (3.0 + row[2]),
            "{row:?}"
        );
    }
}

#[test]
fn what_clumps_lack_is_named() {
    let there = tempfile::tempdir().unwrap();
    let refused = |deck: &str| {
        fs::write(there.path().join("in.deck"), deck).unwrap();
        let out = perigrain(there.path(), &["-in", "in.deck", "-log", "none"]);
        assert!(!out.status.success());
        printed(&out)
    };
    let packs = "region bc block -.06 .06 -.06 .06 -.06 .06 units box\nfix one all insert m pack region bc number 3\nrun 1\n";
    let text = refused(&format!("{HEAD}unfix r\n{packs}"));
    assert!(text.contains("fix ID GROUP rigid/small molecule mol c"), "{text}");
    let bare = HEAD.replace("fix mol all property/atom mol\nneigh_modify exclude molecule/intra all\n", "");
    let bare = bare.replace("fix r all rigid/small molecule mol c\n", "");
    let text = refused(&format!("{bare}{packs}"));
    assert!(text.contains("property/atom mol"), "{text}");
}
