//! Mises flow against closed forms.

use super::*;
use crate::{Flow, Flowing, Heating, JohnsonCook, Reference};

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

/// Roots of τ = σ_y(ε − τ/E), the closed form of a bar in one step.
fn closed(hardening: &Hardening, axial: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1e4);
    for _ in 0..200 {
        let tau = 0.5 * (low + high);
        let flowing = Flowing { before: 0.0, step: (axial - tau / 117e3).max(0.0), dt: 0.0, thermal: 1.0 };
        match tau < hardening.limit(flowing).0 {
            true => low = tau,
            false => high = tau,
        }
    }
    low
}

#[test]
fn pulled_bars_follow_every_hardening() {
    let reference = Reference { rate: 1.0, temperature: 298.0, melting: 1356.0 };
    let power =
        JohnsonCook { yields: 90.0, modulus: 292.0, exponent: 0.31, rate: 0.0, thermal: 1.0, reference };
    let cases = [
        // Digits as printed by an independent program.
        (
            Hardening::Voce { yields: 400.0, saturation: 600.0, exponent: 10.0, modulus: 0.0 },
            Some([412.53784, 523.06019, 598.58167]),
        ),
        (Hardening::JohnsonCook(power), Some([156.98630, 232.12972, 325.13280])),
        (Hardening::Swift { yields: 200.0, strain: 0.01, exponent: 0.2 }, None),
        (Hardening::Table(vec![[0.0, 100.0], [0.05, 200.0], [0.3, 250.0]]), None),
    ];
    for (hardening, printed) in cases {
        for (k, axial) in [0.01, 0.1, 0.5].into_iter().enumerate() {
            let tau = pulled(&bar(hardening.clone()), axial);
            if let Some(printed) = printed {
                assert!((tau / printed[k] - 1.0).abs() < 2e-8, "{hardening:?} {axial}: {tau}");
            }
            // Bisection of the sides to rounding of the strain, times 3G/σ.
            assert!((tau / closed(&hardening, axial) - 1.0).abs() < 1e-12, "{hardening:?} {axial}: {tau}");
        }
    }
}

/// OFHC copper of Johnson and Cook (1983), in MPa, s and K.
const COPPER: JohnsonCook = JohnsonCook {
    yields: 90.0,
    modulus: 292.0,
    exponent: 0.31,
    rate: 0.025,
    thermal: 1.09,
    reference: Reference { rate: 1.0, temperature: 298.0, melting: 1356.0 },
};

#[test]
fn copper_of_johnson_and_cook() {
    // ε̄ = 0.3 at a rate and a temperature: (90 + 292·0.3^0.31)(1 + 0.025 ln 10³)(1 − T*^1.09).
    for (rate, temperature, expected) in
        [(1.0, 298.0, 291.04369), (1e3, 298.0, 341.30515), (1e3, 600.0, 254.27674)]
    {
        let step = 1e-4;
        let flowing =
            Flowing { before: 0.3 - step, step, dt: step / rate, thermal: COPPER.thermal(Some(temperature)) };
        let limit = COPPER.limit(flowing).0;
        assert!((limit / expected - 1.0).abs() < 2e-8, "{limit}");
    }
    let molten = COPPER.thermal(Some(1400.0));
    assert_eq!((COPPER.thermal(None), COPPER.thermal(Some(200.0)), molten), (1.0, 1.0, 0.0));
    // Slopes are those of the limit: rounding/h of a central difference.
    let at = |step| Flowing { before: 0.1, step, dt: 1e-6, thermal: 0.8 };
    let slope = (COPPER.limit(at(1e-3 + 1e-8)).0 - COPPER.limit(at(1e-3 - 1e-8)).0) / 2e-8;
    assert!((COPPER.limit(at(1e-3)).1 / slope - 1.0).abs() < 1e-5);
}

/// A stress just beyond the first yield stress returns, though the slope of ε̄ⁿ is infinite there.
#[test]
fn power_laws_begin_at_any_excess() {
    let hardening = Hardening::JohnsonCook(COPPER);
    let (flow, elastic) = (Flow::Mises(hardening.clone()), bar(hardening).elastic);
    let first = COPPER.limit(Flowing { before: 0.0, step: 0.0, dt: 0.0, thermal: 1.0 }).0;
    for excess in [1e-9, 1e-6, 5e-5, 1e-3, 0.1] {
        let q = first * (1.0 + excess);
        let still = Moment { dt: 0.0, ..STEP };
        let found = flow.returned(&elastic, [q, 0.0], 0.0, &still).unwrap().unwrap();
        let left = q - 3.0 * elastic.shear * found.step - found.limit;
        // Some roundings of q.
        assert!(found.step > 0.0 && left.abs() < 1e-13 * q, "{excess}: {found:?} {left:e}");
    }
}

#[test]
fn molten_matter_bears_no_shear() {
    let material = bar(Hardening::JohnsonCook(COPPER));
    let hot = Moment { temperature: Some(1356.0), ..STEP };
    let r = material.respond(&shear(0.1), &Memory::default(), &hot).unwrap();
    assert_eq!((r.mises, r.dissipated), (0.0, 0.0));
    assert!(r.memory.strain > 0.05);
}

#[test]
fn plastic_work_warms_copper() {
    let material = bar(Hardening::JohnsonCook(COPPER));
    // ρ 8960 kg/m³, c 383 J/(kg K) in MPa: 8960·383/10⁶ MPa/K.
    let heating = Heating { fraction: 0.9, density: 8960.0, capacity: 383e-6 };
    let steps = 3000;
    let (mut memory, mut temperature, mut mises) = (Memory::default(), 298.0, 0.0);
    // The deviatoric strain of a bar at a plastic rate of 10³/s: its elastic part, σ/3G, stays below 3e-3.
    let shear = material.shear();
    for k in 1..=steps {
        let plastic = 0.3 * k as f64 / steps as f64;
        let flowing = Flowing {
            before: plastic - 0.3 / steps as f64,
            step: 0.3 / steps as f64,
            dt: 0.3e-3 / steps as f64,
            thermal: COPPER.thermal(Some(temperature)),
        };
        let axial = plastic + COPPER.limit(flowing).0 / (3.0 * shear);
        let f = stretches([axial.exp(), (-0.5 * axial).exp(), (-0.5 * axial).exp()]);
        let moment = Moment { dt: flowing.dt, temperature: Some(temperature), ..STEP };
        let r = material.respond(&f, &memory, &moment).unwrap();
        temperature += heating.rise(r.dissipated);
        (memory, mises) = (r.memory, r.mises);
    }
    // The path keeps the plastic rate to rounding.
    assert!((memory.strain - 0.3).abs() < 1e-12, "{}", memory.strain);
    // Digits as printed by an independent program. The temperature of a step is that before it: half a step's rise, 4e-3 K, shifts the stress by
    // 1e-5; the steep start of the power law adds as much to the work.
    assert!((temperature - 320.3033).abs() < 5e-4, "{temperature}");
    assert!((mises / 336.2215 - 1.0).abs() < 2e-5, "{mises}");
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
    // τ₁₂ = Y/√3 but for the elastic strains that turn (2e-5); ε̄ = (γ − elastic)/√3, five digits as printed by an independent program.
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
