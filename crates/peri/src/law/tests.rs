//! The laws of one bond by hand.

use crate::law::eps::{Plastic, PlasticLammps};
use crate::law::lps::Elastic;
use crate::law::nonlinear::Flattened;
use crate::law::plastic::Yielding;
use crate::law::ves::Viscous;
use crate::law::*;

fn bond(s: f64) -> Stretch<f64> {
    closed(s * (2.0 + s))
}

/// The first step of a bond.
fn fresh(s: f64) -> Stretch<f64> {
    Stretch { before: 0.0, ..bond(s) }
}

/// Memory is the element's stretch itself.
const ITSELF: Held = Held { decay: 1.0, fresh: 0.0 };
const NOW: Moment = Moment {
    decay: 0.8,
    fresh: 0.9,
    lambda: 0.4,
    flow: 1.0,
    held: ITSELF,
    hold: ITSELF,
    lost: false,
    mended: false,
};

#[test]
fn forms_of_the_stretch() {
    for s in [-0.4, -1e-9, 0.0, 1e-5, 0.3, 2.0] {
        let b = bond(s);
        let near = |a: f64, b: f64| (a - b).abs() <= 4e-16 * (1.0 + b.abs());
        assert!(near(b.s, s) && near(b.share, s / (1.0 + s)) && near(b.inverse, 1.0 / (1.0 + s)));
    }
}

#[test]
fn laws_agree_where_nothing_relaxes_or_flows() {
    // 3K = 7, 15G/m = 3 and 2, theta/3 = 0.01 and -0.02 with m = 1: A = 3K theta/m - B theta/3.
    let (k, g, third) = (7.0, [3.0, 2.0], [0.01, -0.02]);
    let a = [0, 1].map(|i| k * 3.0 * third[i]);
    let b = bond(0.05);
    let lps = [0, 1].map(|i| [a[i] - g[i] * third[i], g[i], 0.0, 0.0, 0.0, 0.0]);
    let eps = [0, 1].map(|i| [a[i], g[i], third[i], 0.0, 0.0, 0.0]);
    let mut none = [0.0; 2];
    let one = 1.0;
    let (x, y) = Elastic::pull(&b, one, &lps, &mut none, &NOW);
    let (p, _) = Plastic::pull(&b, one, &eps, &mut none, &NOW);
    let mut memory = [0.0; 2];
    let still = Moment { lambda: 0.0, ..NOW };
    let (v, _) = Viscous::<true>::pull(&fresh(0.05), one, &lps, &mut memory, &still);
    assert!(x == y && (x - p).abs() < 1e-15 && (x - v).abs() < 1e-15);
}

#[test]
fn a_maxwell_element_relaxes_to_the_spring() {
    let ends = [[0.0, 1.0, 0.0, 0.0, 0.0, 0.0]; 2];
    let mut memory = [0.0; 2];
    let b = bond(0.1);
    let mut pulls = vec![];
    for step in 0..200 {
        let b = if step == 0 { fresh(0.1) } else { b };
        pulls.push(Viscous::<true>::pull(&b, 1.0, &ends, &mut memory, &NOW).0 * 1.1 / 2.0);
    }
    // First 0.6 s + 0.4 * 0.9 s, at last 0.6 s.
    assert!((pulls[0] - 0.096).abs() < 1e-15 && (pulls[199] - 0.06).abs() < 1e-15);
    let kept = memory;
    let look = Moment { decay: 1.0, fresh: 1.0, ..NOW };
    Viscous::<true>::pull(&b, 1.0, &ends, &mut memory, &look);
    // The stretch is taken away and added: a rounding of 0.1.
    assert!((kept[0] - memory[0]).abs() < 2e-17);
}

#[test]
fn both_forms_of_viscous_memory_give_the_same_pulls() {
    let ends = [[0.03, 1.5, 0.01, 0.0, 0.0, 0.0]; 2];
    // The element's stretch by its definition, and in the forms in which bonds remember it; the step changes twice.
    let (mut d, mut before, mut held) = (0.0, 0.0, ITSELF);
    let mut memory = [0.0; 2];
    for step in 0..60 {
        let s = 0.02 * (0.3 * f64::from(step + 1)).sin();
        let (decay, fresh) = if (20..40).contains(&step) { (0.7, 0.84) } else { (0.9, 0.95) };
        d = decay * d + fresh * (s - before);
        let hold = Held::for_steps(decay, fresh);
        let moment = Moment { decay, fresh, lambda: 0.4, flow: 1.0, held, hold, lost: false, mended: false };
        assert_eq!(moment.steady(), ![0, 20, 40].contains(&step));
        let b = Stretch { before, ..bond(s) };
        let mut looking = memory;
        let (any, lammps) = (
            Viscous::<true>::pull(&b, 1.0, &ends, &mut looking, &moment).0,
            Viscous::<true, true>::pull(&b, 1.0, &ends, &mut memory.clone(), &moment).0,
        );
        let relaxed = 3.0 * (0.6 * s + 0.4 * d);
        // Numbers below 0.1, some ten roundings in each of the steps that D still feels (about ten).
        assert!((any - (0.06 + relaxed) / (1.0 + s)).abs() < 1e-15, "{step}");
        assert!((lammps - (0.06 + relaxed - 0.03) / (1.0 + s)).abs() < 1e-15, "{step}");
        if moment.steady() {
            let quick = Viscous::<false>::pull(&b, 1.0, &ends, &mut memory, &moment).0;
            assert!((any - quick).abs() < 1e-15 && (looking[0] - memory[0]).abs() < 1e-16, "{step}");
        }
        (memory, before, held) = (looking, s, hold);
        let angles = [Angles { now: 0.0, unrelaxed: 0.0, relaxing: 0.4 }; 2];
        let now = Stretch { before: s, ..bond(s) };
        let square = Viscous::<true>::squares(&now, 1.0, &angles, &memory, &Moment { held, ..moment }).0;
        assert!((square - (0.6 * s * s + 0.4 * d * d)).abs() < 1e-16, "{step}");
    }
    // Where hardly anything is left of the element there is no way back from the form.
    assert_eq!(Held::for_steps(0.0, 0.1), ITSELF);
}

#[test]
fn a_cycle_of_a_bond_that_yields() {
    // Walayat et al. 2023, Eq. 6: a plateau in compression; after unloading the bond is left shorter.
    let (limit, ends) = (-0.02, [[0.0; COLUMNS]; 2]);
    let mut memory = [0.0; 2];
    for (s, plastic, flat) in [
        (0.01, 0.01, 0.01),
        (-0.01, -0.01, -0.01),
        (-0.05, -0.02, -0.02),
        (-0.03, 0.0, -0.02),
        (0.0, 0.03, 0.0),
    ] {
        let (p, _) = Yielding::pull(&bond(s), limit, &ends, &mut memory, &NOW);
        let (f, _) = Flattened::pull(&bond(s), limit, &ends, &mut [0.0; 2], &NOW);
        assert!((p * (1.0 + s) - plastic).abs() < 1e-16 && (f * (1.0 + s) - flat).abs() < 1e-16, "{s}");
    }
}

#[test]
fn energies_are_the_work_of_the_pulls() {
    // d(½ square)/ds by central differences over 2e-6 is the elastic stretch: (1 + s) times a bond-based pull.
    let none = [Angles { now: 0.0, unrelaxed: 0.0, relaxing: 0.0 }; 2];
    let (limit, ends, step) = (-0.02, [[0.0; COLUMNS]; 2], 1e-6);
    let square = |s: f64| Flattened::squares(&bond(s), limit, &none, &[0.0; 2], &NOW).0;
    for s in [0.03, -0.01, -0.05] {
        let slope = (square(s + step) - square(s - step)) / (4.0 * step);
        let pull = Flattened::pull(&bond(s), limit, &ends, &mut [0.0; 2], &NOW).0;
        // Rounding of 1e-18 over 4e-6.
        assert!((slope - pull * (1.0 + s)).abs() < 1e-11, "{s}");
    }
}

#[test]
fn flow_returns_to_the_limit_and_stays() {
    // Trial 0.1, limit 0.04: 60 % flow.
    let ends = [[0.0, 1.0, 0.0, 0.6, 0.0, 0.0]; 2];
    let mut memory = [0.0; 2];
    let (p, _) = Plastic::pull(&bond(0.1), 1.0, &ends, &mut memory, &NOW);
    assert!((p * 1.1 - 0.08).abs() < 1e-15 && (memory[0] - 0.06).abs() < 1e-15);
    let look = Moment { flow: 0.0, ..NOW };
    let (q, _) = Plastic::pull(&bond(0.1), 1.0, &ends, &mut memory, &look);
    assert_eq!(p, q);
}

#[test]
fn plastic_bodies_of_2026_return_to_the_limit_within_a_body() {
    // B = 3 and B' = 2 at the ends, deviatoric stretch 0.1 at both, limits 0.4 and 0.5 of the trial norms. The multiplier is
    // (1/scale - 1)/B; half of it times the deviatoric pull (B + B') 0.1 scale flows. With B = B' it is 0.1 (1 - scale).
    let flowed = |g: [f64; 2], scale: [f64; 2]| {
        let ends = [0, 1].map(|i| [0.0, g[i], 0.0, scale[i], (1.0 / scale[i] - 1.0) / g[i], 0.0]);
        let mut memory = [0.0; 2];
        let moment = Moment { mended: true, ..NOW };
        // ω is 1 over the length of a bond, here of 1/7; in 2026 it does not count.
        PlasticLammps::pull(&bond(0.1), 7.0, &ends, &mut memory, &moment);
        memory
    };
    let near = |a: f64, b: f64| (a - b).abs() < 1e-15;
    let [a, b] = flowed([3.0, 3.0], [0.4, 0.5]);
    assert!(near(a, 0.06) && near(b, 0.05), "{a} {b}");
    let [a, b] = flowed([3.0, 2.0], [0.4, 0.5]);
    assert!(near(a, 0.06 * (1.0 + 2.0 / 3.0) / 2.0) && near(b, 0.05 * (1.0 + 1.5) / 2.0), "{a} {b}");
}
