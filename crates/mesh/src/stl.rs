//! STL files, text or binary.

use super::Triangle;
use std::borrow::Cow;
use std::fmt;
use thiserror::Error;

/// Contents of a file.
#[derive(Debug, Default, PartialEq)]
pub struct Read {
    /// The object's name, or the first of several.
    pub name: String,
    /// All triangles.
    pub triangles: Vec<Triangle>,
    /// Comment lines, which the format does not have.
    pub comments: usize,
}

/// Why a file is no STL file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Error {
    #[error("it is neither a text nor a whole binary STL file{0}")]
    NoText(Announced),
    #[error("its first line does not begin with `solid`, and it is no whole binary STL file{0}")]
    NoSolid(Announced),
    #[error("it ends without `endsolid`")]
    Open,
    #[error("line {0}: {1}")]
    Line(usize, Line),
}

/// What is wrong in a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum Line {
    #[error("a solid begins with `solid`")]
    Outside,
    #[error("a corner needs three numbers")]
    Corner,
    #[error("a facet needs three corners")]
    Facet,
    #[error("this is no line of an STL file")]
    Unknown,
}

/// The size of the file beside the one that a binary header in it would mean, if it has one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Announced {
    triangles: Option<u32>,
    bytes: usize,
}

impl fmt::Display for Announced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Some(count), has) = (self.triangles, self.bytes) else { return Ok(()) };
        let wanted = length(count);
        write!(f, " (as one it announces {count} triangles in {wanted} bytes, and has {has})")
    }
}

type Found = Result<Read, Error>;

/// Reads an STL file of either kind.
pub fn read(bytes: &[u8]) -> Found {
    if is_binary(bytes) {
        let header = String::from_utf8_lossy(&bytes[..80]);
        let name = header.trim_matches(|c: char| c == '\0' || c.is_whitespace()).to_string();
        return Ok(Read { name, triangles: binary(&bytes[84..]), comments: 0 });
    }
    let announced = Announced { triangles: announced(bytes), bytes: bytes.len() };
    let Ok(text) = std::str::from_utf8(bytes) else {
        return Err(Error::NoText(announced));
    };
    let mut text = Cow::Borrowed(text.trim_start_matches('\u{feff}'));
    if text.contains("SOLID") || text.contains("FACET") {
        text = text.to_ascii_lowercase().into();
    }
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    if !first.unwrap_or("").starts_with("solid") {
        return Err(Error::NoSolid(announced));
    }
    ascii(&text)
}

/// The number of triangles in a binary header.
fn announced(bytes: &[u8]) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(80..84)?.try_into().ok()?))
}

/// The size in bytes of a binary file of so many triangles.
fn length(triangles: u32) -> u64 {
    84 + 50 * u64::from(triangles)
}

/// Whether the file length fits the number of triangles in its header.
pub fn is_binary(bytes: &[u8]) -> bool {
    announced(bytes).is_some_and(|count| count > 0 && bytes.len() as u64 == length(count))
}

fn binary(records: &[u8]) -> Vec<Triangle> {
    let number = |b: &[u8], k: usize| {
        let at = 4 * k;
        f64::from(f32::from_le_bytes([b[at], b[at + 1], b[at + 2], b[at + 3]]))
    };
    // Twelve numbers: the normal, then the corners.
    let corner = |r: &[u8], p: usize| [0, 1, 2].map(|d| number(r, 3 + 3 * p + d));
    records.chunks_exact(50).map(|r| [0, 1, 2].map(|p| corner(r, p))).collect()
}

/// All solids of a text file.
fn ascii(text: &str) -> Found {
    let (mut triangles, mut corners, mut name, mut open) = (vec![], vec![], None, false);
    let mut comments = 0;
    for (n, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let wrong = |what| Err(Error::Line(n + 1, what));
        match words.as_slice() {
            [] => {}
            [word, ..] if word.starts_with('#') => comments += 1,
            ["solid", rest @ ..] if !open => {
                name.get_or_insert_with(|| rest.join(" "));
                open = true;
            }
            ["endsolid", ..] if open => open = false,
            _ if !open => return wrong(Line::Outside),
            ["outer", "loop"] | ["facet", ..] | ["endfacet"] => {}
            ["vertex", x, y, z] => {
                let numbers = [x, y, z].map(|w| w.parse::<f64>().ok().filter(|x| x.is_finite()));
                let [Some(x), Some(y), Some(z)] = numbers else {
                    return wrong(Line::Corner);
                };
                corners.push([x, y, z]);
            }
            ["endloop"] => match corners.as_slice() {
                [a, b, c] => {
                    triangles.push([*a, *b, *c]);
                    corners.clear();
                }
                _ => return wrong(Line::Facet),
            },
            _ => return wrong(Line::Unknown),
        }
    }
    if open {
        return Err(Error::Open);
    }
    Ok(Read { name: name.unwrap_or_default(), triangles, comments })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\n\
                        endloop\nendfacet\nendsolid one\n";

    fn packed() -> Vec<u8> {
        let mut bytes = b"solid in binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend(1u32.to_le_bytes());
        for x in [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            bytes.extend(x.to_le_bytes());
        }
        bytes.extend([0, 0]);
        bytes
    }

    #[test]
    fn both_kinds_of_files_are_read() {
        let corners = vec![[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]];
        let named = |name: &str, triangles: &[Triangle]| {
            Ok(Read { name: name.into(), triangles: triangles.to_vec(), comments: 0 })
        };
        assert_eq!(read(TEXT.as_bytes()), named("one", &corners));
        assert_eq!(read(&packed()), named("solid in binary", &corners));
        // A file with two solids yields both.
        let both = read(format!("{TEXT}\n{}", TEXT.replace("one", "two")).as_bytes());
        assert_eq!(both, named("one", &[&corners[..], &corners].concat()));
    }

    #[test]
    fn comments_capitals_and_a_byte_order_mark_are_taken() {
        let plain = read(TEXT.as_bytes()).unwrap();
        let commented = format!("# by hand\n#\n{}# end\n", TEXT.replace("endloop", "# three\nendloop"));
        assert_eq!(read(commented.as_bytes()), Ok(Read { comments: 4, ..read(TEXT.as_bytes()).unwrap() }));
        let marked = format!("\u{feff}\n {}", TEXT.to_ascii_uppercase());
        assert_eq!(read(marked.as_bytes()), Ok(Read { name: "one".into(), ..plain }));
    }

    #[test]
    fn broken_files_are_refused_with_their_line() {
        let refusal = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
        assert!(refusal("").contains("solid") && refusal("solid a\nvertex 1 2\n").contains("line 2"));
        assert!(refusal("solid a\nouter loop\nvertex 1 2 3\nendloop\n").contains("line 4"));
        assert!(refusal("solid a\nvertex 1 2 nan\n").contains("three numbers"));
        assert!(refusal(&TEXT.replace("endsolid one\n", "")).contains("endsolid"));
        assert!(refusal(&format!("{TEXT}vertex 1 2 3\n")).contains("line 10"));
        assert!(
            read(&packed()[..130])
                .unwrap_err()
                .to_string()
                .contains("announces 1 triangles in 134 bytes, and has 130")
        );
    }
}
