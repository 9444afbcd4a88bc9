//! Text dumps in LAMMPS' `atom` and `custom` formats, rows formatted in parallel.

use std::fs::File;
use std::io::{BufWriter, Write};

use super::file::{self, Pattern};
use super::formats::Kind;
use super::make;
use crate::diag::{Code, Result, fail};
use crate::math::cformat::{Format, Value};
use crate::par;

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
    /// Lower and upper faces of the box.
    pub bounds: [[f64; 2]; 3],
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
        text.push_str(&format!("ITEM: BOX BOUNDS {}\n", self.boundary));
        let bound = Format::parse("%-1.16e %-1.16e\n").unwrap_or_default();
        for [lo, hi] in self.bounds {
            text.push_str(&bound.text(&[Value::Float(lo), Value::Float(hi)]));
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
    file: Option<BufWriter<File>>,
    started: bool,
}

impl Target {
    /// Nothing is opened before the first snapshot.
    pub fn new(pattern: Pattern) -> Self {
        Self { pattern, append: false, file: None, started: false }
    }

    /// Whether the next snapshot opens a file.
    pub fn is_fresh(&self) -> bool {
        self.pattern.many() || !self.started
    }

    /// Writes one snapshot and hands it to the system. A file of its own appears whole or not at all.
    pub fn write(
        &mut self,
        step: i64,
        write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<()> {
        let path = self.pattern.at(step);
        let packed = self.pattern.packed();
        let write = |to: &mut dyn Write| file::pack(to, packed, write);
        if self.pattern.many() {
            return file::replace(&path, write);
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
            None => self.file.insert(file::open(&path, self.append)?),
        };
        self.started = true;
        let outcome = write(file).and_then(|()| file.flush());
        if outcome.is_err() {
            self.file = None;
        }
        outcome.map_err(|e| file::trouble("write", &path, &e).into())
    }

    /// Closes a growing file; the next snapshot goes on behind it.
    pub fn close(&mut self) {
        if self.file.take().is_some() {
            self.append = true;
            self.started = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The probe box of 12 spheres: periodic, fixed, shrink-wrapped.
    const BOUNDS: [[f64; 2]; 3] = [[0.0, 2.0], [0.0, 2.0], [-2.2999999999999998e-04, 2.00023]];

    fn lattice() -> Vec<[f64; 3]> {
        let site = |k: usize| [k % 2, k / 2 % 2, k / 4].map(|n| n as f64);
        (0..12).map(site).collect()
    }

    fn text(snapshot: &Snapshot<'_>) -> String {
        let mut out = vec![];
        snapshot.write(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn atom_style_as_lammps() {
        // Written by LAMMPS 22Jul2025 with `dump_modify image yes sort id units yes time yes` (scaled).
        let expected = "\
ITEM: UNITS
lj
ITEM: TIME
0
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
12
ITEM: BOX BOUNDS pp ff ss
0.0000000000000000e+00 2.0000000000000000e+00
0.0000000000000000e+00 2.0000000000000000e+00
-2.2999999999999998e-04 2.0002300000000002e+00
ITEM: ATOMS id type xs ys zs ix iy iz
1 1 0 0 0.000114974 0 0 0
2 2 0.5 0 0.000114974 0 0 0
3 1 0 0.5 0.000114974 0 0 0
4 1 0.5 0.5 0.000114974 0 0 0
5 1 0 0 0.5 0 0 0
6 1 0.5 0 0.5 0 0 0
7 1 0 0.5 0.5 0 0 0
8 1 0.5 0.5 0.5 0 0 0
9 1 0 0 0.999885 0 0 0
10 1 0.5 0 0.999885 0 0 0
11 1 0 0.5 0.999885 0 0 0
12 1 0.5 0.5 0.999885 0 0 0
";
        let x = lattice();
        let int = |name, rule: fn(usize) -> i64| Field { name, format: None, data: Data::int(rule) };
        let scaled = |name, k: usize| {
            let (x, [lo, hi]) = (&x, BOUNDS[k]);
            Field { name, format: None, data: Data::float(move |i| (x[i][k] - lo) / (hi - lo)) }
        };
        let fields = [
            int("id", |i| i as i64 + 1),
            int("type", |i| if i == 1 { 2 } else { 1 }),
            scaled("xs", 0),
            scaled("ys", 1),
            scaled("zs", 2),
            int("ix", |_| 0),
            int("iy", |_| 0),
            int("iz", |_| 0),
        ];
        let mut rows: Vec<u32> = (0..12).rev().collect();
        sort_rows(&mut rows, &fields[0].data, false);
        let snapshot = Snapshot {
            header: true,
            item: "ATOMS",
            step: 0,
            time: Some(0.0),
            units: Some("lj"),
            bounds: BOUNDS,
            boundary: "pp ff ss",
            rows: &rows,
            fields: &fields,
        };
        assert_eq!(text(&snapshot), expected);
    }

    #[test]
    fn custom_formats_and_sorting_as_lammps() {
        // LAMMPS 22Jul2025: `sort -3 format float %12.4f format 1 %05d format int %3d`, columns id type x xs.
        let expected = "\
00002   2       1.0000       0.5000
00004   1       1.0000       0.5000
00006   1       1.0000       0.5000
00008   1       1.0000       0.5000
00010   1       1.0000       0.5000
00012   1       1.0000       0.5000
00001   1       0.0000       0.0000
00003   1       0.0000       0.0000
00005   1       0.0000       0.0000
00007   1       0.0000       0.0000
00009   1       0.0000       0.0000
00011   1       0.0000       0.0000
";
        let [id, int, float] = ["%05d", "%3d", "%12.4f"].map(|f| Format::parse(f).unwrap());
        let x = lattice();
        let fields = [
            Field { name: "id", format: Some(&id), data: Data::int(|i| i as i64 + 1) },
            Field { name: "type", format: Some(&int), data: Data::int(|i| if i == 1 { 2 } else { 1 }) },
            Field { name: "x", format: Some(&float), data: Data::component(&x, 0) },
            Field { name: "xs", format: Some(&float), data: Data::float(|i| x[i][0] / 2.0) },
        ];
        let mut rows: Vec<u32> = (0..12).collect();
        sort_rows(&mut rows, &fields[2].data, true);
        let snapshot = Snapshot {
            header: true,
            item: "ATOMS",
            step: 0,
            time: None,
            units: None,
            bounds: BOUNDS,
            boundary: "pp ff ss",
            rows: &rows,
            fields: &fields,
        };
        assert_eq!(text(&snapshot).split_once("id type x xs\n").unwrap().1, expected);
    }

    #[test]
    fn many_rows_come_in_order() {
        let n = 3 * BATCH / 2 + 17;
        let rows: Vec<u32> = (0..n as u32).collect();
        let fields = [Field { name: "id", format: None, data: Data::int(|i| i as i64) }];
        let snapshot = Snapshot {
            header: true,
            item: "ATOMS",
            step: 7,
            time: None,
            units: None,
            bounds: BOUNDS,
            boundary: "pp pp pp",
            rows: &rows,
            fields: &fields,
        };
        let all = text(&snapshot);
        let body = all.split_once("ATOMS id\n").unwrap().1;
        assert!(body.lines().enumerate().all(|(k, line)| line == k.to_string()));
        assert_eq!(body.lines().count(), n);
    }

    #[test]
    fn targets() {
        let dir = tempfile::tempdir().unwrap();
        let read = |name: &str| std::fs::read_to_string(dir.path().join(name)).unwrap();
        let pattern = |name: &str| Pattern::new(dir.path().join(name).to_str().unwrap()).unwrap();
        let mut one = Target::new(pattern("a.dump"));
        for step in [0, 5] {
            one.write(step, |w| writeln!(w, "{step}")).unwrap();
        }
        assert_eq!(read("a.dump"), "0\n5\n");
        one.close();
        one.write(9, |w| writeln!(w, "9")).unwrap();
        assert_eq!(read("a.dump"), "0\n5\n9\n");
        let mut fresh = Target::new(pattern("a.dump"));
        fresh.write(1, |w| writeln!(w, "1")).unwrap();
        assert_eq!(read("a.dump"), "1\n");
        let mut many = Target::new(pattern("b.*.dump"));
        for step in [0, 5] {
            many.write(step, |w| writeln!(w, "{step}")).unwrap();
        }
        assert_eq!(read("b.0.dump") + &read("b.5.dump"), "0\n5\n");
        let torn = one.write(10, |_| Err(std::io::Error::other("full")));
        assert!(torn.is_err() && one.write(11, |_| Ok(())).is_err());
    }
}
