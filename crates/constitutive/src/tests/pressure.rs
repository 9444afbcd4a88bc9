//! Drucker and Prager's cone against closed forms.

use super::*;
use crate::{DruckerPrager, Flow};

/// Rock in MPa: 20 GPa, 0.25, cohesion 10 MPa, 30° of friction.
fn rock(modulus: f64, dilation: f64) -> (Material, DruckerPrager) {
    let cone = DruckerPrager::from_angles(10.0, modulus, 30.0, dilation);
    let law = Law::Plastic { flow: Flow::DruckerPrager(cone), damage: None };
    (Material { elastic: Elastic::from_young(20e3, 0.25), law }, cone)
}

/// Mean Kirchhoff stress p and √J₂ of a state sheared by `shape` at a volume strain.
fn state(material: &Material, volume: f64, shape: f64) -> ([f64; 2], Memory) {
    let third = volume / 3.0;
    let f = stretches([(third + shape).exp(), (third - shape).exp(), third.exp()]);
    let r = material.respond(&f, &Memory::default(), &STEP).unwrap();
    let tau = kirchhoff(&r, &f);
    ([(tau[0][0] + tau[1][1] + tau[2][2]) / 3.0, r.mises / 3f64.sqrt()], r.memory)
}

#[test]
fn angles_become_slopes() {
    let cone = rock(0.0, 0.0).1;
    // sin 30° = 1/2: η = 3/(√3 · 2.5), κ = 3√3/(√3 · 2.5).
    assert!((cone.friction - 1.2 / 3f64.sqrt()).abs() < 1e-15 && (cone.factor - 1.2).abs() < 1e-15);
    assert_eq!(cone.dilation, 0.0);
}

#[test]
fn shear_strength_grows_with_pressure() {
    for dilation in [0.0, 10.0, 30.0] {
        let (material, cone) = rock(0.0, dilation);
        // Three pressures: tension, none, compression.
        for volume in [2e-4, 0.0, -3e-3] {
            let ([p, root], memory) = state(&material, volume, 0.02);
            // √J₂ = κc − ηp: rounding of strains about 1 times the moduli, 1e-12 MPa, over 10 MPa.
            let expected = cone.factor * 10.0 - cone.friction * p;
            assert!((root / expected - 1.0).abs() < 1e-10, "{volume}: {root} {expected}");
            // Dilation opens by η̄Δγ = η̄ε̄/κ: det C_p⁻¹ = exp(−2 Δε_v).
            let opened = -0.5 * determinant(&memory.plastic).ln();
            assert!((opened - cone.dilation / cone.factor * memory.strain).abs() < 1e-12, "{opened}");
        }
    }
}

#[test]
fn tension_ends_at_the_apex() {
    for (modulus, dilation) in [(0.0, 30.0), (0.0, 0.0), (500.0, 10.0)] {
        let (material, cone) = rock(modulus, dilation);
        let ([p, root], memory) = state(&material, 0.05, 1e-5);
        let cohesion = 10.0 + modulus * memory.strain;
        assert!((p / (cone.factor * cohesion / cone.friction) - 1.0).abs() < 1e-10, "{p}");
        // The trace of the stress is subtracted: rounding of p.
        assert!(root < 1e-13 * p && memory.strain > 0.0, "{root}");
    }
}

#[test]
fn cohesion_hardens() {
    let (material, cone) = rock(500.0, 10.0);
    let ([p, root], memory) = state(&material, -1e-3, 0.02);
    let expected = cone.factor * (10.0 + 500.0 * memory.strain) - cone.friction * p;
    assert!((root / expected - 1.0).abs() < 1e-10 && memory.strain > 0.01, "{root} {expected}");
}

#[test]
fn without_friction_it_is_mises() {
    let cone = DruckerPrager::from_angles(10.0, 0.0, 0.0, 0.0);
    let elastic = Elastic::from_young(20e3, 0.25);
    let law = Law::Plastic { flow: Flow::DruckerPrager(cone), damage: None };
    // q = √3 κc, κ = 2/√3.
    let mises = flowing(Hardening::Linear { yields: 20.0, modulus: 0.0 });
    let f = near_unit(5, 0.1);
    let [a, b] =
        [law, mises].map(|law| Material { elastic, law }.respond(&f, &Memory::default(), &STEP).unwrap());
    // Roundings of strains times moduli.
    assert!(apart(&a.piola, &b.piola) < 1e-10);
}
