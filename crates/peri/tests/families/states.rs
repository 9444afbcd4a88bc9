//! State-based laws: against plain loops over both ends of every bond, patch tests, closed forms, layouts, bits.

use perigrain_base::par;
use perigrain_peri::families::*;

use super::layouts::{impact, impact_of_types, periodic, rubble};
use super::scene::{Scene, named};

const DX: f64 = 1e-3;
const K: f64 = 14e9;
const G: f64 = 6e9;
pub const KINDS: [&str; 4] = ["lps", "ves", "eps", "ves/apart"];

fn moduli(kind: &'static str, factor: f64) -> Moduli {
    let (lambda, tau) = match kind {
        "ves" => (0.6, 3e-7),
        "ves/apart" => (0.6 / factor, 3e-7 * factor * factor),
        _ => (0.0, 0.0),
    };
    let (bulk, shear, yield_stress) = (K * factor, G * factor * factor, 2e6 * factor);
    Moduli { bulk, shear, lambda, tau, yield_stress, ..Moduli::default() }
}

/// Gives a scene a state-based law; types differ in their moduli.
pub fn with_law(mut s: Scene, kind: &'static str) -> Scene {
    let types = s.table.types();
    s.law.kind = named(kind).into();
    s.law.moduli = (0..types).map(|k| moduli(kind, 1.0 + 0.3 * k as f64)).collect();
    s
}

/// No bond breaks.
pub fn tough(mut s: Scene) -> Scene {
    let types = s.table.types() as u16;
    for (a, b) in (1..=types).flat_map(|a| (1..=types).map(move |b| (a, b))) {
        if let Some(c) = s.table.get(a, b).copied() {
            s.table.set(a, b, PmbCoeff { s00: f64::INFINITY, ..c }).unwrap();
        }
    }
    s
}

/// A block of any types under velocities that vary smoothly, so that no particles touch.
pub fn shaken(mut s: Scene) -> Scene {
    for i in 0..s.x.len() {
        let x = s.x[i];
        s.v[i] = [0, 1, 2].map(|k| 6.0 * (400.0 * x[k] + 250.0 * x[(k + 1) % 3]).sin());
    }
    tough(s)
}

/// One end of a bond.
#[derive(Clone)]
struct End {
    partner: usize,
    length: f64,
    omega: f64,
    weight: f64,
    /// Deviatoric extension in the step before, its relaxed part; or plastic extension.
    memory: [f64; 2],
}

/// Forces by the formulas as they stand in the papers, each end of each bond by itself.
struct Plain {
    ends: Vec<Vec<End>>,
    weighted: Vec<f64>,
    spread: Vec<f64>,
}

impl Plain {
    fn new(s: &Scene) -> Self {
        let n = s.x.len();
        let mut ends = vec![vec![]; n];
        for i in 0..n {
            for j in (0..n).filter(|&j| j != i) {
                let xi = s.bounds.nearest([0, 1, 2].map(|k| s.x[j][k] - s.x[i][k]));
                let length = xi.iter().map(|x| x * x).sum::<f64>().sqrt();
                let Some(c) = s.table.get(s.kind[i], s.kind[j]) else { continue };
                let dx = s.options.lattice_spacing;
                if length <= s.options.volume.reach(c.horizon, dx) {
                    let omega = s.law.influence.of(length, c.horizon);
                    let weight = s.options.volume.weight(length, c.horizon, dx);
                    ends[i].push(End { partner: j, length, omega, weight, memory: [0.0; 2] });
                }
            }
        }
        let sum = |power: i32| -> Vec<f64> {
            let one = |e: &End| e.omega.powi(power) * e.weight * e.length * e.length * s.volume[e.partner];
            ends.iter().map(|ends| ends.iter().map(one).sum()).collect()
        };
        Self { weighted: sum(1), spread: sum(2), ends }
    }

    fn force(&mut self, s: &Scene) -> (Vec<[f64; 3]>, Vec<f64>) {
        let n = s.x.len();
        let bond = |i: usize, e: &End| {
            let now = s.bounds.nearest([0, 1, 2].map(|k| s.x[e.partner][k] - s.x[i][k]));
            let length = now.iter().map(|x| x * x).sum::<f64>().sqrt();
            (now.map(|x| x / length), length - e.length)
        };
        let theta: Vec<f64> = (0..n)
            .map(|i| {
                let one = |e: &End| e.omega * e.weight * e.length * bond(i, e).1 * s.volume[e.partner];
                3.0 / self.weighted[i] * self.ends[i].iter().map(one).sum::<f64>()
            })
            .collect();
        let mut f = vec![[0.0; 3]; n];
        for i in 0..n {
            let m = s.law.of(s.kind[i]);
            let alpha = 15.0 * m.shear / self.weighted[i];
            let dev = |e: &End| bond(i, e).1 - theta[i] * e.length / 3.0;
            let mut scale = 1.0;
            if s.law.kind.name == "eps" {
                let one = |e: &End| {
                    (alpha * e.omega * (dev(e) - e.memory[0])).powi(2) * e.weight * s.volume[e.partner]
                };
                let norm = self.ends[i].iter().map(one).sum::<f64>().sqrt();
                let limit = (5.0 * self.spread[i]).sqrt() * m.yield_stress / self.weighted[i];
                scale = (limit / norm).min(1.0);
            }
            let devs: Vec<f64> = self.ends[i].iter().map(dev).collect();
            let bonds: Vec<_> = self.ends[i].iter().map(|e| bond(i, e)).collect();
            for ((e, dev), (along, _)) in self.ends[i].iter_mut().zip(devs).zip(bonds) {
                let effective = match s.law.kind.name {
                    "ves" | "ves/apart" => {
                        let steps = m.tau / s.dt;
                        let decay = (-1.0 / steps).exp();
                        let beta = 1.0 - steps * (1.0 - decay);
                        let [last, relaxed] = e.memory;
                        let relaxed = last * (1.0 - decay) + relaxed * decay + beta * (dev - last);
                        e.memory = [dev, relaxed];
                        (1.0 - m.lambda) * dev + m.lambda * (dev - relaxed)
                    }
                    "eps" => {
                        let left = scale * (dev - e.memory[0]);
                        e.memory[0] = dev - left;
                        left
                    }
                    _ => dev,
                };
                let own = 3.0 * m.bulk * theta[i] / self.weighted[i] * e.length + alpha * effective;
                let t = e.weight * e.omega * own;
                let j = e.partner;
                for k in 0..3 {
                    f[i][k] += t * s.volume[j] * along[k];
                    f[j][k] -= t * s.volume[i] * along[k];
                }
            }
        }
        (f, theta)
    }
}

fn largest(f: &[[f64; 3]]) -> f64 {
    f.iter().flatten().fold(0.0, |m, f| m.max(f.abs()))
}

/// Moves a scene and compares its forces with the plain ones in every step.
pub fn check(name: &str, scene: &Scene) {
    for (layout, portable) in [(Layout::Auto, false), (Layout::Auto, true), (Layout::List, false)] {
        let mut s = scene.clone();
        (s.options.layout, s.options.portable) = (layout, portable);
        let mut plain = Plain::new(&s);
        s.setup();
        for _ in 0..3 {
            s.step();
            let (f, theta) = plain.force(&s);
            let families = s.families.as_ref().unwrap();
            let most = largest(&f);
            let off =
                largest(&s.f.iter().zip(&f).map(|(a, b)| [0, 1, 2].map(|k| a[k] - b[k])).collect::<Vec<_>>());
            // Extensions of 1e-4 |xi| from absolute lengths lose some 12 digits of 16; nothing adds up over steps.
            assert!(off < 1e-10 * most, "{name} {layout:?} {portable}: {off:e} of {most:e}");
            let angle = theta.iter().fold(0.0f64, |m, t| m.max(t.abs()));
            for (i, theta) in theta.iter().enumerate() {
                assert!((families.dilatation(i) - theta).abs() < 1e-10 * angle);
            }
        }
    }
}

/// A bar whose one end is pulled: most of it is still at rest, bonds break.
fn pulled(layout: Layout) -> Scene {
    let mut s = Scene::new(DX, 4e-8, 1);
    s.options.layout = layout;
    s.fill(DX, [[0, 27], [0, 3], [0, 4]], 1, 2200.0, |_| true);
    let coeff = PmbCoeff { c: 1e20, horizon: 3.015 * DX, s00: 0.004, alpha: 0.25 };
    s.table.set(1, 1, coeff).unwrap();
    for i in 0..s.x.len() {
        if s.x[i][0] < 2.5 * DX {
            s.v[i] = [-200.0, 20.0, 0.0];
        }
    }
    s
}

#[test]
fn forces_are_those_of_the_formulas() {
    for kind in KINDS {
        check(&format!("{kind:?} layers"), &with_law(shaken(impact_of_types(false)), kind));
        check(&format!("{kind:?} scattered"), &with_law(shaken(impact_of_types(true)), kind));
    }
    check("rubble", &with_law(shaken(rubble()), "eps"));
    check("ring", &with_law(tough(periodic([17, 7, 7], 0.0)), "ves"));
}

#[test]
fn influence_and_volume_rules() {
    let pairs = [(Influence::One, VolumeRule::Full), (Influence::Gaussian, VolumeRule::None)];
    for (influence, volume) in pairs {
        let mut s = with_law(shaken(impact(1)), "eps");
        (s.law.influence, s.options.volume) = (influence, volume);
        check(&format!("{influence:?} {volume:?}"), &s);
    }
}

#[test]
fn bits_do_not_depend_on_threads_or_skipping() {
    let _alone = super::threads::alone();
    for (kind, compat_lammps) in [("lps", false), ("ves", false), ("eps", false), ("eps", true)] {
        let ring = tough(periodic([17, 7, 7], 0.0));
        for (name, scene, steps) in
            [("lattice", pulled(Layout::Auto), 12), ("list", pulled(Layout::List), 12), ("ring", ring, 3)]
        {
            let mut bits = Vec::new();
            for (threads, skip_rest) in [(1, true), (3, true), (2, false)] {
                par::set_threads(threads);
                let mut s = with_law(scene.clone(), kind);
                (s.options.skip_rest, s.options.compat_lammps) = (skip_rest, compat_lammps);
                s.setup();
                (0..steps).for_each(|_| s.step());
                let state: Vec<u64> =
                    s.x.iter().chain(&s.v).chain(&s.f).flatten().map(|x| (x + 0.0).to_bits()).collect();
                bits.push((state, s.energy.to_bits(), s.families.as_ref().unwrap().live_bonds()));
            }
            par::set_threads(1);
            assert!(bits.windows(2).all(|b| b[0] == b[1]), "{kind:?} {compat_lammps} {name}");
        }
    }
}

#[test]
fn layouts_agree_while_bonds_break() {
    for kind in KINDS {
        let mut ends = vec![];
        for (layout, portable) in [(Layout::List, false), (Layout::Auto, false), (Layout::Auto, true)] {
            let mut s = with_law(pulled(layout), kind);
            s.options.portable = portable;
            s.setup();
            let bonds = s.families.as_ref().unwrap().live_bonds();
            (0..25).for_each(|_| s.step());
            let live = s.families.as_ref().unwrap().live_bonds();
            assert!(live < bonds, "{kind:?}: nothing broke");
            ends.push((s.x.clone(), s.energy, live));
        }
        for other in &ends[1..] {
            assert_eq!(other.2, ends[0].2);
            let off = other.0.iter().flatten().zip(ends[0].0.iter().flatten());
            let off = off.fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            // Absolute lengths lose digits that displacements keep: stretches differ by some 1e-16 |x|/dx.
            assert!(off < 1e-11 * DX && (other.1 / ends[0].1 - 1.0).abs() < 1e-9, "{kind:?} {off:e}");
        }
    }
}

#[test]
fn true_forces_conserve_momentum_and_angular_momentum() {
    for kind in KINDS {
        for scene in [impact_of_types(true), rubble()] {
            let mut s = with_law(shaken(scene), kind);
            s.options.unit = ForceUnit::Newton;
            s.density.iter_mut().zip(&s.volume).for_each(|(m, v)| *m *= v);
            s.setup();
            for _ in 0..4 {
                s.step();
                let (mut total, mut torque, mut size) = ([0.0; 3], [0.0; 3], 0.0);
                for (x, f) in s.x.iter().zip(&s.f) {
                    for k in 0..3 {
                        let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                        total[k] += f[k];
                        torque[k] += x[a] * f[b] - x[b] * f[a];
                        size += f[k].abs();
                    }
                }
                assert!(total.iter().all(|t| t.abs() < 1e-13 * size), "{kind:?} {total:?}");
                // Bonds pull along themselves; lever arms are some 10 dx.
                assert!(torque.iter().all(|t| t.abs() < 1e-12 * size * 20.0 * DX), "{kind:?} {torque:?}");
            }
        }
    }
}

#[test]
fn energy_is_conserved_while_nothing_flows_or_relaxes() {
    let mut s = with_law(shaken(pulled(Layout::Auto)), "lps");
    s.dt = 1e-8;
    s.setup();
    let kinetic = s.kinetic();
    for _ in 0..100 {
        s.step();
        // Verlet errs by some (omega dt)^2/8, omega dt being 0.1 at most here; most of the motion is slower.
        assert!(((s.energy + s.kinetic()) / kinetic - 1.0).abs() < 2e-4);
    }
    assert!(s.energy > 0.1 * kinetic);
}

/// A block with an inner particle whose family is whole, deformed by `F` and moved.
fn deformed(f: [[f64; 3]; 3], kind: &'static str, layout: Layout, volume: VolumeRule) -> (Scene, usize) {
    let mut s = Scene::new(DX, 1e-8, 1);
    s.fill(DX, [[0, 12]; 3], 1, 2200.0, |_| true);
    s.table.set(1, 1, PmbCoeff { c: 1e20, horizon: 2.015 * DX, s00: f64::INFINITY, alpha: 0.0 }).unwrap();
    s = with_law(s, kind);
    s.law.moduli[0].yield_stress = 1e20;
    (s.options.layout, s.options.volume) = (layout, volume);
    s.setup();
    for x in &mut s.x {
        let at = *x;
        *x = [0, 1, 2].map(|k| 3e-4 + (0..3).map(|l| f[k][l] * at[l]).sum::<f64>());
    }
    s.forces(false);
    let middle = s.x.len() / 2;
    (s, middle)
}

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

#[test]
fn homogeneous_strain_gives_no_force_inside_and_the_bulk_modulus_exactly() {
    for kind in KINDS {
        for layout in [Layout::Auto, Layout::List] {
            for volume in [VolumeRule::Lammps, VolumeRule::Full] {
                let shear = [[1.002, 0.003, 0.0], [-0.001, 0.998, 0.004], [0.002, 0.0, 1.001]];
                let (s, middle) = deformed(shear, kind, layout, volume);
                // Families reach at most 2.5 spacings, and those of partners as far again.
                let surface = largest(&s.f);
                assert!(s.f[middle].iter().all(|f| f.abs() < 1e-12 * surface), "{:?} {surface}", s.f[middle]);
                let strain = 1e-3;
                let grown = IDENTITY.map(|r| r.map(|x| x * (1.0 + strain)));
                let (mut s, middle) = deformed(grown, kind, layout, volume);
                let families = s.families.as_mut().unwrap();
                // theta = 3 strain on every family, whole or not.
                for i in 0..s.x.len() {
                    assert!((families.dilatation(i) / (3.0 * strain) - 1.0).abs() < 1e-11);
                }
                let mut energy = vec![0.0; s.x.len()];
                let (mut families, mut f) = (s.families.take().unwrap(), vec![[0.0; 3]; s.x.len()]);
                let mut tally = PeriTally { per_atom_energy: Some(&mut energy), ..Default::default() };
                families.force(&s.view(), &mut f, false, Some(&mut tally));
                // 9/2 K strain^2, whatever the lattice: physics.md 4.1.
                assert!((energy[middle] / (4.5 * K * strain * strain) - 1.0).abs() < 1e-11);
            }
        }
    }
}

#[test]
fn rotation_gives_no_force() {
    let (c, d) = (0.3f64.cos(), 0.3f64.sin());
    let turn = [[c, -d, 0.0], [c * d, c * c, -d], [d * d, c * d, c]];
    for kind in KINDS {
        for layout in [Layout::Auto, Layout::List] {
            let (s, _) = deformed(turn, kind, layout, VolumeRule::Lammps);
            // A stretch of 1e-3 would pull with this.
            let (strained, _) =
                deformed(IDENTITY.map(|r| r.map(|x| x * 1.001)), kind, layout, VolumeRule::Lammps);
            // Stretches are 0 to 1e-15 |x|/|xi|, and the dead band takes most of that.
            assert!(largest(&s.f) < 1e-11 * largest(&strained.f), "{:e}", largest(&s.f));
        }
    }
}

/// Shear moduli C' and C44 of the cubic lattice over G for a horizon of 3.015 spacings and whole partial volumes
/// (physics.md 4.1, three digits): strain along the axes, and shear between them.
const LATTICE: [f64; 2] = [1.018, 0.988];

/// A bar along x, periodic across, strained or sheared along x as a whole; stresses are what its halves pull with.
struct Sample {
    scene: Scene,
    area: f64,
}

impl Sample {
    fn new(kind: &'static str) -> Self {
        let (long, wide) = (16, 8);
        let mut scene = Scene::new(DX, 1e-7, 1);
        scene.fill(DX, [[0, long - 1], [0, wide - 1], [0, wide - 1]], 1, 2200.0, |_| true);
        let side = f64::from(wide) * DX;
        let (lo, hi) = ([-1.0, -0.5 * DX, -0.5 * DX], [1.0, side - 0.5 * DX, side - 0.5 * DX]);
        scene.bounds = Bounds { lo, hi, periodic: [false, true, true], tilt: [0.0; 3] };
        let coeff = PmbCoeff { c: 0.0, horizon: 3.015 * DX, s00: f64::INFINITY, alpha: 0.0 };
        scene.table.set(1, 1, coeff).unwrap();
        scene.options.volume = VolumeRule::Full;
        scene = with_law(scene, kind);
        scene.setup();
        Self { scene, area: side * side }
    }

    /// Stress xx (axis 0) or xy (axis 1) when points move along the axis in proportion to x.
    fn stress(&mut self, axis: usize, strain: f64, advance: bool) -> f64 {
        let s = &mut self.scene;
        for (x, x0) in s.x.iter_mut().zip(&s.x0) {
            *x = *x0;
            x[axis] += strain * x0[0];
        }
        s.forces(advance);
        let right = (0..s.x.len()).filter(|&i| s.x0[i][0] > 7.5 * DX);
        -right.map(|i| s.f[i][axis] * s.volume[i]).sum::<f64>() / self.area
    }
}

#[test]
fn plastic_loops_are_those_of_von_mises() {
    let yield_stress = moduli("eps", 1.0).yield_stress;
    // Deviatoric stress per strain, its limit, and the volume's part: strain along x alone, or simple shear.
    let uniaxial = (4.0 / 3.0 * LATTICE[0] * G, 2.0 / 3.0 * yield_stress, K);
    let sheared = (LATTICE[1] * G, yield_stress / 3f64.sqrt(), 0.0);
    for (axis, (stiffness, limit, bulk)) in [uniaxial, sheared].into_iter().enumerate() {
        let mut sample = Sample::new("eps");
        let amplitude = 3.0 * limit / stiffness;
        let (mut expected, mut last, mut worst) = (0.0f64, 0.0, 0.0f64);
        // Up, down, up again in steps of a fifth of the amplitude.
        for step in (0..5).chain((-4..=5).rev()).chain(-4..=5) {
            let strain = amplitude * f64::from(step) / 5.0;
            expected = (expected + stiffness * (strain - last)).clamp(-limit, limit);
            last = strain;
            let stress = sample.stress(axis, strain, true);
            worst = worst.max((stress - bulk * strain - expected).abs() / limit);
            // Looking does not change anything.
            assert_eq!(sample.stress(axis, strain, false).to_bits(), stress.to_bits());
        }
        // The limit is for the mean of all directions; the lattice differs by a few per cent, as in its moduli.
        assert!(worst < 0.04, "{axis} {worst}");
    }
}

#[test]
fn a_sheared_sample_relaxes_exponentially() {
    let own = moduli("ves", 1.0);
    let mut sample = Sample::new("ves");
    let dt = sample.scene.dt;
    let strain = 1e-5;
    let stress: Vec<f64> = (0..9).map(|_| sample.stress(1, strain, true)).collect();
    let decay = (-dt / own.tau).exp();
    let fresh = own.tau / dt * (1.0 - decay);
    for (step, stress) in stress.iter().enumerate() {
        let left = 1.0 - own.lambda + own.lambda * fresh * decay.powi(step as i32);
        let expected = LATTICE[1] * G * strain * left;
        assert!((stress / expected - 1.0).abs() < 1e-3, "{step} {stress} {expected}");
    }
    let ratio = (stress[6] - stress[8]) / (stress[2] - stress[4]);
    assert!((ratio / decay.powi(4) - 1.0).abs() < 1e-6);
}
