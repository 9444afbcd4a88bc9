//! K4: bonds beyond their limit when a run begins.

use super::{numbers, run, text};

/// Style and coefficients of a bond that breaks at a stretch of 0.15, and v after the kick of LAMMPS 22Jul2025 with `smooth yes` and `no`
/// (`bpm/beam` is perigrain's own).
const STYLES: [(&str, &str, Option<[f64; 2]>); 4] = [
    ("bpm/spring", "100 0.15 0.0", Some([-998.194850956043, 0.0654958613546894])),
    ("bpm/spring/plastic", "100 0.15 0.0 0.1", Some([-199.638970191209, 0.0130991722709379])),
    ("bpm/rotational", "100 20 2 2 15 3 3 3 0 0 0 0", Some([-8.02041294786623, 0.0654958613546894])),
    ("bpm/beam", "100 0.2 radius 0.4 strength 15 5", None),
];

fn after(style: &str, coeffs: &str, smooth: &str, more: &[&str]) -> Vec<f64> {
    let mut arguments = vec!["-var", "style", style, "-var", "coeffs", coeffs, "-var", "smooth", smooth];
    arguments.extend(more);
    numbers(&text(&run("bond_beyond_limit.in", &arguments)), "@")
}

#[test]
fn bonds_beyond_their_limit_break_when_a_run_begins() {
    for (style, coeffs, lammps) in STYLES {
        for (k, smooth) in ["yes", "no"].into_iter().enumerate() {
            // Nothing has moved, and there is no bond any more.
            assert_eq!(after(style, coeffs, smooth, &[]), [0.0, 0.0], "{style} {smooth}");
            let Some(expected) = lammps else { continue };
            let found = after(style, coeffs, smooth, &["-compat", "lammps/2025"]);
            // All digits that LAMMPS prints.
            assert!(
                (found[0] - expected[k]).abs() < 1e-13 * expected[k].abs().max(1.0) && found[1] == 0.0,
                "{style} {smooth} {found:?}"
            );
        }
    }
}
