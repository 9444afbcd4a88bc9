//! What a bench has found as a table: for people, for programs, for a page.

use super::order::Order;
use super::{Bench, Found, Point};
use crate::sweep::table::{aligned, line};
use perigrain_base::diag::Result;
use perigrain_base::math::cformat::general;
use perigrain_output::file::replace;
use std::path::Path;

/// The table for programs.
pub const TABLE: &str = "bench.csv";

/// The knobs that have a column: the first name of each axis stands for those tied to it.
fn knobs(bench: &Bench) -> Vec<&str> {
    bench.axes.iter().flat_map(|axis| axis.names.iter().map(String::as_str)).collect()
}

/// The axes along which orders make sense.
fn ordered(bench: &Bench) -> Vec<usize> {
    (0..bench.axes.len()).filter(|k| bench.numbers(*k).is_some()).collect()
}

fn value(point: &Point, name: &str) -> String {
    point.vars.iter().find(|(n, _)| n == name).map(|(_, v)| v.clone()).unwrap_or_default()
}

/// A time in three digits.
pub fn seconds(s: f64) -> String {
    let digits = (2.0 - s.max(1e-4).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{s:.digits$}")
}

/// An order in hundredths, without a sign of nothing; `~` in front of one whose halves are uneven.
pub fn hundredths(order: Order) -> String {
    let text = format!("{:.2}", order.power);
    let text = if text == "-0.00" { "0.00".into() } else { text };
    if order.is_even { text } else { format!("~{text}") }
}

/// Heads and rows for people: knobs, seconds, and of each measure value, error (with a star on the front) and observed orders.
pub fn cells(bench: &Bench, found: &Found) -> (Vec<String>, Vec<Vec<String>>) {
    let (knobs, ordered) = (knobs(bench), ordered(bench));
    let mut head: Vec<String> = knobs.iter().map(|k| k.trim_start_matches('-').to_owned()).collect();
    head.push("seconds".into());
    // An order that no setting has needs no column.
    let known = |m: usize, axis: usize| found.points.iter().any(|p| p.errors[m].orders[axis].is_some());
    for (k, m) in bench.measures.iter().enumerate() {
        head.extend([m.name.clone(), format!("error ({})", m.norm.name())]);
        let axes = ordered.iter().filter(|axis| known(k, **axis));
        head.extend(axes.map(|axis| format!("order in {}", bench.axes[*axis].names[0])));
    }
    let row = |point: &Point| {
        let mut row: Vec<String> = knobs.iter().map(|name| value(point, name)).collect();
        row.push(match (point.seconds, &point.problem) {
            (Some(s), _) => seconds(s),
            (None, Some(_)) => "failed".into(),
            (None, None) => String::new(),
        });
        for (k, e) in point.errors.iter().enumerate() {
            let star = if e.in_front { "*" } else { "" };
            let error = match e.error {
                Some(error) => format!("{error:.2e}{star}"),
                None if e.is_reference => "reference".into(),
                None => String::new(),
            };
            row.extend([e.value.map_or(String::new(), |v| general(v, 6)), error]);
            let orders = ordered.iter().filter(|axis| known(k, **axis)).map(|axis| e.orders[*axis]);
            row.extend(orders.map(|order| order.map_or(String::new(), hundredths)));
        }
        row
    };
    (head, found.points.iter().map(row).collect())
}

/// The table for people.
pub fn text(bench: &Bench, found: &Found, width: usize, most: usize) -> String {
    let (head, rows) = cells(bench, found);
    aligned(&head, &rows, width, most)
}

/// The table as text, columns between commas.
pub fn csv(bench: &Bench, found: &Found) -> String {
    let (knobs, ordered) = (knobs(bench), ordered(bench));
    let mut head: Vec<String> = knobs.iter().map(|k| k.trim_start_matches('-').to_owned()).collect();
    head.extend(["seconds", "steps", "atoms", "threads", "repeats"].map(String::from));
    for m in &bench.measures {
        head.extend(["", "_error", "_norm", "_front"].map(|end| format!("{}{end}", m.name)));
        head.extend(ordered.iter().map(|axis| format!("{}_order_{}", m.name, bench.axes[*axis].names[0])));
    }
    head.push("problem".into());
    let number = |v: Option<f64>| v.map_or(String::new(), |v| format!("{v:?}"));
    let row = |point: &Point| {
        let mut row: Vec<String> = knobs.iter().map(|name| value(point, name)).collect();
        row.push(number(point.seconds));
        row.extend([point.steps.to_string(), point.atoms.to_string(), point.threads.to_string()]);
        row.push(point.runs.to_string());
        for (m, e) in bench.measures.iter().zip(&point.errors) {
            let front = if e.in_front { "1" } else { "0" };
            row.extend([number(e.value), number(e.error), m.norm.name().into(), front.into()]);
            row.extend(ordered.iter().map(|axis| number(e.orders[*axis].map(|order| order.power))));
        }
        row.push(point.problem.clone().unwrap_or_default());
        row
    };
    found.points.iter().fold(line(&head), |text, point| text + &line(&row(point)))
}

/// A name that every system takes.
fn plain(name: &str) -> String {
    let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty());
    words.collect::<Vec<_>>().join("_").chars().take(40).collect()
}

/// Writes table and pictures into the folder of the runs; the names of the pictures.
///
/// # Errors
/// Files that cannot be written.
pub fn write(bench: &Bench, found: &Found) -> Result<Vec<String>> {
    let folder: &Path = &bench.sweep.folder;
    replace(&folder.join(TABLE), |w| w.write_all(csv(bench, found).as_bytes()))?;
    let mut names = vec![];
    for (k, chart) in super::picture::charts(bench, found).into_iter().enumerate() {
        let Some(chart) = chart else { continue };
        let name = format!("pareto-{}-{}", k + 1, plain(&bench.measures[k].name));
        let svg = chart.svg();
        replace(&folder.join(format!("{name}.svg")), |w| w.write_all(svg.as_bytes()))?;
        replace(&folder.join(format!("{name}.png")), |w| w.write_all(&chart.png()?))?;
        names.push(name);
    }
    Ok(names)
}
