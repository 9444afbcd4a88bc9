//! Particles on a surface of triangles from an STL file, ASCII or binary.

use super::places::{Maker, New};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::vec3::{add, cross, length, scale, sub};
use perigrain_lang::Args;
use perigrain_styles::BuildCx;

/// Three corners.
pub type Triangle = [[f64; 3]; 3];

/// A surface to be filled.
pub struct Mesh {
    /// Its triangles.
    pub triangles: Vec<Triangle>,
    /// How.
    pub mode: Mode,
    /// Factor of the radii that follow from the triangles.
    pub radius_scale: f64,
}

/// How triangles are filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// Triangles are halved until the corners are on average no farther from the centre than this; one particle each.
    Bisect(f64),
    /// So many particles per area, at places of a quasi-random sequence.
    Quasi(f64),
}

impl Mode {
    /// LAMMPS' name for it.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Bisect(_) => "recursive bisection",
            Mode::Quasi(_) => "quasi-random",
        }
    }
}

impl Mesh {
    /// The particles inside the box.
    pub fn places(&self, m: &Maker) -> Vec<New> {
        let mut found = vec![];
        for triangle in &self.triangles {
            match self.mode {
                Mode::Bisect(threshold) => halve(*triangle, threshold, &mut found),
                Mode::Quasi(density) => scatter(*triangle, density, &mut found),
            }
        }
        let new =
            |(x, radius): ([f64; 3], f64)| New { kind: m.kind, x, radius: Some(radius * self.radius_scale) };
        found.into_iter().filter(|(x, _)| m.domain.holds(x)).map(new).collect()
    }
}

/// Halves a triangle at its longest side until it is small; its centre and mean distance to the corners.
fn halve(t: Triangle, threshold: f64, found: &mut Vec<([f64; 3], f64)>) {
    let mut waiting = vec![t];
    while let Some(t) = waiting.pop() {
        let center = scale(1.0 / 3.0, add(add(t[0], t[1]), t[2]));
        let mean = t.iter().map(|p| length(sub(center, *p))).sum::<f64>() / 3.0;
        if mean <= threshold {
            found.push((center, mean));
            continue;
        }
        let side = |k: usize| sub(t[k], t[(k + 1) % 3]);
        let lengths = [0, 1, 2].map(|k| length(side(k)));
        let longest = match lengths {
            [a, b, c] if a < b => {
                if b < c {
                    2
                } else {
                    1
                }
            }
            [a, _, c] => {
                if a < c {
                    2
                } else {
                    0
                }
            }
        };
        let middle = sub(t[longest], scale(0.5, side(longest)));
        let (mut first, mut second) = (t, t);
        first[longest] = middle;
        second[(longest + 1) % 3] = middle;
        // The first half is worked off first.
        waiting.push(second);
        waiting.push(first);
    }
}

/// Roberts' R2 sequence: the powers 1 and 2 of 1/g for the plastic number g, g³ = g + 1, to the seven digits that LAMMPS
/// has: the places depend on them.
const STEPS: [f64; 2] = [0.7548777, 0.5698403];

/// Fills a triangle with the number of particles that a density gives, each at its place of a quasi-random sequence.
fn scatter([a, b, c]: Triangle, density: f64, found: &mut Vec<([f64; 3], f64)>) {
    let (ab, ac, bc) = (sub(b, a), sub(c, a), sub(c, b));
    let (lab, lac, lbc) = (length(ab), length(ac), length(bc));
    // The origin is the corner with the largest angle, opposite the longest side.
    let (origin, ab, ac) = if lac > lab && lac > lbc {
        (b, scale(-1.0, ab), bc)
    } else if lab > lac && lab > lbc {
        (c, scale(-1.0, bc), scale(-1.0, ac))
    } else {
        (a, ab, ac)
    };
    let area = 0.5 * length(cross(ab, ac));
    let count = (density * area).ceil();
    let radius = (area / std::f64::consts::PI / count).sqrt();
    for k in 1..=count as i64 {
        let [mut u, mut v] = STEPS.map(|s| (0.5 + k as f64 * s) % 1.0);
        if u + v >= 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        found.push((add(origin, add(scale(u, ac), scale(v, ab))), radius));
    }
}

/// Takes a `meshmode`.
pub fn mode(a: &mut Args) -> Result<Mode> {
    Ok(match a.choice("mode", &["bisect", "qrand"])? {
        "bisect" => Mode::Bisect(a.positive("the largest mean distance of the corners")?),
        _ => Mode::Quasi(a.positive("the number of particles per area")?),
    })
}

/// Takes the name of an STL file and reads it; the surface, and what is said about it.
pub fn parse(a: &mut Args, cx: &BuildCx) -> Result<(Mesh, Vec<String>)> {
    let word = a.expect("the name of an STL file")?;
    let mesh = |triangles| Mesh { triangles, mode: Mode::Bisect(1.0), radius_scale: 1.0 };
    let bad = |text: String| fail(Code::NO_FILE, word.span, text);
    match perigrain_base::gate::read(cx.world.to_read(&word.text)) {
        Err(_) if cx.world.parts.promised.may_come(&word.text) => Ok((mesh(vec![]), vec![])),
        Err(e) => fail(
            perigrain_base::gate::code(&e),
            word.span,
            format!("the file `{}` cannot be read: {e}", word.text),
        ),
        Ok(bytes) => match read(&bytes) {
            Err(what) => bad(format!("`{}` is no STL file: {what}", word.text)),
            Ok((name, binary, triangles)) => {
                let kind = if binary { "binary" } else { "text" };
                Ok((
                    mesh(triangles),
                    vec![format!("Reading STL object {name} from {kind} file {}", word.text)],
                ))
            }
        },
    }
}

/// Reads an STL file of either kind; the object's name, whether it is binary, and its triangles.
pub fn read(bytes: &[u8]) -> std::result::Result<(String, bool, Vec<Triangle>), String> {
    if let Some(triangles) = binary(bytes) {
        let header = String::from_utf8_lossy(&bytes[..80]);
        return Ok((
            header.trim_matches(|c: char| c == '\0' || c.is_whitespace()).to_string(),
            true,
            triangles,
        ));
    }
    let text = std::str::from_utf8(bytes)
        .map_err(|_| "it is neither a text nor a whole binary STL file".to_string())?;
    let name = text.lines().next().unwrap_or("").trim();
    let Some(name) = name.strip_prefix("solid") else {
        return Err("its first line does not begin with `solid`, and it is no whole binary STL file".into());
    };
    ascii(text).map(|triangles| (name.trim().to_string(), false, triangles))
}

/// The triangles of a binary file, if its length fits the number it announces.
fn binary(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let count = u32::from_le_bytes(bytes.get(80..84)?.try_into().ok()?) as usize;
    let records = &bytes[84..];
    if count == 0 || records.len() != count.checked_mul(50)? {
        return None;
    }
    let number = |b: &[u8], k: usize| {
        let at = 4 * k;
        f64::from(f32::from_le_bytes([b[at], b[at + 1], b[at + 2], b[at + 3]]))
    };
    // Twelve numbers: the normal, then the corners.
    let corner = |r: &[u8], p: usize| [0, 1, 2].map(|d| number(r, 3 + 3 * p + d));
    Some(records.chunks_exact(50).map(|r| [0, 1, 2].map(|p| corner(r, p))).collect())
}

fn ascii(text: &str) -> std::result::Result<Vec<Triangle>, String> {
    let mut triangles = vec![];
    let mut corners: Vec<[f64; 3]> = vec![];
    for (n, line) in text.lines().enumerate().skip(1) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let wrong = |what: &str| Err(format!("line {}: {what}", n + 1));
        match words.as_slice() {
            [] | ["outer", "loop"] | ["facet", ..] => {}
            ["endsolid", ..] => return Ok(triangles),
            ["vertex", x, y, z] => {
                let numbers = [x, y, z].map(|w| w.parse::<f64>().ok().filter(|x| x.is_finite()));
                let [Some(x), Some(y), Some(z)] = numbers else {
                    return wrong("a corner needs three numbers");
                };
                corners.push([x, y, z]);
            }
            ["endloop"] => match corners.as_slice() {
                [a, b, c] => {
                    triangles.push([*a, *b, *c]);
                    corners.clear();
                }
                _ => return wrong("a facet needs three corners"),
            },
            ["endfacet"] => {}
            _ => return wrong("this is no line of an STL file"),
        }
    }
    Err("it ends without `endsolid`".into())
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
        assert_eq!(read(TEXT.as_bytes()), Ok(("one".into(), false, corners.clone())));
        assert_eq!(read(&packed()), Ok(("solid in binary".into(), true, corners)));
    }

    #[test]
    fn broken_files_are_refused_with_their_line() {
        let said = |text: &str| read(text.as_bytes()).unwrap_err();
        assert!(said("").contains("solid") && said("solid a\nvertex 1 2\n").contains("line 2"));
        assert!(said("solid a\nouter loop\nvertex 1 2 3\nendloop\n").contains("line 4"));
        assert!(said("solid a\nvertex 1 2 nan\n").contains("three numbers"));
        assert!(said(&TEXT.replace("endsolid one\n", "")).contains("endsolid"));
        assert!(read(&packed()[..130]).is_err());
    }

    #[test]
    fn large_triangles_are_halved() {
        let mut found = vec![];
        halve([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 0.5, &mut found);
        // The right triangle halves at its hypotenuse: centres by hand, first half first.
        assert_eq!(found.len(), 2);
        let third = 1.0 / 3.0;
        for ((x, _), wanted) in found.iter().zip([[0.5 * third, 0.5, 0.0], [0.5, 0.5 * third, 0.0]]) {
            assert!((0..3).all(|d| (x[d] - wanted[d]).abs() < 1e-15), "{x:?}");
        }
    }
}
