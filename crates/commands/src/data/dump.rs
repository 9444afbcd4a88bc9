//! LAMMPS' text dumps (`dump atom`, `dump custom`) as they are read: snapshots, their boxes and columns.

use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_geometry::text::{Line, Lines, not_here, number, whole};
use perigrain_world::{Boundary, Domain};

/// One snapshot: its head, and where its rows begin.
#[derive(Clone, Debug)]
pub struct Snapshot<'a> {
    /// The step it was written at.
    pub step: i64,
    /// Lower corner of the box [length].
    pub lo: [f64; 3],
    /// Upper corner.
    pub hi: [f64; 3],
    /// How it leans, where it is one that may.
    pub tilt: Option<[f64; 3]>,
    /// Labels of the columns.
    pub labels: Vec<&'a str>,
    /// Place of the labels.
    pub title: Span,
    rows: Lines<'a>,
    count: usize,
}

/// Takes the next snapshot; `None` at the end of the file.
///
/// # Errors
/// What is no dump, general triclinic boxes, files that break off.
pub fn next<'a>(lines: &mut Lines<'a>) -> Result<Option<Snapshot<'a>>> {
    let (mut step, mut count, mut edges) = (None, None, None);
    while let Some(line) = lines.take_filled() {
        let Some(item) = line.text.strip_prefix("ITEM:").map(str::trim) else {
            let d =
                Diagnostic::error(Code::SYNTAX, line.span(), "an `ITEM:` line of a dump is expected here");
            return Err(d.help("read_dump reads text dumps of the styles atom and custom").into());
        };
        if item == "TIMESTEP" {
            step = Some(single(lines, "the step")?);
        } else if item == "NUMBER OF ATOMS" {
            count = Some(single(lines, "the number of atoms")?.max(0) as usize);
        } else if item == "UNITS" || item == "TIME" {
            lines.take();
        } else if let Some(faces) = item.strip_prefix("BOX BOUNDS") {
            if faces.contains("abc") {
                return Err(not_here(line.span(), "a general triclinic box").into());
            }
            let leans = faces.contains("xy");
            edges = Some(([edge(lines, leans)?, edge(lines, leans)?, edge(lines, leans)?], leans));
        } else if let Some(labels) = item.strip_prefix("ATOMS") {
            let (Some(step), Some(count), Some((edges, leans))) = (step, count, edges) else {
                let text = "a snapshot needs TIMESTEP, NUMBER OF ATOMS and BOX BOUNDS before ATOMS";
                return fail(Code::INCOMPLETE, line.span(), text);
            };
            let rows = *lines;
            for have in 0..count {
                if lines.take().is_none() {
                    let text = format!("the snapshot of step {step} breaks off after {have} of {count} rows");
                    return fail(Code::INCOMPLETE, line.span(), text);
                }
            }
            let (lo, hi, tilt) = inner(edges);
            if let Some(d) = (0..3).find(|&d| (hi[d] - lo[d]).is_nan() || lo[d] >= hi[d]) {
                let text = format!("the box leans so far that nothing is left of {}", ["x", "y", "z"][d]);
                return fail(Code::BAD_VALUE, line.span(), text);
            }
            let tilt = leans.then_some(tilt);
            let labels = labels.split_ascii_whitespace().collect();
            return Ok(Some(Snapshot { step, lo, hi, tilt, labels, title: line.span(), rows, count }));
        } else {
            return Err(not_here(line.span(), &format!("`ITEM: {item}` in a dump")).into());
        }
    }
    match (step, count) {
        (None, None) => Ok(None),
        _ => fail(Code::INCOMPLETE, lines.end(), "the file breaks off within a snapshot"),
    }
}

fn taken<'a>(lines: &mut Lines<'a>, what: &str) -> Result<Line<'a>> {
    match lines.take() {
        Some(line) => Ok(line),
        None => fail(Code::INCOMPLETE, lines.end(), format!("the file ends where {what} should be")),
    }
}

fn single(lines: &mut Lines, what: &str) -> Result<i64> {
    let line = taken(lines, what)?;
    whole(&line, line.word(0), what)
}

/// Corners and tilts of a box from the faces around it.
fn inner([x, y, z]: [[f64; 3]; 3]) -> ([f64; 3], [f64; 3], [f64; 3]) {
    let tilt = [x[2], y[2], z[2]];
    let [[low_x, high_x], [low_y, high_y], _] = boxed([0.0; 3], [0.0; 3], Some(tilt)).bounds();
    ([x[0] - low_x, y[0] - low_y, z[0]], [x[1] - high_x, y[1] - high_y, z[1]], tilt)
}

fn boxed(lo: [f64; 3], hi: [f64; 3], tilt: Option<[f64; 3]>) -> Domain {
    Domain { tilt, ..Domain::new(lo, hi, Boundary::default()) }
}

fn edge(lines: &mut Lines, leans: bool) -> Result<[f64; 3]> {
    let line = taken(lines, "a face of the box")?;
    let tilt = if leans { number(&line, line.word(2), "the tilt")? } else { 0.0 };
    let edge = [
        number(&line, line.word(0), "the lower face")?,
        number(&line, line.word(1), "the upper face")?,
        tilt,
    ];
    if edge[0] < edge[1] {
        Ok(edge)
    } else {
        fail(Code::BAD_VALUE, line.span(), "the faces are in wrong order")
    }
}

impl<'a> Snapshot<'a> {
    /// The place at these fractions of the box's edges.
    pub fn at(&self, f: [f64; 3]) -> [f64; 3] {
        self.domain().at(f)
    }

    /// The box.
    pub fn domain(&self) -> Domain {
        boxed(self.lo, self.hi, self.tilt)
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether it holds none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The column with one of these labels, the first label that there is.
    pub fn column(&self, labels: &[&str]) -> Option<(usize, &'a str)> {
        labels.iter().find_map(|l| self.labels.iter().position(|m| m == l).map(|k| (k, self.labels[k])))
    }

    /// Calls `take` with each row: its line and words.
    ///
    /// # Errors
    /// Rows of the wrong length, and those of `take`.
    pub fn rows(&self, mut take: impl FnMut(&Line<'a>, &[&'a str]) -> Result<()>) -> Result<()> {
        let mut lines = self.rows;
        let mut words = Vec::with_capacity(self.labels.len());
        for _ in 0..self.count {
            let Some(line) = lines.take() else { break };
            words.clear();
            words.extend(line.words());
            if words.len() != self.labels.len() {
                let text =
                    format!("this row has {} columns, the snapshot {}", words.len(), self.labels.len());
                let d = Diagnostic::error(Code::SYNTAX, line.span(), text);
                return Err(d.label(self.title, "the columns").into());
            }
            take(&line, &words)?;
        }
        Ok(())
    }
}
