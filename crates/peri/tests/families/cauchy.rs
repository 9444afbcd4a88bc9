//! Correspondence: affine fields, forces against the energy, conservation, layouts, waves, breaking, memory.

use perigrain_base::par;
use perigrain_constitutive::{Elastic, Flow, Hardening, Law as Stress, Material, Moment};
use perigrain_peri::families::*;

use super::layouts::Scatter;
use super::scene::{Scene, named};

const DX: f64 = 1e-3;
const ELASTIC: Elastic = Elastic { bulk: 14e9, shear: 6e9 };

/// Gives a scene the law, with a material for all types and g = 0.2.
pub fn with_material(mut s: Scene, law: Stress) -> Scene {
    let types = s.table.types();
    s.law.kind = named("cauchy").into();
    s.law.control = 0.2;
    s.law.moduli = vec![Moduli { bulk: ELASTIC.bulk, shear: ELASTIC.shear, ..Moduli::default() }; types];
    s.law.materials = vec![Some(Material { elastic: ELASTIC, law }); types];
    s
}

/// A block of `n` points, off their sites by `jitter` spacings at most, under true forces.
fn block(n: [i32; 3], jitter: f64, layout: Layout, law: Stress) -> Scene {
    let mut s = Scene::new(DX, 2e-8, 1);
    s.fill(DX, n.map(|n| [0, n - 1]), 1, 2200.0, |_| true);
    let mut scatter = Scatter(11);
    for i in 0..s.x.len() {
        s.x[i] = s.x[i].map(|x| x + jitter * DX * (2.0 * scatter.next() - 1.0));
        s.x0[i] = s.x[i];
    }
    (s.options.layout, s.options.unit) = (layout, ForceUnit::Newton);
    s.density.iter_mut().zip(&s.volume).for_each(|(m, v)| *m *= v);
    let horizon = 2.015 * DX;
    let c = 18.0 * ELASTIC.bulk / (std::f64::consts::PI * horizon.powi(4));
    s.table.set(1, 1, PmbCoeff { c, horizon, s00: f64::INFINITY, alpha: 0.0 }).unwrap();
    with_material(s, law)
}

fn moved(s: &mut Scene, f: [[f64; 3]; 3]) {
    for (x, from) in s.x.iter_mut().zip(&s.x0) {
        *x = [0, 1, 2].map(|k| 3e-4 + (0..3).map(|l| f[k][l] * from[l]).sum::<f64>());
    }
}

fn largest(f: &[[f64; 3]]) -> f64 {
    f.iter().flatten().fold(0.0, |m, f| m.max(f.abs()))
}

const SHEARED: [[f64; 3]; 3] = [[1.05, 0.08, 0.0], [-0.02, 0.93, 0.06], [0.03, 0.0, 1.01]];

/// Layouts with and without the portable kernels, and points on no lattice.
const CASES: [(Layout, bool, f64); 4] = [
    (Layout::Auto, false, 0.0),
    (Layout::Auto, true, 0.0),
    (Layout::List, false, 0.0),
    (Layout::Auto, false, 0.2),
];

#[test]
fn an_affine_field_has_its_stress_everywhere_and_no_force_inside() {
    for (layout, portable, jitter) in CASES {
        for law in [Stress::Linear, Stress::NeoHooke, Stress::Hencky] {
            let mut s = block([11, 10, 9], jitter, layout, law);
            s.options.portable = portable;
            s.setup();
            assert_eq!(
                s.families.as_ref().unwrap().lattices.len(),
                usize::from(layout == Layout::Auto && jitter == 0.0)
            );
            assert_eq!((largest(&s.f), s.energy), (0.0, 0.0), "nothing has moved");
            moved(&mut s, SHEARED);
            s.forces(false);
            let material = s.law.materials[0].clone().unwrap();
            let moment = Moment { dt: 0.0, temperature: None, spacing: DX, advance: false };
            let known = material.respond(&SHEARED, &Default::default(), &moment).unwrap();
            let p = known.piola;
            let families = s.families.as_ref().unwrap();
            let mut energy = 0.0;
            for i in 0..s.x.len() {
                energy += known.energy * s.volume[i];
                let state = families.state(i).unwrap();
                for (own, (a, b)) in state.stress.iter().zip(perigrain_base::math::vec3::SIX) {
                    let expected: f64 = (0..3).map(|k| p[a][k] * SHEARED[b][k]).sum();
                    // F to 1e-13: positions of 1e-2 m are rounded to 1e-18 m, bonds of 1e-3 m gradients to some 1e-15.
                    assert!((own - expected).abs() < 1e-13 * 2.0 * ELASTIC.bulk, "{own} {expected}");
                }
            }
            // z is 0 for all bonds: energy is that of the material, and forces cancel where families of families are whole.
            assert!((s.energy / energy - 1.0).abs() < 1e-11, "{}", s.energy / energy);
            let inside = |x: &[f64; 3]| {
                [11, 10, 9].iter().zip(x).all(|(n, x)| *x > 3.5 * DX && *x < (f64::from(*n) - 4.5) * DX)
            };
            let rest = (0..s.x.len()).filter(|&i| jitter == 0.0 && inside(&s.x0[i]));
            let rest: Vec<[f64; 3]> = rest.map(|i| s.f[i]).collect();
            assert_eq!(rest.is_empty(), jitter > 0.0);
            assert!(largest(&rest) < 1e-12 * largest(&s.f), "{:e} {:e}", largest(&rest), largest(&s.f));
        }
    }
}

/// A field that bends and twists, with motions between neighbours.
fn bent(s: &mut Scene) {
    let mut scatter = Scatter(23);
    for (x, from) in s.x.iter_mut().zip(&s.x0) {
        let at = from.map(|x| x / DX);
        *x = [0, 1, 2].map(|k| {
            from[k]
                + DX * (0.02 * (0.7 * at[k]).sin()
                    + 0.03 * (0.5 * at[(k + 1) % 3]).cos()
                    + 0.02 * scatter.next())
        });
    }
}

#[test]
fn forces_are_the_derivative_of_the_energy() {
    for (layout, portable, jitter) in CASES {
        for (law, broken) in [(Stress::NeoHooke, false), (Stress::Hencky, true)] {
            let mut s = block([6, 5, 5], jitter, layout, law);
            s.options.portable = portable;
            s.setup();
            if broken {
                let mut families = s.families.take().unwrap();
                let cut = families
                    .cut(&s.view(), |a, b| (a[0] - 2.6 * DX) * (b[0] - 2.6 * DX) < 0.0 && a[1] < 1.7 * DX);
                assert!(cut > 20);
                s.families = Some(families);
            }
            bent(&mut s);
            s.forces(false);
            let (f, size) = (s.f.clone(), largest(&s.f));
            // Differences err by the third derivative times 1e-5² of a spacing, and by rounding of the energy over 1e-5 of it.
            let h = 1e-5 * DX;
            for (i, k) in [(0, 0), (7, 1), (44, 2), (62, 0), (62, 1), (71, 2), (149, 0), (149, 2)] {
                let at = s.x[i][k];
                let mut energy = [0.0; 2];
                for (energy, side) in energy.iter_mut().zip([h, -h]) {
                    s.x[i][k] = at + side;
                    s.forces(false);
                    *energy = s.energy;
                }
                s.x[i][k] = at;
                let slope = (energy[0] - energy[1]) / (2.0 * h);
                assert!(
                    (f[i][k] + slope).abs() < 1e-7 * size,
                    "{layout:?} {jitter} {i} {k}: {} {slope}",
                    f[i][k]
                );
            }
            let (mut total, mut torque, mut sum) = ([0.0; 3], [0.0; 3], 0.0);
            for (x, f) in s.x.iter().zip(&f) {
                for k in 0..3 {
                    let (a, b) = ((k + 1) % 3, (k + 2) % 3);
                    total[k] += f[k];
                    torque[k] += x[a] * f[b] - x[b] * f[a];
                    sum += f[k].abs();
                }
            }
            // Each bond pulls both ends alike; torques of a site cancel since P Fᵀ is symmetric. Lever arms are some 5 spacings.
            assert!(total.iter().all(|t| t.abs() < 1e-13 * sum), "{total:?} {sum}");
            assert!(torque.iter().all(|t| t.abs() < 1e-13 * sum * 5.0 * DX), "{torque:?} {sum}");
            // The virial is that of all forces.
            let own: f64 = (0..s.x.len()).map(|i| (0..3).map(|k| s.x[i][k] * f[i][k]).sum::<f64>()).sum();
            s.forces(false);
            let trace: f64 = s.virial[..3].iter().sum();
            assert!((trace - own).abs() < 1e-11 * sum * 5.0 * DX, "{trace} {own}");
        }
    }
}

#[test]
fn rotation_gives_no_force() {
    let (c, d) = (0.3f64.cos(), 0.3f64.sin());
    let turn = [[c, -d, 0.0], [c * d, c * c, -d], [d * d, c * d, c]];
    for (layout, portable, jitter) in CASES {
        let mut s = block([6, 6, 6], jitter, layout, Stress::Hencky);
        s.options.portable = portable;
        s.setup();
        moved(&mut s, [[1.001, 0.0, 0.0], [0.0, 1.001, 0.0], [0.0, 0.0, 1.001]]);
        s.forces(false);
        let (size, energy) = (largest(&s.f), s.energy);
        moved(&mut s, turn);
        s.forces(false);
        // Strains of 1e-15 from positions, of 1e-3 the force before.
        assert!(largest(&s.f) < 1e-11 * size, "{:e} {size:e}", largest(&s.f));
        assert!(s.energy.abs() < 1e-20 * energy.max(1.0), "{:e} {energy:e}", s.energy);
    }
}

/// A bar that is pulled apart, or shaken if it does not break.
fn pulled(layout: Layout, law: Stress, s00: f64) -> Scene {
    let mut s = block([14, 5, 6], 0.0, layout, law);
    let own = *s.table.get(1, 1).unwrap();
    s.table.set(1, 1, PmbCoeff { s00, alpha: 0.25, ..own }).unwrap();
    for (x, v) in s.x.iter().zip(&mut s.v) {
        *v = [if x[0] < 6.5 * DX { -30.0 } else { 30.0 }, 2e3 * x[2], 0.0];
    }
    s
}

#[test]
fn layouts_agree_while_bonds_break() {
    let mut ends = vec![];
    for (layout, portable) in [(Layout::List, false), (Layout::Auto, false), (Layout::Auto, true)] {
        let mut s = pulled(layout, Stress::Hencky, 0.004);
        s.options.portable = portable;
        s.setup();
        let bonds = s.families.as_ref().unwrap().live_bonds();
        (0..30).for_each(|_| s.step());
        let live = s.families.as_ref().unwrap().live_bonds();
        assert!(live < bonds, "nothing broke");
        ends.push((s.x.clone(), s.energy, live));
    }
    for other in &ends[1..] {
        assert_eq!(other.2, ends[0].2);
        let off = other.0.iter().flatten().zip(ends[0].0.iter().flatten());
        let off = off.fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        // Rounding of forces over thirty steps.
        assert!(
            off < 1e-11 * DX && (other.1 / ends[0].1 - 1.0).abs() < 1e-9,
            "{off:e} {} {}",
            other.1,
            ends[0].1
        );
    }
}

#[test]
fn bits_are_the_same_for_any_threads_and_without_skipping() {
    for layout in [Layout::Auto, Layout::List] {
        let mut bits = vec![];
        for (threads, skip_rest) in [(1, true), (2, true), (4, false)] {
            par::set_threads(threads);
            let mut s = pulled(layout, Stress::Hencky, 0.004);
            s.options.skip_rest = skip_rest;
            for (x, v) in s.x.iter().zip(&mut s.v) {
                *v = if x[0] < 2.5 * DX { [-90.0, 0.0, 3.0] } else { [0.0; 3] };
            }
            s.setup();
            (0..12).for_each(|_| s.step());
            let state: Vec<u64> =
                s.x.iter().chain(&s.v).chain(&s.f).flatten().map(|x| (x + 0.0).to_bits()).collect();
            bits.push((state, s.energy.to_bits(), s.families.as_ref().unwrap().live_bonds()));
        }
        par::set_threads(1);
        assert!(bits.windows(2).all(|b| b[0] == b[1]), "{layout:?}");
    }
}

/// A metal that yields early.
fn soft_metal() -> Stress {
    Stress::Plastic { flow: Flow::Mises(Hardening::Linear { yields: 2e7, modulus: 1e9 }), damage: None }
}

#[test]
fn trials_use_what_is_remembered_and_write_nothing() {
    for layout in [Layout::Auto, Layout::List] {
        let mut ends = vec![];
        for trials in [false, true] {
            let mut s = pulled(layout, soft_metal(), 0.02);
            s.setup();
            for step in 0..12 {
                s.step();
                if trials && step % 3 == 1 {
                    let (x, f, energy) = (s.x.clone(), s.f.clone(), s.energy);
                    for part in [0.3, -0.2, 0.1] {
                        s.x.iter_mut().for_each(|x| x[0] += part * x[1]);
                        s.forces(false);
                        s.x.clone_from(&x);
                    }
                    // Looking again where the step has been: on the yield surface, to rounding of the return.
                    s.forces(false);
                    let off = s.f.iter().zip(&f).map(|(a, b)| [0, 1, 2].map(|k| a[k] - b[k]));
                    let off = largest(&off.collect::<Vec<_>>());
                    assert!(off < 1e-9 * largest(&f), "{off:e}");
                    assert!((s.energy / energy - 1.0).abs() < 1e-9);
                    (s.f, s.energy) = (f, energy);
                }
            }
            let families = s.families.as_ref().unwrap();
            let flowed: Vec<f64> = (0..s.x.len()).map(|i| families.plastic_strain(i)).collect();
            assert!(flowed.iter().any(|e| *e > 1e-3));
            let bits = s.x.iter().chain(&s.v).chain(&s.f).flatten().chain(&flowed).map(|a| a.to_bits());
            ends.push(bits.collect::<Vec<_>>());
        }
        assert!(ends[0] == ends[1], "{layout:?}");
    }
}

#[test]
fn forces_of_what_has_flowed_are_the_derivative_of_the_energy() {
    for (layout, portable, jitter) in CASES {
        let mut s = block([6, 5, 5], jitter, layout, soft_metal());
        s.options.portable = portable;
        s.setup();
        bent(&mut s);
        s.forces(true);
        // A little of the way back: elastic everywhere. Differences then err by rounding alone.
        for (x, from) in s.x.iter_mut().zip(&s.x0) {
            *x = [0, 1, 2].map(|k| x[k] + 1e-3 * (from[k] - x[k]));
        }
        s.forces(false);
        let (f, size) = (s.f.clone(), largest(&s.f));
        let h = 1e-6 * DX;
        for (i, k) in [(0, 0), (44, 2), (62, 1), (149, 2)] {
            let at = s.x[i][k];
            let mut energy = [0.0; 2];
            for (energy, side) in energy.iter_mut().zip([h, -h]) {
                s.x[i][k] = at + side;
                s.forces(false);
                *energy = s.energy;
            }
            s.x[i][k] = at;
            let slope = (energy[0] - energy[1]) / (2.0 * h);
            assert!(
                (f[i][k] + slope).abs() < 1e-8 * size,
                "{layout:?} {jitter} {i} {k}: {} {slope}",
                f[i][k]
            );
        }
    }
}

/// ω²/(c²k²) of a standing wave along x of so many spacings, longitudinal or shear, c being that of the continuum.
fn dispersion(long: i32, axis: usize) -> f64 {
    let horizon = 2.015 * DX;
    let mut s = Scene::new(DX, 1e-8, 1);
    s.fill(DX, [[0, long - 1], [0, 6], [0, 6]], 1, 1.0, |_| true);
    let size = [long, 7, 7];
    s.bounds = Bounds {
        lo: [-0.5 * DX; 3],
        hi: size.map(|n| (f64::from(n) - 0.5) * DX),
        periodic: [true; 3],
        tilt: [0.0; 3],
    };
    s.options.volume = VolumeRule::Full;
    s.table.set(1, 1, PmbCoeff { c: 0.0, horizon, s00: f64::INFINITY, alpha: 0.0 }).unwrap();
    s = with_material(s, Stress::Linear);
    // ν = 0.3.
    let elastic = Elastic::from_young(1.0, 0.3);
    s.law.moduli[0] = Moduli { bulk: elastic.bulk, shear: elastic.shear, ..Moduli::default() };
    s.law.materials[0] = Some(Material { elastic, law: Stress::Linear });
    s.setup();
    let k = 2.0 * std::f64::consts::PI / (f64::from(long) * DX);
    let amplitude = 1e-6 * DX;
    for (x, from) in s.x.iter_mut().zip(&s.x0) {
        x[axis] += amplitude * (k * from[0]).cos();
    }
    s.forces(false);
    let stiffness = elastic.shear * if axis == 0 { 2.0 * (1.0 - 0.3) / (1.0 - 0.6) } else { 1.0 };
    (-s.f[0][axis] / amplitude / (stiffness * k * k)).sqrt()
}

#[test]
fn waves_have_the_speeds_of_the_infinite_lattice() {
    // Bloch waves of node control with g = 0.2, computed apart: speeds over those of the continuum, three digits.
    for (long, axis, expected) in [(10, 0, 0.901), (10, 1, 0.967), (20, 0, 0.974), (20, 1, 0.992)] {
        let speed = dispersion(long, axis);
        assert!((speed - expected).abs() < 6e-4, "{long} {axis}: {speed}, not {expected}");
    }
}

/// 2/ω of a scene of density 1.
fn limit(s: &Scene) -> f64 {
    let mass: Vec<f64> = s.volume.iter().map(|v| s.density[0] * v).collect();
    2.0 / s.families.as_ref().unwrap().largest_eigenvalue(&s.view(), &mass, 1.0).unwrap().sqrt()
}

/// A body of `n` points with this Poisson's ratio and horizon, whose wave speed c_P is 1 spacing per time.
fn sounding(
    n: [i32; 3],
    jitter: f64,
    (volume, horizon, nu): (VolumeRule, f64, f64),
    periodic: bool,
) -> Scene {
    let mut s = block(n, jitter, Layout::List, Stress::Linear);
    s.options.volume = volume;
    if periodic {
        let hi = n.map(|n| (f64::from(n) - 0.5) * DX);
        s.bounds = Bounds { lo: [-0.5 * DX; 3], hi, periodic: [true; 3], tilt: [0.0; 3] };
    }
    let elastic = Elastic::from_young(1.0, nu);
    s.law.materials[0] = Some(Material { elastic, law: Stress::Linear });
    s.law.moduli[0] = Moduli { bulk: elastic.bulk, shear: elastic.shear, ..Moduli::default() };
    let own = *s.table.get(1, 1).unwrap();
    s.table.set(1, 1, PmbCoeff { horizon: horizon * DX, ..own }).unwrap();
    s.density = vec![(elastic.bulk + 4.0 / 3.0 * elastic.shear) / (DX * DX); s.x.len()];
    s.setup();
    s
}

#[test]
fn steps_are_stable_up_to_those_of_bloch_waves() {
    // Bloch waves of node control with g = 0.2, ν = 0.3 on a grid of wave vectors: three digits, and periods of 10 and 8 spacings.
    for (horizon, expected) in [(2.015, 2.25), (3.015, 3.21)] {
        let step = limit(&sounding([10, 8, 8], 0.0, (VolumeRule::Full, horizon, 0.3), true));
        assert!((step / expected - 1.0).abs() < 0.005, "{horizon}: {step}, not {expected}");
    }
}

#[test]
fn estimates_of_the_step_lie_below_the_limit() {
    let mut closest = [f64::INFINITY; 2];
    for (horizon, nu) in [2.015, 3.015].into_iter().flat_map(|h| [0.0, 0.3, 0.49].map(|nu| (h, nu))) {
        for volume in [VolumeRule::Lammps, VolumeRule::Full] {
            for (n, jitter) in
                [([9, 2, 2], 0.0), ([9, 2, 2], 0.2), ([7, 7, 2], 0.0), ([8, 8, 8], 0.0), ([7, 6, 6], 0.3)]
            {
                let s = sounding(n, jitter, (volume, horizon, nu), false);
                let (step, own) = (limit(&s), s.law.moduli[0]);
                let [sure, stable] = [own.thin_step(DX), own.thick_step(horizon * DX)]
                    .map(|t| t / DX * (s.density[0] * DX * DX).sqrt());
                assert!(sure < step, "{horizon} {nu} {volume:?} {n:?} {jitter}: {step} {sure}");
                assert!(
                    stable < step || n[2] == 2,
                    "{horizon} {nu} {volume:?} {n:?} {jitter}: {step} {stable}"
                );
                closest[0] = closest[0].min(step / sure);
                if n[2] > 2 {
                    closest[1] = closest[1].min(step / stable);
                }
            }
        }
    }
    // Neither needs to be shorter than that.
    assert!(closest.iter().all(|ratio| *ratio < 1.1), "{closest:?}");
}
