//! Properties that hold for random deformations.

use super::*;

/// Every law, with moduli and yield stresses of order 1.
fn laws() -> Vec<Material> {
    let elastic = Elastic { bulk: 2.0, shear: 1.0 };
    let linear = Hardening::Linear { yields: 0.02, modulus: 0.1 };
    [Law::Linear, Law::NeoHooke, Law::Hencky, Law::Plastic(crate::Flow::Mises(linear))]
        .map(|law| Material { elastic, law })
        .into()
}

/// Memories of sites that have flowed: twenty random steps.
fn past(material: &Material, seed: u64) -> Memory {
    let mut memory = Memory::default();
    for k in 0..20 {
        memory = material.respond(&near_unit(100 * seed + k, 0.15), &memory, &STEP).unwrap().memory;
    }
    memory
}

#[test]
fn turned_matter_has_the_turned_stress() {
    for material in laws().iter().filter(|m| m.law != Law::Linear) {
        for seed in 0..100 {
            let memory = past(material, seed);
            let (f, q) = (near_unit(seed + 7, 0.2), rotation(random(seed)[0], 3.0));
            let plain = material.respond(&f, &memory, &STEP).unwrap();
            let turned = material.respond(&times(&q, &f), &memory, &STEP).unwrap();
            // Thirty roundings of moduli of order 1.
            assert!(apart(&turned.piola, &times(&q, &plain.piola)) < 1e-12, "{material:?} {seed}");
            assert!((turned.memory.strain - plain.memory.strain).abs() < 1e-12);
            assert!(
                turned.memory.plastic.iter().zip(&plain.memory.plastic).all(|(a, b)| (a - b).abs() < 1e-12)
            );
        }
    }
}

#[test]
fn stress_is_the_slope_of_the_energy() {
    for material in laws().iter().filter(|m| !m.remembers()) {
        for seed in 0..50 {
            let f = near_unit(seed, 0.2);
            let piola = material.respond(&f, &Memory::default(), &STEP).unwrap().piola;
            let h = 1e-5;
            let energy = |i: usize, j: usize, h: f64| {
                let mut g = f;
                g[i][j] += h;
                material.respond(&g, &Memory::default(), &STEP).unwrap().energy
            };
            let slope: Mat3 = std::array::from_fn(|i| {
                std::array::from_fn(|j| (energy(i, j, h) - energy(i, j, -h)) / (2.0 * h))
            });
            // h² of the third derivative and rounding/h: both below 1e-8 for moduli of order 1.
            assert!(apart(&slope, &piola) < 1e-7, "{material:?} {seed}: {}", apart(&slope, &piola));
        }
    }
}

#[test]
fn flow_keeps_the_volume_and_takes_energy() {
    for material in laws().iter().filter(|m| m.remembers()) {
        for seed in 0..50 {
            let mut memory = Memory::default();
            for k in 0..50 {
                let r = material.respond(&near_unit(100 * seed + k, 0.3), &memory, &STEP).unwrap();
                assert!(r.dissipated >= 0.0 && r.memory.strain >= memory.strain);
                memory = r.memory;
            }
            // Rounding of a determinant, which steps do not add up.
            assert!((determinant(&memory.plastic) - 1.0).abs() < 1e-13, "{:?}", memory);
        }
    }
}

#[test]
fn the_state_after_flow_lies_on_the_yield_surface() {
    for material in laws().iter().filter(|m| m.remembers()) {
        for seed in 0..100 {
            let memory = past(material, seed);
            let f = near_unit(seed + 7, 0.2);
            let r = material.respond(&f, &memory, &STEP).unwrap();
            let again = material.respond(&f, &r.memory, &STEP).unwrap();
            // The same state found through its memory: rounding of b, times 2G.
            assert!(apart(&r.piola, &again.piola) < 1e-13, "{}", apart(&r.piola, &again.piola));
            assert!((again.memory.strain - r.memory.strain).abs() < 1e-14);
        }
    }
}
