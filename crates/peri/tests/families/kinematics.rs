//! Gradients of deformation that families find.

use perigrain_peri::families::*;
use perigrain_peri::kinematics::{Tensor, green_lagrange, neo_hooke};

/// A block of 6³ points one apart, moved by `F`; what each particle finds.
fn gradients(f: &Tensor, layout: Layout, volume: VolumeRule) -> Vec<Option<Tensor>> {
    let place = |i: i32| [i % 6, i / 6 % 6, i / 36].map(f64::from);
    let x0: Vec<[f64; 3]> = (0..216).map(place).collect();
    let moved = |x: &[f64; 3]| [0, 1, 2].map(|a| 0.5 + (0..3).map(|b| f[a][b] * x[b]).sum::<f64>());
    let x: Vec<[f64; 3]> = x0.iter().map(moved).collect();
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1.0, horizon: 2.015, s00: 1.0, alpha: 0.0 }).unwrap();
    let bounds = Bounds { lo: [-50.0; 3], hi: [50.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
    let start = PeriView { x: &x0, x0: &x0, kind: &[1; 216], volume: &[1.0; 216], bounds, excluded: None };
    let options = FamilyOptions { layout, volume, ..FamilyOptions::new(1.0) };
    let families = Families::build(&start, &table, options).unwrap();
    let now = PeriView { x: &x, ..start };
    (0..216).map(|i| families.gradient(&now, i)).collect()
}

const SKEW: Tensor = [[1.1, 0.2, -0.05], [0.03, 0.9, 0.1], [-0.2, 0.04, 1.05]];

#[test]
fn homogeneous_deformation_is_found_exactly_everywhere() {
    // physics.md 4.8: exact for any family, surfaces too; sums of 80 bonds round to some 1e-15.
    for layout in [Layout::Auto, Layout::List] {
        for volume in [VolumeRule::Lammps, VolumeRule::None, VolumeRule::Full] {
            for found in gradients(&SKEW, layout, volume) {
                let found = found.unwrap();
                let off = found.iter().flatten().zip(SKEW.iter().flatten()).map(|(a, b)| (a - b).abs());
                assert!(off.fold(0.0, f64::max) < 1e-13);
            }
        }
    }
}

#[test]
fn a_rotation_has_no_strain_and_no_stress() {
    let (c, s) = (0.7f64.cos(), 0.7f64.sin());
    let turn = [[c, -s, 0.0], [s * c, c * c, -s], [s * s, s * c, c]];
    for f in gradients(&turn, Layout::Auto, VolumeRule::Lammps) {
        let f = f.unwrap();
        assert!(green_lagrange(&f).iter().all(|e| e.abs() < 1e-13));
        assert!(neo_hooke(&f, 2.0, 1.0).unwrap().iter().all(|e| e.abs() < 1e-12));
    }
}

/// A layer that stays in its plane z = 0 is not strained across it; one that leans has no gradient.
#[test]
fn flat_families_have_a_gradient_in_their_plane_alone() {
    for lean in [0.0, 0.3] {
        flat_family(lean);
    }
}

fn flat_family(lean: f64) {
    let at = |i: i32| [f64::from(i % 5), f64::from(i / 5), lean * f64::from(i % 5)];
    let x: Vec<[f64; 3]> = (0..25).map(at).collect();
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1.0, horizon: 2.015, s00: 1.0, alpha: 0.0 }).unwrap();
    let bounds = Bounds { lo: [-50.0; 3], hi: [50.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
    let view = PeriView { x: &x, x0: &x, kind: &[1; 25], volume: &[1.0; 25], bounds, excluded: None };
    let families = Families::build(&view, &table, FamilyOptions::new(1.0)).unwrap();
    let gradients: Vec<_> = (0..25).filter_map(|i| families.gradient(&view, i)).collect();
    assert_eq!(gradients.len(), if lean == 0.0 { 25 } else { 0 });
    for f in gradients {
        let unit = |a: usize, b: usize| if a == b { 1.0 } else { 0.0 };
        assert!((0..9).all(|k| (f[k / 3][k % 3] - unit(k / 3, k % 3)).abs() < 1e-13), "{f:?}");
    }
}
