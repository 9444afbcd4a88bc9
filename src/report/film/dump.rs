//! Snapshots of text dumps, as LAMMPS and perigrain write them.

use super::taken::{order, span};
use super::{Cell, Column, Film, Frame, Grid};
use perigrain_base::diag::{Diagnostics, Result, Source};
use perigrain_commands::data::dump::{Snapshot, next};
use perigrain_geometry::text::{Lines, load, number};
use perigrain_output::file::trouble;
use std::path::Path;
use std::sync::Arc;

/// Adds the snapshots of a dump to a film; what is wrong from some place on, if something is.
///
/// # Errors
/// A file that cannot be read.
pub fn add(path: &Path, film: &mut Film) -> Result<Option<(Arc<Source>, Diagnostics)>> {
    let text = load(path).map_err(|e| trouble("read the dump", path, &e))?;
    let mut lines = Lines::at(&text.text, 0);
    let mut outcome = Ok(());
    loop {
        // Only those that are kept are looked at closely.
        match next(&mut lines) {
            Ok(None) => break,
            Ok(Some(snapshot)) => {
                let at = film.seen as u64;
                if !at.is_multiple_of(film.every()) {
                    film.seen += 1;
                    continue;
                }
                match frame(&snapshot, film.last().map(|frame| frame.grid)) {
                    Ok(frame) => film.take(at, frame),
                    Err(e) => outcome = Err(e),
                }
            }
            Err(e) => outcome = Err(e),
        }
        if outcome.is_err() {
            break;
        }
    }
    Ok(outcome.err().map(|e| (text, e)))
}

/// Columns with the place of a particle.
const PLACES: [[&str; 4]; 3] = [["x", "xu", "xs", "xsu"], ["y", "yu", "ys", "ysu"], ["z", "zu", "zs", "zsu"]];

/// One snapshot with all its columns of numbers.
fn frame(s: &Snapshot, before: Option<Grid>) -> Result<Frame> {
    let n = s.len();
    let mut places = vec![[0.0; 3]; n];
    let mut columns: Vec<Vec<f64>> = s.labels.iter().map(|_| Vec::with_capacity(n)).collect();
    let (mut row, mut texts) = (0, vec![false; s.labels.len()]);
    s.rows(|line, words| {
        for (k, word) in words.iter().enumerate() {
            match number(line, word, s.labels[k]) {
                Ok(value) => columns[k].push(value),
                // `element` and the like are no numbers.
                Err(_) if row == 0 || texts[k] => {
                    texts[k] = true;
                    columns[k].push(0.0);
                }
                Err(e) => return Err(e),
            }
        }
        row += 1;
        Ok(())
    })?;
    let mut scaled = [false; 3];
    for (d, labels) in PLACES.iter().enumerate() {
        let Some((k, label)) = s.column(labels) else { continue };
        scaled[d] = label.contains('s');
        places.iter_mut().zip(&columns[k]).for_each(|(place, value)| place[d] = *value);
    }
    if scaled != [false; 3] {
        for place in &mut places {
            let there = s.at([0, 1, 2].map(|d| if scaled[d] { place[d] } else { 0.0 }));
            (0..3).filter(|&d| scaled[d]).for_each(|d| place[d] = there[d]);
        }
    }
    let tags: Vec<u32> =
        s.column(&["id"]).map_or(vec![], |(k, _)| columns[k].iter().map(|v| *v as u32).collect());
    let order = order(&tags);
    let at = |k: usize| order.as_ref().map_or(k, |order| order[k] as usize);
    let span = span(places.iter().copied());
    let grid = Grid::over(span, before);
    let x = std::array::from_fn(|d| (0..n).map(|k| grid.count(d, places[at(k)][d])).collect());
    let sorted = |k: usize| -> Vec<f64> { (0..n).map(|i| columns[k][at(i)]).collect() };
    let hidden = |label: &str| PLACES.iter().flatten().any(|p| *p == label);
    let mut out: Vec<Column> = vec![];
    for (k, label) in s.labels.iter().enumerate().filter(|(k, label)| !texts[*k] && !hidden(label)) {
        match *label {
            "diameter" => {
                let radii: Vec<f64> = sorted(k).iter().map(|d| 0.5 * d).collect();
                out.push(Column::of("radius", &radii));
            }
            label => out.push(Column::of(label, &sorted(k))),
        }
    }
    if let (Some((x, _)), Some((y, _)), Some((z, _))) =
        (s.column(&["vx"]), s.column(&["vy"]), s.column(&["vz"]))
    {
        let speed = |k: usize| [x, y, z].iter().map(|c| columns[*c][at(k)].powi(2)).sum::<f64>().sqrt();
        out.push(Column::of("speed", &(0..n).map(speed).collect::<Vec<_>>()));
    }
    Ok(Frame {
        step: s.step,
        time: None,
        cell: Cell::of(&s.domain()),
        units: [""; 3],
        walls: [].into(),
        span,
        grid,
        x,
        columns: out,
    })
}
