//! Small bodies of `material`s: they move as those of LAMMPS' numbers, and take impacts without loss.

use std::process::Command;

const SCENE: &str = "
units si
atom_style peri
boundary s s s
lattice sc 1e-3
region body block -0.0041 0.0041 -0.0041 0.0041 -0.0041 0.0041 units box
region world block -0.01 0.01 -0.01 0.01 -0.01 0.01 units box
create_box 1 world
create_atoms 1 region body
set group all volume 1e-9
set group all density 2200
";

const RUN: &str = "
variable vx atom 10*x/0.004
velocity all set v_vx 0 0 units box
fix 1 all nve
timestep 2e-8
thermo_modify norm no
run 100
print \"energies $(pe:%.15g) $(ke:%.15g) bonds $(c_broken:%.15g)\"
";

const DAMAGE: &str = "
compute damage all damage/atom
compute broken all reduce sum c_damage
thermo_style custom step pe ke c_broken
";

/// The numbers that a deck prints after `word`.
fn printed(word: &str, text: &str) -> Vec<f64> {
    let folder = tempfile::tempdir().unwrap();
    let deck = folder.path().join("in.deck");
    std::fs::write(&deck, text).unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_perigrain")).arg(&deck).current_dir(&folder).output().unwrap();
    let printed = String::from_utf8_lossy(&out.stdout).into_owned();
    let line = printed.lines().find(|l| l.starts_with(word));
    let line =
        line.unwrap_or_else(|| panic!("no {word}:\n{printed}\n{}", String::from_utf8_lossy(&out.stderr)));
    line.split(' ').filter_map(|w| w.parse().ok()).collect()
}

fn energies(coefficients: &str) -> Vec<f64> {
    printed("energies", &format!("{SCENE}{coefficients}{DAMAGE}{RUN}"))
}

#[test]
fn materials_give_lammps_motion_and_true_energies() {
    let material = "
material glass file brittle-plate.toml
pair_style peri/pmb
pair_coeff 1 1 material glass horizon 3.015
";
    // The same c and s00 by LAMMPS' formulas for K = 14.9 GPa, Gc = 10.06 J/m2, as numbers.
    let numbers = "
variable d equal 3.015e-3
pair_style peri/pmb
pair_coeff 1 1 $(18*14.9e9/(PI*v_d^4):%.17g) $(v_d:%.17g) $(sqrt(5*10.06/9/14.9e9/v_d):%.17g) 0.25
";
    let (a, b) = (energies(material), energies(numbers));
    // Densities times the volume of a particle, 1e-9 m3; c differs by a rounding, which 100 steps keep below 1e-10.
    assert!((a[0] / (b[0] * 1e-9) - 1.0).abs() < 1e-10, "{a:?} {b:?}");
    assert!((a[1] / (b[1] * 1e-9) - 1.0).abs() < 1e-10, "{a:?} {b:?}");
    assert!(a[2] > 1.0 && (a[2] - b[2]).abs() < 1e-9, "{a:?} {b:?}");
}

/// A ball on a small plate, bonds that break, contact by the mean over the body.
const IMPACT: &str = "
units si
atom_style hybrid sphere peri
boundary s s s
lattice sc 1e-3
region plate block -0.0051 0.0051 -0.0051 0.0051 -0.0031 0.0001 units box
region world block -0.02 0.02 -0.02 0.02 -0.02 0.02 units box
create_box 2 world
create_atoms 1 region plate
create_atoms 2 single 0.0002 0.0001 0.0025 units box
group plate type 1
group ball type 2
set group plate diameter 1e-3
set group plate volume 1e-9
set group ball diameter 4e-3
set group ball density 7945
set group ball volume 1e-9
material glass file brittle-plate.toml
pair_style hybrid/overlay peri/pmb granular
pair_coeff 1 1 peri/pmb material glass horizon 3.015
pair_coeff 1 2 granular hertz/material 4.0e10 1.0 0.25 tangential mindlin NULL 0.0 0.1 damping coeff_restitution &
  average body curvature impactor
pair_coeff 2 2 none
neighbor 5e-4 bin
velocity ball set 10 0 -60 units box
fix 1 plate nve
fix 2 ball nve/sphere
timestep 2e-8
compute damage all damage/atom
compute broken all reduce sum c_damage
compute p all momentum
";

#[test]
fn an_impact_cut_in_two_is_one_impact() {
    let say =
        "print \"state $(vcm(ball,x):%.17g) $(vcm(ball,z):%.17g) $(ke(plate):%.17g) $(c_broken:%.17g)\"\n";
    let whole = printed("state", &format!("{IMPACT}run 200\n{say}"));
    let cut = printed("state", &format!("{IMPACT}run 90\nrun 60\nrun 50\n{say}"));
    assert_eq!(whole, cut);
    assert!(whole[1] > -60.0 && whole[3] > 0.0, "{whole:?}");
}

#[test]
fn an_impact_keeps_momentum() {
    let say = "print \"momentum $(c_p[1]:%.17g) $(c_p[3]:%.17g)\"\n";
    let p = printed("momentum", &format!("{IMPACT}run 200\n{say}"));
    // The ball brings m v, m = 4/3 pi R^3 rho; sums of forces are exact to rounding.
    let m = 4.0 / 3.0 * std::f64::consts::PI * 0.002f64.powi(3) * 7945.0;
    assert!((p[0] / (m * 10.0) - 1.0).abs() < 1e-11 && (p[1] / (m * -60.0) - 1.0).abs() < 1e-11, "{p:?}");
}
