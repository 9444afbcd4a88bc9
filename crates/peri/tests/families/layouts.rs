//! All layouts against the textbook loop, and against themselves on several threads and without skipping.

use perigrain_base::par;
use perigrain_peri::families::*;

use super::scene::Scene;
use super::textbook::Textbook;

/// Numbers in [0, 1) that look random.
pub struct Scatter(pub u64);

impl Scatter {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

pub const DX: f64 = 1e-3;

pub fn coeff(k: f64, s00: f64, alpha: f64) -> PmbCoeff {
    let horizon = 3.015 * DX;
    PmbCoeff { c: 18.0 * k / (std::f64::consts::PI * horizon.powi(4)), horizon, s00, alpha }
}

/// A block hit from the side by a smaller one that was made apart from it: bonds break, both touch.
pub fn impact(types: u16) -> Scene {
    let mut s = Scene::new(DX, 4e-8, usize::from(types));
    s.fill(DX, [[0, 9], [0, 7], [0, 6]], 1, 2200.0, |_| true);
    let first = s.x.len();
    s.fill(DX, [[13, 15], [2, 5], [2, 4]], 1, 2200.0, |_| true);
    for i in 0..s.x.len() {
        s.v[i] = if i < first { [0.0, 30.0 * s.x[i][2] / DX / 6.0, 0.0] } else { [-1500.0, 30.0, 10.0] };
    }
    for a in 1..=types {
        for b in 1..=types {
            let k = 15e9 / (1.0 + 0.5 * f64::from(a.abs_diff(b)));
            s.table.set(a, b, coeff(k, 0.002 + 0.001 * f64::from(a + b), 0.25)).unwrap();
        }
    }
    s
}

/// Types in layers across x, so that rows along y or z stay of one type; or scattered, so that none do.
pub fn impact_of_types(scattered: bool) -> Scene {
    let mut s = impact(3);
    let mut scatter = Scatter(7);
    for i in 0..s.x.len() {
        let layer = (s.x[i][0] / DX / 4.0).round() as u16 % 3;
        s.kind[i] = 1 + if scattered { (3.0 * scatter.next()) as u16 } else { layer };
        if scattered {
            s.volume[i] *= 0.8 + 0.4 * scatter.next();
        }
    }
    s
}

/// Points on no lattice.
pub fn rubble() -> Scene {
    let mut s = impact(2);
    let mut scatter = Scatter(3);
    for i in 0..s.x.len() {
        for k in 0..3 {
            s.x[i][k] += 0.3 * DX * (scatter.next() - 0.5);
        }
        s.x0[i] = s.x[i];
        s.kind[i] = 1 + (2.0 * scatter.next()) as u16;
        s.volume[i] *= 0.8 + 0.4 * scatter.next();
    }
    s
}

/// A periodic block under random velocities, drifting through its faces.
pub fn periodic(cells: [i32; 3], jitter: f64) -> Scene {
    let mut s = Scene::new(DX, 4e-8, 1);
    s.fill(DX, cells.map(|n| [0, n - 1]), 1, 2200.0, |_| true);
    s.bounds = Bounds {
        lo: [-0.5 * DX; 3],
        hi: cells.map(|n| (f64::from(n) - 0.5) * DX),
        periodic: [true; 3],
        tilt: [0.0; 3],
    };
    let mut scatter = Scatter(5);
    for i in 0..s.x.len() {
        s.v[i] = [0, 1, 2].map(|_| 40.0 * (scatter.next() - 0.5) + 200.0);
        for k in 0..3 {
            s.x[i][k] += jitter * DX * (scatter.next() - 0.5);
        }
        s.x0[i] = s.x[i];
    }
    s.table.set(1, 1, coeff(15e9, 0.004, 0.25)).unwrap();
    s
}

/// Wraps positions as a reneighbouring step would.
fn wrap(s: &mut Scene) {
    for x in &mut s.x {
        for k in 0..3 {
            let length = s.bounds.hi[k] - s.bounds.lo[k];
            if s.bounds.periodic[k] {
                x[k] -= length * ((x[k] - s.bounds.lo[k]) / length).floor();
            }
        }
    }
}

/// Moves a scene with families and one with textbook loops side by side; returns the largest deviation of
/// positions in spacings, of velocities relative to the largest, and the damage they agree on.
fn side_by_side(mut s: Scene, steps: usize) -> (f64, f64, f64) {
    let mut t = s.clone();
    s.setup();
    let mut textbook = Textbook::build(&t.view(), &t.table, t.options);
    let damage_of = |textbook: &Textbook, t: &Scene| textbook.damage(&t.volume);
    let mut f = std::mem::take(&mut t.f);
    textbook.force(&t.view(), &mut f, false);
    t.f = f;
    for step in 0..steps {
        s.step();
        t.drift_and_kick(true);
        let mut f = std::mem::take(&mut t.f);
        f.iter_mut().for_each(|f| *f = [0.0; 3]);
        textbook.force(&t.view(), &mut f, true);
        t.f = f;
        t.drift_and_kick(false);
        if step % 7 == 3 {
            wrap(&mut s);
            wrap(&mut t);
        }
        if step == steps / 2 {
            let (ours, theirs) = (s.damage(), damage_of(&textbook, &t));
            assert!(ours.iter().zip(&theirs).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }
    let (ours, theirs) = (s.damage(), damage_of(&textbook, &t));
    // A bond more or less changes damage by about 1/100; rounding of the sums by 1e-15.
    assert!(ours.iter().zip(&theirs).all(|(a, b)| (a - b).abs() < 1e-12));
    let speed = t.v.iter().flatten().fold(0.0f64, |m, v| m.max(v.abs()));
    let (mut dx, mut dv) = (0.0f64, 0.0f64);
    for i in 0..s.x.len() {
        let d = s.bounds.nearest([0, 1, 2].map(|k| s.x[i][k] - t.x[i][k]));
        for k in 0..3 {
            dx = dx.max(d[k].abs() / DX);
            dv = dv.max((s.v[i][k] - t.v[i][k]).abs() / speed);
        }
    }
    (dx, dv, ours.iter().sum())
}

/// Every layout, kernel and unit against the textbook.
fn check(name: &str, scene: &Scene, steps: usize) {
    [Layout::Auto, Layout::List].into_iter().for_each(|layout| check_in(layout, name, scene, steps));
}

/// Every kernel and unit of a layout against the textbook.
pub fn check_in(layout: Layout, name: &str, scene: &Scene, steps: usize) {
    for (portable, unit) in [(false, ForceUnit::Density), (true, ForceUnit::Newton)] {
        let mut s = scene.clone();
        (s.options.layout, s.options.portable, s.options.unit) = (layout, portable, unit);
        if unit == ForceUnit::Newton {
            s.density.iter_mut().zip(&s.volume).for_each(|(m, v)| *m *= v);
        }
        let (dx, dv, damage) = side_by_side(s, steps);
        println!("{name} {layout:?} portable {portable} {unit:?}: x {dx:e}, v {dv:e}, damage {damage}");
        // Absolute lengths lose digits that displacements keep: stretches differ by some 1e-16 |x|/dx, and
        // the motion after an impact multiplies that.
        assert!(dx < 1e-11 && dv < 1e-10, "{name}: {dx:e} {dv:e}");
        assert!(damage > 0.0);
    }
}

#[test]
fn impact_agrees_with_the_textbook() {
    let scene = impact(1);
    let families = Families::build(&scene.view(), &scene.table, scene.options).unwrap();
    assert_eq!((families.lattices.len(), families.list.record.len()), (2, 0));
    check("impact", &scene, 80);
}

#[test]
fn layered_types_agree_with_the_textbook() {
    check("layers", &impact_of_types(false), 80);
}

#[test]
fn scattered_types_and_volumes_agree_with_the_textbook() {
    check("scattered", &impact_of_types(true), 80);
}

#[test]
fn points_on_no_lattice_agree_with_the_textbook() {
    let scene = rubble();
    let families = Families::build(&scene.view(), &scene.table, scene.options).unwrap();
    assert_eq!((families.lattices.len(), families.list.record.len()), (0, scene.x.len()));
    check("rubble", &scene, 80);
}

#[test]
fn periodic_bodies_agree_with_the_textbook() {
    // Rings of 5, 9 and 8 slabs along one axis or another.
    check("periodic 7", &periodic([7, 7, 7], 0.0), 40);
    check("periodic 17", &periodic([17, 7, 7], 0.2), 40);
    check("periodic 13", &periodic([7, 7, 13], 0.0), 40);
}

#[test]
fn a_lattice_in_a_periodic_box_may_drift_through_its_faces() {
    let mut scene = impact(1);
    scene.bounds = Bounds { lo: [-4.0 * DX; 3], hi: [26.0 * DX; 3], periodic: [true; 3], tilt: [0.0; 3] };
    let families = Families::build(&scene.view(), &scene.table, scene.options).unwrap();
    assert_eq!(families.lattices.len(), 2);
    scene.v.iter_mut().for_each(|v| v[1] += 2000.0);
    check("drift", &scene, 80);
}

#[test]
fn volume_rules_and_compat_agree_with_the_textbook() {
    for volume in [VolumeRule::None, VolumeRule::Full] {
        for compat_lammps in [false, true] {
            let mut scene = impact_of_types(false);
            scene.volume.fill(DX * DX * DX);
            (scene.options.volume, scene.options.compat_lammps) = (volume, compat_lammps);
            check("rules", &scene, 70);
        }
    }
}

/// At rest with no bond stretched, but closer than nine tenths of the distances at creation.
#[test]
fn a_body_pressed_before_its_bonds_are_found_pushes_itself_apart() {
    let mut block = Scene::new(DX, 4e-8, 1);
    block.fill(DX, [[0, 9], [0, 7], [0, 6]], 1, 2200.0, |_| true);
    block.table.set(1, 1, coeff(15e9, 1.0, 0.0)).unwrap();
    let mut pressed = block.clone();
    pressed.x.iter_mut().flatten().for_each(|x| *x *= 0.8);
    // One half is moved into the other: on no lattice any more.
    block.x.iter_mut().filter(|x| x[2] > 2.5 * DX).for_each(|x| x[2] -= 0.24 * DX);
    for (name, scene) in [("pressed", pressed), ("moved", block)] {
        for layout in [Layout::Auto, Layout::List] {
            let mut s = scene.clone();
            s.options.layout = layout;
            // Rounding alone, as in `check`; a body that stays at rest is off by the whole velocity.
            let (dx, dv, _) = side_by_side(s, 60);
            assert!(dx < 1e-11 && dv < 1e-10, "{name} {layout:?}: {dx:e} {dv:e}");
        }
    }
}

#[test]
fn deleted_particles_take_their_bonds_along() {
    for layout in [Layout::Auto, Layout::List] {
        let mut s = impact(1);
        s.options.layout = layout;
        s.setup();
        let mut textbook = Textbook::build(&s.view(), &s.table, s.options);
        let n = s.x.len();
        // Every fifth goes; the others move up.
        let mut next = 0;
        let map: Vec<Option<u32>> = (0..n)
            .map(|i| {
                next += u32::from(i % 5 != 2);
                (i % 5 != 2).then_some(next - 1)
            })
            .collect();
        s.keep(|i| i % 5 != 2);
        textbook.remap(&map);
        s.families.as_mut().unwrap().remap(&map);
        let damage = textbook.damage(&s.volume);
        assert!(s.damage().iter().zip(&damage).all(|(a, b)| (a - b).abs() < 1e-14));
        s.x.iter_mut().enumerate().for_each(|(i, x)| x[0] += 1e-3 * DX * (i as f64).sin());
        let mut f = vec![[0.0; 3]; s.x.len()];
        textbook.force(&s.view(), &mut f, true);
        s.forces(true);
        let most = f.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
        let off = s.f.iter().flatten().zip(f.iter().flatten()).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        // Stretches of 1e-3 from lengths of 1e-3 m lose 13 of 16 digits in the textbook's differences.
        assert!(off < 1e-11 * most, "{off} {most}");
    }
}

#[test]
fn bits_do_not_depend_on_threads_or_skipping() {
    let _alone = super::threads::alone();
    let mut late = impact(1);
    // At rest until the smaller block arrives.
    late.v.iter_mut().for_each(|v| *v = if v[0] < 0.0 { *v } else { [0.0; 3] });
    for (name, scene) in
        [("impact", impact(1)), ("late", late), ("rubble", rubble()), ("ring", periodic([17, 7, 7], 0.0))]
    {
        let mut bits = Vec::new();
        for (threads, skip_rest) in [(1, true), (2, true), (8, true), (1, false), (2, false)] {
            par::set_threads(threads);
            let mut s = scene.clone();
            s.options.skip_rest = skip_rest;
            s.setup();
            (0..80).for_each(|_| s.step());
            let state: Vec<u64> = s.x.iter().chain(&s.v).chain(&s.f).flatten().map(|x| x.to_bits()).collect();
            bits.push((state, s.energy.to_bits(), s.families.as_ref().unwrap().live_bonds()));
        }
        par::set_threads(1);
        assert!(bits.windows(2).all(|b| b[0] == b[1]), "{name}");
    }
}

#[test]
fn true_forces_conserve_momentum() {
    for (name, mut s) in [("lattice", impact(1)), ("rubble", rubble()), ("scattered", impact_of_types(true))]
    {
        s.options.unit = ForceUnit::Newton;
        s.density.iter_mut().zip(&s.volume).for_each(|(m, v)| *m *= v);
        s.setup();
        for _ in 0..100 {
            s.step();
            let total = [0, 1, 2].map(|k| s.f.iter().map(|f| f[k]).sum::<f64>());
            let size: f64 = s.f.iter().flatten().map(|f| f.abs()).sum();
            // Each bond pulls both ends equally; what is left is the rounding of the sums.
            assert!(total.iter().all(|t| t.abs() <= 1e-13 * size), "{name} {total:?} {size}");
        }
    }
}

#[test]
fn bonds_as_kept_are_those_of_all_particles() {
    for layout in [Layout::Auto, Layout::List] {
        let mut s = impact(1);
        // A ball has rows of all lengths.
        let far = |x: [f64; 3]| x.map(|x| (x / DX - 24.0).powi(2)).iter().sum::<f64>().sqrt();
        s.fill(DX, [[20, 28]; 3], 1, 2200.0, |x| far(x) < 4.2);
        s.options.layout = layout;
        s.setup();
        for step in 0..2 {
            if step == 1 {
                (0..40).for_each(|_| s.step());
                // A hole, so that rows end here and there.
                let gone = |i: usize| i % 17 == 3;
                let mut next = 0..;
                let map: Vec<Option<u32>> =
                    (0..s.x.len()).map(|i| if gone(i) { None } else { next.next() }).collect();
                s.keep(|i| !gone(i));
                s.families.as_mut().unwrap().remap(&map);
            }
            let families = s.families.as_ref().unwrap();
            for broken in [false, true] {
                let mut kept = vec![];
                families.bonds_as_kept(broken, |i, j| kept.push([i.min(j), i.max(j)]));
                kept.sort_unstable();
                let of = |i: usize| {
                    let all = families.neighbours(i).into_iter().filter(move |n| broken || n.alive);
                    all.map(move |n| [i as u32, n.partner]).filter(|[i, j]| i < j)
                };
                assert!(kept.iter().copied().eq((0..s.x.len()).flat_map(of)), "{layout:?} {broken}");
                assert!(!kept.is_empty());
            }
        }
    }
}
