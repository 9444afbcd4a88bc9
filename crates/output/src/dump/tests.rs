//! Snapshots as LAMMPS writes them.

use super::*;

/// The probe box of 12 spheres: periodic, fixed, shrink-wrapped.
const BOUNDS: [[f64; 2]; 3] = [[0.0, 2.0], [0.0, 2.0], [-2.2999999999999998e-04, 2.00023]];

fn lattice() -> Vec<[f64; 3]> {
    let site = |k: usize| [k % 2, k / 2 % 2, k / 4].map(|n| n as f64);
    (0..12).map(site).collect()
}

fn text(snapshot: &Snapshot<'_>) -> String {
    let mut out = vec![];
    snapshot.write(&mut out).unwrap();
    String::from_utf8(out).unwrap()
}

#[test]
fn atom_style_as_lammps() {
    // Written by LAMMPS 22Jul2025 with `dump_modify image yes sort id units yes time yes` (scaled).
    let expected = "\
ITEM: UNITS
lj
ITEM: TIME
0
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
12
ITEM: BOX BOUNDS pp ff ss
0.0000000000000000e+00 2.0000000000000000e+00
0.0000000000000000e+00 2.0000000000000000e+00
-2.2999999999999998e-04 2.0002300000000002e+00
ITEM: ATOMS id type xs ys zs ix iy iz
1 1 0 0 0.000114974 0 0 0
2 2 0.5 0 0.000114974 0 0 0
3 1 0 0.5 0.000114974 0 0 0
4 1 0.5 0.5 0.000114974 0 0 0
5 1 0 0 0.5 0 0 0
6 1 0.5 0 0.5 0 0 0
7 1 0 0.5 0.5 0 0 0
8 1 0.5 0.5 0.5 0 0 0
9 1 0 0 0.999885 0 0 0
10 1 0.5 0 0.999885 0 0 0
11 1 0 0.5 0.999885 0 0 0
12 1 0.5 0.5 0.999885 0 0 0
";
    let x = lattice();
    let int = |name, rule: fn(usize) -> i64| Field { name, format: None, data: Data::int(rule) };
    let scaled = |name, k: usize| {
        let (x, [lo, hi]) = (&x, BOUNDS[k]);
        Field { name, format: None, data: Data::float(move |i| (x[i][k] - lo) / (hi - lo)) }
    };
    let fields = [
        int("id", |i| i as i64 + 1),
        int("type", |i| if i == 1 { 2 } else { 1 }),
        scaled("xs", 0),
        scaled("ys", 1),
        scaled("zs", 2),
        int("ix", |_| 0),
        int("iy", |_| 0),
        int("iz", |_| 0),
    ];
    let mut rows: Vec<u32> = (0..12).rev().collect();
    sort_rows(&mut rows, &fields[0].data, false);
    let snapshot = Snapshot {
        header: true,
        item: "ATOMS",
        step: 0,
        time: Some(0.0),
        units: Some("lj"),
        tilt: None,
        bounds: BOUNDS,
        boundary: "pp ff ss",
        rows: &rows,
        fields: &fields,
    };
    assert_eq!(text(&snapshot), expected);
}

#[test]
fn custom_formats_and_sorting_as_lammps() {
    // LAMMPS 22Jul2025: `sort -3 format float %12.4f format 1 %05d format int %3d`, columns id type x xs.
    let expected = "\
00002   2       1.0000       0.5000
00004   1       1.0000       0.5000
00006   1       1.0000       0.5000
00008   1       1.0000       0.5000
00010   1       1.0000       0.5000
00012   1       1.0000       0.5000
00001   1       0.0000       0.0000
00003   1       0.0000       0.0000
00005   1       0.0000       0.0000
00007   1       0.0000       0.0000
00009   1       0.0000       0.0000
00011   1       0.0000       0.0000
";
    let [id, int, float] = ["%05d", "%3d", "%12.4f"].map(|f| Format::parse(f).unwrap());
    let x = lattice();
    let fields = [
        Field { name: "id", format: Some(&id), data: Data::int(|i| i as i64 + 1) },
        Field { name: "type", format: Some(&int), data: Data::int(|i| if i == 1 { 2 } else { 1 }) },
        Field { name: "x", format: Some(&float), data: Data::component(&x, 0) },
        Field { name: "xs", format: Some(&float), data: Data::float(|i| x[i][0] / 2.0) },
    ];
    let mut rows: Vec<u32> = (0..12).collect();
    sort_rows(&mut rows, &fields[2].data, true);
    let snapshot = Snapshot {
        header: true,
        item: "ATOMS",
        step: 0,
        time: None,
        units: None,
        tilt: None,
        bounds: BOUNDS,
        boundary: "pp ff ss",
        rows: &rows,
        fields: &fields,
    };
    assert_eq!(text(&snapshot).split_once("id type x xs\n").unwrap().1, expected);
}

#[test]
fn many_rows_come_in_order() {
    let n = 3 * BATCH / 2 + 17;
    let rows: Vec<u32> = (0..n as u32).collect();
    let fields = [Field { name: "id", format: None, data: Data::int(|i| i as i64) }];
    let snapshot = Snapshot {
        header: true,
        item: "ATOMS",
        step: 7,
        time: None,
        units: None,
        tilt: None,
        bounds: BOUNDS,
        boundary: "pp pp pp",
        rows: &rows,
        fields: &fields,
    };
    let all = text(&snapshot);
    let body = all.split_once("ATOMS id\n").unwrap().1;
    assert!(body.lines().enumerate().all(|(k, line)| line == k.to_string()));
    assert_eq!(body.lines().count(), n);
}

#[test]
fn targets() {
    let dir = tempfile::tempdir().unwrap();
    let read = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap();
    let pattern = |name: &str| Pattern::new(dir.path().join(name).to_str().unwrap()).unwrap();
    let mut one = Target::new(pattern("a.dump"));
    for step in [0, 5] {
        one.write(step, |w| writeln!(w, "{step}")).unwrap();
    }
    assert_eq!(read("a.dump"), "0\n5\n");
    one.close();
    one.write(9, |w| writeln!(w, "9")).unwrap();
    assert_eq!(read("a.dump"), "0\n5\n9\n");
    let mut fresh = Target::new(pattern("a.dump"));
    fresh.write(1, |w| writeln!(w, "1")).unwrap();
    assert_eq!(read("a.dump"), "1\n");
    let mut early = Target::new(pattern("a.dump"));
    early.begin().unwrap();
    assert_eq!(read("a.dump"), "", "what an earlier run has left");
    early.begin().unwrap();
    early.write(2, |w| writeln!(w, "2")).unwrap();
    early.begin().unwrap();
    assert_eq!(read("a.dump"), "2\n");
    let mut behind = Target { append: true, ..Target::new(pattern("a.dump")) };
    behind.begin().unwrap();
    behind.write(3, |w| writeln!(w, "3")).unwrap();
    assert_eq!(read("a.dump"), "2\n3\n");
    let mut many = Target::new(pattern("b.*.dump"));
    for step in [0, 5] {
        many.write(step, |w| writeln!(w, "{step}")).unwrap();
    }
    assert_eq!(read("b.0.dump") + &read("b.5.dump"), "0\n5\n");
    let torn = one.write(10, |_| Err(std::io::Error::other("full")));
    assert!(torn.is_err() && one.write(11, |_| Ok(())).is_err());
}
