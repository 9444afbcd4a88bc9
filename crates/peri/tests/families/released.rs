//! What breaking bonds set free is what the energy of all bonds falls by where they are.

use perigrain_peri::families::*;

use super::cauchy::with_material;
use super::scene::{Scene, named};

const DX: f64 = 1e-3;
const KINDS: [&str; 6] = ["pmb", "lps", "ves", "eps", "ves/apart", "cauchy"];

/// A bar that is torn in the middle; its bonds relax and flow before they break.
fn torn(kind: &'static str, layout: Layout) -> Scene {
    let mut s = Scene::new(DX, 4e-8, 1);
    (s.options.layout, s.options.unit) = (layout, ForceUnit::Newton);
    s.fill(DX, [[0, 15], [0, 3], [0, 4]], 1, 2200.0, |_| true);
    s.density.iter_mut().zip(&s.volume).for_each(|(m, v)| *m *= v);
    s.table.set(1, 1, PmbCoeff { c: 1e21, horizon: 3.015 * DX, s00: 0.004, alpha: 0.25 }).unwrap();
    s.law.kind = named(kind).into();
    let (lambda, tau) = if matches!(kind, "ves" | "ves/apart") { (0.6, 3e-7) } else { (0.0, 0.0) };
    s.law.moduli =
        vec![Moduli { bulk: 14e9, shear: 6e9, lambda, tau, yield_stress: 2e7, ..Moduli::default() }];
    if kind == "cauchy" {
        s = with_material(s, perigrain_constitutive::Law::Hencky);
    }
    for (x, v) in s.x.iter().zip(&mut s.v) {
        *v = [if x[0] < 7.5 * DX { -30.0 } else { 30.0 }, 0.0, 0.0];
    }
    s.setup();
    s.families.as_mut().unwrap().counts_losses = true;
    s
}

#[test]
fn what_is_released_is_what_the_energy_falls_by() {
    for (kind, layout) in KINDS.into_iter().flat_map(|k| [(k, Layout::Auto), (k, Layout::List)]) {
        let mut s = torn(kind, layout);
        let (mut breaks, mut total) = (0, 0.0);
        for _ in 0..60 {
            let families = s.families.as_ref().unwrap();
            let (bonds, released) = (families.live_bonds(), families.released);
            s.step();
            let (before, kept) = (s.energy, s.f.clone());
            let families = s.families.as_ref().unwrap();
            let (broken, released) = (bonds - families.live_bonds(), families.released - released);
            if broken == 0 {
                assert_eq!(released, 0.0);
                continue;
            }
            // The same places with the bonds that are left.
            s.forces(false);
            let fell = before - s.energy;
            s.f = kept;
            // Sums over some 10⁴ bonds of the same sign, each off by a few roundings, in another order.
            assert!(
                (released - fell).abs() < 1e-12 * before,
                "{kind:?} {layout:?}: {released:e} {fell:e} of {before:e}"
            );
            (breaks, total) = (breaks + 1, total + released);
        }
        assert!(breaks > 5 && total > 0.0, "{kind:?} {breaks} {total}");
    }
}
