//! What is remembered of the slackest bonds.

use perigrain_peri::families::*;

/// The next of a row of numbers from −1 to 1, as if drawn at random.
fn next(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) as f64 / f64::from(1u32 << 30) - 1.0
}

/// What is remembered of families saves work and changes nothing: a brick is shaken to pieces, once with it and once
/// without.
#[test]
fn slackest_bonds_change_nothing() {
    let x0: Vec<[f64; 3]> =
        (0..540).map(|i| [f64::from(i % 18), f64::from(i / 18 % 6), f64::from(i / 108)]).collect();
    let bounds = Bounds { lo: [-50.0; 3], hi: [50.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
    let (kind, volume) = (vec![1; x0.len()], vec![1.0; x0.len()]);
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1.0, horizon: 3.01, s00: 0.01, alpha: 0.25 }).unwrap();
    for (compat_lammps, layout) in [false, true].map(|c| [(c, Layout::Auto), (c, Layout::List)]).concat() {
        let options = FamilyOptions { compat_lammps, layout, ..FamilyOptions::new(1.0) };
        let at = |f: &Families| {
            f.lattices.iter().map(|b| b.alive.clone()).chain([f.list.alive.clone()]).collect::<Vec<_>>()
        };
        let mut x = x0.clone();
        macro_rules! view {
            () => {
                PeriView { x: &x, x0: &x0, kind: &kind, volume: &volume, bounds, excluded: None }
            };
        }
        let mut one = Families::build(&view!(), &table, options).unwrap();
        let mut other = one.clone();
        let (mut seed, mut known, whole) = (7, 0, one.live_bonds());
        for step in 0..40 {
            for (i, x) in x.iter_mut().enumerate() {
                let pull = 2e-4 * f64::from(step % 9) * (x0[i][0] - 9.0);
                let push = 0.3 * next(&mut seed) * 0.01;
                *x =
                    [x[0] + pull * 0.05 + push, x[1] + 0.01 * next(&mut seed), x[2] + 0.01 * next(&mut seed)];
            }
            let (mut f, mut g) = (vec![[0.0; 3]; x.len()], vec![[0.0; 3]; x.len()]);
            one.force(&view!(), &mut f, true, None);
            other.lattices.iter_mut().for_each(|b| b.slackest = Default::default());
            other.list.limits = Default::default();
            other.force(&view!(), &mut g, true, None);
            assert_eq!(f, g);
            assert_eq!(at(&one), at(&other), "step {step}");
            let bounds = one.lattices.iter().map(|b| &b.slackest.bound).chain([&one.list.limits.least]);
            known = known.max(bounds.flatten().filter(|b| b.is_finite()).count());
        }
        assert!(known > 100 && one.live_bonds() < whole - 500 && one.live_bonds() > whole / 4);
    }
}
