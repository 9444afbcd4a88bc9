//! PLY files: text, and binary in either byte order.

use super::Triangle;
use super::read::fan;
use thiserror::Error;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Text,
    Little,
    Big,
}

/// Why a file is no PLY file.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Error {
    #[error("it is no text, but says so")]
    NoText,
    #[error("its triangles are strips (`tristrips`): write them as faces")]
    Strips,
    #[error("its header ends without `end_header`")]
    OpenHeader,
    #[error("its header has no line `format`")]
    NoFormat,
    #[error("line {0} is no text")]
    LineNoText(usize),
    #[error("line {0}: {1}")]
    Line(usize, Line),
    #[error("it ends, or has a word that is no number, in row {0} of `{1}`")]
    Cut(u64, String),
    #[error("row {0} of `{1}`: {2}")]
    Row(u64, String, Row),
    #[error("its corners have no `{0}`")]
    NoColumn(&'static str),
    #[error("its corners end in a list")]
    CornersWithList,
    #[error("its faces have no list `vertex_indices`")]
    NoCorners,
}

/// What is wrong in a line of the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Line {
    #[error("it does not begin with `ply`")]
    First,
    #[error("a format is ascii, binary_little_endian or binary_big_endian")]
    Format,
    #[error("an element needs a number of rows")]
    Rows,
    #[error("this is no kind of number")]
    Kind,
    #[error("a property needs a kind and a name")]
    Property,
    #[error("a property belongs to an element")]
    Outside,
    #[error("this is no line of a PLY header")]
    Unknown,
}

/// What is wrong in the row of a face.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum Row {
    #[error("a face needs three corners")]
    Face,
    #[error("there is no corner {0}")]
    NoCorner(f64),
}

/// A number type: its size, and whether it is floating-point or signed.
#[derive(Clone, Copy)]
struct Kind {
    bytes: usize,
    float: bool,
    signed: bool,
}

struct Property {
    name: String,
    /// Type of the count at the beginning of a list.
    list: Option<Kind>,
    kind: Kind,
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

/// The numbers after the header, one by one.
enum Numbers<'b> {
    Text(std::str::SplitAsciiWhitespace<'b>),
    Bytes(&'b [u8], bool),
}

impl Numbers<'_> {
    fn next(&mut self, kind: Kind) -> Option<f64> {
        match self {
            Numbers::Text(words) => words.next()?.parse().ok(),
            Numbers::Bytes(rest, big) => {
                let (number, after) = rest.split_at_checked(kind.bytes)?;
                *rest = after;
                Some(decode(number, kind, *big))
            }
        }
    }
}

/// A number of up to eight bytes.
fn decode(bytes: &[u8], kind: Kind, big: bool) -> f64 {
    let fold = |whole: u64, b: &u8| whole << 8 | u64::from(*b);
    let raw = if big { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) };
    let unused = 64 - 8 * kind.bytes as u32;
    match kind {
        Kind { float: true, bytes: 4, .. } => f64::from(f32::from_bits(raw as u32)),
        Kind { float: true, .. } => f64::from_bits(raw),
        Kind { signed: true, .. } => ((raw << unused) as i64 >> unused) as f64,
        _ => raw as f64,
    }
}

fn kind(word: &str) -> Option<Kind> {
    let (bytes, float, signed) = match word {
        "char" | "int8" => (1, false, true),
        "uchar" | "uint8" => (1, false, false),
        "short" | "int16" => (2, false, true),
        "ushort" | "uint16" => (2, false, false),
        "int" | "int32" => (4, false, true),
        "uint" | "uint32" => (4, false, false),
        "float" | "float32" => (4, true, true),
        "double" | "float64" => (8, true, true),
        _ => return None,
    };
    Some(Kind { bytes, float, signed })
}

/// Reads a PLY file.
pub fn read(bytes: &[u8]) -> Result<Vec<Triangle>, Error> {
    let (encoding, elements, body) = header(bytes)?;
    let mut numbers = match encoding {
        Encoding::Text => {
            let text = std::str::from_utf8(body).map_err(|_| Error::NoText)?;
            Numbers::Text(text.split_ascii_whitespace())
        }
        _ => Numbers::Bytes(body, encoding == Encoding::Big),
    };
    let (mut points, mut triangles) = (vec![], vec![]);
    for element in &elements {
        match element.name.as_str() {
            "vertex" => corners(element, &mut numbers, &mut points)?,
            "face" => faces(element, &mut numbers, &points, &mut triangles)?,
            "tristrips" => return Err(Error::Strips),
            // Edges, materials and other elements are skipped.
            _ => rows(element, &mut numbers, |_, _| {}, |_, _| Ok(()))?,
        }
    }
    Ok(triangles)
}

type Header<'b> = (Encoding, Vec<Element>, &'b [u8]);

fn header(bytes: &[u8]) -> Result<Header<'_>, Error> {
    let (mut rest, mut encoding) = (bytes, None);
    let mut elements: Vec<Element> = vec![];
    for n in 1.. {
        let Some(end) = rest.iter().position(|b| *b == b'\n') else {
            return Err(Error::OpenHeader);
        };
        let line = std::str::from_utf8(&rest[..end]).map_err(|_| Error::LineNoText(n))?;
        rest = &rest[end + 1..];
        let words: Vec<&str> = line.split_whitespace().collect();
        let wrong = |what| Err(Error::Line(n, what));
        match words.as_slice() {
            ["ply"] if n == 1 => {}
            _ if n == 1 => return wrong(Line::First),
            ["comment" | "obj_info", ..] | [] => {}
            ["format", word, "1.0"] => {
                encoding = Some(match *word {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::Little,
                    "binary_big_endian" => Encoding::Big,
                    _ => return wrong(Line::Format),
                });
            }
            ["element", name, count] => {
                let Ok(count) = count.parse() else { return wrong(Line::Rows) };
                elements.push(Element { name: (*name).into(), count, properties: vec![] });
            }
            ["property", words @ ..] => {
                let property = match words {
                    ["list", count, of, name] => match (kind(count), kind(of)) {
                        (Some(count), Some(of)) if !count.float => {
                            Property { name: (*name).into(), list: Some(count), kind: of }
                        }
                        _ => return wrong(Line::Kind),
                    },
                    [of, name] => match kind(of) {
                        Some(of) => Property { name: (*name).into(), list: None, kind: of },
                        None => return wrong(Line::Kind),
                    },
                    _ => return wrong(Line::Property),
                };
                match elements.last_mut() {
                    Some(element) => element.properties.push(property),
                    None => return wrong(Line::Outside),
                }
            }
            ["end_header"] => break,
            _ => return wrong(Line::Unknown),
        }
    }
    match encoding {
        Some(encoding) => Ok((encoding, elements, rest)),
        None => Err(Error::NoFormat),
    }
}

/// Reads the rows of an element: each scalar property and each list.
fn rows(
    element: &Element,
    numbers: &mut Numbers,
    mut single: impl FnMut(usize, f64),
    mut listed: impl FnMut(usize, &[f64]) -> Result<(), Row>,
) -> Result<(), Error> {
    let mut list = vec![];
    if element.properties.is_empty() {
        return Ok(());
    }
    for row in 0..element.count {
        let cut = || Error::Cut(row + 1, element.name.clone());
        for (k, property) in element.properties.iter().enumerate() {
            let Some(count) = property.list else {
                single(k, numbers.next(property.kind).ok_or_else(cut)?);
                continue;
            };
            let count = numbers.next(count).ok_or_else(cut)?;
            list.clear();
            for _ in 0..count as u64 {
                list.push(numbers.next(property.kind).ok_or_else(cut)?);
            }
            listed(k, &list).map_err(|what| Error::Row(row + 1, element.name.clone(), what))?;
        }
    }
    Ok(())
}

fn corners(element: &Element, numbers: &mut Numbers, points: &mut Vec<[f64; 3]>) -> Result<(), Error> {
    let at = |name| {
        let found = element.properties.iter().position(|p| p.name == name && p.list.is_none());
        found.ok_or(Error::NoColumn(name))
    };
    let (columns, last) = ([at("x")?, at("y")?, at("z")?], element.properties.len() - 1);
    let mut place = [0.0; 3];
    let ends_in_list = element.properties[last].list.is_some();
    let single = |k: usize, x: f64| {
        if let Some(d) = columns.iter().position(|c| *c == k) {
            place[d] = x;
        }
        if k == last {
            points.push(place);
        }
    };
    if ends_in_list {
        return Err(Error::CornersWithList);
    }
    rows(element, numbers, single, |_, _| Ok(()))
}

fn faces(
    element: &Element,
    numbers: &mut Numbers,
    points: &[[f64; 3]],
    triangles: &mut Vec<Triangle>,
) -> Result<(), Error> {
    let named =
        |p: &Property| matches!(p.name.as_str(), "vertex_indices" | "vertex_index") && p.list.is_some();
    let Some(column) = element.properties.iter().position(named) else {
        return Err(Error::NoCorners);
    };
    let mut polygon = vec![];
    rows(
        element,
        numbers,
        |_, _| {},
        |k, list| {
            if k != column {
                return Ok(());
            }
            if list.len() < 3 {
                return Err(Row::Face);
            }
            polygon.clear();
            for x in list {
                // Only integers from 0 on are valid corner numbers.
                let whole = *x >= 0.0 && x.fract() == 0.0 && *x < points.len() as f64;
                polygon.push(if whole {
                    *x as usize
                } else {
                    return Err(Row::NoCorner(*x));
                });
            }
            fan(&polygon, points, triangles).map_err(|k| Row::NoCorner(k as f64))
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "comment by hand\nelement vertex 3\nproperty float x\nproperty double y\nproperty short z\n\
                        property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

    fn wanted() -> Vec<Triangle> {
        vec![[[0.5, 0.0, -2.0], [1.0, 0.0, 0.0], [0.0, 1.0, 300.0]]]
    }

    fn binary(big: bool) -> Vec<u8> {
        let name = if big { "big" } else { "little" };
        let mut bytes = format!("ply\nformat binary_{name}_endian 1.0\n{HEAD}").into_bytes();
        let mut push = |mut number: Vec<u8>| {
            if !big {
                number.reverse();
            }
            bytes.extend(number);
        };
        for [x, y, z] in wanted()[0] {
            push((x as f32).to_be_bytes().to_vec());
            push(y.to_be_bytes().to_vec());
            push((z as i16).to_be_bytes().to_vec());
            push(vec![255]);
        }
        push(vec![3]);
        (0..3i32).for_each(|k| push(k.to_be_bytes().to_vec()));
        bytes
    }

    #[test]
    fn the_three_encodings_are_read() {
        let text = format!("ply\nformat ascii 1.0\n{HEAD}0.5 0 -2 9\n1 0 0 9\n0 1e0 300 9\n3 0 1 2\n");
        assert_eq!(read(text.as_bytes()), Ok(wanted()));
        assert_eq!(read(&text.replace('\n', "\r\n").into_bytes()), Ok(wanted()));
        assert_eq!(read(&binary(true)), Ok(wanted()));
        assert_eq!(read(&binary(false)), Ok(wanted()));
    }

    #[test]
    fn broken_files_are_refused() {
        let refusal = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
        assert!(refusal("ply\nformat ascii 1.0\n").contains("end_header"));
        assert!(refusal("ply\nformat ascii 2.0\n").contains("line 2"));
        assert!(refusal("ply\nproperty float x\n").contains("line 2"));
        assert!(refusal("ply\nelement vertex 3\nproperty float x\nend_header\n").contains("format"));
        let text = format!("ply\nformat ascii 1.0\n{HEAD}0 0 0 0\n1 0 0 0\n0 1 0 0\n");
        assert!(refusal(&text).contains("row 1 of `face`"));
        assert!(refusal(&format!("{text}3 0 1 3\n")).contains("no corner 3"));
        assert!(refusal(&format!("{text}2 0 1\n")).contains("three corners"));
        let whole = binary(true);
        assert!(read(&whole[..whole.len() - 1]).unwrap_err().to_string().contains("row 1 of `face`"));
        // A number of rows that no file has.
        assert!(refusal(&text.replace("vertex 3", "vertex 99999999999")).contains("row 4"));
    }
}
