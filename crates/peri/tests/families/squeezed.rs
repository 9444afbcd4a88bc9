//! A lattice that is pressed slowly, against the same bonds as a list.

use perigrain_peri::families::*;

/// A brick is pressed slowly by a quarter and pulled again: forces are those of the same bonds as a list, which are looked at
/// one by one, at all stretches and where bonded particles come close enough to repel each other.
#[test]
fn slow_pressing_passes_through_all_forms() {
    let x0: Vec<[f64; 3]> =
        (0..432).map(|i| [f64::from(i % 12), f64::from(i / 12 % 6), f64::from(i / 72)]).collect();
    let bounds = Bounds { lo: [-50.0; 3], hi: [50.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
    let (kind, volume) = (vec![1; x0.len()], vec![1.0; x0.len()]);
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1.0, horizon: 3.01, s00: 10.0, alpha: 0.0 }).unwrap();
    let deepest = [false, true].map(|no_repulsion| {
        let built = |layout| {
            let view = PeriView { x: &x0, x0: &x0, kind: &kind, volume: &volume, bounds, excluded: None };
            let options = FamilyOptions { layout, no_repulsion, ..FamilyOptions::new(1.0) };
            Families::build(&view, &table, options).unwrap()
        };
        let (mut lattice, mut list) = (built(Layout::Auto), built(Layout::List));
        assert!(lattice.lattices.len() == 1 && list.lattices.is_empty());
        let mut deepest = 0.0f64;
        for step in 0..200 {
            let by = 0.25 * f64::from(if step < 100 { step } else { 200 - step }) / 100.0;
            let x: Vec<[f64; 3]> =
                x0.iter().map(|x| [x[0] * (1.0 + 0.3 * by), x[1], x[2] * (1.0 - by)]).collect();
            let view = PeriView { x: &x, x0: &x0, kind: &kind, volume: &volume, bounds, excluded: None };
            let (mut f, mut g) = (vec![[0.0; 3]; x.len()], vec![[0.0; 3]; x.len()]);
            lattice.force(&view, &mut f, true, None);
            list.force(&view, &mut g, true, None);
            let most = g.as_flattened().iter().fold(1e-3f64, |most, f| most.max(f.abs()));
            deepest = deepest.max(most);
            for (f, g) in f.as_flattened().iter().zip(g.as_flattened()) {
                // Sums of 120 forces of this size, each to a few roundings of 1e-16.
                assert!((f - g).abs() < 1e-13 * most, "step {step}: {f} {g}");
            }
        }
        deepest
    });
    assert!(deepest[0] > 1.1 * deepest[1], "layers at 0.75 of their distance repel each other: {deepest:?}");
}
