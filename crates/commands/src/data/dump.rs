//! LAMMPS' text dumps (`dump atom`, `dump custom`) as they are read: snapshots, their boxes and columns.

use super::text::{Line, Lines, not_here, number, whole};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};

/// One snapshot: its head, and where its rows begin.
#[derive(Clone, Debug)]
pub struct Snapshot<'a> {
    /// The step it was written at.
    pub step: i64,
    /// Lower corner of the box [length].
    pub lo: [f64; 3],
    /// Upper corner.
    pub hi: [f64; 3],
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
/// What is no dump, tilted boxes, files that break off.
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
            if faces.contains("xy") || faces.contains("abc") {
                return Err(not_here(line.span(), "a tilted box").into());
            }
            edges = Some([edge(lines)?, edge(lines)?, edge(lines)?]);
        } else if let Some(labels) = item.strip_prefix("ATOMS") {
            let (Some(step), Some(count), Some(edges)) = (step, count, edges) else {
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
            let (lo, hi) = (edges.map(|e| e[0]), edges.map(|e| e[1]));
            let labels = labels.split_ascii_whitespace().collect();
            return Ok(Some(Snapshot { step, lo, hi, labels, title: line.span(), rows, count }));
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

fn edge(lines: &mut Lines) -> Result<[f64; 2]> {
    let line = taken(lines, "a face of the box")?;
    let edge =
        [number(&line, line.word(0), "the lower face")?, number(&line, line.word(1), "the upper face")?];
    if edge[0] < edge[1] {
        Ok(edge)
    } else {
        fail(Code::BAD_VALUE, line.span(), "the faces are in wrong order")
    }
}

impl<'a> Snapshot<'a> {
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
