//! VTU files are read back by `vtkio`, an independent reader. Here and not beside the code: the reader takes as long to compile into a
//! crate's own tests as the crate.

use perigrain::output::vtu::{Array, Storage, Values, write};
use perigrain_base::base64::encode;
use std::path::Path;
use vtkio::model::{Attribute, DataSet, IOBuffer, Piece};

/// Bytes of a block of packed data.
const BLOCK: usize = 1 << 15;

fn points(n: usize) -> Vec<[f64; 3]> {
    (0..n).map(|i| [i as f64 * 0.1, (i * 7 % 13) as f64, -1e-9 * i as f64]).collect()
}

/// The same file with its appended data in base64, the only form `vtkio` 0.7 reads; bytes stay what they are.
fn as_base64(file: &[u8], compressed: bool) -> String {
    let mark = file.windows(16).position(|w| w == b"encoding=\"raw\">\n").unwrap() + 17;
    let data = &file[mark..file.len() - "\n  </AppendedData>\n</VTKFile>\n".len()];
    let head = std::str::from_utf8(&file[..mark]).unwrap().replace("\"raw\"", "\"base64\"");
    let pieces: Vec<&str> = head.split("offset=\"").collect();
    let offset = |k: usize| pieces[k].split('"').next().unwrap().parse::<usize>().unwrap();
    let (mut text, mut coded) = (pieces[0].to_string(), String::new());
    for k in 1..pieces.len() {
        let end = if k + 1 < pieces.len() { offset(k + 1) } else { data.len() };
        let segment = &data[offset(k)..end];
        let blocks = u64::from_le_bytes(segment[..8].try_into().unwrap()) as usize;
        let header = if compressed { 8 * (3 + blocks) } else { 0 };
        text += &format!("offset=\"{}\"{}", coded.len(), pieces[k].split_once('"').unwrap().1);
        coded += &(encode(&segment[..header]) + &encode(&segment[header..]));
    }
    text + &coded + "\n  </AppendedData>\n</VTKFile>\n"
}

/// Reads a file with `vtkio`, an independent reader.
fn import(path: &Path, compressed: bool) -> DataSet {
    let end = path.extension().unwrap().to_str().unwrap();
    let copy = path.with_extension(format!("base64.{end}"));
    std::fs::write(&copy, as_base64(&std::fs::read(path).unwrap(), compressed)).unwrap();
    vtkio::Vtk::import(copy).unwrap().data
}

/// Arrays with their names.
fn arrays(of: &[Attribute]) -> Vec<(String, IOBuffer)> {
    let each = of.iter().map(|a| match a {
        Attribute::DataArray(a) => (a.name.clone(), a.data.clone()),
        Attribute::Field { .. } => panic!("not an array"),
    });
    each.collect()
}

/// Points, arrays and the number of cells.
fn read(path: &Path, compressed: bool) -> (IOBuffer, Vec<(String, IOBuffer)>, usize) {
    let DataSet::UnstructuredGrid { pieces, .. } = import(path, compressed) else {
        panic!("not an unstructured grid")
    };
    let Piece::Inline(piece) = &pieces[0] else { panic!("not inline") };
    (piece.points.clone(), arrays(&piece.data.point), piece.cells.types.len())
}

/// The same of polygonal data.
fn read_poly(path: &Path) -> (IOBuffer, Vec<(String, IOBuffer)>, usize) {
    let DataSet::PolyData { pieces, .. } = import(path, true) else { panic!("not polygonal data") };
    let Piece::Inline(piece) = &pieces[0] else { panic!("not inline") };
    let vertices = piece.verts.as_ref().unwrap();
    (piece.points.clone(), arrays(&piece.data.point), vertices.num_cells())
}

/// Three snapshots of two moving grains; `dump vtk` chooses the format by the name's ending, as LAMMPS and LIGGGHTS do.
#[test]
fn the_ending_chooses_the_format() {
    let dir = tempfile::tempdir().unwrap();
    let deck = "units si\natom_style sphere\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\n\
                create_atoms 1 single 3 1 1\nset group all diameter 0.5\nset group all density 1000\npair_style none\n\
                velocity all set 1 2 3\nfix 1 all nve/sphere\ntimestep 0.001\n\
                dump a all vtk 10 ${dir}/a_*.vtp id vx vy vz radius\ndump_modify a colname radius \"r [m]\" colname vx speed\n\
                dump b all vtk 10 ${dir}/b_*.pvtp id vx vy vz radius\ndump c all vtk 10 ${dir}/c_*.pvtu id vx vy vz radius\n\
                dump_modify c maxfiles 2\nrun 20\n";
    let vars = vec![("dir".into(), vec![dir.path().to_str().unwrap().to_string()])];
    let options = perigrain::session::Options { vars, ..Default::default() };
    perigrain::session::Session::new(options).unwrap().run_text("in.vtk", deck).unwrap();
    let file = |name: &str| dir.path().join(name);
    let places = IOBuffer::F64(vec![1.02, 1.04, 1.06, 3.02, 1.04, 1.06]);
    let wanted = |names: [&str; 3]| {
        let speed = vec![1.0, 2.0, 3.0, 1.0, 2.0, 3.0];
        let values = [IOBuffer::I32(vec![1, 2]), IOBuffer::F64(speed), IOBuffer::F64(vec![0.25; 2])];
        names.map(String::from).into_iter().zip(values).collect::<Vec<_>>()
    };
    let near = |found: &IOBuffer| {
        let (IOBuffer::F64(a), IOBuffer::F64(b)) = (found, &places) else { panic!("{found:?}") };
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-13)
    };
    let (points, arrays, vertices) = read_poly(&file("a_20.vtp"));
    assert!(near(&points) && vertices == 2);
    assert_eq!(arrays, wanted(["id", "speed", "r [m]"]));
    let (points, arrays, vertices) = read_poly(&file("b_20_0.vtp"));
    assert!(near(&points) && vertices == 2);
    assert_eq!(arrays, wanted(["id", "v", "radius"]));
    let (points, arrays, cells) = read(&file("c_20_0.vtu"), true);
    assert!(near(&points) && cells == 2);
    assert_eq!(arrays, wanted(["id", "v", "radius"]));
    for (list, piece) in [("b_20.pvtp", "b_20_0.vtp"), ("c_20.pvtu", "c_20_0.vtu")] {
        let sources: Vec<String> = match vtkio::Vtk::import(file(list)).unwrap().data {
            DataSet::PolyData { pieces, .. } => pieces.iter().map(source).collect(),
            DataSet::UnstructuredGrid { pieces, .. } => pieces.iter().map(source).collect(),
            other => panic!("{other:?}"),
        };
        assert_eq!(sources, [piece]);
    }
    // The list of times names the lists of pieces; of three snapshots two are kept, with their pieces.
    let times = std::fs::read_to_string(file("c.pvd")).unwrap();
    assert!(times.contains("timestep=\"0.02\" group=\"\" part=\"0\" file=\"c_20.pvtu\""), "{times}");
    let there = |name: &str| file(name).exists();
    assert!(there("c_10.pvtu") && there("c_10_0.vtu") && !there("c_0.pvtu") && !there("c_0_0.vtu"));
}

/// The file that a piece stands in.
fn source<P>(piece: &Piece<P>) -> String {
    let Piece::Source(path, _) = piece else { panic!("not in a file of its own") };
    Path::new(path).file_name().unwrap().to_str().unwrap().to_string()
}

#[test]
fn vtkio_reads_what_was_written() {
    let dir = tempfile::tempdir().unwrap();
    for n in [0usize, 1, 10_000] {
        for compress in [true, false] {
            let x = points(n);
            let damage: Vec<f64> = (0..n).map(|i| (i as f64).sqrt()).collect();
            let kind: Vec<i32> = (0..n as i32).map(|i| i % 5 - 2).collect();
            let small: Vec<f32> = (0..n).map(|i| i as f32 / 3.0).collect();
            let arrays = [
                Array { name: "damage", values: Values::F64(&damage) },
                Array { name: "type", values: Values::I32(&kind) },
                Array { name: "a<b", values: Values::F32(&small) },
                Array { name: "v", values: Values::Vectors(&x) },
            ];
            let path = dir.path().join(format!("a{n}{compress}.vtu"));
            let storage = Storage { compress, level: 3 };
            write(&path, 1.5e-6, Values::Vectors(&x), &arrays, storage).unwrap();
            if n == 0 {
                // vtkio refuses empty arrays; ParaView reads them.
                continue;
            }
            let (read_x, read, cells) = read(&path, compress);
            let flat = x.as_flattened().to_vec();
            assert_eq!(read_x, IOBuffer::F64(flat.clone()));
            assert_eq!(cells, n);
            assert_eq!(read[0], ("damage".into(), IOBuffer::F64(damage)));
            assert_eq!(read[1], ("type".into(), IOBuffer::I32(kind)));
            assert_eq!(read[2].1, IOBuffer::F32(small));
            assert_eq!(read[3], ("v".into(), IOBuffer::F64(flat)));
        }
    }
}

#[test]
fn whole_blocks_and_rests() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.vtu");
    for n in [BLOCK / 8 - 1, BLOCK / 8 + 1, 3 * BLOCK / 8 + 5] {
        let (x, d) = (points(n), vec![0.25; n]);
        let arrays = [Array { name: "d", values: Values::F64(&d) }];
        write(&path, 0.0, Values::Vectors32(&x), &arrays, Storage::default()).unwrap();
        let (read_x, arrays, _) = read(&path, true);
        assert_eq!(read_x, IOBuffer::F32(x.as_flattened().iter().map(|&c| c as f32).collect()));
        assert_eq!(arrays[0].1, IOBuffer::F64(d));
    }
}
