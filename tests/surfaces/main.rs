//! Surfaces, movers, servos and walls with laws of coefficients, beside numbers of LIGGGHTS 3.8.0 (`tests/liggghts`).
//!
//! The files hold what the real program printed: 12 digits in tables and dumps, 6 in STL.

mod contacts;
mod movers;
mod pressing;
mod tables;
mod through;

use crate::decks::run_in;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Where the numbers are.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/liggghts")
}

/// Rows of numbers by step.
type Rows = BTreeMap<i64, Vec<f64>>;

/// The rows of a table with so many columns.
fn table(text: &str, columns: usize) -> Rows {
    let mut rows = Rows::new();
    for line in text.lines() {
        let row: Option<Vec<f64>> = line.split_whitespace().map(|w| w.parse().ok()).collect();
        if let Some(row) = row.filter(|row| row.len() == columns + 1) {
            rows.insert(row[0] as i64, row[1..].to_vec());
        }
    }
    rows
}

/// What the real program printed.
fn golden(name: &str) -> String {
    fs::read_to_string(folder().join(format!("{name}.txt"))).unwrap()
}

/// The row of the first particle in a dump by step: what stands behind its ID.
fn dumped(text: &str) -> Rows {
    let mut rows = Rows::new();
    let mut step = None;
    for line in text.lines() {
        if let Some(rest) = line.strip_prefix("step ") {
            step = rest.split(' ').next().and_then(|k| k.parse().ok());
            continue;
        }
        if let (Some(step), Some(rest)) = (step, line.strip_prefix("1 ")) {
            rows.insert(step, rest.split_whitespace().map(|w| w.parse().unwrap()).collect());
        }
    }
    rows
}

/// The same of our own dump.
fn own_dump(text: &str) -> Rows {
    let mut rows = Rows::new();
    for frame in text.split("ITEM: TIMESTEP\n").skip(1) {
        let step = frame.lines().next().unwrap().trim().parse().unwrap();
        let row = frame.lines().find(|line| line.starts_with("1 ") && line.split(' ').count() > 4);
        if let Some(row) = row {
            rows.insert(step, row.split_whitespace().skip(1).map(|w| w.parse().unwrap()).collect());
        }
    }
    rows
}

/// Whether two rows agree to a part of their size.
fn close(name: &str, step: i64, own: &[f64], theirs: &[f64], part: f64) {
    let size = theirs.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    for (k, (a, b)) in own.iter().zip(theirs).enumerate() {
        // Numbers far below the others of their row are rounding there.
        let allowed = part * b.abs().max(1e-6 * size);
        assert!((a - b).abs() <= allowed, "{name}, step {step}, column {k}: {a} beside {b}");
    }
    assert_eq!(own.len(), theirs.len(), "{name}, step {step}");
}

/// Runs a deck in a folder with the surfaces; its output and the folder.
fn ran(deck: &str) -> (String, tempfile::TempDir) {
    let place = tempfile::tempdir().unwrap();
    for name in ["plate", "tri", "far", "flow", "big"] {
        let file = format!("{name}.stl");
        fs::copy(folder().join(&file), place.path().join(&file)).unwrap();
    }
    let (text, well) = run_in(place.path(), deck, &[]);
    assert!(well, "{deck}\n{text}");
    (text, place)
}

/// Coefficients of LIGGGHTS' hertz with history: x_gamma = 2 √(G*/Y*) = 2 √((1 − ν)/(2 (2 − ν))) for ν = 0.45.
fn hertz(restitution: f64) -> String {
    let x_gamma = 2.0 * (0.55f64 / 3.1).sqrt();
    format!(
        "hertz/material 5.e6 {restitution} 0.45 damping coeff_restitution tangential mindlin NULL {x_gamma:.16} 0.5"
    )
}

/// The head of the decks: one type of grains in a box of half this size.
fn head(half: f64, dt: f64, restitution: f64) -> String {
    let hertz = hertz(restitution);
    format!(
        "units si\natom_style sphere\nboundary f f f\nregion reg block -{half} {half} -{half} {half} -{half} {half} units box\n\
         create_box 1 reg\nneighbor 0.002 bin\ntimestep {dt}\npair_style granular\npair_coeff 1 1 {hertz}\n"
    )
}

/// A grain of 10 mm at a place with a velocity.
fn grain(place: &str, velocity: &str) -> String {
    format!(
        "create_atoms 1 single {place} units box\nset atom 1 diameter 0.01 density 2500\nvelocity all set {velocity} units box\n"
    )
}

/// A dump of the grain at each step.
const DUMP: &str = "dump d all custom 1 d.txt id x y z vx vy vz fx fy fz omegax omegay omegaz tqx tqy tqz\n\
                    dump_modify d format float %.12g\n";
