//! The fast loop compared with the plain driver on dense packings that move, are rebuilt and have several
//! laws.
#![allow(clippy::unwrap_used)] // a test fails by panicking

#[path = "fast/ranks.rs"]
mod ranks;

use perigrain_base::math::form::Form;
use perigrain_base::math::periods::Periods;
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;
use perigrain_contact::driver::{Average, Curvature, Grains, Rule, Rules, Sweep};
use perigrain_contact::fast::{Fast, Frame, Laws, Sums};
use perigrain_contact::{
    Advance, Area, Cdt, Classic, Cohesion, Damping, Drag, Epsd, Friction, Granular, Heat, Model, Normal,
    Pull, Rolling, Sds, Slip, Tangential, Twisting, normal,
};
use perigrain_neigh::list::{Reach, View, Wanted, pairs};
use perigrain_world::contacts::Contacts;
use perigrain_world::domain::Flow;
use perigrain_world::{Compat, GroupId, Travel};

#[derive(Clone)]
struct Scene {
    x: Vec<Vec3>,
    v: Vec<Vec3>,
    omega: Vec<Vec3>,
    radius: Vec<f64>,
    mass: Vec<f64>,
    kind: Vec<u16>,
    tag: Vec<u32>,
    frozen: Vec<bool>,
    period: Periods,
    /// Velocity gradient of the box, and the group whose images move with it.
    flow: Option<Flow>,
    mask: Vec<u32>,
}

const SKIN: f64 = 0.2;
const DT: f64 = 2e-3;

/// A disturbed lattice of overlapping grains of two types and many sizes, in no particular order of tags;
/// slabs have many more contacts than fit one batch.
fn scene(period: [f64; 3]) -> Scene {
    let mut random = ParkMiller::new(4711);
    let mut any = |lo: f64, hi: f64| lo + (hi - lo) * random.uniform();
    let mut x = vec![];
    for k in 0..11 * 10 * 12 {
        let site = [k % 11, k / 11 % 10, k / 110].map(|c| f64::from(c) * 0.95 + 0.4);
        x.push(site.map(|a| a + any(-0.1, 0.1)));
    }
    let n = x.len();
    let vector = |_: usize| std::array::from_fn(|_| any(-1.0, 1.0));
    let v: Vec<Vec3> = (0..n).map(vector).collect();
    let mut any = |lo: f64, hi: f64| lo + (hi - lo) * random.uniform();
    Scene {
        omega: v.iter().map(|v| [v[1], v[2], v[0]]).collect(),
        radius: (0..n).map(|_| any(0.35, 0.6)).collect(),
        mass: (0..n).map(|_| any(0.5, 2.0)).collect(),
        kind: (0..n).map(|k| 1 + u16::from(k % 3 == 0)).collect(),
        tag: (0..n as u32).map(|k| (k * 7) % n as u32 + 1).collect(),
        frozen: (0..n).map(|k| k % 11 == 0).collect(),
        mask: (0..n as u32).map(|k| k % 4).collect(),
        flow: None,
        period: Periods::upright(period),
        v,
        x,
    }
}

/// The same in a tilted box, with increasing tilt if it deforms: images slide along its faces.
fn sheared(length: [f64; 3]) -> Scene {
    let mut s = scene(length);
    let tilt = if length[2] > 0.0 { [3.0, -2.0, 4.0] } else { [3.0, 0.0, 0.0] };
    s.period.tilt = tilt;
    for x in &mut s.x {
        let part = |d: usize| if length[d] > 0.0 { x[d] / length[d] } else { 0.0 };
        let lean = s.period.shift([0.0, part(1), part(2)]);
        *x = [x[0] + lean[0], x[1] + part(2) * tilt[2], x[2]];
    }
    let rate = [0.0, 0.1, 0.0];
    s.flow = Some(Flow { rate, tilt: tilt.map(|t| if t == 0.0 { 0.0 } else { 2.0 }), group: GroupId(1) });
    s
}

/// The same with some grains four to seven times as large as the smallest, without others inside them.
fn bidisperse(period: [f64; 3]) -> Scene {
    let mut s = scene(period);
    let large = [13, 350, 401, 888, 1200];
    for (k, i) in large.into_iter().enumerate() {
        (s.radius[i], s.mass[i], s.frozen[i]) = (1.5 + 0.2 * k as f64, 30.0, false);
    }
    let free = |i: &usize| {
        large.iter().all(|l| {
            let d = (0..3).map(|d| {
                let d1 = s.x[*i][d] - s.x[*l][d];
                if period[d] > 0.0 { d1 - period[d] * (d1 / period[d]).round() } else { d1 }
            });
            i == l || d.map(|d| d * d).sum::<f64>().sqrt() > 0.97 * (s.radius[*i] + s.radius[*l])
        })
    };
    let kept: Vec<usize> = (0..s.x.len()).filter(free).collect();
    assert!(kept.len() > 700 && large.iter().filter(|l| kept.contains(l)).count() >= 3);
    let [x, v, omega] = [&s.x, &s.v, &s.omega].map(|c| kept.iter().map(|&i| c[i]).collect());
    let [radius, mass] = [&s.radius, &s.mass].map(|c| kept.iter().map(|&i| c[i]).collect());
    let (kind, tag) = (kept.iter().map(|&i| s.kind[i]).collect(), kept.iter().map(|&i| s.tag[i]).collect());
    let frozen = kept.iter().map(|&i| s.frozen[i]).collect();
    let mask = kept.iter().map(|&i| s.mask[i]).collect();
    Scene { x, v, omega, radius, mass, kind, tag, frozen, mask, ..s }
}

/// The law of two types: there are three, one of them with the largest history.
fn between(a: u16, b: u16) -> Granular {
    let stiffness = 200.0 * f64::from(a + b);
    let normal = Normal::new(&normal::HERTZ, &[stiffness, 3.0]);
    let friction = |kind| Tangential::new(kind, Some(stiffness), 0.4, 0.1 * f64::from(a + b));
    let sds = |stiffness| Sds { stiffness, damping: 0.3, mu: 0.2 };
    let mindlin = Model::new(normal, Damping::Viscoelastic, friction(Friction::Mindlin));
    let model = match a + b {
        2 => mindlin,
        3 => {
            let (stiffness, gamma) = ([stiffness; 2], [4.0, 1.0]);
            Model::classic(
                false,
                true,
                &Classic {
                    stiffness,
                    gamma,
                    mu: 0.5,
                    limit_damping: true,
                    arm: perigrain_contact::Arm::Radius,
                },
            )
        }
        _ => Model { rolling: Rolling::Sds(sds(50.0)), twisting: Twisting::Sds(sds(5.0)), ..mindlin },
    };
    Model { heat: Heat::Radius(f64::from(a + b)), ..model }.law(Compat::Perigrain)
}

/// The same where grains of type 1 stick to each other and to those of type 2.
fn sticky(a: u16, b: u16) -> Granular {
    if a + b == 4 {
        return between(a, b);
    }
    // Grains of radius 0.5 stick across 0.026 with these parameters, an eighth of the skin.
    let normal = Normal::new(&normal::JKR, &[150.0 * f64::from(a + b), 0.5, 0.3, 1.0]);
    let friction = Tangential::new(Friction::Mindlin, Some(300.0), 0.4, 0.2);
    let model = Model::new(normal, Damping::Viscoelastic, friction);
    Model { heat: Heat::Area(0.7), ..model }.law(Compat::Perigrain)
}

/// The same where grains of type 1 are plastic and cohesive among themselves and with those of type 2, with
/// the largest history.
fn plastic(a: u16, b: u16) -> Granular {
    if a + b == 4 {
        return between(a, b);
    }
    let numbers = [200.0 * f64::from(a + b), 0.5, 0.3, 0.6, 0.2, 1.0, 1.5, f64::from(a + b) / 2.0];
    let friction = Tangential::new(Friction::MindlinRescale, Some(300.0), 0.4, 0.2);
    let sds = |stiffness| Sds { stiffness, damping: 0.3, mu: 0.2 };
    let model = Model::new(Normal::new(&normal::EEPA, &numbers), Damping::Viscoelastic, friction);
    let turning = Model { rolling: Rolling::Sds(sds(50.0)), twisting: Twisting::Sds(sds(5.0)), ..model };
    let law = if a == b { turning } else { model };
    Model { heat: Heat::Radius(0.7), ..law }.law(Compat::Perigrain)
}

/// The same where torques against rolling and cohesion act among grains of type 1, and others yield.
fn turning(a: u16, b: u16) -> Granular {
    if a + b == 4 {
        return between(a, b);
    }
    let heat = Heat::Contact { conductivity: 0.7, area: Area::Overlap(1.0) };
    let young = 300.0 * f64::from(a + b);
    let cohesion = Cohesion::Sjkr(Pull { density: 2.0, reduces: false });
    let friction = |kind, stiffness| Tangential {
        drag: Drag::Matched,
        slip: Slip::Spring,
        ..Tangential::new(kind, stiffness, 0.0, 0.2)
    };
    let law = if a == b {
        let normal = Normal::new(&normal::HERTZ_MATERIAL, &[young, 0.7, 0.3]);
        let rolling = Rolling::Epsd(Epsd { mu: 0.2, eta: 0.1, factor: 2.25, full: true });
        let friction = friction(Friction::Mindlin, None);
        Model { rolling, cohesion, ..Model::new(normal, Damping::CoeffRestitution, friction) }
    } else {
        let normal = Normal::new(&normal::HOOKE_HYSTERESIS, &[young, 0.7, 0.3, 0.5, 2.0, 0.2, 0.05]);
        let rolling = Rolling::Cdt(Cdt { mu: 0.2, full: false });
        let friction = Tangential { of_normal: true, ..friction(Friction::LinearHistory, Some(0.3)) };
        Model { rolling, ..Model::new(normal, Damping::CoeffRestitution, friction) }
    };
    Model { heat, ..law }.law(Compat::Perigrain)
}

/// A table of laws by types.
type Table = fn(u16, u16) -> Granular;

impl Scene {
    fn grains(&self) -> Grains<'_> {
        let Self { x, v, omega, radius, mass, kind, tag, frozen, period, flow, mask } = self;
        let travel = Travel::default();
        Grains {
            x,
            v,
            omega,
            radius,
            mass,
            kind,
            tag,
            period: *period,
            flow: flow.map(|flow| (flow, &mask[..])),
            body: &[],
            frozen,
            travel,
        }
    }

    /// Half of the pairs of type 2 are excluded, and pairs of two frozen grains, which have no reduced mass.
    fn keep(&self, i: usize, j: usize) -> bool {
        if self.frozen[i] && self.frozen[j] {
            return false;
        }
        self.kind[i] != 2 || self.kind[j] != 2 || (self.tag[i] + self.tag[j]).is_multiple_of(2)
    }

    fn advance(&mut self, f: &[Vec3], torque: &[Vec3]) {
        for i in 0..self.x.len() {
            for d in 0..3 {
                self.v[i][d] += DT * f[i][d] / self.mass[i];
                self.omega[i][d] += DT * torque[i][d] / (0.4 * self.mass[i] * self.radius[i].powi(2));
                self.x[i][d] += DT * self.v[i][d];
            }
        }
        if let Some(flow) = self.flow {
            (0..3).for_each(|d| self.period.length[d] += DT * flow.rate[d]);
            (0..3).for_each(|d| self.period.tilt[d] += DT * flow.tilt[d]);
        }
    }

    /// Whether two do not touch.
    fn apart(&self, p: &perigrain_neigh::list::Pair) -> bool {
        let d = perigrain_neigh::list::difference(&self.x, &self.period, p);
        perigrain_base::math::vec3::length(d) >= self.radius[p.i as usize] + self.radius[p.j as usize]
    }

    fn wrap(&mut self) {
        for x in &mut self.x {
            let (length, at) = (self.period.length, self.period.straightened(*x, [0.0; 3]));
            let turns = |d: usize| if length[d] > 0.0 { (at[d] / length[d]).floor() } else { 0.0 };
            let by = self.period.shift([0, 1, 2].map(turns));
            (0..3).for_each(|d| x[d] -= by[d]);
        }
    }

    fn temperatures(&self) -> Vec<f64> {
        self.tag.iter().map(|t| f64::from(t % 17)).collect()
    }

    fn zeros(&self) -> Vec<Vec3> {
        vec![[0.0; 3]; self.x.len()]
    }
}

/// Results of a step.
#[derive(Debug, PartialEq)]
struct Got {
    f: Vec<Vec3>,
    torque: Vec<Vec3>,
    heat: Vec<f64>,
    contacts: Contacts,
    virial: [f64; 6],
}

/// Some steps, with lists remade every seventh.
trait Loop {
    fn step(&mut self, s: &Scene, k: usize) -> Got;
}

struct PlainLoop {
    law: Table,
    list: Vec<perigrain_neigh::list::Pair>,
    sweep: Sweep,
    memory: Contacts,
}

impl Loop for PlainLoop {
    fn step(&mut self, s: &Scene, k: usize) -> Got {
        let (mut wanted, mut rules) = (Wanted::new(2), Rules::new(2));
        for (a, b) in [(1, 1), (1, 2), (2, 2)] {
            wanted.set(a, b, Reach::Beyond((self.law)(a, b).gap(0.3)));
            let (average, curvature) = (Average::None, Curvature::Both);
            rules.set(a, b, Rule { law: (self.law)(a, b), average, curvature });
        }
        if k.is_multiple_of(7) {
            let view = View { x: &s.x, tag: &s.tag, kind: &s.kind, radius: &s.radius, period: s.period };
            self.list = pairs(&view, &wanted, SKIN, &|i, j| s.keep(i, j));
        }
        self.sweep.run(&self.list, &s.grains(), &rules, &mut self.memory, Advance { dt: DT, history: true });
        let (mut f, mut torque) = (s.zeros(), s.zeros());
        self.sweep.scatter(&mut f, &mut torque);
        let (mut heat, virial) = (vec![0.0; s.x.len()], self.sweep.virial(&s.x, &s.period));
        self.sweep.conduct(&s.temperatures(), &mut heat);
        Got { f, torque, heat, contacts: self.memory.clone(), virial }
    }
}

struct FastLoop {
    fast: Fast,
    /// Whether contacts are passed through the world at every rebuild.
    through_world: bool,
    /// Whether grains are looked up one by one even if they are equal.
    one_by_one: bool,
}

impl FastLoop {
    fn new(through_world: bool, law: Table) -> Self {
        let fast = Fast::new(Laws::new(2, |a, b| Some(law(a, b))).unwrap());
        Self { fast, through_world, one_by_one: false }
    }
}

impl Loop for FastLoop {
    fn step(&mut self, s: &Scene, k: usize) -> Got {
        if k.is_multiple_of(7) {
            let known = self.through_world.then(|| self.fast.contacts());
            if self.through_world {
                self.fast.clear();
            }
            let frame = Frame { lo: [0.0; 3], period: s.period, reach: SKIN, skin: SKIN };
            self.fast.rebuild(&s.grains(), &frame, |_, _| known, None, &|i, j| s.keep(i, j));
            self.fast.weigh(&s.grains());
            if self.one_by_one {
                self.fast.one_by_one();
            }
        }
        let step = Advance { dt: DT, history: true };
        // An evaluation that stores nothing changes nothing.
        let (mut f, mut torque) = (s.zeros(), s.zeros());
        self.fast.run(
            &s.grains(),
            Sums { force: &mut f, torque: &mut torque, heat: None, deeds: None },
            step,
            false,
            false,
        );
        let (mut f, mut torque) = (s.zeros(), s.zeros());
        let (temperatures, mut heat) = (s.temperatures(), vec![0.0; s.x.len()]);
        let flow = Some((&temperatures[..], &mut heat[..]));
        let sums = Sums { force: &mut f, torque: &mut torque, heat: flow, deeds: None };
        let virial = self.fast.run(&s.grains(), sums, step, true, true);
        Got { f, torque, heat, contacts: self.fast.contacts(), virial }
    }
}

const PERIODS: [[f64; 3]; 3] = [[0.0; 3], [10.45, 9.5, 0.0], [10.45, 9.5, 11.4]];

#[test]
fn the_numbers_of_the_plain_driver() {
    let scenes = PERIODS
        .into_iter()
        .flat_map(|p| [between as Table, sticky, plastic, turning].map(|law| (scene(p), law)));
    // Large grains reach farther: only boxes that are not periodic or wide enough.
    let large = [bidisperse(PERIODS[0]), bidisperse([10.45, 0.0, 0.0])].map(|s| (s, between as Table));
    let leaning = PERIODS[1..].iter().map(|p| (sheared(*p), between as Table));
    for (mut s, law) in scenes.chain(large).chain(leaning) {
        let mut plain = PlainLoop { law, list: vec![], sweep: Sweep::default(), memory: Contacts::default() };
        let mut fast = FastLoop::new(false, law);
        let mut beyond = 0;
        let mut ended = 0;
        for k in 0..40 {
            if k % 7 == 0 {
                s.wrap();
            }
            let Got { f, torque, heat, contacts, virial } = plain.step(&s, k);
            let other = fast.step(&s, k);
            let (f2, torque2, contacts2, virial2) = (other.f, other.torque, other.contacts, other.virial);
            assert_eq!(contacts.keys, contacts2.keys);
            // One contact has the same bits in both loops; sums of a dozen forces of size 100 differ by their
            // order. Differences grow with the steps, by collisions, hence the tolerance.
            let near = |a: f64, b: f64| (a - b).abs() < 1e-9 * (1.0 + a.abs());
            let same = |a: &[Vec3], b: &[Vec3]| {
                a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| near(*a, *b))
            };
            assert!(same(&f, &f2) && same(&torque, &torque2), "step {k}");
            assert!(heat.iter().zip(&other.heat).all(|(a, b)| near(*a, *b)), "step {k}");
            assert!(heat.iter().filter(|q| **q != 0.0).count() > 700);
            assert!(contacts.history.iter().zip(&contacts2.history).all(|(a, b)| near(*a, *b)));
            assert!(virial.iter().zip(&virial2).all(|(a, b)| (a - b).abs() < 1e-8 * (1.0 + virial[0].abs())));
            ended += usize::from(k > 0 && !contacts.is_empty());
            beyond += plain.sweep.contacts().filter(|(p, _)| s.apart(p)).count();
            s.advance(&f, &torque);
        }
        assert_eq!(ended, 39);
        assert_eq!(beyond > 1000, law(1, 1).gap(0.25) > 0.0, "{beyond} contacts beyond touch");
    }
}

#[test]
fn the_same_bits_for_threads_and_across_the_world() {
    let dense = [sticky as Table, plastic, turning].map(|law| (scene(PERIODS[2]), law));
    let leaning = [(sheared(PERIODS[2]), between as Table)];
    for (first, law) in
        dense.into_iter().chain(leaning).chain([(bidisperse([10.45, 0.0, 0.0]), between as Table)])
    {
        same_bits(&first, law);
    }
}

fn same_bits(first: &Scene, law: Table) {
    let run = |through_world: bool, threads: usize| {
        par::set_threads(threads);
        let (mut s, mut fast) = (first.clone(), FastLoop::new(through_world, law));
        let mut heat = vec![];
        for k in 0..30 {
            if k % 7 == 0 {
                s.wrap();
            }
            let got = fast.step(&s, k);
            s.advance(&got.f, &got.torque);
            heat = got.heat;
        }
        par::set_threads(1);
        (s.x, s.omega, fast.fast.contacts(), heat)
    };
    let one = run(false, 1);
    assert!(one.2.len() > 300);
    assert_eq!(one, run(false, 2));
    assert_eq!(one, run(false, 7));
    assert_eq!(one, run(true, 1));
}

#[test]
fn beside_grains_that_went_around_the_box_only_a_rebuild_will_do() {
    let s = scene(PERIODS[2]);
    let mut fast = FastLoop::new(false, between);
    fast.step(&s, 0);
    let frame = Frame { lo: [0.0; 3], period: s.period, reach: SKIN, skin: SKIN };
    let admit = |fast: &mut FastLoop| fast.fast.admit(&s.grains(), &frame, &[7], &|i, j| s.keep(i, j));
    assert!(admit(&mut fast));
    let mut turns = vec![[0; 3]; s.x.len()];
    turns[s.x.len() / 2] = [1, 0, 0];
    fast.fast.turn(&turns, &s.period);
    assert!(!admit(&mut fast));
}

/// The final state after 20 steps.
fn end(first: &Scene, mut fast: FastLoop) -> (Vec<Vec3>, Vec<Vec3>, Got) {
    let mut s = first.clone();
    let mut step = |k: usize| {
        if k.is_multiple_of(7) {
            s.wrap();
        }
        let got = fast.step(&s, k);
        s.advance(&got.f, &got.torque);
        got
    };
    let last = (0..20).map(&mut step).last().unwrap();
    (s.x, s.omega, last)
}

#[test]
fn all_forms_have_the_same_bits() {
    let scenes = [between as Table, sticky, plastic, turning].map(|law| (scene(PERIODS[1]), law));
    for (first, law) in scenes.into_iter().chain([(sheared(PERIODS[1]), between as Table)]) {
        let run = |form| {
            let mut fast = FastLoop::new(false, law);
            fast.fast.compute_as(form);
            end(&first, fast)
        };
        let plain = run(Form::Plain);
        for form in Form::all() {
            assert_eq!(run(form), plain, "{form:?}");
        }
    }
}

#[test]
fn grains_that_are_alike_have_the_same_bits() {
    let mut first = scene(PERIODS[1]);
    first.radius.fill(0.5);
    for masses in [vec![1.3; first.mass.len()], first.mass.clone()] {
        first.mass = masses;
        for form in Form::all() {
            let run = |one_by_one| {
                let mut fast = FastLoop { one_by_one, ..FastLoop::new(false, between) };
                fast.fast.compute_as(form);
                end(&first, fast)
            };
            let [alike, each] = [run(false), run(true)];
            assert!(alike.2.contacts.keys.len() > 100);
            assert_eq!(alike, each, "{form:?}");
        }
    }
}
