//! Fixes and computes in small decks against LAMMPS' numbers.
//!
//! `golden/NAME.txt` holds the thermo table that LAMMPS 22Jul2025 prints for `NAME.in`, 15 digits per number.

#[path = "../common/thermo.rs"]
pub mod thermo;

use perigrain::session::{Options, Session, set_threads};
use std::fs;
use std::path::Path;
use thermo::{run, run_in};

/// Differences, as shares of the largest number of a column, that the order of additions explains: a few ulp, times the
/// some tens of steps that carry them on.
const TOLERANCE: f64 = 1e-13;

/// Of grains that are pressed hard at rest forces cancel to a thousandth and less: what is left of them carries that much more of
/// their rounding.
const CANCELLED: f64 = 1e-12;

/// Compares a deck's thermo table with LAMMPS'; the files that the deck writes are in the folder returned.
fn agrees(name: &str) -> tempfile::TempDir {
    agrees_to(TOLERANCE, name)
}

fn agrees_to(tolerance: f64, name: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    thermo::agrees("fixes", name, tolerance, |deck| {
        let _alone = super::folder();
        std::env::set_current_dir(&folder).unwrap();
        let (_, ours) = run_in(folder.path(), name, deck, true);
        std::env::set_current_dir("/").unwrap();
        ours
    });
    folder
}

#[test]
fn forces_agree() {
    agrees("forces");
}

#[test]
fn indenters_agree() {
    agrees("indenters");
}

#[test]
fn cones_agree() {
    agrees("cones");
}

#[test]
fn adaptive_steps_agree() {
    agrees("steps");
}

#[test]
fn wiggle_agrees() {
    agrees("wiggle");
}

#[test]
fn grains_in_a_squeezed_box_agree() {
    agrees_to(CANCELLED, "squeezed");
}

#[test]
fn boxes_steered_by_pressures_agree() {
    agrees_to(CANCELLED, "pressed");
}

/// The word to blame and the message of a line that is refused, behind a box with one sphere.
fn refused(lines: &str) -> String {
    let deck = format!(
        "units lj\natom_style sphere\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\n\
         pair_style gran/hooke 2000 NULL 5 NULL 0.4 1\npair_coeff * *\ncompute c all ke\n{lines}\n"
    );
    let mut session = Session::new(Options::default()).unwrap();
    let d = session.run_text("in.refused", &deck).expect_err(lines).0.remove(0);
    let span = d.span.unwrap();
    format!("[{}] {}", &deck[span.start as usize..span.end as usize], d.message)
}

#[test]
fn pressures_that_steer_nothing_are_refused() {
    for (lines, printed) in [
        ("fix d all deform/pressure 1 x pressure 1 0.1 couple yz", "none of these lengths has the style"),
        (
            "fix d all deform/pressure 1 x pressure 1 0.1 y pressure 2 0.1 couple xy",
            "`couple`: y is to follow another pressure than the rest",
        ),
        ("fix d all deform/pressure 1 x pressure 1 0.1 vol/balance/p yes", "[vol/balance/p] "),
        ("fix d all deform/pressure 1 box volume", "[box] "),
        ("fix d all deform/pressure 1 x pressure 1 0.1 normalize yes", "[normalize] "),
        (
            "fix d all deform/pressure 1 x pressure 1 0.1\nfix_modify d press c",
            "[c] compute `c` is of style ke",
        ),
        (
            "fix d all deform/pressure 1 x pressure 1 0.1\nfix_modify d temp c",
            "[temp] fix deform/pressure takes its",
        ),
        ("fix d all deform/pressure 1 x pressure 1 0.1\nfix_modify d bodyforces no", "[bodyforces] "),
    ] {
        let got = refused(lines);
        assert!(got.contains(printed), "{lines}: {got}");
    }
}

#[test]
fn spheres_agree() {
    agrees("spheres");
}

#[test]
fn baths_agree() {
    agrees("bath");
}

#[test]
fn walls_with_springs_agree() {
    agrees("soft_walls");
}

#[test]
fn walls_that_throw_back_agree() {
    agrees("mirrors");
}

#[test]
fn springs_lines_and_limits_agree() {
    agrees("holds");
}

#[test]
fn motions_and_kept_states_agree() {
    agrees("motions");
}

#[test]
fn virials_temperatures_and_losses_agree() {
    agrees("virial");
}

#[test]
fn sizes_and_own_properties_agree() {
    agrees("adapt");
}

// `golden/averages` holds the files that LAMMPS 22Jul2025 writes for `averages.in`.
#[test]
fn averages_agree_and_their_files_are_the_same_bytes() {
    let files = agrees("averages");
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixes/golden/averages");
    for entry in fs::read_dir(golden).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap();
        let ours = fs::read_to_string(files.path().join(name)).unwrap();
        assert_eq!(ours, fs::read_to_string(&path).unwrap(), "{}", path.display());
    }
}

/// `steps.in` with its runs replaced.
fn steps(runs: &str) -> String {
    let deck = include_str!("steps.in");
    let begin = deck.lines().take_while(|l| !l.starts_with("run ")).collect::<Vec<_>>().join("\n");
    format!("{begin}\n{runs}\n")
}

// The time step is looked at every 3 steps: 7 and 20 lie between.
#[test]
fn a_run_cut_in_three_is_one_run() {
    let (one, _) = run("one", &steps("run 40"), false);
    let (three, _) = run("three", &steps("run 7\nrun 13\nrun 20"), false);
    assert_eq!(one.world.particles.x, three.world.particles.x);
    assert_eq!(one.world.particles.v, three.world.particles.v);
    assert_eq!(one.world.clock.dt.to_bits(), three.world.clock.dt.to_bits());
}

// 9261 particles are five chunks.
#[test]
fn threads_leave_every_bit_as_it_is() {
    let deck = "units lj\natom_style atomic\nboundary s s s\nlattice sc 1.0\nregion b block 0 20 0 20 0 20\n\
        create_box 1 b\ncreate_atoms 1 box\nmass 1 1.7\nvariable u atom sin(x*y+z)\nvariable w atom cos(z*y-x)\n\
        velocity all set v_u v_w v_u units box\nfix 1 all nve\nfix i all indent 3.0 sphere 10 9 8 7.0\n\
        fix d all viscous 0.3\nfix g all gravity 1.0 chute 24\nfix a all addforce 0.1 v_w 0\n\
        fix t all dt/reset 2 NULL 0.01 0.02\nfix m all setforce NULL v_u NULL\ncompute r all reduce sumsq x vy fz v_u\n\
        compute e all ke/atom\ncompute s all reduce ave c_e\nthermo_style custom step time temp ke press f_i f_i[3] f_a \
        f_m[2] f_g c_r[*] c_s\nthermo_modify format float %.17g norm no\nthermo 2\nrun 10\n";
    let _alone = super::threads::alone();
    set_threads(1);
    let (_, one) = run("one", deck, false);
    set_threads(3);
    let (_, three) = run("three", deck, false);
    assert_eq!(one.len(), 7);
    assert_eq!(one, three);
}

// 9261 particles again, with the fixes that sum over groups, keep states and average.
#[test]
fn threads_leave_averages_and_springs_as_they_are() {
    let deck = "units lj\natom_style sphere\nboundary s s s\nlattice sc 1.0\nregion b block 0 20 0 20 0 20\n\
        create_box 1 b\ncreate_atoms 1 box\nset group all diameter 0.5\nvariable u atom sin(x*y+z)\n\
        variable w atom cos(z*y-x)\nvelocity all set v_u v_w v_u units box\nfix n all nve/limit 0.006\n\
        fix te all spring tether 3.0 1 2 3 0.5\nfix se all spring/self 2.0\nfix av all aveforce NULL 0.1 NULL\n\
        fix dr all drag 1 NULL 3 0.7 0.2\nfix mo all momentum 2 linear 1 1 1 angular rescale\n\
        fix re all recenter INIT NULL INIT\nfix st all store/state 3 vx xu com yes\nfix m all ave/atom 1 2 2 vy v_u\n\
        fix h all ave/histo 1 2 2 -1 1 9 vx vy mode vector\ncompute r all reduce sumsq x vy fz f_st[1] f_st[2] f_m[1]\n\
        fix a all ave/time 1 2 2 c_r[*] ave running\nthermo_style custom step ke f_n f_te f_te[1] f_se f_av[3] f_dr[1] \
        f_re[1] c_r[*] f_a[*] f_h[3] f_h[5][2]\nthermo_modify format float %.17g norm no\nthermo 2\nrun 6\n";
    let _alone = super::threads::alone();
    set_threads(1);
    let (_, one) = run("one", deck, false);
    set_threads(3);
    let (_, three) = run("three", deck, false);
    assert_eq!(one.len(), 5);
    assert_eq!(one, three);
}

// Averages continue across runs as if there were one.
#[test]
fn averages_of_a_run_cut_in_three_are_those_of_one() {
    let deck = |runs: &str| {
        format!(
            "units lj\natom_style atomic\nlattice sc 1.0\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\n\
             create_atoms 1 box\nmass 1 1.0\nvelocity all create 1.0 4711\nfix 1 all nve\ncompute s all reduce sum x\n\
             fix a all ave/time 2 3 6 c_s ave window 2\nfix m all ave/atom 1 4 6 x\ncompute r all reduce sumsq f_m\n\
             fix v all vector 2 c_s\nvariable t equal trap(f_v)\n{runs}\nvariable all equal f_a+c_r+v_t\n"
        )
    };
    let value = |runs: &str| {
        let (session, _) = run("cut", &deck(runs), false);
        let w = &session.world;
        let slot = |name: &str| w.slots.get(w.slots.find(name).unwrap());
        (slot("f_a").scalar, slot("f_m").atom.clone(), slot("f_v").vector.clone())
    };
    assert_eq!(value("run 18"), value("run 5\nrun 6\nrun 7"));
}
