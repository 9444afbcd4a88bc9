//! VTP files: VTK's XML of surfaces.

use super::Triangle;
use super::read::fan;
use super::vtk::xml::{self, Document};
use perigrain_base::diag::{Diagnostics, FileId};
use thiserror::Error;

/// Rows of faces: their corners, and the end of each row.
#[derive(Default)]
struct Cells {
    connectivity: Vec<f64>,
    offsets: Vec<f64>,
}

/// One part of the surface.
struct Piece {
    points: Vec<f64>,
    polys: Cells,
    strips: Cells,
}

/// Why a file is no VTP file.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Error {
    /// What reading the XML says, with line or byte.
    #[error("{0}")]
    Xml(String),
    #[error("the number of its coordinates is no multiple of three")]
    Coordinates,
    #[error("there is no point {0}")]
    NoPoint(f64),
    #[error("no row of faces can end at {0}")]
    RowEnd(f64),
    #[error("its rows of faces end before their corners do")]
    Rows,
}

/// Reads a VTP file.
pub fn read(bytes: &[u8]) -> Result<Vec<Triangle>, Error> {
    let problem = |e: Diagnostics| Error::Xml(sentence(&e, bytes));
    let document = Document::read(bytes, "PolyData").map_err(problem)?;
    let mut triangles = vec![];
    for piece in &document.pieces {
        Piece::read(&document, piece).map_err(problem)?.add_to(&mut triangles)?;
    }
    Ok(triangles)
}

/// The message, with line or byte offset.
fn sentence(e: &Diagnostics, bytes: &[u8]) -> String {
    let at = e.0.first().and_then(|d| d.span).filter(|s| s.file == FileId::BROUGHT).map(|s| s.start as usize);
    match at.map(|at| (at, std::str::from_utf8(&bytes[..at.min(bytes.len())]))) {
        None => e.to_string(),
        Some((_, Ok(text))) => format!("{e} (line {})", 1 + text.matches('\n').count()),
        Some((at, Err(_))) => format!("{e} (byte {at})"),
    }
}

impl Piece {
    fn read(document: &Document, piece: &xml::Piece) -> Result<Self, Diagnostics> {
        let numbers = |of: &str, name: &str| {
            let array = document.array(piece, of, name);
            array.map_or(Ok(vec![]), |array| document.numbers(array))
        };
        let cells = |of: &str| -> Result<Cells, Diagnostics> {
            Ok(Cells { connectivity: numbers(of, "connectivity")?, offsets: numbers(of, "offsets")? })
        };
        Ok(Self { points: numbers("Points", "")?, polys: cells("Polys")?, strips: cells("Strips")? })
    }

    fn add_to(self, triangles: &mut Vec<Triangle>) -> Result<(), Error> {
        let (points, rest) = self.points.as_chunks::<3>();
        if !rest.is_empty() {
            return Err(Error::Coordinates);
        }
        self.polys.each(points.len(), |face| fan(face, points, triangles))?;
        self.strips.each(points.len(), |strip| {
            for (k, three) in strip.windows(3).enumerate() {
                // Every second triangle of a strip has the opposite order.
                let turned = if k % 2 == 0 { [three[0], three[1]] } else { [three[1], three[0]] };
                fan(&[turned[0], turned[1], three[2]], points, triangles)?;
            }
            Ok(())
        })
    }
}

impl Cells {
    /// Calls `with` for the corners of each row.
    fn each(&self, points: usize, mut with: impl FnMut(&[usize]) -> Result<(), usize>) -> Result<(), Error> {
        let mut corners = vec![];
        for x in &self.connectivity {
            let whole = *x >= 0.0 && *x < points as f64;
            corners.push(if whole { *x as usize } else { return Err(Error::NoPoint(*x)) });
        }
        let mut from = 0;
        for end in &self.offsets {
            let to = *end as usize;
            let row = corners.get(from..to).ok_or(Error::RowEnd(*end))?;
            with(row).map_err(|k| Error::NoPoint(k as f64))?;
            from = to;
        }
        if from == corners.len() { Ok(()) } else { Err(Error::Rows) }
    }
}

#[cfg(test)]
mod tests;
