//! K6: words of LAMMPS that decks of strangers use: soft pushes, collections, angles, torques, dipoles.

use super::{numbers, run, text};

/// Numbers that stand behind `name` are those wanted, to a part `tolerance` of each.
fn close(printed: &str, name: &str, wanted: &[f64], tolerance: f64) {
    let found = numbers(printed, name);
    assert_eq!(found.len(), wanted.len(), "{name}: {found:?} for {wanted:?} in\n{printed}");
    for (a, b) in found.iter().zip(wanted) {
        assert!((a - b).abs() <= tolerance * b.abs(), "{name}: {found:?} for {wanted:?}");
    }
}

/// The deck of LAMMPS' manual (fix adapt raises A by ramp()) with nve/limit, then minimize; LAMMPS 22Jul2025 prints these numbers:
/// pe, ke, press, Σ energies and forces of pairs, energy between the types, Σ of virials of particles.
#[test]
fn soft_pushes_take_points_apart() {
    let printed = text(&run("soft_push.in", &["-compat", "lammps/2025"]));
    let wanted = [878.4232928, 941.5509851, 11.73595401, 878.4232928, 5173.999012, 422.9885982, -1888.102608];
    // Ten digits after 100 steps of 100 points.
    close(&printed, "RESULT", &wanted, 1e-9);
    // Twenty turns of a line search multiply roundings.
    close(&printed, "RELAXED", &[46.84319115], 1e-6);
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
        let printed = text(&run("soft_between_bonds.in", &["-var", "style", style, "-var", "line", line]));
        for (rule, wanted) in rules.iter().zip(wanted) {
            // All twelve digits that LAMMPS prints.
            close(&printed, &format!("RESULT_{rule}"), &wanted, 1e-11);
        }
    }
}

/// LAMMPS 22Jul2025: angles, bonds, pe and ke of a chain, angle types; angles and bonds after replicate, a molecule and a line.
#[test]
fn chains_keep_their_angles() {
    let printed = text(&run("chain_with_angles.in", &[]));
    close(&printed, "RESULT", &[3.0, 4.0, 1.086232601, 2.750469687, 3.0], 1e-9);
    close(&printed, "MORE", &[8.0, 10.0], 0.0);
    close(&printed, "RESTARTED", &[3.0, 4.0], 0.0);
    close(&printed, "READ", &[3.0, 4.0, 3.0], 0.0);
    // The file that was written names the coefficients of all three types, so that `angle_style zero` needs no further lines.
    assert!(!printed.contains("error["), "{printed}");
}

/// ω = t T/(2/5 m R²), m = π/6, R = 1/2, t = 1; the total before each fix changes it.
#[test]
fn torques_of_single_spheres_are_added_and_set() {
    let inertia = 0.4 * std::f64::consts::PI / 6.0 * 0.25;
    let printed = text(&run("torques_of_spheres.in", &[]));
    let found = numbers(&printed, "RESULT");
    let wanted = [0.02 / inertia, 0.1 / inertia, 0.02 / inertia, 0.0, 0.0, 0.02, 0.1];
    assert_eq!(found.len(), wanted.len(), "{printed}");
    // A hundred additions of equal numbers.
    assert!(
        found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-13 * (1.0 + b)),
        "{found:?} {wanted:?}"
    );
}

/// LAMMPS 22Jul2025 prints these numbers with fourteen digits; with `dipole/dlm` its own. Moments stay behind in `displace_atoms rotate` and
/// `fix move rotate` as in LAMMPS under compat, and turn along without it.
#[test]
fn dipoles_turn_in_fields() {
    let start = [
        0.3,
        -0.88314335509192,
        0.43357172187211,
        -0.84974900785458,
        0.67568298287459,
        1.3,
        0.7,
        0.0,
        0.7,
        0.35,
    ];
    let plain = [
        0.70117169598406,
        0.16063141047117,
        -1.2461112000626,
        -0.33377301725662,
        0.77326856947891,
        1.3,
        0.0,
        0.0,
        4.1408460164328,
    ];
    let rotations = [
        0.70037689009812,
        -0.029248963611129,
        -1.2988752875425,
        -0.045469611159254,
        0.765529410334,
        1.3,
        0.0,
        0.0,
        4.1408460164328,
    ];
    let energies = [[-38.386239753721; 2], [-38.626237301074; 2]];
    let rigid = [
        [0.55391753431162, 0.26139843564742, 0.35333585018113],
        [0.57721101712513, 0.12634511395096, 0.38841260778982],
    ];
    for (k, (update, after)) in [("dipole", plain), ("dipole/dlm", rotations)].into_iter().enumerate() {
        let printed = text(&run("dipoles_in_a_field.in", &["-var", "u", update, "-compat", "lammps/2025"]));
        // All digits at first; 500 steps of rounding after that.
        close(&printed, "RESULT0", &start, 1e-13);
        close(&printed, "RESULT1", &after, 1e-9);
        let second = numbers(&printed, "RESULT2");
        assert!(second[4..6].iter().zip(&energies[k]).all(|(a, b)| (a / b - 1.0).abs() < 1e-9), "{printed}");
        let (then, turned, moved) =
            (numbers(&printed, "RESULT2")[0], numbers(&printed, "ROTATED"), numbers(&printed, "MOVED"));
        assert!(turned == moved && turned[0] == then, "{printed}");
        close(&printed, "RIGID", &rigid[k], 1e-9);
        assert_eq!(numbers(&printed, "RESTARTED")[1], 0.7);
        assert_eq!(numbers(&printed, "READ"), numbers(&printed, "RESTARTED"), "{printed}");
    }
    // A quarter of a turn about z, and another one in 2.5 of 10 time units.
    let printed = text(&run("dipoles_in_a_field.in", &["-var", "u", "dipole"]));
    let before = numbers(&printed, "RESULT2")[0];
    let (turned, moved) = (numbers(&printed, "ROTATED"), numbers(&printed, "MOVED"));
    assert!((turned[1] - before).abs() < 1e-12, "{printed}");
    assert!((moved[0] + turned[1]).abs() < 1e-12 && (moved[1] - turned[0]).abs() < 1e-12, "{printed}");
}
