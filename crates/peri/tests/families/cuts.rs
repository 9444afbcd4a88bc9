//! Bonds cut by hand.

use perigrain_peri::families::*;

#[test]
fn a_plane_parts_a_row() {
    let x: Vec<[f64; 3]> = (0..10).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let mut table = PmbTable::new(1);
    table.set(1, 1, PmbCoeff { c: 1.0, horizon: 2.5, s00: 1.0, alpha: 0.0 }).unwrap();
    let bounds = Bounds { lo: [-20.0; 3], hi: [20.0; 3], periodic: [false; 3], tilt: [0.0; 3] };
    let view = PeriView { x: &x, x0: &x, kind: &[1; 10], volume: &[1.0; 10], bounds, excluded: None };
    for layout in [Layout::Auto, Layout::List] {
        let options = FamilyOptions { layout, ..FamilyOptions::new(1.0) };
        let mut families = Families::build(&view, &table, options).unwrap();
        let before = families.live_bonds();
        // Between 4 and 5: the bonds 3-5, 4-5 and 4-6.
        assert_eq!(families.cut(&view, |a, b| (a[0] - 4.5) * (b[0] - 4.5) < 0.0), 3);
        assert_eq!(families.live_bonds(), before - 6);
        assert!(families.damage(4, &[1.0; 10]) == 0.5 && families.damage(0, &[1.0; 10]) == 0.0);
    }
}
