//! Strengths and stiffnesses that differ from particle to particle.

use super::scene::named;
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::scatter::{Distribution, gaussian};
use perigrain_peri::families::*;

const BOUNDS: Bounds = Bounds { lo: [-50.0; 3], hi: [50.0; 3], periodic: [false; 3], tilt: [0.0; 3] };

/// Bonds that live, and vectors of particles.
type Shaken = (Vec<[u32; 2]>, Vec<[f64; 3]>, Vec<[f64; 3]>);

/// A brick that is drawn and shaken in so many steps: bonds that live, by their ends, and the last forces.
fn shaken(
    (layout, alpha): (Layout, f64),
    law: &Law,
    [strength, stiffness]: [&[f64]; 2],
    steps: usize,
) -> Shaken {
    let x0: Vec<[f64; 3]> =
        (0..540).map(|i| [f64::from(i % 18), f64::from(i / 18 % 6), f64::from(i / 108)]).collect();
    let (kind, volume) = (vec![1; x0.len()], vec![1.0; x0.len()]);
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1.0, horizon: 3.01, s00: 0.01, alpha }).unwrap();
    let options = FamilyOptions { layout, ..FamilyOptions::new(1.0) };
    let mut x = x0.clone();
    macro_rules! view {
        () => {
            PeriView { x: &x, x0: &x0, kind: &kind, volume: &volume, bounds: BOUNDS, excluded: None }
        };
    }
    let mut families = Families::build_of(&view!(), &table, options, law.clone()).unwrap();
    families.scatter(strength, stiffness);
    let (mut random, mut f) = (ParkMiller::new(7), vec![]);
    for step in 0..steps {
        for (x, x0) in x.iter_mut().zip(&x0) {
            x[0] += 2e-4 * (step as f64 - 2.0) * (x0[0] - 9.0);
            *x = x.map(|a| a + 0.004 * (random.uniform() - 0.5));
        }
        f = vec![[0.0; 3]; x.len()];
        families.force(&view!(), &mut f, true, None);
    }
    let mut living = vec![];
    for (i, j) in (0..540).flat_map(|j| (0..j).map(move |i| (i, j))) {
        if families.bonded(i, j) {
            living.push([i, j]);
        }
    }
    (living, f, x)
}

fn drawn(of: Distribution, seed: u64) -> Vec<f64> {
    (0..540).map(|tag| of.factor(gaussian(seed, tag))).collect()
}

#[test]
fn factors_of_one_change_no_bit() {
    let (shaped, ones) = (Law { kind: named("shaped").into(), ..Law::default() }, [1.0; 540]);
    for layout in [Layout::Auto, Layout::List] {
        for law in [&Law::default(), &shaped] {
            let plain = shaken((layout, 0.25), law, [&[], &[]], 20);
            assert!(plain.0.len() < 20_000, "some break: {}", plain.0.len());
            assert!(plain == shaken((layout, 0.25), law, [&ones, &ones], 20));
        }
    }
}

/// Two steps, of which the second breaks bonds: those that live are those that bear their stretch.
#[test]
fn bonds_break_at_the_strength_of_their_weaker_end() {
    let factors = drawn(Distribution::Weibull(1.5), 4711);
    for layout in [Layout::Auto, Layout::List] {
        let (whole, ..) = shaken((layout, 0.0), &Law::default(), [&factors, &[]], 1);
        let (living, _, x) = shaken((layout, 0.0), &Law::default(), [&factors, &[]], 2);
        let bears = |ends: &&[u32; 2]| {
            let [i, j] = ends.map(|i| i as usize);
            let place = |i: usize| [i % 18, i / 18 % 6, i / 108].map(|a| a as f64);
            let length = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
            let stretch = length(x[i], x[j]) / length(place(i), place(j)) - 1.0;
            stretch <= 0.01 * factors[i].min(factors[j])
        };
        let expected: Vec<[u32; 2]> = whole.iter().filter(bears).copied().collect();
        assert!(expected.len() + 20 < whole.len(), "{} of {}", expected.len(), whole.len());
        assert_eq!(living, expected);
    }
}

/// Sums are rounded in another order on lattices: forces agree to some of their last digits.
#[test]
fn lattices_and_lists_agree() {
    let strength = drawn(Distribution::Weibull(4.0), 4711);
    let stiffness = drawn(Distribution::Normal(0.2), 12);
    let shaped = Law { kind: named("shaped").into(), ..Law::default() };
    for law in [&Law::default(), &shaped] {
        let [a, b] = [Layout::Auto, Layout::List]
            .map(|layout| shaken((layout, 0.25), law, [&strength, &stiffness], 20));
        assert_eq!(a.0, b.0);
        let most = a.1.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
        let off = a.1.iter().flatten().zip(b.1.iter().flatten()).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-12 * most);
    }
}

/// A bond of two particles pulls with the mean of their factors, times c s V².
#[test]
fn stiffness_is_the_mean_of_both_ends() {
    let x0 = [[0.0; 3], [1.0, 0.0, 0.0]];
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1.0, horizon: 1.4, s00: 1.0, alpha: 0.0 }).unwrap();
    let drawn = [[0.0; 3], [1.01, 0.0, 0.0]];
    let view = |x| PeriView { x, x0: &x0, kind: &[1; 2], volume: &[1.0; 2], bounds: BOUNDS, excluded: None };
    for layout in [Layout::Auto, Layout::List] {
        let options = FamilyOptions { layout, ..FamilyOptions::new(1.0) };
        let law = Law { kind: named("shaped").into(), influence: Influence::One, ..Law::default() };
        let mut families = Families::build_of(&view(&x0), &table, options, law).unwrap();
        families.scatter(&[], &[0.5, 1.1]);
        let mut f = [[0.0; 3]; 2];
        families.force(&view(&drawn), &mut f, false, None);
        // The weight of partial volumes is (1.4 + 0.5 − 1)/1.
        assert!((f[0][0] / (0.8 * 0.9 * 0.01) - 1.0).abs() < 1e-12, "{}", f[0][0]);
    }
}
