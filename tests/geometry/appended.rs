//! `.vtu` files whose arrays stand behind the tags, as ParaView writes them: raw or base64, packed or not.

use super::world;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;

/// How the arrays are kept.
#[derive(Clone, Copy, Debug)]
struct Way {
    packed: bool,
    raw: bool,
    wide: bool,
    big: bool,
}

impl Way {
    fn word(self, n: usize) -> Vec<u8> {
        match (self.wide, self.big) {
            (true, true) => (n as u64).to_be_bytes().to_vec(),
            (true, false) => (n as u64).to_le_bytes().to_vec(),
            (false, true) => (n as u32).to_be_bytes().to_vec(),
            (false, false) => (n as u32).to_le_bytes().to_vec(),
        }
    }

    /// An array as it stands in the file.
    fn kept(self, bytes: &[u8]) -> Vec<u8> {
        let (head, body) = match self.packed {
            false => (vec![], [self.word(bytes.len()), bytes.to_vec()].concat()),
            true => {
                // Blocks of sixteen bytes, the last one of what is left.
                let blocks: Vec<Vec<u8>> = bytes.chunks(16).map(packed).collect();
                let mut head = [self.word(blocks.len()), self.word(16), self.word(bytes.len() % 16)].concat();
                blocks.iter().for_each(|b| head.extend(self.word(b.len())));
                (head, blocks.concat())
            }
        };
        if self.raw { [head, body].concat() } else { [base64(&head), base64(&body)].concat() }
    }
}

/// Bytes as zlib packs them.
pub fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut writer = flate2::write::ZlibEncoder::new(vec![], flate2::Compression::default());
    writer.write_all(bytes).unwrap();
    writer.finish().unwrap()
}

fn base64(bytes: &[u8]) -> Vec<u8> {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |c: &[u8]| {
        let n = (0..3).fold(0, |n, k| n << 8 | u32::from(c.get(k).copied().unwrap_or(0)));
        let letter = |k: usize| if k <= c.len() { LETTERS[(n >> (18 - 6 * k) & 63) as usize] } else { b'=' };
        [0, 1, 2, 3].map(letter)
    };
    bytes.chunks(3).flat_map(group).collect()
}

/// A tetrahedron of volume 1/6 of type 2, and one of 4/3 of type 1.
fn file(way: Way) -> Vec<u8> {
    let float = |x: f64| if way.big { x.to_be_bytes() } else { x.to_le_bytes() };
    let long = |k: i64| if way.big { k.to_be_bytes() } else { k.to_le_bytes() };
    let short = |k: i16| if way.big { k.to_be_bytes() } else { k.to_le_bytes() };
    let mut x = vec![];
    for size in [1.0, 2.0] {
        x.extend([0.0; 3]);
        x.extend([size, 0.0, 0.0, 0.0, size, 0.0, 0.0, 0.0, size]);
    }
    let arrays: [(&str, &str, &str, Vec<u8>); 5] = [
        ("CellData", "Int16", "Name=\"Material\"", [2, 1].into_iter().flat_map(short).collect()),
        (
            "Points",
            "Float64",
            "Name=\"Points\" NumberOfComponents=\"3\"",
            x.into_iter().flat_map(float).collect(),
        ),
        ("Cells", "Int64", "Name=\"connectivity\"", (0..8).flat_map(long).collect()),
        ("Cells", "Int64", "Name=\"offsets\"", [4, 8].into_iter().flat_map(long).collect()),
        ("Cells", "UInt8", "Name=\"types\"", vec![10, 10]),
    ];
    let order = if way.big { "BigEndian" } else { "LittleEndian" };
    let header = if way.wide { "UInt64" } else { "UInt32" };
    let packer = if way.packed { " compressor=\"vtkZLibDataCompressor\"" } else { "" };
    let mut head = format!(
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"{order}\" header_type=\"{header}\"{packer}><UnstructuredGrid>\
         <Piece NumberOfPoints=\"8\" NumberOfCells=\"2\">"
    );
    let mut data = vec![];
    for (of, kind, words, bytes) in arrays {
        let _ = write!(
            head,
            "<{of}><DataArray type=\"{kind}\" {words} format=\"appended\" offset=\"{}\"/></{of}>",
            data.len()
        );
        data.extend(way.kept(&bytes));
    }
    let encoding = if way.raw { "raw" } else { "base64" };
    let _ = write!(head, "</Piece></UnstructuredGrid><AppendedData encoding=\"{encoding}\">_");
    [head.as_bytes(), &data, b"</AppendedData></VTKFile>"].concat()
}

#[test]
fn arrays_behind_the_tags_are_read() {
    let folder = tempfile::tempdir().unwrap();
    for k in 0..16 {
        let way = Way { packed: k & 1 != 0, raw: k & 2 != 0, wide: k & 4 != 0, big: k & 8 != 0 };
        fs::write(folder.path().join("two.vtu"), file(way)).unwrap();
        let deck = "units si\natom_style peri\nboundary f f f\nregion b block -1 9 -1 9 -1 9\ncreate_box 2 b\n\
                    read_mesh two.vtu types cell Material\n";
        let w = world(folder.path(), deck);
        assert_eq!(w.particles.kind[..], [2, 1], "{way:?}");
        for (v, volume) in w.particles.volume.iter().zip([1.0 / 6.0, 4.0 / 3.0]) {
            assert!((v - volume).abs() < 1e-15, "{way:?} {v}");
        }
        assert_eq!(w.particles.x[1], [0.5; 3]);
    }
}
