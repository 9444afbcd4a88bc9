//! The op that prints a row of the step table.

use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::cformat::Value;
use perigrain_output::log::Log;
use perigrain_output::table_row::{LATEST_ROW, RowValue, TableRow};
use perigrain_output::thermo::{Column, Kind, Layout, memory_line};
use perigrain_plan::{About, Needs, Op, Stage, Tick, When};
use perigrain_styles::Reading;
use perigrain_world::World;
use perigrain_world::field::{FACTS, LISTS, SLOTS};
use std::sync::Arc;

/// Prints a row.
pub struct Row {
    /// How it looks.
    pub layout: Layout,
    /// Its values.
    pub readings: Vec<Reading>,
    /// The place in the deck of columns that only a run can provide or lack.
    pub spans: Vec<Option<Span>>,
    /// At which steps.
    pub when: When,
    /// Where to.
    pub log: Log,
    /// Warns once that particles were lost.
    pub warn: bool,
    /// How many columns the header on a narrow screen has.
    pub shown: usize,
}

impl Row {
    /// The row as numbers, per particle where it is printed so.
    fn kept(&self, w: &World, t: &Tick) -> (Vec<String>, perigrain_output::rows::Row) {
        let columns = self.layout.columns.iter().map(|c| c.name.clone()).collect();
        let share = |c: &Column| if self.layout.norm && c.extensive { w.n().max(1) as f64 } else { 1.0 };
        let values =
            self.readings.iter().zip(&self.layout.columns).map(|(r, c)| r.get(w) / share(c)).collect();
        (columns, perigrain_output::rows::Row { step: t.step, time: w.clock.time(), values })
    }

    /// Refuses elements that vectors do not have as the run begins; where they go later, 0 is shown, as in LAMMPS.
    fn all_there(&self, w: &World, t: &Tick) -> Result<()> {
        for ((reading, column), span) in self.readings.iter().zip(&self.layout.columns).zip(&self.spans) {
            let (Some(span), Some(there)) = (span, reading.too_few(w)) else { continue };
            let what = column.name.split('[').next().unwrap_or_default();
            let text =
                format!("there is no `{}`: `{what}` has {there} elements at step {}", column.name, t.step);
            let d = Diagnostic::error(Code::WRONG_KIND, *span, text);
            return Err(d
                .help("show an element that is there, or choose this thermo_style after a run")
                .into());
        }
        Ok(())
    }

    /// Lists on a narrow screen the columns that do not fit.
    fn name_the_rest(&self) {
        let rest: Vec<&str> =
            self.layout.columns.iter().skip(self.shown).map(|c| c.header.as_str()).collect();
        if rest.is_empty() {
            return;
        }
        let place = self.log.path().map_or(String::new(), |path| format!(", in {} alone", path.display()));
        self.log.to_screen(&format!("({} more than fit here{place}: {})", rest.len(), rest.join(" ")));
    }

    /// The row as dumps repeat it.
    fn repeated(&self, w: &World, t: &Tick) -> TableRow {
        let (_, row) = self.kept(w, t);
        let value = |(c, x): (&Column, f64)| match c.kind {
            Kind::Int => (c.usual_header(), RowValue::Whole(x as i64)),
            _ => (c.usual_header(), RowValue::Real(x)),
        };
        TableRow { step: t.step, values: self.layout.columns.iter().zip(row.values).map(value).collect() }
    }
}

impl Op for Row {
    fn about(&self) -> About {
        About {
            when: self.when.clone(),
            ..About::new("thermo", Stage::Output, Needs::new().read(SLOTS | LISTS).write(FACTS | LISTS))
        }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if t.setup {
            self.log.line_or(&memory_line(perigrain_world::memory::bytes(w)), None)?;
            self.all_there(w, t)?;
        }
        let values: Vec<Value> = (self.readings.iter().zip(&self.layout.columns))
            .map(|(r, c)| {
                let a = r.get(w);
                match c.kind {
                    Kind::Int => Value::Int(a as i64),
                    _ => Value::Float(a),
                }
            })
            .collect();
        let atoms = w.n() as u64;
        let fitting = self.log.brief().map_or(usize::MAX, |width| self.layout.fitting(width, atoms, &values));
        if t.setup && !self.layout.header().is_empty() {
            self.shown = fitting;
            self.log.line_or(&self.layout.header(), Some(&self.layout.header_of(fitting)))?;
            self.name_the_rest();
        }
        if self.warn && w.rebuild.lost > 0 {
            self.warn = false;
            let (now, lost) = (atoms, std::mem::take(&mut w.rebuild.lost));
            self.log.line(&format!("WARNING: Lost atoms: original {} current {now}", now + lost))?;
        }
        let cpu = w.clock.began.map_or(0.0, |b| b.elapsed().as_secs_f64());
        let row = self.layout.row(t.step, cpu, atoms, &values);
        match fitting.min(self.shown) {
            n if n >= values.len() => self.log.line(&row)?,
            n => self.log.line_or(&row, Some(&self.layout.row_of(n, t.step, cpu, atoms, &values)))?,
        }
        self.log.row(|| self.kept(w, t));
        let row = Arc::new(self.repeated(w, t));
        w.facts.insert(*LATEST_ROW, row);
        if self.layout.flush { self.log.flush() } else { Ok(()) }
    }
    fn finish(&mut self, _w: &mut World) -> Result<()> {
        self.layout.footer().map_or(Ok(()), |text| self.log.line(text))
    }
}
