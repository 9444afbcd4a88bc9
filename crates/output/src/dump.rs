//! Text dumps in LAMMPS' `atom` and `custom` formats, rows formatted in parallel.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use super::file::{self, Pattern};
use super::formats::Kind;
use super::gzip::{self, Growing};
use super::make;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::cformat::{Format, Value};
use perigrain_base::par;

/// Rows formatted at a time, so that memory stays bounded: chunks of a batch run on all threads.
const BATCH: usize = 64 * par::CHUNK;

/// The values of a column, by particle index.
pub enum Data<'a> {
    /// Whole numbers.
    Int(Box<dyn Fn(usize) -> i64 + Sync + 'a>),
    /// Numbers.
    Float(Box<dyn Fn(usize) -> f64 + Sync + 'a>),
    /// Words of a list, and which of them.
    Text(&'a [String], Box<dyn Fn(usize) -> usize + Sync + 'a>),
}

impl<'a> Data<'a> {
    /// Whole numbers by a rule.
    pub fn int(rule: impl Fn(usize) -> i64 + Sync + 'a) -> Self {
        Self::Int(Box::new(rule))
    }

    /// Numbers by a rule.
    pub fn float(rule: impl Fn(usize) -> f64 + Sync + 'a) -> Self {
        Self::Float(Box::new(rule))
    }

    /// Numbers of a slice.
    pub fn slice(values: &'a [f64]) -> Self {
        Self::float(move |i| values[i])
    }

    /// One component of vectors.
    pub fn component(values: &'a [[f64; 3]], k: usize) -> Self {
        Self::float(move |i| values[i][k])
    }

    /// Whole numbers or not.
    pub fn kind(&self) -> Kind {
        match self {
            Self::Int(_) => Kind::Int,
            Self::Float(_) => Kind::Float,
            Self::Text(..) => Kind::Text,
        }
    }

    /// The value of a particle as a number.
    pub fn number(&self, i: usize) -> f64 {
        match self {
            Self::Int(f) => f(i) as f64,
            Self::Float(f) => f(i),
            Self::Text(_, which) => which(i) as f64,
        }
    }

    /// The value of a particle as it is printed.
    pub fn value(&self, i: usize) -> Value<'_> {
        match self {
            Self::Int(f) => Value::Int(f(i)),
            Self::Float(f) => Value::Float(f(i)),
            Self::Text(list, which) => Value::Text(list.get(which(i)).map_or("", String::as_str)),
        }
    }
}

/// A column of a dump.
pub struct Field<'a> {
    /// As it stands in the `ITEM: ATOMS` line.
    pub name: &'a str,
    /// Its format; `None`: `%d`, `%g` or `%s`, as LAMMPS does.
    pub format: Option<&'a Format>,
    /// Its values.
    pub data: Data<'a>,
}

/// The formats of columns that have none of their own.
struct Plain([Format; 3]);

impl Plain {
    fn new() -> Self {
        Self(["%d", "%g", "%s"].map(|f| Format::parse(f).unwrap_or_default()))
    }

    fn of(&self, kind: Kind) -> &Format {
        match kind {
            Kind::Int => &self.0[0],
            Kind::Float => &self.0[1],
            Kind::Text => &self.0[2],
        }
    }
}

/// Writes rows of columns, formatted on all threads: what comes before and after a row, and before a column (from 1).
pub fn write_rows(
    to: &mut dyn Write,
    rows: &[u32],
    fields: &[Field<'_>],
    [before, after]: [&str; 2],
    between: impl Fn(usize) -> &'static str + Sync,
) -> std::io::Result<()> {
    let plain = Plain::new();
    let formats: Vec<&Format> =
        fields.iter().map(|f| f.format.unwrap_or_else(|| plain.of(f.data.kind()))).collect();
    let some = |rows: &[u32]| {
        let mut text = Vec::with_capacity(rows.len() * fields.len() * 12);
        for &i in rows {
            text.extend_from_slice(before.as_bytes());
            for (k, (field, format)) in fields.iter().zip(&formats).enumerate() {
                if k > 0 {
                    text.extend_from_slice(between(k).as_bytes());
                }
                format.write(&mut text, &[field.data.value(i as usize)]);
            }
            text.extend_from_slice(after.as_bytes());
        }
        text
    };
    for batch in rows.chunks(BATCH) {
        let chunks: Vec<&[u32]> = batch.chunks(par::CHUNK).collect();
        for text in make(chunks.len(), |k| some(chunks[k])) {
            to.write_all(&text)?;
        }
    }
    Ok(())
}

/// One snapshot.
pub struct Snapshot<'a> {
    /// Whether there are lines before the rows.
    pub header: bool,
    /// What a row is, as `ATOMS`, and how the line that counts them calls it.
    pub item: &'a str,
    /// Step number.
    pub step: i64,
    /// Simulated time, for `dump_modify time yes`.
    pub time: Option<f64>,
    /// Unit system, for `dump_modify units yes`.
    pub units: Option<&'a str>,
    /// Lower and upper faces of the upright box around the box.
    pub bounds: [[f64; 2]; 3],
    /// How the box leans, where it is one that may.
    pub tilt: Option<[f64; 3]>,
    /// Boundary letters, as `pp ff sm`.
    pub boundary: &'a str,
    /// Particle indices in the order of the rows.
    pub rows: &'a [u32],
    /// Columns from left to right.
    pub fields: &'a [Field<'a>],
}

impl Snapshot<'_> {
    /// Writes the snapshot.
    pub fn write(&self, to: &mut dyn Write) -> std::io::Result<()> {
        if self.header {
            to.write_all(&self.header())?;
        }
        let end = if self.item == "ATOMS" { "\n" } else { " \n" };
        write_rows(to, self.rows, self.fields, ["", end], |_| " ")
    }

    fn header(&self) -> Vec<u8> {
        let mut text = String::new();
        if let Some(units) = self.units {
            text.push_str(&format!("ITEM: UNITS\n{units}\n"));
        }
        if let Some(time) = self.time {
            let time = Format::parse("%.16g").map(|f| f.text(&[Value::Float(time)])).unwrap_or_default();
            text.push_str(&format!("ITEM: TIME\n{time}\n"));
        }
        text.push_str(&format!(
            "ITEM: TIMESTEP\n{}\nITEM: NUMBER OF {}\n{}\n",
            self.step,
            self.item,
            self.rows.len()
        ));
        let leans = if self.tilt.is_some() { "xy xz yz " } else { "" };
        text.push_str(&format!("ITEM: BOX BOUNDS {leans}{}\n", self.boundary));
        let format = if leans.is_empty() { "%-1.16e %-1.16e\n" } else { "%-1.16e %-1.16e %-1.16e\n" };
        let bound = Format::parse(format).unwrap_or_default();
        for (k, [lo, hi]) in self.bounds.into_iter().enumerate() {
            let tilt = self.tilt.map(|tilt| tilt[k]);
            let numbers: Vec<Value> = [lo, hi].into_iter().chain(tilt).map(Value::Float).collect();
            text.push_str(&bound.text(&numbers));
        }
        text.push_str("ITEM: ");
        text.push_str(self.item);
        for field in self.fields {
            text.push(' ');
            text.push_str(field.name);
        }
        text.push('\n');
        text.into_bytes()
    }
}

/// Puts rows in the order of a column; equal values keep their order, NaN comes last.
pub fn sort_rows(rows: &mut [u32], data: &Data<'_>, descending: bool) {
    match data {
        Data::Int(f) if descending => rows.sort_by_key(|&i| std::cmp::Reverse(f(i as usize))),
        Data::Int(f) => rows.sort_by_key(|&i| f(i as usize)),
        Data::Text(list, which) => rows.sort_by(|&a, &b| {
            let [a, b] = [a, b].map(|i| list.get(which(i as usize)));
            if descending { b.cmp(&a) } else { a.cmp(&b) }
        }),
        Data::Float(f) if descending => {
            rows.sort_by(|&a, &b| f(b as usize).total_cmp(&f(a as usize)));
        }
        Data::Float(f) => rows.sort_by(|&a, &b| f(a as usize).total_cmp(&f(b as usize))),
    }
}

/// Where the snapshots of a dump go: one growing file, or one whole file each.
#[derive(Debug)]
pub struct Target {
    /// The name, with `*` where the step goes.
    pub pattern: Pattern,
    /// Whether a growing file keeps what it held before.
    pub append: bool,
    /// The level of compression, from 0 to 9; the usual level if not set.
    pub level: Option<u32>,
    file: Option<Open>,
    started: bool,
}

/// A growing file.
#[derive(Debug)]
enum Open {
    Plain(BufWriter<File>),
    Packed(Growing),
}

impl Open {
    fn add(&mut self, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> std::io::Result<()> {
        match self {
            Open::Plain(file) => write(file).and_then(|()| file.flush()),
            Open::Packed(file) => file.add(write),
        }
    }
}

impl Target {
    /// Nothing is opened yet.
    pub fn new(pattern: Pattern) -> Self {
        Self { pattern, append: false, level: None, file: None, started: false }
    }

    /// Whether the next snapshot opens a file.
    pub fn is_fresh(&self) -> bool {
        self.pattern.many() || !self.started
    }

    /// Makes a growing file before its first snapshot: what an earlier run left in it is not taken for this run's.
    pub fn begin(&mut self) -> Result<()> {
        if self.pattern.many() || self.started || self.file.is_some() {
            return Ok(());
        }
        self.file = Some(self.open(&self.pattern.at(0))?);
        Ok(())
    }

    fn open(&self, path: &Path) -> Result<Open> {
        Ok(match self.packed() {
            None => Open::Plain(file::open(path, self.append)?),
            Some(level) => Open::Packed(Growing::open(path, self.append, level)?),
        })
    }

    /// How tightly the file is packed, if it is.
    fn packed(&self) -> Option<flate2::Compression> {
        let usual = flate2::Compression::default();
        self.pattern.packed().then(|| self.level.map_or(usual, flate2::Compression::new))
    }

    /// Writes one snapshot and hands it to the system. A file of its own appears whole or not at all.
    pub fn write(
        &mut self,
        step: i64,
        write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<()> {
        let path = self.pattern.at(step);
        if self.pattern.many() {
            let packed = self.packed();
            return file::replace(&path, |to| gzip::pack(to, packed, write));
        }
        let file = match &mut self.file {
            Some(file) => file,
            // After a failure nothing more is written behind the torn snapshot.
            None if self.started => {
                return fail(
                    Code::NO_FILE,
                    None,
                    format!("`{}` could not be written before", path.display()),
                );
            }
            None => {
                let open = self.open(&path)?;
                self.file.insert(open)
            }
        };
        self.started = true;
        let outcome = file.add(write);
        if outcome.is_err() {
            self.file = None;
        }
        outcome.map_err(|e| file::trouble("write", &path, &e).into())
    }

    /// Closes a growing file; the next snapshot is appended.
    pub fn close(&mut self) {
        if self.file.take().is_some() {
            self.append = true;
            self.started = false;
        }
    }
}

#[cfg(test)]
mod tests;
