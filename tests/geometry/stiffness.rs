//! Young's modulus inside of bodies from files: jittered points, meshes of hexahedra and tetrahedra, voxels in blocks.

use super::{files, world};
use std::fmt::Write as _;
use std::fs;

/// Edge of the bodies: whole families around what is measured, which are the particles a little more than a horizon inside.
const EDGE: usize = 13;

/// A number from -1 to 1 that belongs to a place.
fn jitter(k: usize) -> f64 {
    let mut s = (k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    s = (s ^ s >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    s = (s ^ s >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((s ^ s >> 31) >> 11) as f64 / f64::powi(2.0, 52) - 1.0
}

/// Points of a grid, each shifted by a fifth of the spacing at most.
fn points() -> String {
    let mut text = "x,y,z,volume\n".to_string();
    for k in 0..EDGE.pow(3) {
        let at = [k % EDGE, k / EDGE % EDGE, k / EDGE / EDGE];
        let x = [0, 1, 2].map(|d| at[d] as f64 + 0.5 + 0.2 * jitter(3 * k + d));
        let _ = writeln!(text, "{},{},{},1", x[0], x[1], x[2]);
    }
    text
}

/// A grid of hexahedra, the corners inside shifted by a fifth of the edge at most; or each as six tetrahedra of an edge `h`.
fn mesh(tetrahedra: bool) -> String {
    const SIX: [[usize; 4]; 6] =
        [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]];
    // Six tetrahedra take the room of one cube: with that edge they are as large as the cubes are otherwise.
    let (n, h) = if tetrahedra { (7, EDGE as f64 / 7.0) } else { (EDGE, 1.0) };
    let m = n + 1;
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", m.pow(3));
    for k in 0..m.pow(3) {
        let at = [k % m, k / m % m, k / m / m];
        let inner = at.iter().all(|a| *a > 0 && *a < n);
        let x = [0, 1, 2].map(|d| h * (at[d] as f64 + if inner { 0.2 * jitter(3 * k + d) } else { 0.0 }));
        let _ = writeln!(text, "{} {} {} {}", k + 1, x[0], x[1], x[2]);
    }
    let count = n.pow(3) * if tetrahedra { 6 } else { 1 };
    let _ = writeln!(text, "$EndNodes\n$Elements\n{count}");
    let mut id = 0;
    for k in 0..n.pow(3) {
        let [i, j, l] = [k % n, k / n % n, k / n / n];
        let at = |a: usize, b: usize, c: usize| 1 + i + a + m * (j + b + m * (l + c));
        let eight = [
            at(0, 0, 0),
            at(1, 0, 0),
            at(1, 1, 0),
            at(0, 1, 0),
            at(0, 0, 1),
            at(1, 0, 1),
            at(1, 1, 1),
            at(0, 1, 1),
        ];
        let cells: Vec<Vec<usize>> = match tetrahedra {
            false => vec![eight.to_vec()],
            true => SIX.iter().map(|t| t.map(|c| eight[c]).to_vec()).collect(),
        };
        for cell in cells {
            id += 1;
            let nodes = cell.iter().map(|c| c.to_string()).collect::<Vec<_>>().join(" ");
            let _ = writeln!(text, "{id} {} 0 {nodes}", if tetrahedra { 4 } else { 5 });
        }
    }
    text + "$EndElements\n"
}

/// Two voxels to each particle along each axis.
fn image() -> Vec<u8> {
    let head = format!(
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: {0} {0} {0}\nencoding: raw\nspacings: 0.5 0.5 0.5\n\n",
        2 * EDGE
    );
    [head.into_bytes(), vec![200; (2 * EDGE).pow(3)]].concat()
}

/// The stretch of a bar that becomes thinner by ν of it: the energy density of the particles inside is E ε²/2.
fn young(folder: &std::path::Path, line: &str, law: &str, options: &str, spacing: f64) -> f64 {
    let deck = format!(
        "units si\natom_style peri\nboundary f f f\nlattice sc {spacing}\nregion world block -5 20 -5 20 -5 20 units box\n\
         create_box 1 world\n{line}\nset group all density 1\n\
         region middle block 4.4 8.6 4.4 8.6 4.4 8.6 units box\ngroup middle region middle\n\
         material m E 1 nu 0.25 rho 1\npair_style peri/{law}\npair_coeff * * material m horizon 3.015 s00 100\n\
         peri_modify force newton volume full {options}\nfix 1 all nve\ntimestep 1e-3\n\
         compute w all pe/atom\ncompute one middle reduce sum c_w\ncompute v middle property/atom vfrac\n\
         compute all middle reduce sum c_v\nthermo_style custom step c_one c_all\nrun 0 post no\n\
         displace_atoms all ramp x -2e-4 2e-4 x -20 20 units box\n\
         displace_atoms all ramp y 5e-5 -5e-5 y -20 20 units box\n\
         displace_atoms all ramp z 5e-5 -5e-5 z -20 20 units box\nrun 0 post no\n\
         print $(2*c_one/1e-10/c_all) file OUT screen no\n"
    );
    let deck = deck.replace("OUT", &folder.join("young.out").display().to_string());
    world(folder, &deck);
    fs::read_to_string(folder.join("young.out")).unwrap().trim().parse().unwrap()
}

/// The modulus of the material, 1, within 2 %: a lattice itself gives 1.015 (`peri/lps`, and bonds whose families count as whole ones).
#[test]
fn bodies_from_files_are_as_stiff_as_their_material() {
    assert!(files().exists());
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("points.csv"), points()).unwrap();
    fs::write(folder.path().join("hexes.msh"), mesh(false)).unwrap();
    fs::write(folder.path().join("tets.msh"), mesh(true)).unwrap();
    fs::write(folder.path().join("image.nrrd"), image()).unwrap();
    let tet = (13.0f64.powi(3) / (6.0 * 7.0f64.powi(3))).cbrt();
    for (line, spacing) in [
        ("read_points points.csv", 1.0),
        ("read_mesh hexes.msh", 1.0),
        ("read_mesh tets.msh", tet),
        ("read_voxels image.nrrd types 100:255 1 resample 1", 1.0),
    ] {
        for (law, options) in [("pmb", "surface energy"), ("lps", "influence one")] {
            let e = young(folder.path(), line, law, options, spacing);
            println!("{line} {law}: {e:.4}");
            assert!((e - 1.0).abs() < 0.02, "{line} {law}: {e}");
        }
    }
}
