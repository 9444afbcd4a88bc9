//! Bodies, walls and cracks from surfaces in files: what each kind of file gives, volumes of what is filled, cuts.

use perigrain::session::{Options, Session};
use perigrain::world::World;
use perigrain_world::region::Shape;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::fs;
use std::path::Path;

type Triangle = [[f64; 3]; 3];

fn world(folder: &Path, deck: &str) -> World {
    let options = Options { folder: folder.to_path_buf(), ..Options::default() };
    let mut session = Session::new(options).unwrap();
    session.run_text("in.deck", deck).map(drop).unwrap_or_else(|e| panic!("{deck}: {e}"));
    session.world
}

/// A ring about z of 32 × 16 squares, or, without a ring, a ball of 32 × 16.
fn round(ring: f64, tube: f64) -> Vec<Triangle> {
    let (m, n) = (32, 16);
    let at = |i: usize, j: usize| {
        let u = TAU * (i % m) as f64 / m as f64;
        let v = if ring > 0.0 { TAU * (j % n) as f64 / n as f64 } else { PI * (j as f64 / n as f64 - 0.5) };
        let pole = ring == 0.0 && (j == 0 || j == n);
        let r = if pole { 0.0 } else { ring + tube * v.cos() };
        [r * u.cos() + 0.0, r * u.sin() + 0.0, tube * v.sin()]
    };
    let mut t = vec![];
    for i in 0..m {
        for j in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            t.extend([[a, b, c], [a, c, d]].into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
        }
    }
    t
}

fn cube(half: f64) -> Vec<Triangle> {
    let p = |k: usize| [0, 1, 2].map(|d| if k >> d & 1 == 0 { -half } else { half });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    faces.into_iter().flat_map(|[a, b, c, d]| [[p(a), p(b), p(c)], [p(a), p(c), p(d)]]).collect()
}

/// Writes triangles as STL, OBJ, PLY and VTP, each corner by itself; the names.
fn written(folder: &Path, name: &str, triangles: &[Triangle]) -> [String; 4] {
    let points: Vec<String> =
        triangles.as_flattened().iter().map(|[x, y, z]| format!("{x:?} {y:?} {z:?}")).collect();
    let n = triangles.len();
    let mut stl = String::from("solid body\n");
    for t in points.chunks(3) {
        let corners: String = t.iter().map(|p| format!("vertex {p}\n")).collect();
        write!(stl, "facet normal 0 0 0\nouter loop\n{corners}endloop\nendfacet\n").unwrap();
    }
    stl += "endsolid body\n";
    let mut obj: String = points.iter().map(|p| format!("v {p}\n")).collect();
    (0..n).for_each(|k| writeln!(obj, "f {} {} {}", 3 * k + 1, 3 * k + 2, 3 * k + 3).unwrap());
    let mut ply = format!(
        "ply\nformat binary_big_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {n}\nproperty list uchar uint vertex_indices\nend_header\n",
        3 * n
    )
    .into_bytes();
    triangles.as_flattened().as_flattened().iter().for_each(|x| ply.extend(x.to_be_bytes()));
    for k in 0..n as u32 {
        ply.push(3);
        (0..3).for_each(|c| ply.extend((3 * k + c).to_be_bytes()));
    }
    let (corners, ends): (Vec<_>, Vec<_>) =
        ((0..3 * n).map(|k| k.to_string()).collect(), (1..=n).map(|k| (3 * k).to_string()).collect());
    let vtp = format!(
        "<VTKFile type=\"PolyData\"><PolyData><Piece><Points><DataArray type=\"Float64\" format=\"ascii\">{}</DataArray>\
         </Points><Polys><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">{}</DataArray><DataArray type=\"Int64\" \
         Name=\"offsets\" format=\"ascii\">{}</DataArray></Polys></Piece></PolyData></VTKFile>",
        points.join(" "),
        corners.join(" "),
        ends.join(" ")
    );
    let names = ["stl", "obj", "ply", "vtp"].map(|kind| format!("{name}.{kind}"));
    for (name, bytes) in names.iter().zip([stl.into_bytes(), obj.into_bytes(), ply, vtp.into_bytes()]) {
        fs::write(folder.join(name), bytes).unwrap();
    }
    names
}

fn volume(w: &World, region: &str) -> f64 {
    let Shape::Mesh(solid) = &w.regions[region].shape else { panic!("{region} is no mesh") };
    solid.volume()
}

/// A box around the origin with a lattice of `spacing`, and a region `body`.
fn scene(spacing: f64, origin: &str, region: &str) -> String {
    format!(
        "units si\natom_style peri\natom_modify map array\nlattice sc {spacing} origin {origin}\nregion box block -3 3 -3 3 -3 3 units box\n\
         create_box 1 box\nregion body {region} units box\n"
    )
}

/// Total volume, its centre, and the second moments about the axes of particles with volumes.
fn moments(w: &World) -> (f64, [f64; 3], [f64; 3]) {
    let p = &w.particles;
    let sum = |f: &dyn Fn(usize) -> f64| (0..p.len()).map(|i| f(i) * p.volume[i]).sum::<f64>();
    let all = sum(&|_| 1.0);
    let center = [0, 1, 2].map(|d| sum(&|i| p.x[i][d]) / all);
    let about = [0, 1, 2].map(|d| {
        let square =
            |i: usize| (0..3).filter(|e| *e != d).map(|e| (p.x[i][e] - center[e]).powi(2)).sum::<f64>();
        sum(&square)
    });
    (all, center, about)
}

/// Volume and second moments about the axes of what triangles enclose: sums over tetrahedra from the origin, of which one with
/// corners 0, a, b, c has V/10 (a² + b² + c² + ab + bc + ca) along each axis.
fn enclosed(triangles: &[Triangle]) -> (f64, [f64; 3]) {
    let (mut volume, mut along) = (0.0, [0.0; 3]);
    for [a, b, c] in triangles {
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        let own = (0..3).map(|d| a[d] * cross[d]).sum::<f64>() / 6.0;
        volume += own;
        for d in 0..3 {
            let (a, b, c) = (a[d], b[d], c[d]);
            along[d] += own / 10.0 * (a * a + b * b + c * c + a * b + b * c + c * a);
        }
    }
    (volume, [along[1] + along[2], along[2] + along[0], along[0] + along[1]])
}

// Volumes that the writers give (tests/meshes/README.md); STL and VTK's rings have numbers of seven digits.
#[test]
fn files_of_other_programs_are_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    let files = [
        ("trimesh_ball.stl", 80, 12.348153703728542, 1e-6),
        ("trimesh_ring.obj", 256, 19.48305960526309, 1e-7),
        ("meshio_tube.ply", 96, 13.5, 1e-14),
        ("meshio_block.obj", 12, 6.0, 1e-14),
        ("vtk_ring.vtp", 210, 8.347487401271893, 1e-6),
        ("vtk_block.vtp", 12, 6.0, 1e-14),
    ];
    for (file, count, wanted, tolerance) in files {
        let w = world(&folder, &format!("units si\nregion body mesh {file} units box\n"));
        let Shape::Mesh(solid) = &w.regions["body"].shape else { panic!("{file}") };
        assert_eq!(solid.triangles().len(), count, "{file}");
        assert!((solid.volume() / wanted - 1.0).abs() < tolerance, "{file}: {}", solid.volume());
    }
    let deck = "units si\nregion body mesh trimesh_ball.stl shift -3 -2 -1 scale 2 units box\n";
    let w = world(&folder, deck);
    assert!((volume(&w, "body") / 8.0 / 12.348153703728542 - 1.0).abs() < 1e-6);
}

#[test]
fn filled_bodies_have_volume_centre_and_inertia() {
    let folder = tempfile::tempdir().unwrap();
    // What smooth bodies have about x and z; faces of 32 × 16 squares lie within them, 2 % of the volume for the ball and
    // 4 % for the ring. A lump at a site in place of a part of a cell adds 1 % at most.
    let ball = (4.0 / 3.0 * PI * 8.0, [0.4 * 4.0; 2]);
    let ring = (TAU * PI * 2.0 * 0.5625, [0.5 * 4.0 + 0.625 * 0.5625, 4.0 + 0.75 * 0.5625]);
    let block = (27.0, [1.5; 2]);
    for (name, body, (smooth, squares), coarse) in [
        ("ball", round(0.0, 2.0), ball, 0.04),
        ("ring", round(2.0, 0.75), ring, 0.07),
        ("cube", cube(1.5), block, 1e-12),
    ] {
        let (enclosed_volume, enclosed_about) = enclosed(&body);
        let mut first = None;
        for file in written(folder.path(), name, &body) {
            let deck = scene(0.21, "0.3 0.1 0.45", &format!("mesh {file}"));
            let w = world(folder.path(), &format!("{deck}create_atoms 1 region body volumes cut\n"));
            let (all, center, about) = moments(&w);
            // Cells are cut exactly.
            assert!((all / volume(&w, "body") - 1.0).abs() < 1e-12, "{file}: {all}");
            assert!((all / smooth - 1.0).abs() < coarse, "{file}: {all} {smooth}");
            assert!(center.iter().all(|x| x.abs() < 2e-3 * 2.0), "{file}: {center:?}");
            for (d, k) in [(0, 0), (2, 1)] {
                let off = about[d] / (all * squares[k]) - 1.0;
                assert!(off.abs() < coarse + 0.02, "{file}: moment {d} off by {off}");
            }
            // Of the body with its faces the volume is exact. Points lack what their cells have about their own middles, h²/6
            // of each volume. What is left is that a piece of thickness t is at its site, (h − t)/2 from its middle, h²/8 of
            // the area at most: of the cube, whose faces cut all cells alike, 2 · 9 · 3 h²/8 of 27 · 0.75, 1.5 %; round bodies
            // cut theirs in all ways, which takes nine tenths of it away.
            assert!((all / enclosed_volume - 1.0).abs() < 1e-12, "{file}: {all} {enclosed_volume}");
            let lumps = if name == "cube" { 1.5e-2 } else { 1.5e-3 };
            for d in 0..3 {
                let off = (about[d] + all * 0.21 * 0.21 / 6.0) / enclosed_about[d] - 1.0;
                assert!(off.abs() < lumps, "{file}: moment {d} off by {off}");
            }
            assert!(w.particles.volume.iter().all(|v| *v > 0.0 && *v < 4.0 * 0.21f64.powi(3)), "{file}");
            let columns = (w.particles.x.to_vec(), w.particles.volume.to_vec());
            match &first {
                None => first = Some(columns),
                Some(first) => assert!(*first == columns, "{file} differs"),
            }
        }
    }
}

#[test]
fn cells_that_end_at_the_faces_are_whole() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), "cube", &cube(1.5));
    for region in ["mesh cube.ply", "block -1.5 1.5 -1.5 1.5 -1.5 1.5"] {
        let deck = scene(0.25, "0.5 0.5 0.5", region);
        let w = world(folder.path(), &format!("{deck}create_atoms 1 region body volumes cut\n"));
        let whole = 0.25f64.powi(3);
        assert!(
            w.n() == 1728 && w.particles.volume.iter().all(|v| (v / whole - 1.0).abs() < 1e-12),
            "{region}"
        );
        // The closed form, 27 · (3² + 3²)/12, but for what the cells have about their own middles.
        let (all, _, about) = moments(&w);
        assert!(about.iter().all(|i| ((i + all * 0.0625 / 6.0) / 40.5 - 1.0).abs() < 1e-12), "{about:?}");
    }
}

#[test]
fn volumes_of_other_regions_add_up_too() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), "ball", &round(0.0, 1.0));
    let ball = |r: f64| 4.0 / 3.0 * PI * r * r * r;
    let cases = [
        ("sphere 0.1 0.2 0.3 2", ball(2.0)),
        ("cylinder z 0 0 1.234 -2 1.77", PI * 1.234 * 1.234 * 3.77),
        // Faces just before and behind sites.
        ("block -1.05 0.931 -1 1.049 -0.731 1.222", 1.981 * 2.049 * 1.953),
        // What lies outside of the box is none of it.
        ("sphere 3 0 0 1.5", ball(1.5) / 2.0),
        ("sphere 0 0 0 2 side out", 216.0 - ball(2.0)),
    ];
    for lattice in ["sc 0.2", "fcc 0.3", "bcc 0.25 orient x 1 1 0 orient y -1 1 0"] {
        for (region, wanted) in cases {
            let deck =
                scene(0.2, "0.3 0.1 0.45", region).replace("lattice sc 0.2", &format!("lattice {lattice}"));
            let w = world(folder.path(), &format!("{deck}create_atoms 1 region body volumes cut\n"));
            let all: f64 = w.particles.volume.iter().sum();
            assert!((all / wanted - 1.0).abs() < 1e-3, "{lattice}, {region}: {all} {wanted}");
        }
    }
    // A box that repeats, filled by its own region: whole cells.
    let deck =
        scene(0.2, "0 0 0", "block -3 3 -3 3 -3 3").replace("atom_style", "boundary p p p\natom_style");
    let w = world(folder.path(), &format!("{deck}create_atoms 1 region body volumes cut\n"));
    assert!(w.n() == 27_000 && w.particles.volume.iter().all(|v| (v / 0.008 - 1.0).abs() < 0.01));
    let all: f64 = w.particles.volume.iter().sum();
    assert!((all / 216.0 - 1.0).abs() < 1e-3, "{all}");
    // A mesh within a union, which has no exact cut, and the same body twice: as much as the mesh.
    let deck = scene(0.15, "0.3 0.1 0.45", "mesh ball.obj");
    let deck = format!("{deck}region small sphere 0 0 0 0.2 units box\nregion both union 2 body small\n");
    let w = world(folder.path(), &format!("{deck}create_atoms 1 region both volumes cut\n"));
    let all: f64 = w.particles.volume.iter().sum();
    assert!((all / volume(&w, "body") - 1.0).abs() < 1e-3, "{all}");
}

#[test]
fn sites_of_a_mesh_are_those_of_the_shape() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), "cube", &cube(1.5));
    // The lattice's sites lie on the faces too.
    for lattice in ["sc 0.25", "fcc 0.5", "bcc 0.75"] {
        let of = |region: &str| {
            let deck = scene(0.25, "0 0 0", region).replace("lattice sc 0.25", &format!("lattice {lattice}"));
            let w = world(folder.path(), &format!("{deck}create_atoms 1 region body\n"));
            w.particles.x.to_vec()
        };
        let block = of("block -1.5 1.5 -1.5 1.5 -1.5 1.5");
        assert!(
            block.len() > 100 && of("mesh cube.obj") == block && of("mesh cube.stl") == block,
            "{lattice}"
        );
    }
    // Turned and shifted by variables, and outside: as the block.
    let of = |region: &str| {
        let deck = scene(0.23, "0.5 0.5 0.5", "block 0 1 0 1 0 1");
        let turned = "move v_d NULL v_a rotate v_a 0.1 0 0 1 2 3";
        let deck = format!(
            "{deck}variable a equal 0.4\nvariable d equal 0.7\nregion it {region} units box {turned}\ncreate_atoms 1 region it\n"
        );
        let w = world(folder.path(), &deck);
        w.particles.x.to_vec()
    };
    for side in ["in", "out"] {
        let block = of(&format!("block -1.5 1.5 -1.5 1.5 -1.5 1.5 side {side}"));
        assert!(block.len() > 1000 && of(&format!("mesh cube.vtp side {side}")) == block, "{side}");
    }
}

#[test]
fn a_surface_cuts_the_bonds_that_cross_it() {
    let folder = tempfile::tempdir().unwrap();
    let square = [
        [[0.5, -9.0, -9.0], [0.5, 9.0, -9.0], [0.5, 9.0, 9.0]],
        [[0.5, -9.0, -9.0], [0.5, -9.0, 9.0], [0.5, 9.0, 9.0]],
    ];
    written(folder.path(), "square", &square);
    let deck = |crack: &str| {
        format!(
            "units si\natom_style peri\natom_modify map array\nlattice sc 1.0\nregion box block -4 4 -4 4 -4 4\ncreate_box 1 box\n\
             create_atoms 1 box\nset group all density 1\nset group all volume 1\npair_style peri/pmb\npair_coeff * * 1 2.5 0.1 0\n\
             fix 1 all nve\ntimestep 1e-3\n{crack}\ncompute d all damage/atom\ncompute s all reduce sum c_d\nthermo_style custom step c_s\n\
             run 0\nvariable s equal c_s\nprint \"$(v_s:%.12g)\"\n"
        )
    };
    let damage = |crack: &str| {
        let w = world(folder.path(), &deck(crack));
        let f = w.families.as_ref().unwrap();
        (0..w.n()).map(|i| f.damage(i, &w.particles.volume)).collect::<Vec<f64>>()
    };
    let plane = damage("peri_crack plane 0.5 0 0 1 0 0");
    assert!(plane.iter().sum::<f64>() > 10.0);
    for kind in ["stl", "obj", "ply", "vtp"] {
        assert!(damage(&format!("peri_crack mesh square.{kind}")) == plane, "{kind}");
    }
    // Through particles: a plane takes them for what lies in front of its normal, and so does a surface.
    assert!(damage("peri_crack plane 0 0 0 1 0 0") == damage("peri_crack mesh square.obj shift -0.5 0 0"));
    // Part of a plane: half of the square, up to z = −0.3 or so; and a slit that reaches the same place.
    let slit = damage(
        "region low block INF INF INF INF INF -0.3 units box\npair_coeff * * 1 2.5 0.1 0\nperi_crack plane 0.5 0 0 1 0 0 region low",
    );
    assert!(damage("peri_crack mesh square.obj scale 1 shift 0 0 -9.3") == slit);
}

#[test]
fn walls_of_all_files_and_of_regions_push_alike() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), "cube", &cube(1.5));
    let force = |wall: &str| {
        let deck = format!(
            "units si\natom_style sphere\natom_modify map array\nregion box block -3 3 -3 3 -3 3 units box\ncreate_box 1 box\n\
             create_atoms 1 single 1.2 0.3 -1.25 units box\ncreate_atoms 1 single 0.2 1.7 0.1 units box\nset group all diameter 0.8\n\
             region block block -1.5 1.5 -1.5 1.5 -1.5 1.5 units box\nregion body mesh cube.ply units box\n\
             region out block -1.5 1.5 -1.5 1.5 -1.5 1.5 units box side out\nregion away mesh cube.ply units box side out\n\
             pair_style granular\npair_coeff * * hooke 1 0 tangential linear_nohistory 0 0\nfix 1 all nve/sphere\n\
             fix w all {wall}\ntimestep 1e-3\nrun 0\n"
        );
        world(folder.path(), &deck).particles.f.to_vec()
    };
    let law = "granular hooke 1000 0 tangential linear_nohistory 0 0";
    let both = force(&format!("wall/mesh {law} mesh cube.stl"));
    // Calculated by hand: overlaps 0.1 and 0.15 with two faces from inside, 0.2 with one from outside.
    let wanted = [[-100.0, 0.0, 150.0], [0.0, 200.0, 0.0]];
    let off = both.as_flattened().iter().zip(wanted.as_flattened()).map(|(a, b)| (a - b).abs());
    assert!(off.fold(0.0, f64::max) < 1e-10, "{both:?}");
    for kind in ["obj", "ply", "vtp"] {
        assert_eq!(force(&format!("wall/mesh {law} mesh cube.{kind}")), both, "{kind}");
    }
    for (mesh, block) in [("body", "block"), ("away", "out")] {
        let [a, b] = [mesh, block].map(|r| force(&format!("wall/gran/region {law} region {r}")));
        let off = a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-10, "{mesh}: {a:?} {b:?}");
    }
}

#[test]
fn a_restart_file_has_the_body() {
    let folder = tempfile::tempdir().unwrap();
    written(folder.path(), "ring", &round(1.0, 0.5));
    let deck = scene(0.2, "0.3 0.1 0.45", "mesh ring.obj");
    let file = folder.path().join("a.restart").display().to_string();
    let before = world(
        folder.path(),
        &format!("{deck}create_atoms 1 region body volumes cut\nwrite_restart {file}\n"),
    );
    let after = world(folder.path(), &format!("read_restart {file}\n"));
    assert!(before.regions["body"] == after.regions["body"] && volume(&after, "body") > 1.0);
    assert!(before.particles.volume == after.particles.volume);
}
