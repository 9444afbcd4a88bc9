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

/// Reads point data back with `vtkio`, an independent reader.
fn read(path: &Path, compressed: bool) -> (IOBuffer, Vec<(String, IOBuffer)>, usize) {
    let path = &path.with_extension("base64.vtu");
    let raw = std::fs::read(path.with_extension("").with_extension("vtu")).unwrap();
    std::fs::write(path, as_base64(&raw, compressed)).unwrap();
    let vtk = vtkio::Vtk::import(path).unwrap();
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else { panic!("not an unstructured grid") };
    let Piece::Inline(piece) = &pieces[0] else { panic!("not inline") };
    let arrays = piece.data.point.iter().map(|a| match a {
        Attribute::DataArray(a) => (a.name.clone(), a.data.clone()),
        Attribute::Field { .. } => panic!("not an array"),
    });
    (piece.points.clone(), arrays.collect(), piece.cells.types.len())
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
