//! Wall time against error: the settings of a bench, the Pareto front marked.

use super::table::hundredths;
use super::{Bench, Found};
use crate::plot::{COLOURS, Chart, Curve, Look, terminal};

const FRONT: u32 = 0xd0_2020;

/// Settings that differ along one axis only: its name and their places in the order of the axis.
struct Line {
    name: String,
    points: Vec<usize>,
}

/// The chart of each measure; none where no setting has an error.
pub fn charts(bench: &Bench, found: &Found) -> Vec<Option<Chart>> {
    (0..bench.measures.len()).map(|m| chart(bench, found, m)).collect()
}

fn chart(bench: &Bench, found: &Found, measure: usize) -> Option<Chart> {
    let m = &bench.measures[measure];
    let mut curves = vec![];
    let mut front = vec![];
    for (k, line) in lines(bench).into_iter().enumerate() {
        let points: Vec<[f64; 2]> = line.points.iter().filter_map(|p| place(found, measure, *p)).collect();
        let ahead = line.points.iter().filter(|p| found.points[**p].errors[measure].in_front);
        front.extend(ahead.filter_map(|p| place(found, measure, *p)));
        let name = with_order(bench, found, measure, &line);
        curves.push(Curve { name, points, look: Look::Chain, colour: COLOURS[k % COLOURS.len()] });
    }
    curves.retain(|c| !c.points.is_empty());
    if curves.is_empty() {
        return None;
    }
    curves.push(Curve { name: "Pareto front".into(), points: front, look: Look::Rings, colour: FRONT });
    Some(Chart {
        title: format!("{}: wall time against error", m.name),
        x: "wall time of the steps, s".into(),
        y: format!("error of {} ({})", m.name, m.norm.name()),
        logarithmic: true,
        curves,
    })
}

/// Wall time and error, where both can stand on logarithmic axes.
fn place(found: &Found, measure: usize, point: usize) -> Option<[f64; 2]> {
    let p = &found.points[point];
    let (seconds, error) = (p.seconds?, p.errors.get(measure)?.counted()?);
    (seconds > 0.0 && error > 0.0 && error.is_finite()).then_some([seconds, error])
}

/// The axis that lines go along: the last one with numbers.
fn along(bench: &Bench) -> Option<usize> {
    (0..bench.axes.len()).rev().find(|k| bench.numbers(*k).is_some())
}

/// All settings in lines along one axis; one line of all without such an axis.
fn lines(bench: &Bench) -> Vec<Line> {
    let Some(axis) = along(bench) else {
        return vec![Line { name: "settings".into(), points: (0..bench.settings()).collect() }];
    };
    let starts = (0..bench.settings()).filter(|p| bench.places(*p)[axis] == 0);
    let line = |start: usize| {
        let mut places = bench.places(start);
        let points = (0..bench.axes[axis].rows.len()).map(|k| {
            places[axis] = k;
            bench.at(&places)
        });
        let others = bench.axes.iter().enumerate().zip(bench.places(start)).filter(|((k, _), _)| *k != axis);
        let name = |((_, a), place): ((usize, &crate::session::axes::Axis), usize)| match a.names[0].as_str()
        {
            super::PROGRAM => a.rows[place][0].clone(),
            name => format!("{} {}", name.trim_start_matches('-'), a.rows[place][0]),
        };
        let name = others.map(name).collect::<Vec<_>>().join(", ");
        let own = &bench.axes[axis].names[0];
        Line { points: points.collect(), name: if name.is_empty() { own.clone() } else { name } }
    };
    starts.map(line).collect()
}

/// The line's name with the last order that was observed along it.
fn with_order(bench: &Bench, found: &Found, measure: usize, line: &Line) -> String {
    let axis = along(bench);
    let order = |p: &usize| found.points[*p].errors[measure].orders[axis?];
    match line.points.iter().rev().find_map(order) {
        Some(order) => format!("{}: order {}", line.name, hundredths(order)),
        None => line.name.clone(),
    }
}

/// The picture of a measure for a terminal: letters mark settings, capitals those on the front.
pub fn text(bench: &Bench, found: &Found, measure: usize, colours: bool) -> Option<String> {
    let all = lines(bench);
    let mut marks = vec![];
    let mut names = vec![];
    for (k, line) in all.iter().enumerate() {
        let letter = char::from(b'a' + (k % 26) as u8);
        for &p in &line.points {
            let Some(place) = place(found, measure, p) else { continue };
            let in_front = found.points[p].errors[measure].in_front;
            marks.push((place, if in_front { letter.to_ascii_uppercase() } else { letter }));
        }
        names.push(format!("{letter} {}", with_order(bench, found, measure, line)));
    }
    if marks.is_empty() {
        return None;
    }
    let points = |line: &Line| line.points.iter().filter_map(|p| place(found, measure, *p)).collect();
    let curves: Vec<terminal::Curve> = all
        .iter()
        .zip(&names)
        .map(|(line, name)| terminal::Curve { name, points: points(line) })
        .filter(|curve| !curve.points.is_empty())
        .collect();
    let m = &bench.measures[measure];
    let head = format!(
        "error of {} ({}) against {}; capitals are on the Pareto front\n",
        m.name,
        m.norm.name(),
        m.against.describe()
    );
    Some(head + &terminal::logarithmic(&curves, &marks, "seconds", colours))
}
