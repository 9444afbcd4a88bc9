//! VTP files: VTK's XML of surfaces, its numbers as text, in base64 or appended, plain or compressed by zlib.

mod blocks;
mod xml;

use super::Triangle;
use super::read::fan;
use blocks::{Layout, array};
use xml::{Event, Tag};

/// Rows of faces: the corners of all of them, and where each ends.
#[derive(Default)]
struct Cells {
    connectivity: Vec<f64>,
    offsets: Vec<f64>,
}

/// One part of the surface.
#[derive(Default)]
struct Piece {
    points: Vec<f64>,
    polys: Cells,
    strips: Cells,
}

/// Reads a VTP file.
pub fn read(bytes: &[u8]) -> Result<Vec<Triangle>, String> {
    let mut layout = Layout::default();
    let mut triangles = vec![];
    let mut piece = Piece::default();
    // The elements that are open, and the array whose numbers are looked at.
    let mut open: Vec<&[u8]> = vec![];
    let mut wanted: Option<Tag> = None;
    let appended = xml::appended(bytes)?;
    let mut kind = None;
    for event in xml::events(appended.map_or(bytes, |a| &bytes[..a.begins])) {
        match event? {
            Event::Open(tag) => {
                if tag.name == b"VTKFile" {
                    layout = Layout::of(&tag)?;
                    kind = tag.text("type");
                }
                if tag.name == b"DataArray" {
                    match slot(&open, &tag, &mut piece) {
                        Some(numbers) if tag.text("format").as_deref() == Some("appended") => {
                            let Some(appended) = &appended else {
                                return Err("it has no `AppendedData`, but an array that stands there".into());
                            };
                            *numbers = array(&tag, &layout, &bytes[appended.begins..], Some(appended.raw))?;
                        }
                        Some(_) => wanted = Some(tag.clone()),
                        None => {}
                    }
                }
                if !tag.closed {
                    open.push(tag.name);
                }
            }
            Event::Text(text) => {
                if let Some(tag) = wanted.take()
                    && let Some(numbers) = slot(&open[..open.len().saturating_sub(1)], &tag, &mut piece)
                {
                    *numbers = array(&tag, &layout, text, None)?;
                }
            }
            Event::Close(name) => {
                wanted = None;
                if open.pop() != Some(name) {
                    return Err(format!("`</{}>` closes nothing", String::from_utf8_lossy(name)));
                }
                if name == b"Piece" {
                    std::mem::take(&mut piece).add_to(&mut triangles)?;
                }
            }
        }
    }
    match kind.as_deref() {
        Some("PolyData") if open.is_empty() => Ok(triangles),
        // Behind the arrays that are appended nothing is looked at.
        Some("PolyData") if open == [&b"VTKFile"[..], b"AppendedData"] => Ok(triangles),
        Some("PolyData") => {
            Err(format!("`{}` is never closed", String::from_utf8_lossy(open[open.len() - 1])))
        }
        Some(other) => Err(format!("it holds `{other}`, not `PolyData`")),
        None => Err("it has no element `VTKFile` with a type".into()),
    }
}

/// Where the numbers of an array belong, if it is one of the surface's.
fn slot<'p>(open: &[&[u8]], tag: &Tag, piece: &'p mut Piece) -> Option<&'p mut Vec<f64>> {
    let name = tag.text("Name");
    let cells = match open.last().copied() {
        Some(b"Points") => return Some(&mut piece.points),
        Some(b"Polys") => &mut piece.polys,
        Some(b"Strips") => &mut piece.strips,
        _ => return None,
    };
    match name.as_deref() {
        Some("connectivity") => Some(&mut cells.connectivity),
        Some("offsets") => Some(&mut cells.offsets),
        _ => None,
    }
}

impl Piece {
    fn add_to(self, triangles: &mut Vec<Triangle>) -> Result<(), String> {
        let (points, rest) = self.points.as_chunks::<3>();
        if !rest.is_empty() {
            return Err("the number of its coordinates is no multiple of three".into());
        }
        self.polys.each(points.len(), |face| fan(face, points, triangles))?;
        self.strips.each(points.len(), |strip| {
            for (k, three) in strip.windows(3).enumerate() {
                // Every second triangle of a strip runs the other way round.
                let turned = if k % 2 == 0 { [three[0], three[1]] } else { [three[1], three[0]] };
                fan(&[turned[0], turned[1], three[2]], points, triangles)?;
            }
            Ok(())
        })
    }
}

impl Cells {
    /// Calls `with` for the corners of each row.
    fn each(&self, points: usize, mut with: impl FnMut(&[usize]) -> Result<(), usize>) -> Result<(), String> {
        let mut corners = vec![];
        for x in &self.connectivity {
            let whole = *x >= 0.0 && *x < points as f64;
            corners.push(if whole { *x as usize } else { return Err(format!("there is no point {x}")) });
        }
        let mut from = 0;
        for end in &self.offsets {
            let to = *end as usize;
            let row = corners.get(from..to).ok_or_else(|| format!("no row of faces can end at {end}"))?;
            with(row).map_err(|k| format!("there is no point {k}"))?;
            from = to;
        }
        if from == corners.len() {
            Ok(())
        } else {
            Err("its rows of faces end before their corners do".into())
        }
    }
}

#[cfg(test)]
mod tests;
