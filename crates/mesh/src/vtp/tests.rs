//! VTP files as text, base64, appended and compressed.

use super::*;
use perigrain_base::base64::encode as base64;
use std::io::Write;

const POINTS: [f64; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.25];

fn wanted() -> Vec<Triangle> {
    let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.25]];
    vec![[a, b, c], [a, c, d]]
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut zlib = flate2::write::ZlibEncoder::new(vec![], flate2::Compression::default());
    zlib.write_all(bytes).unwrap();
    zlib.finish().unwrap()
}

/// A file with arrays in the given `format`, encoded by `code`.
fn file(attributes: &str, appended: Option<&str>, code: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let points: Vec<u8> = POINTS.iter().flat_map(|x| x.to_le_bytes()).collect();
    let corners: Vec<u8> = [0i64, 1, 2, 3].iter().flat_map(|x| x.to_le_bytes()).collect();
    let ends: Vec<u8> = 4i32.to_le_bytes().to_vec();
    let mut behind = vec![];
    let mut array = |name: &str, kind: &str, bytes: &[u8]| {
        let coded = code(bytes);
        let head = format!("<DataArray type=\"{kind}\" Name=\"{name}\"");
        if appended.is_none() {
            return format!("{head} format=\"binary\">\n{}\n</DataArray>", String::from_utf8(coded).unwrap());
        }
        let offset = behind.len();
        behind.extend(coded);
        format!("{head} format=\"appended\" offset=\"{offset}\"/>")
    };
    let [points, corners, ends] = [
        array("Points", "Float64", &points),
        array("connectivity", "Int64", &corners),
        array("offsets", "Int32", &ends),
    ];
    let mut bytes = format!(
        "<?xml version=\"1.0\"?>\n<!-- by hand -->\n<VTKFile type=\"PolyData\" {attributes}><PolyData>\
         <Piece NumberOfPoints=\"4\" NumberOfPolys=\"1\"><PointData><DataArray type=\"Float32\" Name=\"a>b\" \
         format=\"ascii\">1 2 3 4</DataArray></PointData><Points>{points}</Points><Polys>{corners}{ends}</Polys>\
         </Piece></PolyData>"
    )
    .into_bytes();
    if let Some(encoding) = appended {
        bytes.extend(format!("<AppendedData encoding=\"{encoding}\">_").bytes());
        bytes.extend(behind);
        bytes.extend(b"</AppendedData>");
    }
    bytes.extend(b"</VTKFile>\n");
    bytes
}

/// Bytes after their size in four bytes.
fn counted(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}

/// Two zlib blocks with their sizes in eight bytes each: header and blocks.
fn blocks(bytes: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let half = bytes.len().div_ceil(2);
    let (a, b) = (packed(&bytes[..half]), packed(&bytes[half..]));
    let sizes = [2, half, bytes.len() - half, a.len(), b.len()];
    (sizes.iter().flat_map(|n| (*n as u64).to_le_bytes()).collect(), [a, b].concat())
}

fn all() -> Vec<Vec<u8>> {
    let zlib = "byte_order=\"LittleEndian\" header_type='UInt64' compressor=\"vtkZLibDataCompressor\"";
    vec![
        file("", None, |b| base64(&counted(b)).into_bytes()),
        // Header and bytes padded separately, as some writers do.
        file("", None, |b| [base64(&(b.len() as u32).to_le_bytes()), base64(b)].concat().into_bytes()),
        file("", Some("raw"), counted),
        file("", Some("base64"), |b| base64(&counted(b)).into_bytes()),
        file(zlib, None, |b| {
            let (head, blocks) = blocks(b);
            [base64(&head), base64(&blocks)].concat().into_bytes()
        }),
        file(zlib, Some("raw"), |b| {
            let (head, blocks) = blocks(b);
            [head, blocks].concat()
        }),
    ]
}

#[test]
fn every_way_of_writing_numbers_is_read() {
    for (k, bytes) in all().iter().enumerate() {
        assert_eq!(read(bytes), Ok(wanted()), "file {k}");
    }
}

#[test]
fn text_polygons_and_strips_are_read() {
    let text = "<VTKFile type='PolyData'><PolyData><Piece><Points><DataArray type='Float32' format='ascii'>0 0 0 1 0 0 1 1 0 \
                0 1 0.25</DataArray></Points><Strips><DataArray type='Int32' Name='connectivity' format='ascii'>0 1 3 2\
                </DataArray><DataArray type='Int32' Name='offsets' format='ascii'>4</DataArray></Strips></Piece></PolyData>\
                </VTKFile>";
    let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.25]];
    assert_eq!(read(text.as_bytes()), Ok(vec![[a, b, d], [d, b, c]]));
    let refusal = |from: &str, to: &str| read(text.replace(from, to).as_bytes()).unwrap_err().to_string();
    assert!(refusal("PolyData'", "UnstructuredGrid'").contains("UnstructuredGrid"));
    assert!(refusal("0 1 3 2", "0 1 4 2").contains("no point 4"));
    assert!(refusal(">4<", ">5<").contains("end at 5"));
    assert!(refusal(">4<", ">3<").contains("end before"));
    assert!(refusal("0.25", "").contains("multiple of three"));
    assert!(refusal("0.25", "x").contains("a number must stand here (line 1)"));
    assert!(refusal("Float32", "Strange").contains("`Strange`"));
    assert!(refusal("type='PolyData'", "type='PolyData' compressor='vtkLZ4DataCompressor'").contains("LZ4"));
    assert!(
        refusal("</VTKFile>", "").contains("ends within <VTKFile>")
            && refusal("</Piece>", "</Peace>").contains("closes nothing")
    );
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    for bytes in all() {
        let last = bytes.windows(5).position(|w| w == b"</VTK").unwrap() - 20;
        for end in (0..last).step_by(7) {
            let found = read(&bytes[..end]);
            // A file cut within trailing blanks or tags may still contain all numbers.
            assert!(found.is_err() || found == Ok(wanted()), "{end}: {found:?}");
        }
    }
}
