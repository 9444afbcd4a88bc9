//! Snapshots in other forms than LAMMPS' own: XYZ, YAML, and CFG for AtomEye.

use std::io::Write;

use super::dump::{Field, write_rows};
use crate::table_row::{RowValue, TableRow};
use perigrain_base::math::cformat::{Format, Value, shortest};

/// A number as `%g`.
fn g(x: f64) -> String {
    Format::parse("%g").map_or_else(|_| x.to_string(), |f| f.text(&[Value::Float(x)]))
}

/// A name as a word of YAML: brackets would begin a list.
fn word(name: &str) -> String {
    if name.contains(['[', ']']) { format!("'{name}'") } else { name.to_string() }
}

/// One XYZ snapshot: the number of particles, a line of comment, and a row for each.
pub fn xyz(
    to: &mut dyn Write,
    step: i64,
    time: Option<f64>,
    rows: &[u32],
    fields: &[Field<'_>],
) -> std::io::Result<()> {
    write!(to, "{}\n Atoms. Timestep: {step}", rows.len())?;
    if let Some(time) = time {
        write!(to, " Time: {time:.6}")?;
    }
    writeln!(to)?;
    write_rows(to, rows, fields, ["", "\n"], |_| " ")
}

/// What stands above the rows of a YAML snapshot.
pub struct Yaml<'a> {
    /// Step number.
    pub step: i64,
    /// Unit system, for `units yes`.
    pub units: Option<&'a str>,
    /// Simulated time, for `time yes`.
    pub time: Option<f64>,
    /// Boundary letters, as `pp ff sm`.
    pub boundary: &'a str,
    /// The row of the step table, for `thermo yes`.
    pub row: Option<&'a TableRow>,
    /// Lower and upper faces of the upright box around the box.
    pub bounds: [[f64; 2]; 3],
    /// How the box leans, where it is one that may.
    pub tilt: Option<[f64; 3]>,
    /// Whether to write all this.
    pub header: bool,
}

impl Yaml<'_> {
    /// Writes one document.
    pub fn write(&self, to: &mut dyn Write, rows: &[u32], fields: &[Field<'_>]) -> std::io::Result<()> {
        if self.header {
            self.head(to, rows.len())?;
            write!(to, "keywords: [ ")?;
            for f in fields {
                write!(to, "{}, ", word(f.name))?;
            }
            writeln!(to, " ]\ndata:")?;
        }
        write_rows(to, rows, fields, ["  - [ ", ", ]\n"], |_| " , ")?;
        writeln!(to, "...")
    }

    fn head(&self, to: &mut dyn Write, count: usize) -> std::io::Result<()> {
        writeln!(to, "---\ncreator: LAMMPS\ntimestep: {}", self.step)?;
        if let Some(units) = self.units {
            writeln!(to, "units: {units}")?;
        }
        if let Some(time) = self.time {
            writeln!(to, "time: {}", shortest(time))?;
        }
        write!(to, "natoms: {count}\nboundary: [ ")?;
        for letter in self.boundary.chars().filter(|c| *c != ' ') {
            write!(to, "{letter}, ")?;
        }
        writeln!(to, "]")?;
        if let Some(row) = self.row {
            write!(to, "thermo:\n  - keywords: [ ")?;
            row.values.iter().try_for_each(|(name, _)| write!(to, "{}, ", word(name)))?;
            write!(to, "]\n  - data: [ ")?;
            for (_, value) in &row.values {
                match value {
                    RowValue::Whole(k) => write!(to, "{k}, ")?,
                    RowValue::Real(x) => write!(to, "{}, ", shortest(*x))?,
                }
            }
            writeln!(to, "]")?;
        }
        writeln!(to, "box:")?;
        for [lo, hi] in self.bounds {
            writeln!(to, "  - [ {}, {} ]", shortest(lo), shortest(hi))?;
        }
        if let Some([xy, xz, yz]) = self.tilt.map(|tilt| tilt.map(shortest)) {
            writeln!(to, "  - [ {xy}, {xz}, {yz} ]")?;
        }
        Ok(())
    }
}

/// One CFG snapshot: mass and element on lines of their own, scaled positions and what else there is behind them.
/// The first five columns are mass, element and the three positions.
pub fn cfg(
    to: &mut dyn Write,
    scale: f64,
    edges: [[f64; 3]; 3],
    rows: &[u32],
    fields: &[Field<'_>],
) -> std::io::Result<()> {
    writeln!(to, "Number of particles = {}\nA = {} Angstrom (basic length-scale)", rows.len(), g(scale))?;
    for (i, edge) in edges.iter().enumerate() {
        for (j, h) in edge.iter().enumerate() {
            writeln!(to, "H0({},{}) = {} A", i + 1, j + 1, g(*h))?;
        }
    }
    let rest = fields.get(2..).unwrap_or(&[]);
    writeln!(to, ".NO_VELOCITY.\nentry_count = {}", rest.len())?;
    for (k, f) in rest.iter().skip(3).enumerate() {
        writeln!(to, "auxiliary[{k}] = {}", f.name)?;
    }
    write_rows(to, rows, fields, ["", "\n"], |k| if k <= 2 { " \n" } else { " " })
}
