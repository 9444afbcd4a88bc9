//! The Edinburgh elasto-plastic adhesion model compared with its branches in closed form: pairs, walls,
//! energy, action and reaction.

use super::*;
use crate::walls::{Meeting, Planes, Spheres, WallSweep};
use perigrain_base::math::vec3::dot;
use perigrain_world::contacts::Contacts;
use std::f64::consts::PI;

const E: f64 = 5.0e6;
const NU: f64 = 0.3;

/// λ_p, f_0, γ, n, χ.
type Numbers = [f64; 5];

/// Hertz' powers, the linear form, other powers, all with both kinds of adhesion; without adhesion; elastic.
const CASES: [Numbers; 6] = [
    [0.6, 2.0e-3, 8.0, 1.5, 1.5],
    [0.5, 1.0e-3, 5.0, 1.0, 1.0],
    [0.7, 0.0, 8.0, 1.3, 2.2],
    [0.9, 3.0e-3, 300.0, 1.5, 1.5],
    [0.5, 0.0, 0.0, 1.5, 1.5],
    [0.0, 1.0e-3, 5.0, 1.5, 1.5],
];

fn eepa([plasticity, pull, gamma, n, chi]: Numbers, eta: f64) -> Normal {
    Normal::new(&normal::EEPA, &[E, eta, NU, plasticity, pull, gamma, n, chi])
}

fn smooth(numbers: Numbers) -> Granular {
    model(eepa(numbers, 0.0), Damping::None, Tangential::SMOOTH).law(Compat::Perigrain)
}

/// The branches as in the papers, from δ_max and δ_p.
struct Branches {
    numbers: Numbers,
    curvature: f64,
    deepest: f64,
    sticks: f64,
}

impl Branches {
    fn new(numbers: Numbers, curvature: f64) -> Self {
        Self { numbers, curvature, deepest: 0.0, sticks: 0.0 }
    }

    fn stiffness(&self) -> [f64; 2] {
        let [plasticity, _, _, n, _] = self.numbers;
        let young = E / (2.0 * (1.0 - NU * NU));
        let k1 = 4.0 / 3.0 * young * self.curvature.powf(2.0 - n);
        [k1, k1 / (1.0 - plasticity)]
    }

    /// The largest pull beyond f_0 and its overlap, for a plastic overlap.
    fn pull(&self, plastic: f64) -> [f64; 2] {
        let [_, _, gamma, n, _] = self.numbers;
        let k2 = self.stiffness()[1];
        let asked = 1.5 * PI * gamma * (self.curvature * plastic).sqrt();
        let most = k2 * (plastic.powf(n) - (0.5 * plastic).powf(n));
        let pull = asked.min(most);
        [pull, (plastic.powf(n) - pull / k2).powf(1.0 / n)]
    }

    fn force(&mut self, overlap: f64) -> f64 {
        let [plasticity, f0, _, n, chi] = self.numbers;
        let [k1, k2] = self.stiffness();
        let plastic = |deepest: f64| plasticity.powf(1.0 / n) * deepest;
        if overlap >= self.deepest {
            self.deepest = overlap;
            let [pull, at] = self.pull(plastic(overlap));
            self.sticks = if pull > 0.0 { pull / at.powf(chi) } else { 0.0 };
            return -f0 + k1 * overlap.powf(n);
        }
        let unloading = k2 * (overlap.powf(n) - plastic(self.deepest).powf(n));
        let adhesive = -self.sticks * overlap.powf(chi);
        if unloading >= adhesive {
            return -f0 + unloading;
        }
        // Reloading starts from here.
        let back = overlap.powf(n) - adhesive / k2;
        self.deepest = (back / plasticity).powf(1.0 / n);
        -f0 + adhesive
    }
}

/// Overlaps over radius: in, back a little, deeper, out along the adhesive branch, in again from there,
/// deeper, out.
fn path() -> Vec<f64> {
    let legs = [0.0, 0.02, 0.015, 0.03, 0.012, 0.025, 0.05, 0.004, 0.06, 0.0];
    let mut path = vec![];
    for leg in legs.windows(2) {
        path.extend((1..=40).map(|k| leg[0] + (leg[1] - leg[0]) * f64::from(k) / 40.0));
    }
    // First touch itself is not a contact.
    path.into_iter().filter(|d| *d > 1e-9).collect()
}

const RADII: [f64; 2] = [0.005, 0.004];
const STILL: Motion = Motion { velocity: [0.0; 3], spin: [0.0; 3] };
const STEP: Advance = Advance { dt: 1e-6, history: true };

/// Relative difference allowed between two forces, as a fraction of the largest so far: the branches are
/// differences of powers, computed in a different order.
const ROUNDING: f64 = 1e-12;

#[test]
fn two_spheres_follow_the_branches() {
    for numbers in CASES {
        let law = smooth(numbers);
        let curvature = RADII[0] * RADII[1] / (RADII[0] + RADII[1]);
        let (mut exact, mut history) = (Branches::new(numbers, curvature), vec![0.0; law.memory()]);
        let (mut largest, mut pulled) = (0.0_f64, 0.0_f64);
        for part in path() {
            let overlap = part * RADII[1];
            let d = [RADII[0] + RADII[1] - overlap, 0.0, 0.0];
            let g = Geometry { overlap, ..Geometry::of_spheres(d, RADII, [1.0; 2], 0.0).unwrap() };
            let w = law.contact(&g, &STILL, &STILL, &mut history, STEP);
            let force = exact.force(overlap);
            (largest, pulled) = (largest.max(force.abs()), pulled.min(force));
            assert!(
                (w.force[0] - force).abs() <= ROUNDING * largest,
                "{numbers:?} {part}: {} {force}",
                w.force[0]
            );
            assert_eq!([w.force[1], w.force[2]], [0.0; 2]);
            // The history is that of the formula: δ_max^n.
            let deepest = exact.deepest.powf(numbers[3]);
            assert!((history[3] - deepest).abs() <= 1e-11 * deepest, "{numbers:?} {part}");
        }
        assert_eq!(pulled < 0.0, numbers[1] + numbers[2] * numbers[0] > 0.0, "{numbers:?}: {pulled}");
    }
}

#[test]
fn spheres_on_a_wall_follow_the_branches_one_by_one_and_together() {
    for numbers in CASES {
        let law = smooth(numbers);
        // Seven grains side by side are evaluated as a group, two of the first at a time.
        for count in [2, 7] {
            let radius = vec![RADII[0]; count];
            let (still, tag) = (vec![[0.0; 3]; count], (1..=count as u32).collect::<Vec<_>>());
            let floor = Planes { axis: 2, lo: Some(0.0), hi: None, velocity: [[0.0; 3]; 2], nearer: false };
            let (mut sweep, mut memory) = (WallSweep::default(), Contacts::default());
            let mut exact = Branches::new(numbers, RADII[0]);
            let mut largest = 0.0_f64;
            for part in path() {
                let height = RADII[0] - part * RADII[0];
                let x: Vec<Vec3> = (0..count).map(|k| [k as f64, 0.0, height]).collect();
                let grains =
                    Spheres { x: &x, v: &still, omega: &still, radius: &radius, mass: &radius, tag: &tag };
                let all = 0..count;
                let which = Meeting {
                    mask: &vec![1; count],
                    group: 1,
                    rows: std::slice::from_ref(&all),
                    kinds: None,
                };
                sweep.list(&floor, &grains, &which, &law, 0.001);
                sweep.run(&floor, &grains, &law, &mut memory, STEP);
                let force = exact.force(RADII[0] - height);
                largest = largest.max(force.abs());
                assert_eq!(sweep.contacts().count(), count);
                for (_, w) in sweep.contacts() {
                    // Overlaps of 1e-9 come from heights of 1e-3.
                    assert!(
                        (w.force[2] - force).abs() <= 1e-11 * largest,
                        "{numbers:?} {part}: {:?} {force}",
                        w.force
                    );
                }
            }
        }
    }
}

#[test]
fn a_cycle_takes_the_area_between_the_branches() {
    let numbers @ [_, f0, _, n, chi] = CASES[0];
    let law = smooth(numbers);
    let deepest = 2.0e-4;
    let curvature = RADII[0];
    let exact = Branches::new(numbers, curvature);
    let ([k1, k2], plastic) = (exact.stiffness(), numbers[0].powf(1.0 / n) * deepest);
    let [pull, least] = exact.pull(plastic);
    // In along k_1; out along k_2 to δ_min; then along the adhesive branch. The work of f_0 cancels.
    let inward = k1 * deepest.powf(n + 1.0) / (n + 1.0);
    let power = |d: f64| d.powf(n + 1.0) / (n + 1.0);
    let outward = k2 * (power(deepest) - power(least) - plastic.powf(n) * (deepest - least));
    let along = pull * least / (chi + 1.0);
    let lost = inward - outward + along;
    let (steps, mut work, mut history) = (200_000, 0.0, vec![0.0; law.memory()]);
    let geometry = |overlap: f64| Geometry {
        normal: [1.0, 0.0, 0.0],
        overlap,
        radii: [RADII[0], 0.0],
        curvature,
        mass: 1.0,
    };
    // Work by the trapezoidal rule, whose error is the square of a step, and near first touch its power 2.5.
    let ends = (-f0, -f0);
    let mut before = ends.0;
    for k in 1..=2 * steps {
        let part = if k <= steps { k } else { 2 * steps - k };
        let force = if part == 0 {
            ends.1
        } else {
            let g = geometry(deepest * f64::from(part) / f64::from(steps));
            law.contact(&g, &STILL, &STILL, &mut history, STEP).force[0]
        };
        let sign = if k <= steps { 1.0 } else { -1.0 };
        work += sign * 0.5 * (before + force) * deepest / f64::from(steps);
        before = force;
    }
    assert!((work / lost - 1.0).abs() < 1e-9, "{work} {lost}");
    // The stored energy at the deepest point is the work of unloading to δ_p, minus that of f_0.
    let g = geometry(deepest);
    let mut history = vec![0.0; law.memory()];
    law.contact(&g, &STILL, &STILL, &mut history, STEP);
    let held = k2 * (power(deepest) - power(plastic) - plastic.powf(n) * (deepest - plastic)) - f0 * deepest;
    let stored = law.stored(&g, &history);
    assert!(
        (stored.normal / held - 1.0).abs() < 1e-12
            && (stored.push / (k1 * deepest.powf(n) - f0) - 1.0).abs() < 1e-12
    );
}

#[test]
fn without_plasticity_it_is_hertz() {
    let law = smooth([0.0, 0.0, 5.0, 1.5, 1.5]);
    let hertz = model(material(E, 0.0, NU), Damping::None, Tangential::SMOOTH).law(Compat::Perigrain);
    let mut history = vec![0.0; law.memory()];
    for part in path() {
        let d = [(RADII[0] + RADII[1]) * (1.0 - part), 0.0, 0.0];
        let g = Geometry::of_spheres(d, RADII, [1.0; 2], 0.0).unwrap();
        let force = law.contact(&g, &STILL, &STILL, &mut history, STEP).force[0];
        let exact = hertz.contact(&g, &STILL, &STILL, &mut [], STEP).force[0];
        assert!((force / exact - 1.0).abs() < 1e-14);
    }
}

/// Two spinning spheres that meet and separate, or stay together; with every part that a contact can have.
fn impact(numbers: Numbers, damping: Damping, eta: f64) -> Duel {
    let sds = |stiffness, mu| Sds { stiffness, damping: 0.0, mu };
    let m = Model {
        rolling: Rolling::Sds(sds(200.0, 0.2)),
        twisting: Twisting::Sds(sds(0.01, 1e-4)),
        ..model(eepa(numbers, eta), damping, mindlin(0.5, 0.4))
    };
    let law = m.law(Compat::Perigrain);
    assert_eq!(law.memory(), 9);
    let balls = [
        Ball::new([-0.0045, 0.0, 0.0], [0.4, 0.1, 0.0], [20.0, -30.0, 40.0], RADII[0], 2500.0),
        Ball::new([0.0045, 0.001, 0.0005], [-0.4, 0.0, -0.1], [0.0, 15.0, -25.0], RADII[1], 4000.0),
    ];
    Duel::new(balls, law, 2e-7)
}

fn energy(duel: &Duel) -> f64 {
    let of = |b: &Ball| {
        b.mass * dot(b.motion.velocity, b.motion.velocity) + b.inertia() * dot(b.motion.spin, b.motion.spin)
    };
    0.5 * (of(&duel.balls[0]) + of(&duel.balls[1]))
}

#[test]
fn action_is_reaction_and_energy_only_falls_from_impact_to_impact() {
    for numbers in CASES {
        let mut duel = impact(numbers, Damping::Viscoelastic, 10.0);
        let (p, l, first) = (duel.momentum(), duel.angular_momentum(), energy(&duel));
        for _ in 0..5000 {
            duel.step();
        }
        let [p2, l2] = [duel.momentum(), duel.angular_momentum()];
        // Rounding errors of 5000 steps.
        assert!(length(sub(p2, p)) < 1e-12 * duel.balls[0].mass, "{numbers:?}");
        assert!(length(sub(l2, l)) < 1e-11 * length(l), "{numbers:?}");
        assert!(energy(&duel) < first, "{numbers:?}");
    }
    // Seen from the other side, a contact has the opposite force, to the bit, and its history is mirrored.
    let law = impact(CASES[0], Damping::Viscoelastic, 10.0).law;
    let d = [0.0088, 0.0003, -0.0002];
    let g = Geometry::of_spheres(d, RADII, [1.0, 2.0], 0.0).unwrap();
    let back = Geometry::of_spheres(scale(-1.0, d), [RADII[1], RADII[0]], [2.0, 1.0], 0.0).unwrap();
    let (a, b) = (Motion { velocity: [0.1, 0.2, 0.3], spin: [3.0, 1.0, 2.0] }, STILL);
    let (mut one, mut other) = (vec![0.0; 9], vec![0.0; 9]);
    let w = law.contact(&g, &a, &b, &mut one, STEP);
    let v = law.contact(&back, &b, &a, &mut other, STEP);
    assert_eq!(w.force, scale(-1.0, v.force));
    perigrain_world::contacts::mirror(&mut other);
    assert_eq!(one, other);
}

#[test]
fn friction_is_limited_by_force_and_adhesion_together() {
    // At the end of the adhesive branch no friction is left; halfway down the unloading branch it is μ (F +
    // f_0 + k_adh δ^χ).
    let numbers @ [_, f0, ..] = CASES[0];
    let law = model(eepa(numbers, 0.0), Damping::None, mindlin(0.0, 0.4)).law(Compat::Perigrain);
    let mut exact = Branches::new(numbers, RADII[0]);
    let mut history = vec![0.0; law.memory()];
    let slides = Motion { velocity: [0.0, 1e3, 0.0], spin: [0.0; 3] };
    let smallest = 0.4 * 2e-4;
    for overlap in [1e-4, 2e-4, 1.8e-4, smallest, 0.5 * smallest] {
        let geometry = Geometry {
            normal: [1.0, 0.0, 0.0],
            overlap,
            radii: [RADII[0], 0.0],
            curvature: RADII[0],
            mass: 1.0,
        };
        let w = law.contact(&geometry, &slides, &STILL, &mut history, STEP);
        let force = exact.force(overlap);
        let carried = force + f0 + exact.sticks * overlap.powf(numbers[4]);
        assert!((w.force[1] + 0.4 * carried).abs() < 1e-12 * (1.0 + carried), "{overlap}: {w:?} {carried}");
    }
}

#[test]
fn restitution_is_that_of_the_elastic_grains_and_falls_with_plasticity() {
    let e = |plasticity: f64, n: f64| {
        let normal = eepa([plasticity, 0.0, 0.0, n, 1.5], 0.7);
        let law = model(normal, Damping::CoeffRestitution, Tangential::SMOOTH).law(Compat::Perigrain);
        let ball = |x: f64, v: f64| Ball::new([x, 0.0, 0.0], [v, 0.0, 0.0], [0.0; 3], 0.005, 2500.0);
        let mut duel = Duel::new([ball(-0.005_000_05, 0.5), ball(0.005_000_05, -0.5)], law, 2e-7);
        while duel.overlap() <= 0.0 {
            duel.step();
        }
        while duel.overlap() > 0.0 {
            duel.step();
        }
        duel.balls[1].motion.velocity[0] / 0.5
    };
    // α = √(2 (n + 1)) β: exact for every power; the time step adds a few 1e-4.
    for n in [1.0, 1.25, 1.5, 2.0] {
        assert!((e(0.0, n) - 0.7).abs() < 2e-3, "{n}: {}", e(0.0, n));
    }
    assert!(e(0.5, 1.5) < 0.6 && e(0.8, 1.5) < e(0.5, 1.5));
}

#[test]
fn exponents_of_types_that_mix_are_the_same() {
    let of = |n| model(eepa([0.5, 0.0, 1.0, n, 1.5], 0.0), Damping::Velocity, Tangential::SMOOTH);
    assert_eq!(
        of(1.5).mixed(&of(1.0), Compat::Perigrain),
        Err(Unmixable("the exponent n", "the exponent n"))
    );
    assert!(of(1.5).mixed(&of(1.5), Compat::Perigrain).is_ok());
}
