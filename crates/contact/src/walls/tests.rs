//! Walls: lists, contacts, histories of springs, and loads on walls.

use super::*;
use crate::{
    Cdt, Cohesion, Damping, Epsd, Friction, Granular, Model, Normal, Pull, Rolling, Sds, Slip, Tangential,
    normal,
};
use perigrain_world::Compat;

fn law(mu: f64) -> Granular {
    let normal = Normal::new(&normal::HERTZ_MATERIAL, &[1e6, 0.0, 0.25]);
    let friction = Tangential::new(Friction::Mindlin, None, 0.0, mu);
    Model::new(normal, Damping::Velocity, friction).law(Compat::Perigrain)
}

/// Balls of radius 1 and mass 1 with these positions and velocities.
struct Scene {
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    omega: Vec<Vec3>,
    radius: Vec<f64>,
    tag: Vec<u32>,
}

impl Scene {
    fn new(x: &[Vec3], v: Vec3) -> Self {
        let n = x.len();
        Self {
            x: x.to_vec(),
            v: vec![v; n],
            omega: vec![[0.0; 3]; n],
            radius: vec![1.0; n],
            tag: (1..=n as u32).rev().collect(),
        }
    }

    fn grains(&self) -> Spheres<'_> {
        Spheres {
            x: &self.x,
            v: &self.v,
            omega: &self.omega,
            radius: &self.radius,
            mass: &self.radius,
            tag: &self.tag,
        }
    }
}

const STEP: Advance = Advance { dt: 1e-3, history: true };

fn floor() -> Planes {
    Planes { axis: 2, lo: Some(0.0), hi: None, velocity: [[0.0; 3]; 2], nearer: false }
}

/// All of them that belong to the group.
fn meeting(mask: &[u32], group: u32) -> Meeting<'_> {
    Meeting { mask, group, rows: std::slice::from_ref(&EVERY), kinds: None }
}

static EVERY: Range<usize> = 0..usize::MAX;

#[test]
fn only_what_is_near_is_listed_and_springs_last_while_they_touch() {
    let places = [[0.0, 0.0, 0.99], [5.0, 0.0, 1.1], [9.0, 0.0, 3.0]];
    let mut s = Scene::new(&places, [1.0, 0.0, 0.0]);
    let (mut sweep, mut memory) = (WallSweep::default(), Contacts::default());
    sweep.list(&floor(), &s.grains(), &meeting(&[1, 1, 1], 1), &law(0.5), 0.2);
    assert_eq!(sweep.listed(), 2);
    sweep.run(&floor(), &s.grains(), &law(0.5), &mut memory, STEP);
    assert_eq!(memory.keys, [[3, 0]]);
    assert!((memory.history[0] - 1e-3).abs() < 1e-15, "{:?}", memory.history);
    sweep.run(&floor(), &s.grains(), &law(0.5), &mut memory, STEP);
    assert!((memory.history[0] - 2e-3).abs() < 1e-15);
    s.x[0][2] = 1.01;
    sweep.run(&floor(), &s.grains(), &law(0.5), &mut memory, STEP);
    assert!(memory.is_empty());
    // There is none of another group.
    sweep.list(&floor(), &s.grains(), &meeting(&[1, 1, 1], 2), &law(0.5), 0.2);
    assert_eq!(sweep.listed(), 0);
}

#[test]
fn the_wall_feels_what_the_grain_does_not() {
    let s = Scene::new(&[[2.0, 0.0, 0.99]], [0.0, 1.0, 0.0]);
    let (mut sweep, mut memory) = (WallSweep::default(), Contacts::default());
    sweep.list(&floor(), &s.grains(), &meeting(&[1], 1), &law(0.5), 0.2);
    sweep.run(&floor(), &s.grains(), &law(0.5), &mut memory, STEP);
    let (mut f, mut torque) = ([[0.0; 3]], [[0.0; 3]]);
    let felt = sweep.scatter(&mut f, &mut torque, &s.x, [0.0; 3]);
    // Hertz by hand: 4/3 E* √R δ^1.5 with E* = E / (2 (1 − ν²)).
    let push = 4.0 / 3.0 * (1e6 / 1.875) * 0.01f64.powf(1.5);
    assert!((f[0][2] - push).abs() < 1e-9 * push);
    assert!((0..3).all(|d| felt[d] == -f[0][d]));
    // Angular momentum: the torques of grain and wall about the origin cancel.
    let total = add(add(torque[0], cross(s.x[0], f[0])), [felt[3], felt[4], felt[5]]);
    assert!(length(total) < 1e-12 * push, "{total:?}");
}

fn length(a: Vec3) -> f64 {
    perigrain_base::math::vec3::length(a)
}

#[test]
fn two_planes_act_together_unless_lammps_is_meant() {
    let narrow = Planes { hi: Some(1.9), ..floor() };
    let near = |wall: &Planes, z: f64| {
        let mut out = vec![];
        wall.near([0.0, 0.0, z], 1.0, &mut out);
        out.iter().map(|n| (n.part, n.normal[2])).collect::<Vec<_>>()
    };
    assert_eq!(near(&narrow, 0.94), [(0, 1.0), (1, -1.0)]);
    let lammps = Planes { nearer: true, ..narrow };
    assert_eq!(near(&lammps, 0.94), [(0, 1.0)]);
    assert_eq!(near(&lammps, 0.96), [(1, -1.0)]);
}

#[test]
fn a_tube_is_hollow_inside_and_turns() {
    let tube = Tube { radius: 5.0, velocity: [0.0, 0.0, 2.0], spin: 3.0, lammps: false };
    let mut out = vec![];
    tube.near([0.0, 4.5, 7.0], 1.0, &mut out);
    let n = out[0];
    assert_eq!((n.normal, n.distance, n.radius), ([-0.0, -1.0, -0.0], 0.5, -10.0));
    // Clockwise seen from above: at +y the surface goes to +x.
    assert_eq!(n.velocity, [3.0, 0.0, 2.0]);
    out.clear();
    tube.near([0.0, -5.5, 7.0], 1.0, &mut out);
    assert_eq!((out[0].normal[1], out[0].radius), (-1.0, 10.0));
    // For a grain too large for the tube the wall counts as flat.
    assert_eq!(effective(3.0, -2.0), 3.0);
    assert!((effective(1.0, -2.0) - 2.0).abs() < 1e-15);
}

// LIGGGHTS 3.8.0: the coordinates of the centre of a cylinder about y are z, x; shear turns it at the grain's distance.
#[test]
fn a_cylinder_off_the_axis_turns_at_the_grains_distance() {
    let wall = Cylinder { axis: 1, center: [2.0, 1.0], radius: 5.0, velocity: [0.0; 3], omega: 3.0 };
    let mut out = vec![];
    wall.near([1.0, 7.0, 6.5], 1.0, &mut out);
    assert_eq!((out[0].normal, out[0].distance, out[0].radius), ([-0.0, 0.0, -1.0], 0.5, 0.0));
    // About +y a point at +z goes to +x, at the distance of the centre, 4.5.
    assert_eq!(out[0].velocity, [13.5, 0.0, 0.0]);
    out.clear();
    wall.near([6.5, 0.0, 2.0], 1.0, &mut out);
    assert_eq!((out[0].normal[0], out[0].velocity[2]), (1.0, -16.5));
    out.clear();
    let shifted = Shifted { wall: &wall, shift: [0.0, 0.0, 0.25], velocity: [0.0, 1.0, 0.0] };
    shifted.near([1.0, 7.0, 6.75], 1.0, &mut out);
    assert_eq!((out[0].distance, out[0].velocity), (0.5, [13.5, 1.0, 0.0]));
}

#[test]
fn contacts_several_at_a_time_are_contacts_one_by_one() {
    let tube = Tube { radius: 6.0, velocity: [0.3, 0.0, 2.0], spin: 3.0, lammps: false };
    // Around the tube, deeper and deeper, spinning; a full group of eight, and some more.
    let at = |k: usize| (0.5 * k as f64).sin_cos();
    let places: Vec<Vec3> = (0..13).map(|k| [at(k).0 * 5.05, at(k).1 * 5.05, 0.1 * k as f64]).collect();
    let mut s = Scene::new(&places, [0.2, -0.7, 0.1]);
    (0..13).for_each(|k| s.omega[k] = [0.1 * k as f64, 1.0, -0.5]);
    (0..13).for_each(|k| s.radius[k] = 1.0 + 0.003 * k as f64);
    let jkr = Normal::new(&normal::JKR, &[1e6, 0.1, 0.25, 20.0]);
    let soft = Normal::new(&normal::HERTZ_MATERIAL, &[1e6, 0.3, 0.25]);
    let hooke = Normal::new(&normal::HOOKE, &[1e5, 20.0]);
    let springs = Tangential::new(Friction::Mindlin, None, 1.0, 0.5);
    let linear = Tangential::new(Friction::LinearHistory, Some(1e4), 1.0, 0.5);
    let sds = Rolling::Sds(Sds { stiffness: 1e3, damping: 0.1, mu: 0.2 });
    let epsd = Rolling::Epsd(Epsd { mu: 0.2, eta: 0.3, factor: 2.25, full: true });
    let cdt = Rolling::Cdt(Cdt { mu: 0.2, full: false });
    let slips = Tangential { slip: Slip::Spring, ..springs };
    let pull = Pull { density: 1e5, reduces: true };
    for (normal, damping, friction, rolling, cohesion) in [
        (soft, Damping::Tsuji, springs, sds, Cohesion::None),
        (jkr, Damping::Viscoelastic, springs, sds, Cohesion::None),
        (hooke, Damping::Velocity, linear, sds, Cohesion::None),
        (soft, Damping::CoeffRestitution, slips, epsd, Cohesion::Sjkr(pull)),
        (soft, Damping::CoeffRestitution, slips, cdt, Cohesion::Sjkr2(pull)),
    ] {
        let model = Model { rolling, cohesion, ..Model::new(normal, damping, friction) };
        let law = model.law(Compat::Perigrain);
        let grains = s.grains();
        let (mut sweep, mut memory) = (WallSweep::default(), Contacts::default());
        sweep.list(&tube, &grains, &meeting(&[1; 13], 1), &law, 0.5);
        let mut alone = None;
        for _ in 0..3 {
            sweep.run(&tube, &grains, &law, &mut memory, STEP);
            let width = law.memory();
            let history = alone.get_or_insert_with(|| vec![0.0; 13 * width]);
            assert_eq!(sweep.touching.len(), 13);
            for (k, (touch, wrench)) in sweep.contacts().enumerate() {
                let i = touch.grain as usize;
                let own = Motion { velocity: s.v[i], spin: s.omega[i] };
                let wall = Motion { velocity: touch.near.velocity, spin: [0.0; 3] };
                let g = geometry(&touch.near, s.radius[i], s.radius[i]);
                let expected =
                    law.on_wall().contact(&g, &own, &wall, &mut history[k * width..][..width], STEP);
                assert_eq!(*wrench, expected, "{k}");
            }
            assert_eq!(memory.history, *history);
        }
    }
}
