//! Onset of damage and softening.

use super::*;
use crate::{Brittle, Damage, DruckerPrager, Failure, Flow, FractureStrain, Onset, Reference};

const REFERENCE: Reference = Reference { rate: 1.0, temperature: 298.0, melting: 1356.0 };

/// OFHC copper of Johnson and Cook (1985).
const COPPER: FractureStrain = FractureStrain { d: [0.54, 4.89, -3.03, 0.014, 1.12], reference: REFERENCE };

/// Perfectly plastic metal of 400 MPa that breaks.
fn metal(onset: Onset, energy: f64) -> Material {
    let flow = Flow::Mises(Hardening::Linear { yields: 400.0, modulus: 0.0 });
    let law = Law::Plastic { flow, damage: Some(Damage { onset, energy }) };
    Material { elastic: Elastic::from_young(117e3, 0.35), law }
}

/// Strains without change of volume, in steps, and returns all responses.
fn drawn(material: &Material, most: f64, steps: usize, spacing: f64) -> Vec<Response> {
    let mut memory = Memory::default();
    let moment = Moment { spacing, ..STEP };
    let step = |k: usize| {
        let axial = most * k as f64 / steps as f64;
        let f = stretches([axial.exp(), (-0.5 * axial).exp(), (-0.5 * axial).exp()]);
        let r = material.respond(&f, &memory, &moment).unwrap();
        memory = r.memory;
        r
    };
    (1..=steps).map(step).collect()
}

#[test]
fn fracture_strains_of_copper() {
    // Digits as printed by an independent program.
    for (ratio, expected) in [(1.0 / 3.0, 2.32103), (1.0, 0.776263), (-1.0 / 3.0, 13.96599)] {
        let strain = COPPER.at(ratio, 1.0, 0.0, None);
        assert!((strain / expected - 1.0).abs() < 1e-6, "{strain}");
    }
    // 10³/s and half way to melting.
    let factor = COPPER.at(1.0, 1e-3, 1e-6, Some(827.0)) / COPPER.at(1.0, 1e-3, 0.0, None);
    assert!((factor - (1.0 + 0.014 * 1e3f64.ln()) * 1.56).abs() < 1e-12, "{factor}");
}

#[test]
fn damage_begins_where_wear_is_complete() {
    // Without mean stress ε_f = D₁ + D₂ = 5.43.
    let all = drawn(&metal(Onset::JohnsonCook(COPPER), 1e9), 1.0, 500, 1.0);
    let last = all.last().unwrap().memory;
    assert!((last.wear - last.strain / 5.43).abs() < 1e-12 && last.damage == 0.0 && last.onset == 0.0);
}

#[test]
fn a_layer_spends_its_fracture_energy_whatever_its_thickness() {
    // G_f 20 N/mm (20 kJ/m²) at 400 MPa: ū_f = 0.1 mm.
    for spacing in [0.5, 1.0] {
        for steps in [1000, 4000] {
            let all = drawn(&metal(Onset::Strain(0.1), 20.0), 0.5, steps, spacing);
            let last = all.last().unwrap();
            assert_eq!((last.memory.damage, last.memory.wear, last.mises), (1.0, 1.0, 0.0));
            assert_eq!(last.memory.onset, 400.0);
            assert!(last.energy.abs() < 1e-12);
            // Work after the onset, per area: ½σ_y ū_f = G_f. Flow is stretched to the end of the step that contains its onset, and
            // of that of its end: two steps of 400 MPa.
            let after: f64 = all.iter().filter(|r| r.memory.damage > 0.0).map(|r| r.dissipated).sum();
            let tolerance = 2.0 * 400.0 * 0.5 / steps as f64;
            assert!(
                (after * spacing - 20.0).abs() < tolerance * spacing,
                "{} {spacing} {steps}",
                after * spacing
            );
            // Elastic energy at the onset q²/6G is set free by the damage. Mean: one step of damage.
            let released: f64 = all.iter().map(|r| r.released).sum();
            let stored = 400.0 * 400.0 / (6.0 * metal(Onset::Strain(0.1), 20.0).shear());
            assert!((released / stored - 1.0).abs() < 1e-9, "{released} {stored}");
        }
    }
}

#[test]
fn broken_matter_bears_pressure_alone() {
    let material = metal(Onset::Strain(0.1), 20.0);
    let broken = drawn(&material, 0.5, 500, 1.0).last().unwrap().memory;
    let axial = 0.5f64;
    let at = |volume: f64| {
        let f = stretches([axial, -0.5 * axial, -0.5 * axial].map(|x| (x + volume / 3.0).exp()));
        let tau = kirchhoff(&material.respond(&f, &broken, &STEP).unwrap(), &f);
        [tau[0][0], tau[1][1], tau[0][1]]
    };
    assert_eq!(at(0.01), [0.0; 3]);
    let [x, y, xy] = at(-0.01);
    // p = K tr ε; rounding of strains about 1 times K over 1e-2 K.
    let pressure = -0.01 * material.bulk();
    assert!((x / pressure - 1.0).abs() < 1e-12 && (y / pressure - 1.0).abs() < 1e-12 && xy == 0.0);
}

#[test]
fn matter_without_a_fracture_strain_is_damaged_at_once() {
    let brittle = FractureStrain { d: [-0.1, 0.05, -1.0, 0.0, 0.0], reference: REFERENCE };
    let all = drawn(&metal(Onset::JohnsonCook(brittle), 20.0), 0.05, 50, 1.0);
    let first = all.iter().find(|r| r.memory.strain > 0.0).unwrap().memory;
    assert!(first.wear == 1.0 && first.damage > 0.0, "{first:?}");
}

/// Concrete in MPa and mm: 30 GPa, 0.2, 3 MPa, 0.1 N/mm.
fn concrete() -> Material {
    let law = Law::Brittle(Brittle { strength: 3.0, energy: 0.1 });
    Material { elastic: Elastic::from_young(30e3, 0.2), law }
}

/// F of a bar of this axial logarithmic strain whose sides carry no stress while it is elastic: ν of Hencky's law.
fn bar(axial: f64) -> Mat3 {
    stretches([axial, -0.2 * axial, -0.2 * axial].map(f64::exp))
}

#[test]
fn pulled_concrete_softens_on_a_line() {
    let material = concrete();
    // s = 2EG_f/(f_t²Δx) with Δx = 20 mm.
    let (spacing, end) = (20.0, 2.0 * 30e3 * 0.1 / (9.0 * 20.0));
    let moment = Moment { spacing, ..STEP };
    let (mut memory, mut released) = (Memory::default(), 0.0);
    for k in 1..=400 {
        let w = k as f64 * 0.1;
        let f = bar(w * 3.0 / 30e3);
        let r = material.respond(&f, &memory, &moment).unwrap();
        let tau = kirchhoff(&r, &f);
        let expected = if w <= 1.0 { 3.0 * w } else { 3.0 * (end - w).max(0.0) / (end - 1.0) };
        // Rounding of strains about 1 over 1e-4, times E, grows with w.
        assert!((tau[0][0] - expected).abs() < 1e-10 * w, "{w}: {} {expected}", tau[0][0]);
        released += r.released;
        memory = r.memory;
    }
    assert_eq!((memory.damage, memory.onset), (1.0, 3.0));
    // All of G_f, exactly where stresses grow in proportion.
    assert!((released * spacing / 0.1 - 1.0).abs() < 1e-9, "{}", released * spacing);
}

#[test]
fn cracks_in_concrete_unload_to_the_origin_and_close() {
    let material = concrete();
    let moment = Moment { spacing: 20.0, ..STEP };
    let r = material.respond(&bar(5e-4), &Memory::default(), &moment).unwrap();
    let half = material.respond(&bar(2.5e-4), &r.memory, &moment).unwrap();
    assert!(half.memory == r.memory && half.released == 0.0);
    assert!((half.energy / r.energy - 0.25).abs() < 1e-9);
    let [damaged, whole] = [r.memory, Memory::default()].map(|memory| {
        let third = (-1e-4f64).exp();
        material.respond(&stretches([third; 3]), &memory, &moment).unwrap().piola
    });
    assert_eq!(damaged, whole);
    // A trial leaves the memory.
    let trial = Moment { advance: false, ..moment };
    let trial = material.respond(&bar(5e-4), &Memory::default(), &trial).unwrap();
    assert_eq!((trial.piola, trial.memory), (r.piola, Memory::default()));
}

#[test]
fn sites_too_far_apart_for_a_fracture_energy_are_refused() {
    let material = concrete();
    // 2EG_f/f_t² = 666.7 mm.
    let moment = Moment { spacing: 700.0, ..STEP };
    let failure = material.respond(&UNIT, &Memory::default(), &moment).unwrap_err();
    assert!(matches!(failure, Failure::Coarse { most, .. } if (most / (2000.0 / 3.0) - 1.0).abs() < 1e-12));
}

#[test]
fn matter_that_flows_may_be_damaged_by_tension() {
    let cone = DruckerPrager::from_angles(10.0, 0.0, 30.0, 30.0);
    let damage = Damage { onset: Onset::Stress(5.0), energy: 0.1 };
    let law = Law::Plastic { flow: Flow::DruckerPrager(cone), damage: Some(damage) };
    let material = Material { elastic: Elastic::from_young(20e3, 0.25), law };
    let at = |f| material.respond(&f, &Memory::default(), &STEP).unwrap();
    // Pulled to the apex at 17 MPa, above 5 MPa; sheared under pressure without tension.
    assert!(at(stretches([1.01; 3])).memory.damage > 0.0);
    let pressed = at(stretches([1.004, 0.985, 0.9995]));
    assert!(pressed.memory.strain > 0.0 && pressed.memory.damage == 0.0);
    // Elastic tension of any size does no damage by itself.
    assert_eq!(at(stretches([1.0002, 1.0, 1.0])).memory, Memory::default());
}
