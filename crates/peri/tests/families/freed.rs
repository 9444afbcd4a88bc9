//! Broken bonds are set free: forces are the gradient of the energy, and breaking never makes any.

use perigrain_peri::families::*;

use super::scene::{Scene, named};

const DX: f64 = 1e-3;
const KINDS: [&str; 4] = ["lps", "ves", "eps", "ves/apart"];

/// A block of a material with ν = 0.4 that is torn apart and has relaxed or flowed, in true forces, without contact.
fn torn(kind: &'static str, layout: Layout) -> Scene {
    let mut s = Scene::new(DX, 4e-8, 1);
    (s.options.layout, s.options.unit, s.options.no_repulsion) = (layout, ForceUnit::Newton, true);
    s.fill(DX, [[0, 7], [0, 5], [0, 4]], 1, 2200.0, |_| true);
    s.density.iter_mut().zip(&s.volume).for_each(|(m, v)| *m *= v);
    s.table.set(1, 1, PmbCoeff { c: 1e21, horizon: 3.015 * DX, s00: 0.004, alpha: 0.25 }).unwrap();
    s.law.kind = named(kind).into();
    let (lambda, tau) = if matches!(kind, "ves" | "ves/apart") { (0.6, 3e-7) } else { (0.0, 0.0) };
    s.law.moduli =
        vec![Moduli { bulk: 14e9, shear: 3e9, lambda, tau, yield_stress: 2e7, ..Moduli::default() }];
    for (x, v) in s.x.iter().zip(&mut s.v) {
        *v = [0, 1, 2].map(|k| 40.0 * (900.0 * x[k] + 500.0 * x[(k + 1) % 3]).sin());
    }
    s.setup();
    for _ in 0..30 {
        s.step();
    }
    let families = s.families.as_ref().unwrap();
    let (all, left) = (families.bonds(), families.live_bonds());
    assert!(left * 20 < all * 19 && left * 3 > all, "{kind:?}: {left} of {all} bonds live");
    s
}

#[test]
fn forces_are_the_gradient_of_the_energy() {
    for (kind, layout) in KINDS.into_iter().flat_map(|k| [(k, Layout::Auto), (k, Layout::List)]) {
        let mut s = torn(kind, layout);
        s.forces(false);
        let force = s.f.clone();
        let most = force.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
        for i in (0..s.x.len()).step_by(23) {
            for k in 0..3 {
                let x = s.x[i][k];
                // Bonds bend the energy by the cube of 1e-4 of a spacing; rounding is 1e-16 of the energy over it.
                let mut energy = |by: f64| {
                    s.x[i][k] = x + by * DX;
                    s.forces(false);
                    s.x[i][k] = x;
                    s.energy
                };
                let slope = |by: f64, energy: &mut dyn FnMut(f64) -> f64| {
                    (energy(by) - energy(-by)) / (2.0 * by * DX)
                };
                // Richardson's extrapolation of central differences.
                let (wide, narrow) = (slope(4e-5, &mut energy), slope(2e-5, &mut energy));
                let gradient = (4.0 * narrow - wide) / 3.0;
                assert!(
                    (gradient + force[i][k]).abs() < 1e-6 * most,
                    "{kind:?} {layout:?} {i} {k}: {gradient:e} {:e} of {most:e}",
                    force[i][k]
                );
            }
        }
    }
}

#[test]
fn cuts_set_energy_free() {
    for (kind, layout) in KINDS.into_iter().flat_map(|k| [(k, Layout::Auto), (k, Layout::List)]) {
        let mut s = torn(kind, layout);
        s.forces(false);
        let (first, mut before) = (s.energy, s.energy);
        for cut in 0..24 {
            // Planes through the block, one after the other.
            let (axis, at) = (cut % 3, (0.5 + f64::from(cut as u32 / 3)) * DX);
            let mut families = s.families.take().unwrap();
            families.cut(&s.view(), |a, b| (a[axis] - at) * (b[axis] - at) < 0.0);
            s.families = Some(families);
            s.forces(false);
            // Rounding of sums over some 10⁴ bonds.
            assert!(s.energy <= before + 1e-12 * first, "{kind:?} {layout:?}: {before:e} to {:e}", s.energy);
            before = s.energy;
        }
        // No bond lives.
        assert_eq!((s.families.as_ref().unwrap().live_bonds(), s.energy.abs() < 1e-9 * first), (0, true));
    }
}

/// Energies, positions and what has been counted are the same in both layouts.
#[test]
fn layouts_agree_on_what_broken_bonds_leave() {
    for kind in KINDS {
        let [mut a, mut b] = [torn(kind, Layout::Auto), torn(kind, Layout::List)];
        for s in [&mut a, &mut b] {
            s.families.as_mut().unwrap().counts_losses = true;
            (0..5).for_each(|_| s.step());
        }
        let near =
            |a: f64, b: f64, of: f64| assert!((a - b).abs() < 1e-9 * of.abs(), "{kind:?}: {a:e} {b:e}");
        near(a.energy, b.energy, a.energy);
        let [f, g] = [&a, &b].map(|s| s.families.as_ref().unwrap());
        near(f.heat, g.heat, a.energy);
        near(f.released, g.released, a.energy);
        assert_eq!(f.live_bonds(), g.live_bonds());
        assert!(f.released > 0.0 && (kind == "lps" || f.heat > 0.0), "{kind:?} {} {}", f.released, f.heat);
    }
}
