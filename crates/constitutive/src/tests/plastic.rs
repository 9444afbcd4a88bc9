//! Mises flow against closed forms.

use super::*;

/// Copper's constants of solids: 117 GPa, 0.35, in MPa.
fn bar(hardening: Hardening) -> Material {
    mises(117e3, 0.35, hardening)
}

/// Axial Kirchhoff stress of a bar of this logarithmic strain, in one step.
fn pulled(material: &Material, axial: f64) -> f64 {
    let tau = |s: [f64; 3]| {
        let f = stretches(s);
        kirchhoff(&material.respond(&f, &Memory::default(), &STEP).unwrap(), &f)
    };
    tau(free_sides(axial, tau))[0][0]
}

#[test]
fn pulled_bars_follow_linear_hardening() {
    let material = bar(Hardening::Linear { yields: 400.0, modulus: 100.0 });
    // τ = (σ₀ + Hε)/(1 + H/E): proportional strain makes one step exact. Digits as printed.
    for (axial, expected) in [(0.01, 400.65756), (0.1, 409.64987), (0.5, 449.61571)] {
        let tau = pulled(&material, axial);
        assert!((tau / expected - 1.0).abs() < 2e-8, "{axial}: {tau}");
        let closed = (400.0 + 100.0 * axial) / (1.0 + 100.0 / 117e3);
        // Bisection of the sides to rounding of the strain, times 3G/σ.
        assert!((tau / closed - 1.0).abs() < 1e-12, "{axial}: {tau} {closed}");
    }
}

/// Shears in `steps` steps to γ = 2; the last state.
fn sheared(material: &Material, steps: usize, turn: impl Fn(usize) -> Mat3) -> (Response, Mat3) {
    let mut memory = Memory::default();
    let mut last = None;
    for k in 1..=steps {
        let f = times(&turn(k), &shear(2.0 * k as f64 / steps as f64));
        let r = material.respond(&f, &memory, &STEP).unwrap();
        memory = r.memory;
        last = Some((r, f));
    }
    last.unwrap()
}

#[test]
fn sheared_metal_reaches_its_yield_stress() {
    let perfect = bar(Hardening::Linear { yields: 400.0, modulus: 0.0 });
    let (r, f) = sheared(&perfect, 10_000, |_| UNIT);
    let tau = kirchhoff(&r, &f);
    // τ₁₂ = Y/√3 but for the elastic strains that turn (2e-5); ε̄ = (γ − elastic)/√3, five digits as printed by closed.py.
    assert!((tau[0][1] * 3f64.sqrt() / 400.0 - 1.0).abs() < 2e-5, "{tau:?}");
    assert!((r.memory.strain - 1.15161).abs() < 5e-6, "{}", r.memory.strain);
    assert!((r.mises / 400.0 - 1.0).abs() < 1e-12);
    // Digits as printed, of the same 10⁴ steps.
    let hard = bar(Hardening::Linear { yields: 400.0, modulus: 100.0 });
    let (r, f) = sheared(&hard, 10_000, |_| UNIT);
    let tau = kirchhoff(&r, &f);
    assert!((tau[0][1] - 297.3695).abs() < 1e-4, "{tau:?}");
}

#[test]
fn a_turn_in_between_changes_nothing() {
    let material = bar(Hardening::Linear { yields: 400.0, modulus: 100.0 });
    let (plain, f) = sheared(&material, 1000, |_| UNIT);
    let q = rotation([1.0, 2.0, -1.0], 1.0);
    let (turned, g) = sheared(&material, 1000, |k| if k > 500 { q } else { UNIT });
    let back = times(&transposed(&q), &times(&kirchhoff(&turned, &g), &q));
    // Rounding of F Fᵀ about 1, times 2G, is 2e-11 MPa: 5e-14 of the yield stress a step, of which flow forgets all but the last.
    assert!(apart(&back, &kirchhoff(&plain, &f)) < 1e-12 * 400.0, "{back:?}");
    assert!((plain.memory.strain - turned.memory.strain).abs() < 1e-12);
}

#[test]
fn a_trial_has_the_stress_of_a_step_and_leaves_the_memory() {
    let material = bar(Hardening::Linear { yields: 400.0, modulus: 100.0 });
    let f = shear(0.1);
    let step = material.respond(&f, &Memory::default(), &STEP).unwrap();
    let trial = Moment { advance: false, ..STEP };
    let trial = material.respond(&f, &Memory::default(), &trial).unwrap();
    assert_eq!((trial.piola, trial.memory), (step.piola, Memory::default()));
    assert!(step.memory.strain > 0.0 && step.dissipated > 0.0);
}

#[test]
fn a_bar_unloads_elastically() {
    let material = bar(Hardening::Linear { yields: 400.0, modulus: 100.0 });
    let f = stretches([1.02, 0.99, 0.99]);
    let memory = material.respond(&f, &Memory::default(), &STEP).unwrap().memory;
    let less = stretches([1.02 * (-1e-3f64).exp(), 0.99 * 3e-4f64.exp(), 0.99 * 3e-4f64.exp()]);
    let [a, b] = [f, less].map(|f| material.respond(&f, &memory, &STEP).unwrap());
    assert_eq!(b.memory, memory);
    let (a, b) = (kirchhoff(&a, &f), kirchhoff(&b, &less));
    let (bulk, shear) = (material.bulk(), material.shear());
    // Logarithmic strains add up along fixed axes: Δτ = K tr Δε + 2G dev Δε with Δε = −1e-3, 3e-4, 3e-4.
    let volume: f64 = -1e-3 + 6e-4;
    let expected = bulk * volume + 2.0 * shear * (-1e-3 - volume / 3.0);
    assert!((b[0][0] - a[0][0] - expected).abs() < 1e-9 * expected.abs(), "{} {expected}", b[0][0] - a[0][0]);
}
