//! Dispersion: speeds of plane waves on the lattice against the relation of the discrete sum and the continuum's limit.

use perigrain_peri::families::*;

use super::scene::Scene;

const DX: f64 = 1e-3;
const K: f64 = 14.9e9;
const RHO: f64 = 2200.0;
/// Sites along the wave.
const LONG: i32 = 24;
/// Sites across it: more than twice the horizon, or bonds would meet their own images.
const WIDE: i32 = 8;

fn micromodulus(delta: f64) -> f64 {
    18.0 * K / (std::f64::consts::PI * delta.powi(4))
}

/// ω of a wave along x with wave number k, moving along `axis`:
/// ρω² = Σ c w V (ξ_axis²/|ξ|³)(1 − cos kξ_x), by plain sum over a whole family.
fn relation(m: f64, rule: VolumeRule, k: f64, axis: usize) -> f64 {
    let delta = m * DX;
    let reach = rule.reach(m, 1.0);
    let edge = reach.floor() as i32;
    let side = || -edge..=edge;
    let mut sum = 0.0;
    for (x, y, z) in side().flat_map(|x| side().flat_map(move |y| side().map(move |z| (x, y, z)))) {
        let xi = [x, y, z].map(|n| f64::from(n) * DX);
        let length = xi.iter().map(|x| x * x).sum::<f64>().sqrt();
        if length > 0.0 && length <= reach * DX {
            let weight = rule.weight(length, delta, DX);
            sum += weight * xi[axis].powi(2) / length.powi(3) * (1.0 - (k * xi[0]).cos());
        }
    }
    (micromodulus(delta) * sum * DX.powi(3) / RHO).sqrt()
}

/// ω from one step of a standing wave of `waves` lengths that starts at rest: u₁ = u₀ (1 − ω²dt²/2).
fn measured(m: f64, rule: VolumeRule, waves: i32, axis: usize) -> f64 {
    let delta = m * DX;
    let mut s = Scene::new(DX, 2e-8, 1);
    s.fill(DX, [[0, LONG - 1], [0, WIDE - 1], [0, WIDE - 1]], 1, RHO, |_| true);
    let size = [LONG, WIDE, WIDE].map(|n| f64::from(n) * DX);
    s.bounds =
        Bounds { lo: [-0.5 * DX; 3], hi: size.map(|l| l - 0.5 * DX), periodic: [true; 3], tilt: [0.0; 3] };
    s.table.set(1, 1, PmbCoeff { c: micromodulus(delta), horizon: delta, s00: 1.0, alpha: 0.0 }).unwrap();
    s.options.volume = rule;
    s.setup();
    let k = 2.0 * std::f64::consts::PI * f64::from(waves) / size[0];
    let start: Vec<f64> = s.x0.iter().map(|x| 1e-5 * DX * (k * x[0]).cos()).collect();
    for (x, u) in s.x.iter_mut().zip(&start) {
        x[axis] += u;
    }
    s.forces(false);
    s.drift_and_kick(true);
    let moved: f64 = (0..s.x.len()).map(|i| (s.x[i][axis] - s.x0[i][axis]) * start[i]).sum();
    let square: f64 = start.iter().map(|u| u * u).sum();
    (2.0 * (1.0 - moved / square)).sqrt() / s.dt
}

#[test]
fn waves_follow_the_discrete_dispersion_relation() {
    for (m, rule) in [(3.015, VolumeRule::Lammps), (3.015, VolumeRule::None), (2.015, VolumeRule::Full)] {
        for waves in [1, 2, 4, 8, 12] {
            for axis in [0, 1] {
                let k = 2.0 * std::f64::consts::PI * f64::from(waves) / (f64::from(LONG) * DX);
                let ratio = measured(m, rule, waves, axis) / relation(m, rule, k, axis);
                // Bonds are linear to their strain, at most 3e-5 of it counts in the mean as its square; the longest wave
                // changes by 1.5e-4 of 1e-5 dx in the step, and places of 24 dx are known to 3e-16 of that: 2e-6.
                assert!((ratio - 1.0).abs() < 1e-5, "{m} {rule:?} {waves} {axis}: {ratio}");
            }
        }
    }
}

#[test]
fn long_waves_have_the_speed_of_the_lattice_moduli() {
    // physics.md 4.2: c_L along an axis is √0.854 = 0.924 of √(9K/5ρ) for a horizon of 3.015 and LAMMPS' weights.
    let long = 1e-3 / DX;
    let speed = relation(3.015, VolumeRule::Lammps, long, 0) / long;
    let ratio = speed / (1.8 * K / RHO).sqrt();
    assert!((ratio - 0.924).abs() < 5e-4, "{ratio}");
    // Shorter waves are slower: at the edge of the zone by more than half (test-cases.md 3c for a bar: 0.32).
    let short = std::f64::consts::PI / DX;
    assert!(relation(3.015, VolumeRule::Lammps, short, 0) / short < 0.5 * speed);
}
