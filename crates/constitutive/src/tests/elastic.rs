//! Elastic laws against closed forms.

use super::*;

const ELASTIC: Elastic = Elastic { bulk: 2.0, shear: 1.0 };

/// Relative rounding of stresses at strains of order 1: some thirty operations.
const ROUNDING: f64 = 1e-14;

#[test]
fn simple_shear_of_hencky_and_neo_hooke() {
    let [hencky, neo] = [Law::Hencky, Law::NeoHooke].map(|law| Material { elastic: ELASTIC, law });
    // τ₁₂/G = 2 asinh(γ/2)/√(1 + γ²/4): the axes of FFᵀ turn as γ grows. Eight digits as printed by an independent program.
    for (gamma, expected) in
        [(0.1, 0.09983367), (0.5, 0.48015546), (1.0, 0.86081788), (2.0, 1.24645048), (5.0, 1.22353258)]
    {
        let f = shear(gamma);
        let tau = kirchhoff(&hencky.respond(&f, &Memory::default(), &STEP).unwrap(), &f);
        let closed = 2.0 * (0.5f64 * gamma).asinh() / (1.0 + 0.25 * gamma * gamma).sqrt();
        assert!((closed - expected).abs() < 5e-9, "{closed}");
        assert!((tau[0][1] - closed).abs() < ROUNDING * gamma.max(1.0).powi(2), "{gamma}: {tau:?}");
        // τ₁₁ − τ₂₂ = γτ₁₂ holds for every isotropic elastic law.
        let difference = tau[0][0] - tau[1][1] - gamma * tau[0][1];
        assert!(difference.abs() < ROUNDING * gamma.max(1.0).powi(3), "{gamma}: {difference}");
        let tau = kirchhoff(&neo.respond(&f, &Memory::default(), &STEP).unwrap(), &f);
        assert!((tau[0][1] - gamma).abs() < ROUNDING * gamma.max(1.0), "{gamma}: {tau:?}");
    }
}

#[test]
fn small_strains_of_all_laws_agree() {
    let f = near_unit(3, 1e-7);
    let linear = Material { elastic: ELASTIC, law: Law::Linear };
    let linear = linear.respond(&f, &Memory::default(), &STEP).unwrap();
    for law in [Law::Hencky, Law::NeoHooke] {
        let large = Material { elastic: ELASTIC, law }.respond(&f, &Memory::default(), &STEP).unwrap();
        // Second order in strain and rotation: 1e-14, times a few moduli.
        assert!(apart(&large.piola, &linear.piola) < 3e-13);
        assert!((large.mises - linear.mises).abs() < 3e-13);
    }
}

#[test]
fn matter_turned_inside_out_is_refused() {
    let f = stretches([1.0, -1.0, 1.0]);
    for law in [Law::Hencky, Law::NeoHooke] {
        let material = Material { elastic: ELASTIC, law };
        let respond = |f: &Mat3| material.respond(f, &Memory::default(), &STEP);
        assert_eq!(respond(&f), Err(crate::Failure::Inverted(-1.0)));
        assert_eq!(respond(&stretches([1.0, f64::NAN, 1.0])), Err(crate::Failure::NotFinite));
        // Nearly flat and very long states have numbers, as long as they are states.
        assert!(respond(&stretches([1e-6, 1.0, 1.0])).unwrap().piola[0][0] < -1.0);
        assert!(respond(&stretches([1e6, 1.0, 1.0])).unwrap().energy > 1.0);
    }
}
