//! Averaging, curvature, momentum and thread counts of the contact loop.

use super::*;
use crate::{Damping, Friction, Granular, Model, Normal, Tangential, normal};
use perigrain_neigh::list::{Reach, View, Wanted, pairs};
use perigrain_world::Compat;
use perigrain_world::domain::Flow;

struct Scene {
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    omega: Vec<Vec3>,
    radius: Vec<f64>,
    mass: Vec<f64>,
    kind: Vec<u16>,
    tag: Vec<u32>,
    body: Vec<u32>,
}

/// A grain (type 2, radius 1) pressed into a flat solid of 5 × 5 small spheres (type 1), with many contacts.
fn scene() -> Scene {
    let mut x: Vec<Vec3> = vec![];
    for k in 0..25 {
        x.push([f64::from(k % 5) * 0.2 - 0.4, f64::from(k / 5) * 0.2 - 0.4, 0.0]);
    }
    x.push([0.03, 0.02, 1.02]);
    let n = x.len();
    let mut s = Scene {
        v: vec![[0.0; 3]; n],
        omega: vec![[0.0; 3]; n],
        radius: vec![0.1; n],
        mass: vec![0.01; n],
        kind: vec![1; n],
        tag: (1..=n as u32).collect(),
        body: vec![0; n],
        x,
    };
    (s.radius[25], s.mass[25], s.kind[25], s.body[25]) = (1.0, 2.0, 2, NO_BODY);
    (s.v[25], s.omega[25]) = ([0.3, 0.0, -1.0], [0.0, 2.0, 1.0]);
    s
}

fn law() -> Granular {
    let normal = Normal::new(&normal::HERTZ_MATERIAL, &[1e6, 0.8, 0.25]);
    let friction = Tangential::new(Friction::Mindlin, None, 0.5, 0.3);
    Model::new(normal, Damping::Tsuji, friction).law(Compat::Perigrain)
}

/// Forces and torques after one evaluation, and the number of contacts.
fn evaluate(s: &Scene, average: Average, curvature: Curvature) -> (Vec<Vec3>, Vec<Vec3>, usize) {
    let mut wanted = Wanted::new(2);
    let mut rules = Rules::new(2);
    for (a, b) in [(1, 2), (2, 2)] {
        wanted.set(a, b, Reach::Touch);
        rules.set(a, b, Rule { law: law(), average, curvature });
    }
    let period = perigrain_base::math::periods::Periods::default();
    let view = View { x: &s.x, tag: &s.tag, kind: &s.kind, radius: &s.radius, period };
    let list = pairs(&view, &wanted, 0.1, &|_, _| true);
    let grains = Grains {
        x: &s.x,
        v: &s.v,
        omega: &s.omega,
        radius: &s.radius,
        mass: &s.mass,
        kind: &s.kind,
        tag: &s.tag,
        flow: None,
        period,
        body: &s.body,
        frozen: &[],
        travel: Default::default(),
    };
    let mut sweep = Sweep::default();
    let mut memory = Contacts::default();
    sweep.run(&list, &grains, &rules, &mut memory, Advance { dt: 1e-5, history: true });
    assert_eq!(memory.len(), sweep.len());
    let (mut f, mut torque) = (vec![[0.0; 3]; s.x.len()], vec![[0.0; 3]; s.x.len()]);
    sweep.scatter(&mut f, &mut torque);
    (f, torque, sweep.len())
}

#[test]
fn shared_forces_conserve_momentum() {
    let s = scene();
    let (plain, plain_torque, n) = evaluate(&s, Average::None, Curvature::Both);
    assert!(n > 5);
    for average in [Average::Particle, Average::Body] {
        let (f, torque, same) = evaluate(&s, average, Curvature::Both);
        assert_eq!(same, n);
        // The grain has n contacts, each small particle one: N = n in both modes.
        for d in 0..3 {
            assert!((f[25][d] * n as f64 - plain[25][d]).abs() < 1e-12 * plain[25][2].abs());
            assert!((torque[25][d] * n as f64 - plain_torque[25][d]).abs() < 1e-12 * plain[25][2].abs());
            let total: f64 = f.iter().map(|f| f[d]).sum();
            assert!(total.abs() < 1e-14 * plain[25][2].abs());
        }
    }
}

#[test]
fn bodies_share_apart() {
    // Two solids under one grain: each divides among its own contacts.
    let mut s = scene();
    let (plain, _, n) = evaluate(&s, Average::None, Curvature::Both);
    for k in 0..25 {
        s.body[k] = u32::from(k >= 10);
    }
    let touched = |k: usize| plain[k] != [0.0; 3];
    let first = (0..10).filter(|k| touched(*k)).count();
    assert!(first > 0 && first < n);
    let (f, ..) = evaluate(&s, Average::Body, Curvature::Both);
    for k in (0..25).filter(|k| touched(*k)) {
        let share = if k < 10 { first } else { n - first };
        assert!((f[k][2] * share as f64 / plain[k][2] - 1.0).abs() < 1e-14);
    }
}

#[test]
fn a_flat_solid_makes_contacts_stiffer() {
    // Smooth and elastic at rest: F ∝ √R̄, with R̄ = R compared with R r/(R + r) = R/11.
    let mut s = scene();
    (s.v[25], s.omega[25]) = ([0.0; 3], [0.0; 3]);
    let (both, ..) = evaluate(&s, Average::None, Curvature::Both);
    let (flat, ..) = evaluate(&s, Average::None, Curvature::Impactor);
    assert!((flat[25][2] / both[25][2] / 11.0_f64.sqrt() - 1.0).abs() < 1e-12);
    // Two grains: neither is flat.
    s.body.fill(NO_BODY);
    let (grains, ..) = evaluate(&s, Average::None, Curvature::Impactor);
    assert_eq!(grains, both);
}

#[test]
fn the_same_bits_for_any_number_of_threads() {
    let s = scene();
    let one = evaluate(&s, Average::Body, Curvature::Impactor);
    perigrain_base::par::set_threads(2);
    let two = evaluate(&s, Average::Body, Curvature::Impactor);
    perigrain_base::par::set_threads(1);
    assert_eq!(one, two);
}

/// Histories and results of the contacts in a row of grains, evaluated several at a time or one by one.
fn row(law: &Granular, flowing: bool, alone: bool) -> (Vec<f64>, Vec<Wrench>) {
    let n = 21;
    let vector = |k: u32| [0.618, 0.755, 0.329].map(|a| (f64::from(k) * a).fract() - 0.5);
    let x: Vec<Vec3> = (0..n).map(|k| [1.95 * f64::from(k), 0.0, 0.0]).collect();
    let (v, omega): (Vec<Vec3>, Vec<Vec3>) = (0..n).map(|k| (vector(k), vector(k + n))).unzip();
    let (radius, mass) = (vec![1.0; n as usize], vec![2.0; n as usize]);
    let (kind, mask, tag): (Vec<u16>, Vec<u32>, Vec<u32>) =
        (vec![1; n as usize], vec![1; n as usize], (1..=n).collect());
    let flow = Flow { group: perigrain_world::GroupId::ALL, rate: [0.1, 0.0, 0.0], tilt: [0.0; 3] };
    let grains = Grains {
        x: &x,
        v: &v,
        omega: &omega,
        radius: &radius,
        mass: &mass,
        kind: &kind,
        tag: &tag,
        period: Default::default(),
        flow: flowing.then_some((flow, &mask[..])),
        body: &[],
        frozen: &[],
        travel: Default::default(),
    };
    let mut rules = Rules::new(1);
    rules.set(1, 1, Rule { law: *law, average: Average::None, curvature: Curvature::Both });
    let list: Vec<Pair> = (1..n).map(|j| Pair { i: j - 1, j, shift: [0; 3] }).collect();
    let (mut history, mut wrenches) = (vec![], vec![]);
    for part in list.chunks(if alone { 1 } else { list.len() }) {
        let (mut sweep, mut memory) = (Sweep::default(), Contacts::default());
        let step = Advance { dt: 0.01, history: true };
        (0..5).for_each(|_| sweep.run(part, &grains, &rules, &mut memory, step));
        history.append(&mut memory.history);
        wrenches.append(&mut sweep.wrenches);
    }
    (history, wrenches)
}

#[test]
fn contacts_together_have_the_bits_of_single_ones() {
    let normal = Normal::new(&normal::HERTZ_MATERIAL, &[1e3, 0.8, 0.25]);
    let plain = Tangential::new(Friction::LinearNohistory, Some(0.0), 0.5, 0.3);
    let spring = Tangential::new(Friction::Mindlin, None, 0.5, 0.3);
    let slider = crate::Sds { stiffness: 10.0, damping: 1.0, mu: 0.2 };
    let (rolling, twisting) = (crate::Rolling::Sds(slider), crate::Twisting::Sds(slider));
    let model = |friction| Model::new(normal, Damping::Tsuji, friction);
    let turning = Model { rolling, ..model(spring) };
    let slips = Tangential { slip: crate::Slip::Spring, ..spring };
    let rolling = crate::Rolling::Epsd(crate::Epsd { mu: 0.1, eta: 0.3, factor: 2.25, full: false });
    let cohesion = crate::Cohesion::Sjkr(crate::Pull { density: 3.0, reduces: true });
    let torque = Model { rolling, cohesion, ..model(slips) };
    let yields = Normal::new(&normal::HOOKE_HYSTERESIS, &[1e3, 0.8, 0.25, 0.5, 2.0, 0.2, 0.05]);
    let yields = Model::new(yields, Damping::CoeffRestitution, plain);
    let models = [model(plain), model(spring), turning, Model { twisting, ..turning }, torque, yields];
    for (law, memory) in models.map(|m| m.law(Compat::Perigrain)).iter().zip([0, 3, 6, 7, 6, 4]) {
        assert_eq!(law.memory(), memory);
        for flowing in [false, true] {
            let together = row(law, flowing, false);
            assert_eq!((together.0.len(), together.1.len()), (20 * memory, 20));
            assert_eq!(together, row(law, flowing, true), "{memory} {flowing}");
        }
    }
}
