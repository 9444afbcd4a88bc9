//! VTK's legacy text files of surfaces and of tetrahedra: `POLYDATA` and `UNSTRUCTURED_GRID`.

use super::Triangle;
use super::read::fan;
use perigrain_base::math::vec3::{cross, dot, sub};
use std::collections::BTreeMap;
use std::str::SplitAsciiWhitespace;
use thiserror::Error;

/// How such a file begins.
pub const MARK: &[u8] = b"# vtk DataFile";

/// Why a file is no VTK file.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Error {
    #[error("it is no text: write it as ASCII")]
    NoText,
    #[error("it is a binary file: write it as ASCII, or as .vtp")]
    Binary,
    #[error("its data are `{0}`: POLYDATA or UNSTRUCTURED_GRID is read")]
    Kind(String),
    #[error("a number is missing after `{0}`")]
    Number(&'static str),
    #[error("there is no point {0}")]
    NoPoint(usize),
    #[error("it has no points")]
    NoPoints,
    #[error(
        "cells of type {0} are no faces: triangles, quadrilaterals, polygons, strips and tetrahedra are read"
    )]
    Cell(usize),
    #[error("{0} tetrahedra have the face of the points {a} {b} {c}", a = .1[0], b = .1[1], c = .1[2])]
    Shared(usize, [usize; 3]),
}

/// VTK's numbers of kinds of cells.
const TRIANGLE: usize = 5;
const STRIP: usize = 6;
const POLYGON: usize = 7;
const PIXEL: usize = 8;
const QUAD: usize = 9;
const TETRA: usize = 10;
/// Points and lines, which are passed over.
const WITHOUT_AREA: [usize; 4] = [1, 2, 3, 4];

/// Reads the triangles of a file.
pub fn read(bytes: &[u8]) -> Result<Vec<Triangle>, Error> {
    let text = std::str::from_utf8(bytes).map_err(|_| Error::NoText)?;
    // The first two lines are the version and a title.
    let mut rest = text.splitn(3, '\n').nth(2).unwrap_or("").split_ascii_whitespace();
    match rest.next() {
        Some("ASCII") => {}
        Some("BINARY") => return Err(Error::Binary),
        other => return Err(Error::Kind(other.unwrap_or("").to_string())),
    }
    let kind = rest.nth(1).unwrap_or("");
    if !["POLYDATA", "UNSTRUCTURED_GRID"].contains(&kind) {
        return Err(Error::Kind(kind.to_string()));
    }
    let mut points: Vec<[f64; 3]> = vec![];
    let (mut cells, mut kinds): (Vec<Vec<usize>>, Vec<usize>) = (vec![], vec![]);
    while let Some(word) = rest.next() {
        match word {
            "POINTS" => {
                let count: usize = number(&mut rest, "POINTS")?;
                rest.next();
                for _ in 0..count {
                    let mut next = || number::<f64>(&mut rest, "POINTS");
                    points.push([next()?, next()?, next()?]);
                }
            }
            "POLYGONS" => rows(&mut rest, "POLYGONS", POLYGON, &mut cells, &mut kinds)?,
            "TRIANGLE_STRIPS" => rows(&mut rest, "TRIANGLE_STRIPS", STRIP, &mut cells, &mut kinds)?,
            "CELLS" => rows(&mut rest, "CELLS", POLYGON, &mut cells, &mut kinds)?,
            "CELL_TYPES" => {
                let count: usize = number(&mut rest, "CELL_TYPES")?;
                for k in 0..count {
                    let kind = number(&mut rest, "CELL_TYPES")?;
                    if let Some(own) = kinds.get_mut(k) {
                        *own = kind;
                    }
                }
            }
            "CELL_DATA" | "POINT_DATA" => break,
            _ => {}
        }
    }
    if points.is_empty() {
        return Err(Error::NoPoints);
    }
    let mut triangles = vec![];
    let mut bodies: Vec<[usize; 4]> = vec![];
    for (cell, kind) in cells.iter().zip(kinds) {
        match (kind, cell.as_slice()) {
            (TETRA, [a, b, c, d]) => bodies.push([*a, *b, *c, *d]),
            _ => faces(cell, kind, &points, &mut triangles)?,
        }
    }
    if !bodies.is_empty() {
        // Faces beside them, as Gmsh writes them, are sides of tetrahedra.
        triangles.clear();
        hull(&bodies, &points, &mut triangles)?;
    }
    Ok(triangles)
}

/// The faces that belong to one tetrahedron alone, with their corners counterclockwise as seen from outside.
fn hull(bodies: &[[usize; 4]], points: &[[f64; 3]], out: &mut Vec<Triangle>) -> Result<(), Error> {
    let place = |k: usize| points.get(k).copied().ok_or(Error::NoPoint(k));
    let mut found: BTreeMap<[usize; 3], usize> = BTreeMap::new();
    let sorted = |mut face: [usize; 3]| {
        face.sort_unstable();
        face
    };
    // Each face with the corner across from it.
    let sides = |t: &[usize; 4]| {
        let [a, b, c, d] = *t;
        [([b, c, d], a), ([a, c, d], b), ([a, b, d], c), ([a, b, c], d)]
    };
    for (face, _) in bodies.iter().flat_map(sides) {
        *found.entry(sorted(face)).or_default() += 1;
    }
    if let Some((face, count)) = found.iter().find(|(_, count)| **count > 2) {
        return Err(Error::Shared(*count, *face));
    }
    for (face, inner) in bodies.iter().flat_map(sides) {
        if found.get(&sorted(face)) != Some(&1) {
            continue;
        }
        let [a, b, c] = [place(face[0])?, place(face[1])?, place(face[2])?];
        let inwards = dot(cross(sub(b, a), sub(c, a)), sub(place(inner)?, a)) > 0.0;
        out.push(if inwards { [a, c, b] } else { [a, b, c] });
    }
    Ok(())
}

/// The next number behind a word.
fn number<T: std::str::FromStr>(rest: &mut SplitAsciiWhitespace, word: &'static str) -> Result<T, Error> {
    rest.next().and_then(|text| text.parse().ok()).ok_or(Error::Number(word))
}

/// Rows of corners, each with its length in front.
fn rows(
    rest: &mut SplitAsciiWhitespace,
    word: &'static str,
    kind: usize,
    cells: &mut Vec<Vec<usize>>,
    kinds: &mut Vec<usize>,
) -> Result<(), Error> {
    let count: usize = number(rest, word)?;
    let length: usize = number(rest, word)?;
    let Some(first) = rest.next() else { return Err(Error::Number(word)) };
    if first == "OFFSETS" {
        // Since version 5.1: where each row ends, one number more than rows, then the corners of all rows.
        rest.next();
        let ends = (0..count).map(|_| number(rest, word)).collect::<Result<Vec<usize>, Error>>()?;
        rest.next();
        rest.next();
        let corners = (0..length).map(|_| number(rest, word)).collect::<Result<Vec<usize>, Error>>()?;
        for pair in ends.windows(2) {
            let Some(row) = corners.get(pair[0]..pair[1]) else { return Err(Error::Number(word)) };
            cells.push(row.to_vec());
            kinds.push(kind);
        }
        return Ok(());
    }
    let mut corners: usize = first.parse().map_err(|_| Error::Number(word))?;
    for k in 0..count {
        if k > 0 {
            corners = number(rest, word)?;
        }
        let mut row = vec![];
        for _ in 0..corners {
            row.push(number(rest, word)?);
        }
        cells.push(row);
        kinds.push(kind);
    }
    Ok(())
}

/// The triangles of a cell.
fn faces(cell: &[usize], kind: usize, points: &[[f64; 3]], out: &mut Vec<Triangle>) -> Result<(), Error> {
    match kind {
        TRIANGLE | POLYGON | QUAD => fan(cell, points, out).map_err(Error::NoPoint),
        PIXEL => match cell {
            // A pixel has its corners row by row.
            [a, b, c, d] => fan(&[*a, *b, *d, *c], points, out).map_err(Error::NoPoint),
            _ => Err(Error::Cell(kind)),
        },
        STRIP => {
            for (k, three) in cell.windows(3).enumerate() {
                let [a, b, c] = [three[0], three[1], three[2]];
                let turned = if k % 2 == 0 { [a, b, c] } else { [b, a, c] };
                fan(&turned, points, out).map_err(Error::NoPoint)?;
            }
            Ok(())
        }
        _ if WITHOUT_AREA.contains(&kind) => Ok(()),
        _ => Err(Error::Cell(kind)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "# vtk DataFile Version 2.0\na plate\nASCII\n";

    #[test]
    fn polygons_strips_and_cells_are_read() {
        let square = "POINTS 4 float\n0 0 0  1 0 0\n1 1 0  0 1 0\n";
        let halves = halves_again();
        let poly =
            format!("{HEAD}DATASET POLYDATA\n{square}POLYGONS 1 5\n4 0 1 2 3\nCELL_DATA 1\nSCALARS a int\n");
        assert_eq!(read(poly.as_bytes()), Ok(halves.clone()));
        let grid = format!(
            "{HEAD}DATASET UNSTRUCTURED_GRID\n{square}CELLS 3 11\n3 0 1 2\n3 0 2 3\n2 0 1\nCELL_TYPES 3\n5 5 3\n"
        );
        assert_eq!(read(grid.as_bytes()), Ok(halves));
        // As LIGGGHTS 3.8.0 writes it.
        let newer = format!(
            "# vtk DataFile Version 5.1\n\nASCII\nDATASET POLYDATA\n{square}POLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6\n\
             CONNECTIVITY vtktypeint64\n0 1 2 0 2 3\nCELL_DATA 2\n"
        );
        assert_eq!(read(newer.as_bytes()), Ok(halves_again()));
        let strip = format!("{HEAD}DATASET POLYDATA\n{square}TRIANGLE_STRIPS 1 5\n4 0 1 3 2\n");
        assert_eq!(read(strip.as_bytes()).map(|all| all.len()), Ok(2));
    }

    /// The corners of a cube and its six tetrahedra about the diagonal from 0 to 6.
    pub const CUBE: &str = "POINTS 8 double\n0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1\nCELLS 6 30\n4 0 1 2 6\n\
        4 0 2 3 6\n4 0 3 7 6\n4 0 7 4 6\n4 0 4 5 6\n4 0 5 1 6\nCELL_TYPES 6\n10 10 10 10 10 10\n";

    // A cube has 12 triangles of area 1/2, and the flux of x through them is its volume where all look outwards.
    #[test]
    fn faces_of_one_tetrahedron_alone_are_the_surface() {
        let all = read(format!("{HEAD}DATASET UNSTRUCTURED_GRID\n{CUBE}").as_bytes()).unwrap();
        let volume: f64 = all.iter().map(|[a, b, c]| dot(*a, cross(*b, *c)) / 6.0).sum();
        assert_eq!(all.len(), 12);
        assert!((volume - 1.0).abs() < 1e-15, "{volume}");
        let beside = CUBE.replace("CELLS 6 30", "CELLS 7 34\n3 0 1 2").replace("TYPES 6", "TYPES 7\n5");
        let beside = read(format!("{HEAD}DATASET UNSTRUCTURED_GRID\n{beside}").as_bytes()).unwrap();
        assert_eq!(beside, all);
        let twice = CUBE.replace("4 0 2 3 6", "4 0 1 2 6").replace("4 0 3 7 6", "4 0 1 2 6");
        let fault = read(format!("{HEAD}DATASET UNSTRUCTURED_GRID\n{twice}").as_bytes()).unwrap_err();
        assert!(matches!(fault, Error::Shared(3, _)), "{fault}");
        let beyond = CUBE.replace("4 0 2 3 6", "4 0 2 3 9");
        let fault = read(format!("{HEAD}DATASET UNSTRUCTURED_GRID\n{beyond}").as_bytes()).unwrap_err();
        assert_eq!(fault, Error::NoPoint(9));
    }

    fn halves_again() -> Vec<Triangle> {
        vec![[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]]
    }

    #[test]
    fn broken_files_are_refused() {
        let refusal = |text: &str| read(text.as_bytes()).unwrap_err();
        assert_eq!(refusal("# vtk DataFile Version 2.0\n\nBINARY\n"), Error::Binary);
        assert_eq!(
            refusal(&format!("{HEAD}DATASET POLYDATA\nPOINTS 1 float\n0 0\n")),
            Error::Number("POINTS")
        );
        assert_eq!(refusal(&format!("{HEAD}DATASET POLYDATA\n")), Error::NoPoints);
        assert_eq!(
            refusal(&format!("{HEAD}DATASET STRUCTURED_POINTS\n")),
            Error::Kind("STRUCTURED_POINTS".into())
        );
        let beyond = format!("{HEAD}DATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOLYGONS 1 4\n3 0 0 7\n");
        assert_eq!(refusal(&beyond), Error::NoPoint(7));
        assert!(matches!(
            refusal(&format!("{HEAD}DATASET POLYDATA\nPOINTS 99999999999 float\n0 0 0\n")),
            Error::Number(_)
        ));
    }
}
