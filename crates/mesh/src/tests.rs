//! Bodies within surfaces: contents, refusals, and files with arbitrary bytes.

use super::shapes::{ball, block, torus};
use super::*;
use perigrain_base::math::vec3::length;
use proptest::prelude::*;
use std::f64::consts::PI;

/// Pseudo-random numbers between 0 and 1.
fn numbers() -> impl FnMut() -> f64 {
    let mut state = 88172645463325252u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

#[test]
fn volumes_of_bodies() {
    let cube = Solid::new(block([1.0; 3], [3.0, 4.0, 5.0])).unwrap();
    assert_eq!((cube.volume(), cube.area(), cube.turned()), (24.0, 52.0, 0));
    assert_eq!(cube.bounds(), Some(([1.0; 3], [3.0, 4.0, 5.0])));
    // The volume of a polyhedral ball is too small by the square of the face size.
    let sphere = Solid::new(ball([5.0, 0.0, 0.0], 2.0, 5)).unwrap();
    assert!((sphere.volume() / (PI * 32.0 / 3.0) - 1.0).abs() < 2e-3, "{}", sphere.volume());
    let ring = Solid::new(torus(3.0, 1.0, 120, 60)).unwrap();
    assert!((ring.volume() / (6.0 * PI * PI) - 1.0).abs() < 3e-3, "{}", ring.volume());
}

#[test]
fn a_lattice_through_corners_and_edges_is_never_misjudged() {
    // Test points lie on faces, edges and corners, and rays from them run along faces and through edges and
    // corners.
    let solid = Solid::new(block([-2.0, -1.0, 0.0], [2.0, 3.0, 4.0])).unwrap();
    for i in -12..=12 {
        for j in -12..=12 {
            for k in -4..=20 {
                let x = [f64::from(i) * 0.25, f64::from(j) * 0.25, f64::from(k) * 0.25];
                let inside = x[0].abs() <= 2.0 && (-1.0..=3.0).contains(&x[1]) && (0.0..=4.0).contains(&x[2]);
                assert_eq!(solid.contains(x), inside, "{x:?}");
            }
        }
    }
    // An octahedron: |x| + |y| + |z| ≤ 2 is exact in quarters.
    let solid = Solid::new(ball([0.0; 3], 2.0, 0)).unwrap();
    for i in -9..=9i32 {
        for j in -9..=9i32 {
            for k in -9..=9i32 {
                let x = [f64::from(i) * 0.25, f64::from(j) * 0.25, f64::from(k) * 0.25];
                assert_eq!(solid.contains(x), i.abs() + j.abs() + k.abs() <= 8, "{x:?}");
            }
        }
    }
    // A ball of many triangles with corners and edges directly above test points.
    let (solid, mut next) = (Solid::new(ball([0.0; 3], 1.0, 4)).unwrap(), numbers());
    let edge = solid.triangles().to_vec();
    for t in &edge {
        for p in t {
            // Below and above corners, slightly inside and outside.
            assert!(solid.contains(p.map(|x| x * 0.999)) && !solid.contains(p.map(|x| x * 1.001)), "{p:?}");
            assert!(solid.contains(*p));
            let z = p[2] * (next() - 0.5);
            assert!(solid.contains([p[0], p[1], z]), "{p:?} {z}");
        }
    }
}

#[test]
fn places_agree_with_the_ball_and_the_ring() {
    let mut next = numbers();
    let (r, times) = (1.0, 5);
    let sphere = Solid::new(ball([0.0; 3], r, times)).unwrap();
    // The faces are at most this far within the sphere: a quarter of the square of the longest edge, 0.05,
    // over twice the radius.
    let slack = 0.002;
    let ring = Solid::new(torus(1.0, 0.4, 200, 100)).unwrap();
    let (mut sphere_holds, mut ring_holds) = (0, 0);
    for _ in 0..20_000 {
        let x = [0, 1, 2].map(|_| 3.0 * next() - 1.5);
        let d = length(x) - r;
        if d.abs() > slack {
            assert_eq!(sphere.contains(x), d < 0.0, "{x:?}");
            sphere_holds += usize::from(d < 0.0);
        }
        let d = (x[0].hypot(x[1]) - 1.0).hypot(x[2]) - 0.4;
        if d.abs() > slack {
            assert_eq!(ring.contains(x), d < 0.0, "{x:?}");
            ring_holds += usize::from(d < 0.0);
        }
    }
    assert!(sphere_holds > 1000 && ring_holds > 1000);
}

#[test]
fn wrong_orders_are_turned_and_holes_are_holes() {
    let mut shell = [ball([0.0; 3], 2.0, 2), ball([0.0; 3], 1.0, 2)].concat();
    let right = Solid::new(shell.clone()).unwrap();
    // The inner surface is a hole: half of all triangles.
    assert_eq!(right.turned(), shell.len() / 2);
    assert!(!right.contains([0.5, 0.0, 0.0]) && right.contains([1.5, 0.0, 0.0]));
    shell.iter_mut().step_by(3).for_each(|t| t.swap(0, 1));
    let mended = Solid::new(shell).unwrap();
    // A different order of corners: different rounding of 512 terms.
    assert!((mended.volume() / right.volume() - 1.0).abs() < 1e-13);
    let inward = block([0.0; 3], [1.0; 3]).into_iter().map(|[a, b, c]| [a, c, b]).collect();
    let cube = Solid::new(inward).unwrap();
    // Twelve terms, each rounded.
    assert!((cube.volume() - 1.0).abs() < 12.0 * f64::EPSILON && cube.turned() == 12);
}

/// A surface as read from a file.
fn surface(triangles: Vec<Triangle>) -> Surface {
    Surface { name: String::new(), format: Format::Obj, triangles, left_out: vec![], comments: 0 }
}

#[test]
fn triangles_without_area_are_left_out_and_numbers_are_the_file_s() {
    let cube = block([0.0; 3], [1.0; 3]);
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let mut all = cube.clone();
    [12, 4, 0].into_iter().for_each(|k| all.insert(k, flat));
    let mut read = surface(all);
    read.leave_out_flat();
    assert_eq!((&read.triangles, &read.left_out[..]), (&cube, &[0, 5, 14][..]));
    assert_eq!([0, 3, 4, 11].map(|k| read.number(k)), [2, 5, 7, 14]);
    assert!(Fault::Open(1, [4, 0]).text(&read).ends_with("at triangle 7"));
    assert_eq!(Solid::new(read.triangles), Solid::new(cube));
}

#[test]
fn what_is_no_body_is_named() {
    let cube = block([0.0; 3], [1.0; 3]);
    let fault = |t: Vec<Triangle>| Solid::new(t).unwrap_err();
    assert_eq!(fault(vec![]), Fault::Empty);
    let mut open = cube.clone();
    let lid = open.remove(3);
    // Without the second half of the lid three edges are open, the first of them the third side of the other
    // half.
    assert_eq!(fault(open.clone()), Fault::Open(3, [2, 2]));
    assert_eq!(
        Fault::Open(3, [2, 2]).text(&surface(open.clone())),
        "it is not closed: 3 edges border one triangle only, the first from (1 1 1) to (0 0 1) at triangle 3"
    );
    assert_eq!(fault([open, vec![lid, lid, lid]].concat()), Fault::Crowded(3, [2, 2]));
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    assert_eq!(fault([cube.clone(), vec![flat]].concat()), Fault::Flat(12));
    let crossing = |lo, hi| fault([cube.clone(), block(lo, hi)].concat());
    assert!(matches!(crossing([0.5; 3], [1.5; 3]), Fault::Crossing(n, _) if n > 0));
    // The same block shifted along x: its edges run within faces. And one standing on the lid.
    assert!(matches!(crossing([0.5, 0.0, 0.0], [1.5, 1.0, 1.0]), Fault::Crossing(..) | Fault::Crowded(..)));
    assert!(matches!(crossing([0.2, 0.2, 1.0], [0.7, 0.6, 2.0]), Fault::Crossing(..)));
    assert!(Solid::new([cube.clone(), block([1.5; 3], [2.0; 3])].concat()).is_ok());
    // Two identical triangles.
    let t = cube[0];
    assert!(matches!(fault(vec![t, [t[0], t[2], t[1]]]), Fault::Crossing(1, [0, 1])));
}

#[test]
fn surfaces_of_one_side_are_refused() {
    // The projective plane with six corners is one-sided; it must intersect itself in space, which is not
    // tested here.
    let p = |k: usize| [k as f64, (k * k) as f64, (k * k * k) as f64];
    let faces = [
        [0, 1, 2],
        [0, 2, 3],
        [0, 3, 4],
        [0, 4, 5],
        [0, 5, 1],
        [1, 2, 4],
        [2, 3, 5],
        [3, 4, 1],
        [4, 5, 2],
        [5, 1, 3],
    ];
    let mut t: Vec<Triangle> = faces.iter().map(|f| f.map(p)).collect();
    let sides = check::closed(&t).unwrap();
    let tree = tree::Tree::new(&t);
    assert!(matches!(sides.orient(&mut t, &tree), Err(Fault::OneSided(_))));
}

#[test]
fn sheets_cut_what_crosses_them() {
    let [a, b, c, d] = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [2.0, 2.0, 1.0], [0.0, 2.0, 1.0]];
    // Two triangles with opposite orientation.
    let sheet = Sheet::from(vec![[a, b, c], [a, d, c]]);
    let cuts = |x: [f64; 3], y: [f64; 3]| {
        assert_eq!(sheet.cuts(x, y), sheet.cuts(y, x));
        sheet.cuts(x, y)
    };
    assert!(cuts([0.5, 0.2, 0.0], [0.5, 0.2, 2.0]) && cuts([0.2, 0.5, 0.0], [0.4, 0.6, 1.5]));
    // Through the common edge, and through the rim; beside it.
    assert!(cuts([1.0, 1.0, 0.0], [1.0, 1.0, 2.0]) && cuts([2.0, 1.0, 0.0], [2.0, 1.0, 2.0]));
    assert!(!cuts([2.1, 1.0, 0.0], [2.1, 1.0, 2.0]) && !cuts([0.5, 0.5, 1.5], [1.5, 0.5, 1.1]));
    // Points on the sheet count as above it, on either triangle.
    for (x, y) in [(1.5, 0.5), (0.5, 1.5), (1.0, 1.0)] {
        assert!(cuts([x, y, 1.0], [x, y, 0.5]) && !cuts([x, y, 1.0], [x, y, 1.5]));
    }
    assert!(!cuts([0.5, 0.2, 1.0], [1.5, 0.3, 1.0]));
}

#[test]
fn parts_in_boxes_add_up_to_the_whole() {
    // A block from (0.3, 0.3, 0.3) in cells around integers, halved, and in left-handed, skew coordinates.
    let cube = Solid::new(block([0.3; 3], [2.3, 1.5, 2.0])).unwrap();
    let plain = cube.columns(|x| x);
    let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} {b}");
    near(plain.volume([-0.5; 3], [0.5; 3]), 0.008);
    near(plain.volume([0.5; 3], [1.5; 3]), 1.0);
    near(plain.volume([1.5, 0.5, 1.5], [2.5, 1.5, 2.5]), 0.8 * 0.5);
    near(plain.volume([5.0; 3], [6.0; 3]), 0.0);
    // Common faces: the whole, and nothing above, below and beside it.
    let (lo, hi) = cube.bounds().unwrap();
    near(plain.volume(lo, hi), cube.volume());
    for d in 0..3 {
        let (mut below, mut above) = (hi, lo);
        (below[d], above[d]) = (lo[d], hi[d]);
        near(plain.volume(lo.map(|x| x - 1.0), below), 0.0);
        near(plain.volume(above, hi.map(|x| x + 1.0)), 0.0);
    }
    near(cube.columns(|[x, y, z]| [y + 0.5 * x, x, z]).volume([-9.0; 3], [9.0; 3]), cube.volume());
    let ring = Solid::new(torus(3.0, 1.0, 40, 20)).unwrap();
    let columns = ring.columns(|x| x);
    let mut sum = 0.0;
    for k in 0..9 * 9 * 5 {
        let lo = [k % 9, k / 9 % 9, k / 81].map(f64::from);
        let lo = [lo[0] - 4.5, lo[1] - 4.5, lo[2] - 2.5];
        let part = columns.volume(lo, lo.map(|x| x + 1.0));
        assert!(part <= 1.0 + 1e-14);
        sum += part;
    }
    // The sum over 405 boxes, each with rounding errors of 1e-16.
    assert!((sum / ring.volume() - 1.0).abs() < 1e-13, "{sum} {}", ring.volume());
}

#[test]
fn a_copy_from_its_triangles_is_the_same() {
    let ring = Solid::new(torus(1.0, 0.4, 12, 8)).unwrap();
    let copy = Solid::try_from(Vec::from(ring.clone())).unwrap();
    assert!(ring == copy && copy.contains([1.0, 0.0, 0.0]) && !copy.contains([0.0; 3]));
    assert!(!Solid::default().contains([0.0; 3]) && Solid::default().volume() == 0.0);
    assert!(Solid::try_from(vec![[[f64::NAN; 3]; 3]]).is_err());
}

/// Bytes that resemble one of the formats and contain errors.
fn files() -> impl Strategy<Value = (String, Vec<u8>)> {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_index\nend_header\n0123456789abcdefghijklmnopqrstuvwxyz\x03\0\0\0\0\x01\0\0\0\x02\0\0\0";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    let vtp = "<VTKFile type='PolyData' header_type='UInt32'><PolyData><Piece><Points><DataArray type='Float32' format='appended' offset='0'/>\
               </Points><Polys><DataArray type='Int32' Name='connectivity' format='binary'>DAAAAAAAAAABAAAAAgAAAA==</DataArray>\
               <DataArray type='Int32' Name='offsets' format='ascii'>3</DataArray></Polys></Piece></PolyData><AppendedData encoding='raw'>_\
               \x24\0\0\0aaaabbbbccccddddeeeeffffgggghhhhiiii</AppendedData></VTKFile>";
    let zlib = vtp.replace("header_type", "compressor='vtkZLibDataCompressor' header_type");
    let known: Vec<(&str, Vec<u8>)> = vec![
        ("a.obj", obj.into()),
        ("a.ply", ply.into()),
        ("a.stl", stl.into()),
        ("a.vtp", vtp.into()),
        ("a.vtp", zlib.into_bytes()),
    ];
    let changes = prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6);
    (prop::sample::select(known), changes, any::<prop::sample::Index>(), any::<bool>()).prop_map(
        |((name, mut bytes), changes, end, cut)| {
            for (at, to) in changes {
                let k = at.index(bytes.len());
                bytes[k] = to;
            }
            if cut {
                bytes.truncate(end.index(bytes.len()));
            }
            (name.to_string(), bytes)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn no_file_makes_the_reader_panic((name, bytes) in files()) {
        if let Ok(surface) = read(&name, &bytes) {
            let _ = Sheet::from(surface.triangles.clone()).cuts([0.1; 3], [0.9; 3]);
            if let Err(fault) = Solid::new(surface.triangles.clone()) {
                prop_assert!(!fault.text(&surface).is_empty());
            }
        }
    }

    #[test]
    fn neither_do_bytes_of_any_kind(bytes in prop::collection::vec(any::<u8>(), 0..300), name in "[a.](obj|ply|stl|vtp)?") {
        let _ = read(&name, &bytes);
    }
}
