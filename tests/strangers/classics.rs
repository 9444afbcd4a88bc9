//! K6: words of LAMMPS that decks of strangers use: soft pushes, collections, angles, torques, dipoles.

use super::{numbers, run, text};

/// Numbers that stand behind `name` are those wanted, to a part `tolerance` of each.
fn close(said: &str, name: &str, wanted: &[f64], tolerance: f64) {
    let found = numbers(said, name);
    assert_eq!(found.len(), wanted.len(), "{name}: {found:?} for {wanted:?} in\n{said}");
    for (a, b) in found.iter().zip(wanted) {
        assert!((a - b).abs() <= tolerance * b.abs(), "{name}: {found:?} for {wanted:?}");
    }
}

/// The deck of LAMMPS' manual (fix adapt raises A by ramp()) with nve/limit, then minimize; LAMMPS 22Jul2025 prints these numbers:
/// pe, ke, press, Σ energies and forces of pairs, energy between the types, Σ of virials of particles.
#[test]
fn soft_pushes_take_points_apart() {
    let said = text(&run("soft_push.in", &["-compat", "lammps/2025"]));
    let wanted = [878.4232928, 941.5509851, 11.73595401, 878.4232928, 5173.999012, 422.9885982, -1888.102608];
    // Ten digits after 100 steps of 100 points.
    close(&said, "RESULT", &wanted, 1e-9);
    // Twenty turns of a line search multiply roundings.
    close(&said, "RELAXED", &[46.84319115], 1e-6);
}

/// LAMMPS 22Jul2025: pressure, fx of particle 1, energy for each rule of mixing, with weights 0.5 and 0.25 between bonded particles.
#[test]
fn weights_in_part_and_rules_of_mixing_are_lammps() {
    let rules = ["geometric", "arithmetic", "sixthpower"];
    let soft = [
        [0.0840038834677, -30.5316256825, 56.3385027148],
        [0.0821424458088, -29.5513490868, 57.2272598408],
        [0.0751688577126, -25.9960909097, 60.3864930921],
    ];
    let springs = [
        [0.042071049998, -10.7188060658, 16.4957727661],
        [0.0429935003583, -11.1494233306, 17.4892072111],
        [0.0329482805452, -6.59620037719, 12.8397808],
    ];
    for (style, line, wanted) in [("soft", "soft 1.1", soft), ("bpm/spring", "bpm/spring", springs)] {
        let said = text(&run("soft_between_bonds.in", &["-var", "style", style, "-var", "line", line]));
        for (rule, wanted) in rules.iter().zip(wanted) {
            // All twelve digits that LAMMPS prints.
            close(&said, &format!("RESULT_{rule}"), &wanted, 1e-11);
        }
    }
}

/// LAMMPS 22Jul2025: angles, bonds, pe and ke of a chain, angle types; angles and bonds after replicate, a molecule and a line.
#[test]
fn chains_keep_their_angles() {
    let said = text(&run("chain_with_angles.in", &[]));
    close(&said, "RESULT", &[3.0, 4.0, 1.086232601, 2.750469687, 3.0], 1e-9);
    close(&said, "MORE", &[8.0, 10.0], 0.0);
    close(&said, "RESTARTED", &[3.0, 4.0], 0.0);
    close(&said, "READ", &[3.0, 4.0, 3.0], 0.0);
    // The file that was written names the coefficients of all three types, so that `angle_style zero` needs no further lines.
    assert!(!said.contains("error["), "{said}");
}
