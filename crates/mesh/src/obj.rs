//! Wavefront OBJ files: their corners and faces.

use super::Triangle;
use super::read::fan;
use thiserror::Error;

/// Skipped lines: appearance, groups, and elements that are not surfaces (points and lines).
const PASSED: [&str; 14] = [
    "vt",
    "vn",
    "g",
    "s",
    "usemtl",
    "mtllib",
    "l",
    "p",
    "mg",
    "maplib",
    "usemap",
    "shadow_obj",
    "trace_obj",
    "lod",
];

/// Why a file is no OBJ file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Error {
    #[error("it is no text")]
    NoText,
    #[error("line {0}: {1}")]
    Line(usize, Line),
}

/// What is wrong in a line.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Line {
    #[error("a corner needs three numbers")]
    Corner,
    #[error("a face needs three corners")]
    Face,
    #[error("there is no corner `{0}` above")]
    NotAbove(String),
    #[error("there is no corner {0}")]
    NoCorner(usize),
    #[error("`{0}` is no line of a surface of polygons")]
    Unknown(String),
}

/// Reads an OBJ file: the first object's name and the triangles.
pub fn read(bytes: &[u8]) -> Result<(String, Vec<Triangle>), Error> {
    let text = std::str::from_utf8(bytes).map_err(|_| Error::NoText)?;
    let (mut points, mut triangles, mut name) = (vec![], vec![], None);
    let mut polygon = vec![];
    for (n, line) in text.lines().enumerate() {
        let line = line.split('#').next().unwrap_or("");
        let words: Vec<&str> = line.split_whitespace().collect();
        let wrong = |what| Err(Error::Line(n + 1, what));
        match words.as_slice() {
            [] => {}
            // A fourth number is a weight; six numbers are a corner with a colour.
            ["v", x, y, z, ..] => {
                let numbers = [x, y, z].map(|w| w.parse::<f64>().ok().filter(|x| x.is_finite()));
                let [Some(x), Some(y), Some(z)] = numbers else {
                    return wrong(Line::Corner);
                };
                points.push([x, y, z]);
            }
            ["v", ..] => return wrong(Line::Corner),
            ["f", corners @ ..] => {
                if corners.len() < 3 {
                    return wrong(Line::Face);
                }
                polygon.clear();
                for corner in corners {
                    match place(corner, points.len()) {
                        Some(k) => polygon.push(k),
                        None => return wrong(Line::NotAbove((*corner).into())),
                    }
                }
                if let Err(k) = fan(&polygon, &points, &mut triangles) {
                    return wrong(Line::NoCorner(k + 1));
                }
            }
            ["o", rest @ ..] => {
                name.get_or_insert_with(|| rest.join(" "));
            }
            [word, ..] if PASSED.contains(word) => {}
            [word, ..] => return wrong(Line::Unknown((*word).into())),
        }
    }
    Ok((name.unwrap_or_default(), triangles))
}

/// The corner named by `7`, `7/1/2` or, counted backwards from the last one, `-1`; from 0.
fn place(word: &str, count: usize) -> Option<usize> {
    let k: i64 = word.split('/').next()?.parse().ok()?;
    match usize::try_from(k) {
        Ok(k) => k.checked_sub(1).filter(|k| *k < count),
        Err(_) => count.checked_sub(usize::try_from(k.unsigned_abs()).ok()?),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_by_number_and_counted_back() {
        let text = "# made by hand\no plate\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2/7/1 3 4\nf -4 -3 -2\n";
        let (name, t) = read(text.as_bytes()).unwrap();
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!((name.as_str(), t), ("plate", vec![[a, b, c], [a, c, d], [a, b, c]]));
    }

    #[test]
    fn broken_files_are_refused_with_their_line() {
        let refusal = |text: &str| read(text.as_bytes()).unwrap_err().to_string();
        assert!(refusal("v 0 0\n").contains("line 1") && refusal("v 0 0 inf\n").contains("three numbers"));
        assert!(refusal("v 0 0 0\nf 1 2 3\n").contains("line 2: there is no corner `2`"));
        assert!(refusal("v 0 0 0\nf 1 1 -2\n").contains("`-2`") && refusal("f 0 0 0\n").contains("`0`"));
        assert!(refusal("v 0 0 0\nf 1 1\n").contains("three corners"));
        assert!(refusal("curv 0 1 2\n").contains("`curv`"));
    }
}
