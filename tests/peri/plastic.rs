//! Plastic bars under loads that come and go: the loop of an elastic, perfectly plastic solid, cycle after cycle.

use super::scene::Scene;
use perigrain::world::families::*;

const DX: f64 = 1e-3;
const K: f64 = 14e9;
const G: f64 = 6e9;
const YIELD: f64 = 2e6;

/// A bar along x, periodic across, whose three outer layers on both sides are moved.
struct Bar {
    scene: Scene,
    long: i32,
    area: f64,
}

impl Bar {
    fn new(dt: f64) -> Self {
        let (long, wide) = (10, 6);
        let mut scene = Scene::new(DX, dt, 1);
        scene.fill(DX, [[0, long - 1], [0, wide - 1], [0, wide - 1]], 1, 2200.0, |_| true);
        let side = f64::from(wide) * DX;
        let (lo, hi) = ([-1.0, -0.5 * DX, -0.5 * DX], [1.0, side - 0.5 * DX, side - 0.5 * DX]);
        scene.bounds = Bounds { lo, hi, periodic: [false, true, true] };
        let coeff = PmbCoeff { c: 0.0, horizon: 2.015 * DX, s00: f64::INFINITY, alpha: 0.0 };
        scene.table.set(1, 1, coeff).unwrap();
        scene.options.volume = VolumeRule::Full;
        scene.law.kind = LawKind::Eps;
        let own = Moduli { bulk: K, shear: G, yield_stress: YIELD, ..Moduli::default() };
        scene.law.moduli = vec![own];
        scene.setup();
        Self { scene, long, area: side * side }
    }

    /// A step of velocity Verlet in which the ends have this strain; the stress with which the halves of the bar pull.
    fn step(&mut self, strain: f64) -> f64 {
        let s = &mut self.scene;
        let far = f64::from(self.long) * DX;
        s.drift_and_kick(true);
        for (x, x0) in s.x.iter_mut().zip(&s.x0) {
            if x0[0] < 2.5 * DX || x0[0] > far - 3.5 * DX {
                *x = [x0[0] * (1.0 + strain), x0[1], x0[2]];
            }
        }
        s.forces(true);
        s.drift_and_kick(false);
        let right = (0..s.x.len()).filter(|&i| s.x0[i][0] > 0.5 * far - 0.5 * DX);
        -right.map(|i| s.f[i][0] * s.volume[i]).sum::<f64>() / self.area
    }
}

/// Cycles of strain up and down at a constant rate, `steps` each; stress in units of the yield stress, cycle by cycle, at
/// both ends of the loop and where strain goes through 0 both ways.
fn cycles(bar: &mut Bar, amplitude: f64, steps: usize, count: usize) -> Vec<[f64; 4]> {
    let quarter = steps / 4;
    (0..count)
        .map(|_| {
            let mut corners = [0.0; 4];
            for k in 1..=steps {
                let phase = k as f64 / steps as f64;
                let saw = 1.0 - 4.0 * ((phase + 0.25).fract() - 0.5).abs();
                let stress = bar.step(amplitude * saw);
                if k % quarter == 0 {
                    corners[k / quarter - 1] = stress / YIELD;
                }
            }
            corners
        })
        .collect()
}

/// Stress of an elastic, perfectly plastic solid under strain along one axis alone: Kε and a deviatoric part of at most
/// 2/3 of the yield stress. At the ends of the loop it flows; where strain comes back to 0 it still does, if the
/// amplitude is more than twice the strain at which it began.
fn checked(steps: usize, count: usize) {
    // The longest wave of the free middle (5 spacings) swings in some 4 µs: 200 steps of 1.5e-7 s are slow. The step is 0.45 dx/c,
    // c = √((K + 4G/3)/ρ).
    let mut bar = Bar::new(1.5e-7);
    let limit = 2.0 / 3.0;
    let amplitude = 4.0 * limit * YIELD / (4.0 / 3.0 * G);
    let loops = cycles(&mut bar, amplitude, steps, count);
    let volume = K * amplitude / YIELD;
    for (n, [top, down, bottom, up]) in loops.iter().enumerate().skip(1) {
        // The lattice's own directions yield a few per cent off, as in `plastic_loops_are_those_of_von_mises` (4 %, for
        // twice the neighbours); ends are families that lack half of their partners.
        for (stress, expected) in
            [(top, volume + limit), (down, -limit), (bottom, -volume - limit), (up, limit)]
        {
            let off = (stress - expected).abs() / limit;
            assert!(off < 0.1, "cycle {n}: {stress}, not {expected}: {loops:?}");
        }
        // Nothing hardens, softens or walks away: rounding of 1e5 steps.
        let first = loops[1];
        for (a, b) in first.iter().zip([top, down, bottom, up]) {
            assert!((a - b).abs() < 1e-3 * limit, "cycle {n}: {b}, {a} in the first");
        }
    }
}

#[test]
fn a_bar_follows_the_loop_of_perfect_plasticity() {
    checked(200, 3);
}

/// 500 cycles of 200 steps; seconds where the crate is optimised.
#[test]
#[ignore = "a long run"]
fn a_bar_still_does_after_1e5_steps() {
    checked(200, 500);
}
