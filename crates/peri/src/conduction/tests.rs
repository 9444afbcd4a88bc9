//! Conduction in small bricks.

use super::implicit::Step;
use super::{Conduction, Conductors};
use crate::families::{Bounds, Families, FamilyOptions, Layout, PeriView, PmbCoeff, PmbTable};

const K: f64 = 3.0;
/// Cells of a brick along each axis: two of them are more than 2 δ from every face.
const SIZE: [usize; 3] = [12, 11, 11];

fn places(size: [usize; 3]) -> Vec<[f64; 3]> {
    let [nx, ny, nz] = size;
    let at = |i: usize| [i % nx, i / nx % ny, i / nx / ny].map(|k| k as f64);
    (0..nx * ny * nz).map(at).collect()
}

/// A brick of unit spacing, volumes and conductivity [`K`].
fn brick(x: &[[f64; 3]], layout: Layout) -> (Families, Conductors) {
    let n = x.len();
    let (kind, volume) = (vec![1; n], vec![1.0; n]);
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1.0, horizon: 2.015, s00: 1.0, alpha: 0.0 }).unwrap();
    let bounds = Bounds { lo: [-50.0; 3], hi: [50.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
    let view = PeriView { x, x0: x, kind: &kind, volume: &volume, bounds, excluded: None };
    let options = FamilyOptions { layout, ..FamilyOptions::new(1.0) };
    let families = Families::build(&view, &table, options).unwrap();
    let share = families.conducting_volumes(&kind, &volume).iter().map(|m| 3.0 * K / m).collect();
    (families, Conductors { share, volume })
}

fn flow(families: &Families, ends: &Conductors, cracks: f64, t: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; t.len()];
    Conduction::new(families, cracks).flow(families, ends, t, &mut out);
    out
}

/// Inside, T = ½x² heats each unit of volume by k, and an even gradient by nothing; all heat together is 0.
#[test]
fn even_gradients_conduct_k() {
    let x = places(SIZE);
    for layout in [Layout::Auto, Layout::List] {
        let (families, ends) = brick(&x, layout);
        assert_eq!(families.lattices.len(), usize::from(layout == Layout::Auto));
        let inside = |p: &[f64; 3]| (0..3).all(|d| p[d] >= 4.5 && p[d] <= SIZE[d] as f64 - 5.5);
        let bent: Vec<f64> = x.iter().map(|p| 0.5 * p[0] * p[0]).collect();
        let even: Vec<f64> = x.iter().map(|p| 2.0 * p[0] - p[1] + 0.5 * p[2]).collect();
        let (curved, none) = (flow(&families, &ends, 0.0, &bent), flow(&families, &ends, 0.0, &even));
        let mut looked = 0;
        for i in (0..x.len()).filter(|i| inside(&x[*i])) {
            // Sums of 32 bonds of sizes up to 20.
            assert!((curved[i] - K).abs() < 1e-13 * 400.0 && none[i].abs() < 1e-13 * 20.0);
            looked += 1;
        }
        assert!(looked > 0);
        let (sum, size) = curved.iter().fold((0.0, 0.0f64), |s, q| (s.0 + q, s.1.max(q.abs())));
        assert!(sum.abs() < 1e-13 * size * x.len() as f64, "{sum} {size}");
    }
}

/// Both layouts conduct the same, also beside a cut, which conducts its share.
#[test]
fn a_cut_conducts_its_share() {
    let x = places([8, 5, 4]);
    let kind = vec![1; x.len()];
    let volume = vec![1.0; x.len()];
    let bounds = Bounds { lo: [-50.0; 3], hi: [50.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
    let view = PeriView { x: &x, x0: &x, kind: &kind, volume: &volume, bounds, excluded: None };
    let t: Vec<f64> = x.iter().map(|p| if p[0] < 3.5 { 1.0 } else { 0.0 }).collect();
    let mut both = vec![];
    for layout in [Layout::Auto, Layout::List] {
        let (mut families, ends) = brick(&x, layout);
        let whole = flow(&families, &ends, 0.0, &t);
        families.cut(&view, |a, b| (a[0] - 3.5) * (b[0] - 3.5) < 0.0);
        let (shut, third) = (flow(&families, &ends, 0.0, &t), flow(&families, &ends, 0.3, &t));
        assert!(shut.iter().all(|q| *q == 0.0) && whole.iter().any(|q| *q != 0.0));
        // Rounding of sums of up to 32 terms.
        assert!(whole.iter().zip(&third).all(|(a, b)| (0.3 * a - b).abs() < 1e-13));
        both.push(whole);
    }
    // The two add up in different orders.
    assert!(both[0].iter().zip(&both[1]).all(|(a, b)| (a - b).abs() < 1e-13));
}

/// A bar with one end held warmer: one step of backward Euler satisfies its equation, and many small ones of either kind agree.
#[test]
fn long_steps_and_short_ones() {
    let x = places([10, 3, 3]);
    let (families, ends) = brick(&x, Layout::Auto);
    let (n, conduction) = (x.len(), Conduction::new(&families, 0.0));
    let mut conductance = vec![0.0; n];
    conduction.conductance(&families, &ends, &mut conductance);
    let held: Vec<bool> = x.iter().map(|p| p[0] < 0.5).collect();
    let (capacity, film) = (vec![2.0; n], vec![0.0; n]);
    let source: Vec<f64> = x.iter().map(|p| if p[0] > 8.5 { 0.1 } else { 0.0 }).collect();
    let start: Vec<f64> = held.iter().map(|held| if *held { 1.0 } else { 0.0 }).collect();
    let end = |theta: f64, dt: f64, steps: usize| {
        let (mut t, mut flow) = (start.clone(), vec![0.0; n]);
        for _ in 0..steps {
            let before = t.clone();
            let step = Step {
                capacity: &capacity,
                conductance: &conductance,
                film: &film,
                source: &source,
                held: &held,
                dt,
                theta,
            };
            let conduct = |t: &[f64], out: &mut [f64]| conduction.flow(&families, &ends, t, out);
            let solved = step.solve(conduct, &before, &mut t, &mut flow, 500);
            assert!(solved.left <= super::implicit::EXACT && solved.products < 100);
            for i in (0..n).filter(|i| !held[*i]) {
                let rest = capacity[i] * (t[i] - before[i]) / dt - flow[i] - source[i];
                // The system is solved to 1e-10 of its right side, which is below 10.
                assert!(rest.abs() < 1e-9, "{rest}");
            }
        }
        t
    };
    let mut explicit = start.clone();
    let mut q = vec![0.0; n];
    for _ in 0..4000 {
        conduction.flow(&families, &ends, &explicit, &mut q);
        for i in (0..n).filter(|i| !held[*i]) {
            explicit[i] += 0.005 * (q[i] + source[i]) / capacity[i];
        }
    }
    let most = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
    // First order in 0.05 of a time of 20: half of 0.05 times the largest rate at the end, 0.03; second order in 0.5 likewise small.
    assert!(most(&explicit, &end(1.0, 0.05, 400)) < 2e-3);
    assert!(most(&explicit, &end(0.5, 0.5, 40)) < 2e-3);
    // Very long: a steady state, whatever the start.
    assert!(most(&end(1.0, 1e6, 2), &end(1.0, 1e7, 1)) < 1e-4);
}
