//! Bodies from files: meshes, tables of points and images give particles with the volumes that are in the file.
//!
//! The files in `files` are made by `meshes.py` (meshio and Gmsh) and `images.py` (NumPy, pynrrd, Pillow).

mod appended;
mod stiffness;

use perigrain::diag::{Diagnostics, FileId, render};
use perigrain::session::{Mode, Options, Session};
use perigrain::world::World;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where the files are.
pub fn files() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/geometry/files")
}

/// A session after a deck whose files are in a folder, and what was refused.
fn outcome(folder: &Path, deck: &str, mode: Mode) -> (Session, Result<(), Diagnostics>) {
    let options = Options { folder: folder.to_path_buf(), mode, ..Options::default() };
    let mut session = Session::new(options).unwrap();
    let outcome = session.run_text("in.deck", deck).map(drop);
    (session, outcome)
}

/// The world after a deck that works.
pub fn world(folder: &Path, deck: &str) -> World {
    let (session, outcome) = outcome(folder, deck, Mode::Run);
    outcome.unwrap_or_else(|e| panic!("{deck}\n{}", render::plain(&e, &session.sources)));
    session.world
}

const BOX: &str = "units si\nboundary f f f\nregion world block -10 10 -10 10 -10 10\ncreate_box 3 world\n";

fn peri(line: &str) -> World {
    world(&files(), &format!("atom_style peri\n{BOX}{line}\n"))
}

/// Particles, volume, and its first moment over it, of a type or of all.
fn moments(w: &World, kind: Option<u16>) -> (usize, f64, [f64; 3]) {
    let p = &w.particles;
    let chosen: Vec<usize> = (0..p.len()).filter(|&i| kind.is_none_or(|k| p.kind[i] == k)).collect();
    let volume: f64 = chosen.iter().map(|&i| p.volume[i]).sum();
    let x = [0, 1, 2].map(|d| chosen.iter().map(|&i| p.volume[i] * p.x[i][d]).sum::<f64>() / volume);
    (chosen.len(), volume, x)
}

fn near(a: f64, b: f64) -> bool {
    // Sums of a few dozen numbers with 16 digits.
    (a - b).abs() < 1e-13 * b.abs().max(1.0)
}

/// The bar of all meshes: 3 x 2 x 1, material 1 up to x = 2, then material 2; volumes and centres calculated by hand.
fn is_the_bar(name: &str, w: &World) {
    for (kind, volume, x) in [(None, 6.0, 1.5), (Some(1), 4.0, 1.0), (Some(2), 2.0, 2.5)] {
        let (_, v, c) = moments(w, kind);
        assert!(
            near(v, volume) && near(c[0], x) && near(c[1], 1.0) && near(c[2], 0.5),
            "{name} {kind:?} {v} {c:?}"
        );
    }
}

#[test]
fn every_mesh_format_gives_exact_volumes_and_centres() {
    for (kind, cells) in [("tets", 36), ("hexes", 6)] {
        for (ending, types) in [
            (".vtk", "cell Material"),
            ("_text.vtk", "cell Material 1 1 2 2"),
            (".vtu", "cell Material 2 2 1 1"),
            ("_text.vtu", "cell Material"),
            ("_22.msh", "physical rock 1 binder 2"),
            ("_22.msh", "physical"),
            (".inp", "set rock 1 Binder 2"),
        ] {
            let name = format!("{kind}{ending}");
            let w = peri(&format!("read_mesh {name} types {types} density 2.5"));
            assert_eq!(w.n(), cells, "{name}");
            is_the_bar(&name, &w);
            // LAMMPS' convention: the mass of a peridynamic particle is its density.
            assert!(w.particles.mass.iter().all(|m| *m == 2.5) && w.particles.x0 == w.particles.x);
        }
    }
    for name in ["gmsh_22.msh", "gmsh_41.msh"] {
        let w = peri(&format!("read_mesh {name} types physical rock 1 12 2"));
        is_the_bar(name, &w);
    }
}

/// Moment of inertia of the bar about z through its centre: V (3² + 2²)/12; cells of edge h counted as points miss V h²/6 of
/// it, exactly.
#[test]
fn inertia_misses_that_of_the_cells() {
    let w = peri("read_mesh hexes.vtk type 1");
    let p = &w.particles;
    let about: f64 =
        (0..w.n()).map(|i| p.volume[i] * ((p.x[i][0] - 1.5).powi(2) + (p.x[i][1] - 1.0).powi(2))).sum();
    assert!(near(about, 6.0 * 13.0 / 12.0 - 6.0 / 6.0), "{about}");
}

#[test]
fn meshes_are_scaled_turned_and_shifted() {
    let w = peri("read_mesh tets.vtu types cell Material scale 0.5 rotate 90 0 0 2 shift 1 2 3 group body");
    let (n, v, x) = moments(&w, None);
    // (1.5, 1, 0.5)/2 turned about z is (-0.5, 0.75, 0.25).
    assert!(n == 36 && near(v, 0.75) && near(x[0], 0.5) && near(x[1], 2.75) && near(x[2], 3.25), "{v} {x:?}");
    let bit = w.groups.find("body").unwrap().bit();
    assert!(w.particles.mask.iter().all(|m| m & bit != 0));
}

#[test]
fn spheres_have_the_volume_of_the_cell() {
    let w = world(
        &files(),
        &format!("atom_style sphere\n{BOX}read_mesh hexes.inp type 2 density 3\nread_mesh hexes.vtk type 1"),
    );
    for i in 0..12 {
        let r = w.particles.radius[i];
        assert!(near(4.0 / 3.0 * std::f64::consts::PI * r * r * r, 1.0));
        assert!(near(w.particles.mass[i], if i < 6 { 3.0 } else { 1.0 }), "{i}");
    }
    assert_eq!(w.particles.tag, (1..=12).collect::<Vec<u32>>());
}

#[test]
fn flat_meshes_have_a_thickness() {
    let folder = tempfile::tempdir().unwrap();
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 2 0 0\n3 2 1 0\n4 0 1 0\n5 1 3 0\n$EndNodes\n\
                $Elements\n3\n1 1 0 1 2\n2 3 0 1 2 3 4\n3 2 0 4 3 5\n$EndElements\n";
    fs::write(folder.path().join("flat.msh"), text).unwrap();
    let deck = "units si\natom_style peri\ndimension 2\nboundary f f p\nregion b block -5 5 -5 5 -1 1\ncreate_box 1 b\n";
    let w = world(folder.path(), &format!("{deck}read_mesh flat.msh thickness 0.5 scale 2"));
    // Areas 2 and 2, calculated by hand, times 2² for the scale.
    assert_eq!(w.particles.volume, [4.0, 4.0]);
    assert!(near(w.particles.x[1][1], 2.0 * 5.0 / 3.0) && w.particles.x.iter().all(|x| x[2] == 0.0));
    let (_, outcome) = outcome(folder.path(), &format!("{deck}read_mesh flat.msh"), Mode::Run);
    assert!(outcome.unwrap_err().0[0].message.contains("needs the thickness"));
}

#[test]
fn what_is_outside_is_left_out_with_a_warning() {
    let deck = format!("atom_style peri\n{BOX}read_mesh hexes.vtk type 1 shift 8 0 0\n");
    let (session, outcome) = outcome(&files(), &deck, Mode::Run);
    outcome.unwrap();
    assert_eq!(session.world.n(), 4);
    let note = session.notes.0.iter().find(|d| d.message.contains("lie outside of the box")).unwrap();
    assert_eq!(note.message, "2 of 6 cells lie outside of the box and are left out");
}

/// A refusal: the line and column in the file that is underlined, or 0 for the deck's, and the message; the same by a check.
fn refused(folder: &Path, head: &str, line: &str) -> (usize, usize, String) {
    let mut first = None;
    for mode in [Mode::Run, Mode::Check] {
        let (session, outcome) = outcome(folder, &format!("atom_style {head}\n{BOX}{line}\n"), mode);
        let d = outcome.expect_err(line).0.remove(0);
        let span = d.span.unwrap();
        assert!(span.file != FileId::BROUGHT, "{line}");
        let in_deck = session.sources.get(span.file).unwrap().name.ends_with("in.deck");
        let (row, column) = if in_deck { (0, 0) } else { session.sources.place(span) };
        let printed = (row, column, d.message);
        assert_eq!(*first.get_or_insert(printed.clone()), printed, "{mode:?}");
    }
    first.unwrap()
}

#[test]
fn mistakes_in_meshes_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let from = |name: &str| fs::read_to_string(files().join(name)).unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let inp = from("tets.inp");
    let first = inp.lines().find(|l| l.starts_with("1,1,2")).unwrap();
    let [a, b, c, d]: [&str; 4] = first.split(',').skip(1).collect::<Vec<_>>().try_into().unwrap();
    let row = 1 + inp.lines().position(|l| l == first).unwrap();
    write("inside_out.inp", &inp.replace(first, &format!("1,{a},{c},{b},{d}")));
    write("flat.inp", &inp.replace(first, &format!("1,{a},{c},{c},{d}")));
    let second =
        inp.lines().find(|l| l.starts_with("2,")).filter(|l| l.matches(',').count() == 4).map(str::to_owned);
    let second = second.unwrap_or_else(|| {
        inp.lines().rfind(|l| l.starts_with("2,") && l.matches(',').count() == 4).unwrap().into()
    });
    write("twice.inp", &inp.replace(&second, &format!("2,{b},{a},{d},{c}")));
    write("cut.vtu", &from("tets.vtu")[..700]);
    fs::write(folder.path().join("cut.vtk"), &fs::read(files().join("tets.vtk")).unwrap()[..900]).unwrap();
    fs::copy(files().join("binary.msh"), folder.path().join("binary.msh")).unwrap();
    fs::copy(files().join("tets_22.msh"), folder.path().join("tets.msh")).unwrap();
    fs::copy(files().join("tets.vtu"), folder.path().join("tets.vtu")).unwrap();
    for (line, at, printed) in [
        ("inside_out.inp type 1", (row, 1), "cell 1 is inside out: its volume is -0.16666"),
        ("flat.inp type 1", (row, 1), "cell 1 has no volume"),
        ("twice.inp type 1", (row + 1, 1), "cell 2 has the corners of cell 1"),
        ("cut.vtk type 1", (0, 0), "the file ends within"),
        ("binary.msh type 1", (0, 0), "a binary .msh file is not in perigrain yet"),
        ("tets.msh types physical rock 1", (0, 0), "nothing here gives cell"),
        ("tets.msh types physical sand 1", (0, 0), "the file has no `sand`"),
        ("tets.msh types physical rock 4", (0, 0), "there are types 1 to 3, not 4"),
        ("tets.vtu types cell Matter", (0, 0), "no array `Matter`"),
        ("tets.vtu types cell Material x 1", (0, 0), "must be a number"),
        ("tets.vtu", (0, 0), "which type the particles get is missing"),
        ("tets.vtu type 1 shift 100 0 0", (0, 0), "none of the 36 cells lies in the box"),
        ("tets.vtu type 1 thickness 1", (0, 0), "has no triangles or quads"),
        ("tets.vtu typ 1", (0, 0), "unknown keyword of read_mesh: `typ`"),
        ("none.vtu type 1", (0, 0), "the mesh `none.vtu` cannot be read"),
    ] {
        let (row, column, message) = refused(folder.path(), "peri", &format!("read_mesh {line}"));
        assert!(message.contains(printed), "{line}: {message}");
        assert_eq!((row, column), at, "{line}: {message}");
    }
    let (row, _, message) = refused(folder.path(), "peri", "read_mesh cut.vtu type 1");
    assert!(row > 0 && message.contains("the file ends within <DataArray>"), "{row} {message}");
    assert!(
        refused(folder.path(), "atomic", "read_mesh tets.vtu type 1 density 1").2.contains("have no density")
    );
}

const TABLE: &str = "x,y,z,Vol,type,d_own,diameter,density,vx,wz,note\n0,0,0,2,1,7.5,0.5,1000,3,1,1\n1,0,0,3,2,0,0.25,2000,0,0,2\n";

#[test]
fn tables_give_every_property() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("p.csv"), TABLE).unwrap();
    let own = "fix p all property/atom d_own\n";
    let deck =
        format!("atom_style sphere\n{own}{BOX}read_points p.csv scale 2 rotate 90 0 0 1 shift 0 0 1\n");
    let w = world(folder.path(), &deck);
    let p = &w.particles;
    assert!(near(p.x[1][1], 2.0) && p.x[1][0].abs() < 1e-15 && p.x[1][2] == 1.0);
    assert_eq!((&p.kind[..], &p.radius[..]), (&[1, 2][..], &[0.5, 0.25][..]));
    assert!(near(p.v[0][1], 3.0) && near(p.omega[0][2], 1.0));
    assert!(near(p.mass[0], 1000.0 * 4.0 / 3.0 * std::f64::consts::PI / 8.0));
    assert_eq!(w.columns.get_scalar(w.columns.custom("d_own").unwrap()).unwrap(), [7.5, 0.0]);
    let w =
        world(folder.path(), &format!("atom_style peri\n{BOX}read_points p.csv columns volume Vol type 2\n"));
    assert_eq!((&w.particles.volume[..], &w.particles.kind[..]), (&[2.0, 3.0][..], &[1, 2][..]));
    let w = world(folder.path(), &format!("atom_style peri\n{BOX}read_points p.csv volume 4 density 5\n"));
    assert_eq!((&w.particles.volume[..], &w.particles.mass[..]), (&[4.0, 4.0][..], &[1000.0, 2000.0][..]));
}

#[test]
fn mistakes_in_tables_are_shown_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let cases = [
        ("0,0,0,2,", "0,0,zero,2,", "columns volume Vol", (2, 5), "z must be a number, not `zero`"),
        ("0,0,0,2,", "0,0,,2,", "columns volume Vol", (2, 0), "z must be a number, not ``"),
        ("1,0,0,3", "-0.0,0,0,3", "columns volume Vol", (3, 1), "a second point at the same place"),
        ("1,0,0,3,2", "1,0,0,3,4", "columns volume Vol", (3, 9), "there are types 1 to 3, not 4"),
        (
            "1,0,0,3,2",
            "1,0,0,-3,2",
            "columns volume Vol",
            (3, 7),
            "the volume must be greater than zero, not -3",
        ),
        (
            "2000,0,0,2\n",
            "2000,0,0\n",
            "columns volume Vol",
            (3, 1),
            "this line has 10 columns, the first one names 11",
        ),
        ("x,y", "x,x", "columns volume Vol", (1, 3), "a second column `x`"),
        ("x,y", "x,why", "columns volume Vol", (1, 1), "there is no column `y`"),
        ("x,y", "x,y", "columns volume Volume", (1, 1), "there is no column `Volume` for volume"),
        ("x,y", "x,y", "", (1, 1), "there is no column `volume`"),
        ("x,y", "1,2", "columns volume Vol", (1, 1), "names of columns must stand in the first line"),
        ("x,y", "x,y", "columns volume", (0, 0), "`columns` needs a property and the name of its column"),
    ];
    for (from, to, line, at, printed) in cases {
        assert!(TABLE.contains(from), "{from}");
        fs::write(folder.path().join("p.csv"), TABLE.replacen(from, to, 1)).unwrap();
        let (row, column, message) = refused(folder.path(), "peri", &format!("read_points p.csv {line}"));
        assert!(message.contains(printed), "{to}: {message}");
        assert!((row, column) == at || at.1 == 0 && row == at.0, "{to}: {row} {column} {message}");
    }
    fs::write(folder.path().join("p.csv"), "id,x,y,z\n3,0,0,0\n3,1,0,0\n").unwrap();
    let (row, column, message) = refused(folder.path(), "peri", "read_points p.csv volume 1 type 1");
    assert_eq!((row, column, message.as_str()), (3, 1, "there is a particle 3 already"));
}

/// What images.py counted: below 40 319 voxels, from 40 to 120 518, the ball 123, each (1/2)³ large.
#[test]
fn every_image_format_gives_the_voxels() {
    for name in [
        "raw8.nrrd",
        "gzip8.nrrd",
        "big16.nrrd",
        "float.nhdr",
        "nospacing.nrrd spacing 0.5",
        "ct_*.png spacing 0.5",
        "pages.tif spacing 0.5",
        "big.tiff spacing 0.5",
    ] {
        let w = peri(&format!("read_voxels {name} types 0:39 1 40:120 2 200 3"));
        for (kind, count) in [(1, 319), (2, 518), (3, 123)] {
            let (n, v, _) = moments(&w, Some(kind));
            assert_eq!((n, v), (count, count as f64 / 8.0), "{name}");
        }
        // The ball's middle is voxel (6, 5, 4).
        let (_, _, x) = moments(&w, Some(3));
        assert!(near(x[0], 3.25) && near(x[1], 2.75) && near(x[2], 2.25), "{name} {x:?}");
        assert_eq!(w.particles.x[0], [0.25; 3]);
    }
    let flat = "units si\natom_style peri\ndimension 2\nboundary f f p\nregion b block -1 99 -1 99 -1 1\ncreate_box 1 b\n";
    let w = world(&files(), &format!("{flat}read_voxels bits.png types 1 1 spacing 1 1 0.5"));
    // Pixels above 100 in the first slice: one column of the ramp, x = 11, and none of the ball.
    assert_eq!((w.n(), w.particles.volume[0], w.particles.x[0]), (10, 0.5, [11.5, 0.5, 0.0]));
    let w = world(&files(), &format!("{flat}read_voxels deep.png types 25601:65535 1 spacing 1"));
    assert_eq!(w.n(), 10);
}

#[test]
fn images_of_vtk_are_read_too() {
    let folder = tempfile::tempdir().unwrap();
    let image = |of: &str, extent: &str, name: &str| {
        format!(
            "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"{extent}\" Origin=\"1 0 0\" \
             Spacing=\"0.5 1 2\"><Piece Extent=\"{extent}\"><{of}><DataArray type=\"Int16\" Name=\"{name}\" format=\"ascii\">\
             5 6 7 8</DataArray></{of}></Piece></ImageData></VTKFile>"
        )
    };
    fs::write(folder.path().join("cells.vti"), image("CellData", "0 2 0 2 0 1", "grey")).unwrap();
    fs::write(folder.path().join("points.vti"), image("PointData", "0 1 0 1 0 0", "grey")).unwrap();
    for (name, x) in [("cells", [1.75, 1.5, 1.0]), ("points", [1.5, 1.0, 0.0])] {
        let w = world(
            folder.path(),
            &format!("atom_style peri\n{BOX}read_voxels {name}.vti types 6:8 2 array grey"),
        );
        assert_eq!((w.n(), w.particles.volume[0], w.particles.x[2]), (3, 1.0, x), "{name}");
    }
    let printed = refused(folder.path(), "peri", "read_voxels cells.vti types 1:9 1 array gray").2;
    assert!(printed.contains("no array `gray`"), "{printed}");
}

/// An image of 9 x 8 x 7 voxels as ParaView writes it, its array among the tags as text or raw behind them, in blocks or in one.
fn image(way: &str, values: &[u16]) -> Vec<u8> {
    let (packed, raw) = (way == "packed", way != "text");
    let text: String = values.iter().map(|v| format!("{v} ")).collect();
    let (format, text) = if raw { ("appended\" offset=\"0", "") } else { ("ascii", text.as_str()) };
    let packer = if packed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    let mut all = format!(
        "<VTKFile type=\"ImageData\" byte_order=\"BigEndian\" header_type=\"UInt64\"{packer}><ImageData WholeExtent=\"0 9 0 8 0 7\" \
         Origin=\"1 0 0\" Spacing=\"0.5 1 0.25\"><Piece Extent=\"0 9 0 8 0 7\"><CellData><DataArray type=\"UInt16\" Name=\"g\" \
         format=\"{format}\">{text}</DataArray></CellData></Piece></ImageData>"
    )
    .into_bytes();
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
    let word = |n: usize| (n as u64).to_be_bytes();
    if raw {
        all.extend(b"<AppendedData encoding=\"raw\">_");
    }
    match way {
        "raw" => all.extend([&word(bytes.len())[..], &bytes].concat()),
        "packed" => {
            // Blocks that end within a slice, within a voxel even.
            let blocks: Vec<Vec<u8>> = bytes.chunks(101).map(appended::packed).collect();
            let counts = [blocks.len(), 101, bytes.len() % 101];
            counts.into_iter().chain(blocks.iter().map(Vec::len)).for_each(|n| all.extend(word(n)));
            all.extend(blocks.concat());
        }
        _ => {}
    }
    all.extend(if raw { &b"</AppendedData></VTKFile>"[..] } else { b"</VTKFile>" });
    all
}

#[test]
fn images_read_slice_by_slice_give_what_those_read_whole_do() {
    let folder = tempfile::tempdir().unwrap();
    let values: Vec<u16> = (0..9 * 8 * 7u32).map(|k| (k * k % 1009) as u16).collect();
    let particles = |way: &str, words: &str| {
        fs::write(folder.path().join("image.vti"), image(way, &values)).unwrap();
        let line = format!("read_voxels image.vti types 100:499 1 500:900 2{words}");
        let p = world(folder.path(), &format!("atom_style peri\n{BOX}{line}")).particles.clone();
        (p.x.clone(), p.kind.clone(), p.volume.clone())
    };
    for words in ["", " resample 0.8"] {
        let whole = particles("text", words);
        assert!(whole.0.len() > 10);
        assert_eq!(particles("raw", words), whole);
        assert_eq!(particles("packed", words), whole);
    }
    for way in ["raw", "packed"] {
        let bytes = image(way, &values);
        fs::write(folder.path().join("cut.vti"), &bytes[..bytes.len() - 300]).unwrap();
        let printed = refused(folder.path(), "peri", "read_voxels cut.vti types 1:9 1").2;
        assert!(printed.contains("cut off"), "{printed}");
    }
}

#[test]
fn blocks_keep_the_volume_of_each_material() {
    let deck =
        format!("atom_style peri\n{BOX}read_voxels raw8.nrrd types 0:39 1 40:120 2 200 3 resample 1\n");
    let (session, outcome) = outcome(&files(), &deck, Mode::Run);
    outcome.unwrap();
    let w = &session.world;
    assert_eq!(w.n(), 6 * 5 * 4);
    assert_eq!(w.particles.volume[0], 1.0);
    for (kind, count) in [(1, 319), (2, 518), (3, 123)] {
        let (n, _, _) = moments(w, Some(kind));
        // Ten blocks at most, as the page states; here it is one.
        assert!((n as f64 - f64::from(count) / 8.0).abs() < 1.5, "{kind}: {n}");
    }
}

#[test]
fn mistakes_in_images_are_named() {
    let folder = tempfile::tempdir().unwrap();
    for name in
        ["raw8.nrrd", "gzip8.nrrd", "nospacing.nrrd", "colour.png", "ct_5.png", "float.nhdr", "packed.tif"]
    {
        fs::copy(files().join(name), folder.path().join(name)).unwrap();
    }
    fs::copy(files().join("colour.png"), folder.path().join("two_1.png")).unwrap();
    let raw = fs::read(files().join("raw8.nrrd")).unwrap();
    fs::write(folder.path().join("cut.nrrd"), &raw[..raw.len() - 1]).unwrap();
    fs::write(folder.path().join("cut.png"), &fs::read(files().join("ct_5.png")).unwrap()[..60]).unwrap();
    fs::write(folder.path().join("cut.tif"), &fs::read(files().join("pages.tif")).unwrap()[..700]).unwrap();
    let huge =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4000000 4000000 9\nencoding: raw\nspacings: 1 1 1\n\n";
    fs::write(folder.path().join("huge.nrrd"), huge).unwrap();
    fs::write(folder.path().join("odd.nrrd"), huge.replace("uint8", "block")).unwrap();
    for (line, row, printed) in [
        ("nospacing.nrrd types 1:9 1", 0, "does not state the size of its voxels"),
        ("ct_5.png types 1:9 1", 0, "does not state the size of its voxels"),
        ("raw8.nrrd", 0, "which grey values are which types is missing"),
        ("raw8.nrrd types 9:1 1", 0, "`9:1` is no range"),
        ("raw8.nrrd types 1:9 1 9:20 2", 0, "has values in common with 1:9"),
        ("raw8.nrrd types 1:9 4", 0, "there are types 1 to 3, not 4"),
        ("raw8.nrrd types 250:255 1", 0, "no voxel of `raw8.nrrd` has a grey value"),
        ("raw8.nrrd types 0:255 1 shift 0 0 100", 0, "none of the 960 voxels lies in the box"),
        ("cut.nrrd types 0:255 1", 0, "ends within slice 8 of 8"),
        ("cut.png types 0:255 1 spacing 1", 0, "cannot be read"),
        ("colour.png types 0:255 1 spacing 1", 0, "has colours or transparency"),
        ("packed.tif types 0:255 1 spacing 1", 0, "packed TIFF (compression 8) is not in perigrain yet"),
        ("cut.tif types 0:255 1 spacing 1", 0, "cut off"),
        ("none_*.png types 0:255 1 spacing 1", 0, "no image `none_*.png` is there"),
        ("none.nrrd types 0:255 1", 0, "cannot be read: it is not there"),
        ("a.bmp types 0:255 1", 0, "is no image that can be read"),
        ("float.nhdr types 0:255 1", 0, "cannot be read"),
        ("huge.nrrd types 0:255 1", 0, "of memory"),
        ("odd.nrrd types 0:255 1", 2, "NRRD's type `block`"),
    ] {
        let (at, _, message) = refused(folder.path(), "peri", &format!("read_voxels {line}"));
        assert!(message.contains(printed), "{line}: {message}");
        assert_eq!(at, row, "{line}");
    }
}

#[test]
fn a_plan_makes_the_particles_and_a_check_none() {
    let deck = format!(
        "atom_style peri\n{BOX}read_mesh tets.vtu type 1 density 1 group body\nread_voxels ct_*.png types 0:255 2 spacing 0.1 density 1\n\
         group body clear\n"
    );
    for (mode, n) in [(Mode::Check, 0), (Mode::Plan, 36 + 960)] {
        let (session, outcome) = outcome(&files(), &deck, mode);
        outcome.unwrap_or_else(|e| panic!("{}", render::plain(&e, &session.sources)));
        assert_eq!(session.world.n(), n, "{mode:?}");
    }
}

/// A million voxels would be 300 MB: the refusal comes before the particles.
#[test]
fn more_particles_than_memory_are_refused_beforehand() {
    let folder = tempfile::tempdir().unwrap();
    let head =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 100 100 100\nencoding: gzip\nspacings: 0.1 0.1 0.1\n\n";
    let mut packed = flate2::write::GzEncoder::new(head.as_bytes().to_vec(), flate2::Compression::fast());
    packed.write_all(&vec![9; 1_000_000]).unwrap();
    fs::write(folder.path().join("full.nrrd"), packed.finish().unwrap()).unwrap();
    let deck = format!("atom_style peri\n{BOX}read_voxels full.nrrd types 9 1\n");
    fs::write(folder.path().join("in.deck"), deck).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_perigrain"))
        .args(["-safe", "-limit", "memory", "150", "-log", "none", "-in", "in.deck"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let printed = String::from_utf8_lossy(&output.stderr);
    assert!(printed.contains("about 1.000e6 particles would need 0.3 GB of memory"), "{printed}");
}
