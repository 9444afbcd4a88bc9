//! Thermal strains: forces are gradients, free bodies bear nothing, and limits are those of the mechanical stretch.

use perigrain_peri::families::*;

use super::scene::{Scene, named};

const DX: f64 = 1e-3;
const LAYOUTS: [Layout; 2] = [Layout::Auto, Layout::List];

/// A block of a linear law in true forces, without contact; bonds break at `s00`.
fn block(kind: &'static str, layout: Layout, s00: f64) -> Scene {
    let mut s = Scene::new(DX, 4e-8, 1);
    (s.options.layout, s.options.unit, s.options.no_repulsion) = (layout, ForceUnit::Newton, true);
    s.fill(DX, [[0, 7], [0, 5], [0, 4]], 1, 2200.0, |_| true);
    s.density.iter_mut().zip(&s.volume).for_each(|(m, v)| *m *= v);
    s.table.set(1, 1, PmbCoeff { c: 1e21, horizon: 3.015 * DX, s00, alpha: 0.0 }).unwrap();
    s.law.kind = named(kind).into();
    s.law.moduli = vec![Moduli { bulk: 14e9, shear: 3e9, ..Moduli::default() }];
    s.setup();
    s
}

fn warm(s: &mut Scene, strain: impl Fn([f64; 3]) -> f64) {
    let strain: Vec<f64> = s.x0.iter().map(|x| strain(*x)).collect();
    s.families.as_mut().unwrap().warm(&strain);
}

/// Half torn blocks with uneven strains that pull their bonds, at rest to begin with.
#[test]
fn forces_are_the_gradient_of_the_energy_at_fixed_temperatures() {
    for (kind, layout) in ["lps", "shaped"].into_iter().flat_map(|k| LAYOUTS.map(|l| (k, l))) {
        let mut s = block(kind, layout, 0.004);
        for (x, v) in s.x.iter().zip(&mut s.v) {
            *v = [0, 1, 2].map(|k| 40.0 * (900.0 * x[k] + 500.0 * x[(k + 1) % 3]).sin());
        }
        warm(&mut s, |x| 3e-3 * (700.0 * x[0] + 400.0 * x[1]).sin());
        (0..30).for_each(|_| s.step());
        let families = s.families.as_ref().unwrap();
        assert!(families.live_bonds() * 20 < families.bonds() * 19, "{kind} {layout:?}: some have broken");
        s.forces(false);
        let force = s.f.clone();
        let most = force.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
        for i in (0..s.x.len()).step_by(23) {
            for k in 0..3 {
                let x = s.x[i][k];
                let mut slope = |by: f64| {
                    let [ahead, behind] = [by, -by].map(|by| {
                        s.x[i][k] = x + by * DX;
                        s.forces(false);
                        s.x[i][k] = x;
                        s.energy
                    });
                    (ahead - behind) / (2.0 * by * DX)
                };
                // Richardson's extrapolation of central differences; rounding is 1e-16 of the energy over 2e-5 spacings.
                let (wide, narrow) = (slope(4e-5), slope(2e-5));
                let gradient = (4.0 * narrow - wide) / 3.0;
                let off = (gradient + force[i][k]).abs();
                assert!(
                    off < 1e-6 * most,
                    "{kind} {layout:?} {i} {k}: {gradient:e} {:e} of {most:e}",
                    force[i][k]
                );
            }
        }
    }
}

#[test]
fn a_free_body_expands_without_stress() {
    for (kind, layout) in ["lps", "shaped"].into_iter().flat_map(|k| LAYOUTS.map(|l| (k, l))) {
        let mut s = block(kind, layout, 1.0);
        warm(&mut s, |_| 2e-3);
        s.forces(false);
        let (held, energy) = (s.f.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs())), s.energy);
        s.x.iter_mut().for_each(|x| *x = x.map(|a| 1.002 * a));
        s.forces(false);
        let free = s.f.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
        // Stretches are differences of places: 1e-16 of 8 spacings over a strain of 2e-3, and squares of that.
        assert!(
            held > 0.0 && free < 1e-11 * held && s.energy < 1e-11 * energy,
            "{kind} {layout:?}: {free:e} {held:e}"
        );
        // Cold again and back: as if nothing had been.
        s.families.as_mut().unwrap().warm(&[]);
        s.x.clone_from(&s.x0);
        s.forces(false);
        assert!(s.energy == 0.0 && s.f.iter().flatten().all(|f| *f == 0.0));
    }
}

/// A block that is held and cooled by a strain of 2e-3 bears a stretch of 2e-3 in all bonds; one that is warmed bears pressure.
#[test]
fn bonds_break_by_their_mechanical_stretch() {
    for (kind, layout) in ["lps", "shaped"].into_iter().flat_map(|k| LAYOUTS.map(|l| (k, l))) {
        let left = |s00: f64, strain: f64, stretch: f64| {
            let mut s = block(kind, layout, s00);
            s.forces(true);
            warm(&mut s, |_| strain);
            s.x.iter_mut().for_each(|x| *x = x.map(|a| (1.0 + stretch) * a));
            s.forces(true);
            let families = s.families.as_ref().unwrap();
            (families.live_bonds(), families.bonds())
        };
        let all = left(1.0, 0.0, 0.0).1;
        for (s00, strain, stretch, live) in [
            (1.999e-3, -2e-3, 0.0, 0),
            (2.001e-3, -2e-3, 0.0, all),
            (1.999e-3, 1e-2, 1.19e-2, all),
            (1.999e-3, 1e-2, 1.21e-2, 0),
            (0.999e-3, -3e-3, -2e-3, 0),
            (1.001e-3, -3e-3, -2e-3, all),
        ] {
            assert_eq!(left(s00, strain, stretch).0, live, "{kind} {layout:?} {s00} {strain} {stretch}");
        }
    }
}
