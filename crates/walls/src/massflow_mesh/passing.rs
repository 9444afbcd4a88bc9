//! The file of fix massflow/mesh: a row for each grain that passes.

use perigrain_base::diag::Result;
use perigrain_base::math::cformat::{Format, Value};
use perigrain_output::Sheet;
use perigrain_styles::words::At;
use perigrain_world::World;
use std::path::PathBuf;

/// Where rows go, as declared.
#[derive(Clone, Debug)]
pub struct Target {
    path: PathBuf,
    append: bool,
    time: bool,
}

impl Target {
    /// Of `file` and `append` the later one counts; nothing without either.
    pub fn of(file: Option<At<PathBuf>>, append: Option<At<PathBuf>>, time: bool) -> Option<Self> {
        let append = append.filter(|a| file.as_ref().is_none_or(|f| a.span.start > f.span.start));
        let (at, append) = append.map(|a| (a, true)).or(file.map(|f| (f, false)))?;
        Some(Self { path: at.value, append, time })
    }

    /// The file.
    pub fn path(&self) -> &PathBuf {
        &self.path
    }

    /// Writes the first line (measured with LIGGGHTS 3.8.0, in an appended file too).
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(&self) -> Result<()> {
        let time = if self.time { "time  " } else { "" };
        let title = format!("# ID {time}diameter x y z u v w  (ex ey ez, color)\n");
        Sheet::begin(&self.path, self.append, &title).map(drop)
    }

    /// The file during a run.
    pub fn open(&self) -> Passing {
        let format = if self.time { "%d  %4.4g  " } else { "%d " };
        let row = Format::parse(&format!("{format}%4.4g %4.4g %4.4g %4.4g %4.4g %4.4g %4.4g\n"));
        Passing { sheet: Sheet::new(&self.path, None), row: row.unwrap_or_default(), time: self.time }
    }
}

/// The file during a run.
pub struct Passing {
    sheet: Sheet,
    row: Format,
    time: bool,
}

impl Passing {
    /// Adds rows for these particles: ID, the time, diameter, position, velocity, four digits each.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, w: &World, passed: &[usize]) -> Result<()> {
        let (p, mut text) = (&w.particles, String::new());
        for &i in passed {
            let mut row = vec![Value::Int(i64::from(p.tag[i]))];
            row.extend(self.time.then(|| Value::Float(w.clock.time())));
            row.push(Value::Float(2.0 * p.radius.get(i).copied().unwrap_or(0.0)));
            row.extend(p.x[i].iter().chain(&p.v[i]).map(|x| Value::Float(*x)));
            text += &self.row.text(&row);
        }
        if text.is_empty() { Ok(()) } else { self.sheet.block(&text) }
    }
}
