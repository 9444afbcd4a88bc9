//! Onset of damage and softening.

use super::*;
use crate::{Damage, Flow, FractureStrain, Onset, Reference};

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
