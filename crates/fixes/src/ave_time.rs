//! fix ave/time: averages of global values over time, for other styles and a file.

use super::window::{Ave, Averager, Kept, Samples, Schedule, forget};
use super::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::cformat::{Format, Value};
use perigrain_computes::chunk::{hold, let_go};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_output::Sheet;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, GlobalValue, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, Wants};
use perigrain_world::field::{MEMO, SLOTS};
use perigrain_world::{Key, Numbers, SlotId, World};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The style.
pub struct AveTime;

impl Style for AveTime {
    fn name(&self) -> &'static str {
        "ave/time"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Averages single numbers or global vectors over time and writes them to a file.",
            text: "At every multiple of Nfreq the average is offered as `f_ID` and written; before the first one it is 0. The \
                   group means nothing.\n\n\
                   Scalar where there is one value and vector where there are several in mode scalar; vector for one, array \
                   with a column per value for several in mode vector. Where rows are those of chunks, their number is held \
                   from the first sample of an average to its last, for good with `ave running` and `ave window`.\n\n\
                   Where the elements of a compute have names, as those of energy/ledger, the head of the file has a line more \
                   with them (`# columns: step c_e[kinetic] …`, `# rows: …`), not with `compat lammps`.",
            example: "compute t all temp\nfix mean all ave/time 1 5 10 c_t c_t[*] v_force file mean.txt ave running",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(flatten)]
    samples: Samples,
    /// What is averaged: `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]`, with ranges such as `[*]` or `[2*4]`, or `v_name`.
    #[word(name = "value", least = 1)]
    values: Vec<GlobalValue>,
    #[word(keyword)]
    mode: Mode,
    #[word(keyword, shown = "one")]
    ave: Ave,
    /// No sample before this step.
    #[word(keyword, name = "N", what = "the first step", default = 0)]
    start: i64,
    /// The k-th value is not averaged: its latest sample counts.
    #[word(keyword, name = "k", what = "the number of a value")]
    off: Vec<At<i64>>,
    /// How each number is written.
    #[word(keyword, name = "%g", with = number_format, kind = Kind::Text, default = Format::parse(" %g").unwrap_or_default(), shown = " %g")]
    format: Format,
    #[word(flatten)]
    output: Output,
}

/// Which values are read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Words)]
#[word(what = "mode")]
pub enum Mode {
    /// Values are single numbers.
    #[default]
    Scalar,
    /// Values are whole vectors and columns of arrays.
    Vector,
}

/// Where averages are written.
#[derive(Clone, Default, Words)]
pub struct Output {
    /// Averages are written to this file.
    #[word(keyword, name = "FILE", what = "the file's name")]
    file: Option<At<PathBuf>>,
    /// Averages are written to this file, behind what it holds.
    #[word(keyword, name = "FILE", what = "the file's name")]
    append: Option<At<PathBuf>>,
    /// Only the latest average stays in the file; needs `ave running`.
    #[word(flag)]
    overwrite: bool,
    /// The first line of the file.
    #[word(keyword, name = "text", what = "the title")]
    title1: Option<String>,
    /// The second line of the file.
    #[word(keyword, name = "text", what = "the title")]
    title2: Option<String>,
    /// The third line of the file, where its head has three.
    #[word(keyword, name = "text", what = "the title")]
    title3: Option<String>,
}

/// The file behind the later one of `file` and `append`, and whether it is `append`.
pub fn later<'a>(file: Option<&'a At<PathBuf>>, append: Option<&'a At<PathBuf>>) -> Option<(&'a Path, bool)> {
    let append = append.filter(|a| file.is_none_or(|f| a.span.start > f.span.start));
    let (file, append) = append.map(|a| (a, true)).or(file.map(|f| (f, false)))?;
    Some((&file.value, append))
}

impl Output {
    /// The file, and whether averages stand behind what it holds: of `file` and `append` the later one counts.
    fn target(&self) -> Option<(&Path, bool)> {
        later(self.file.as_ref(), self.append.as_ref())
    }

    /// The file's path.
    pub fn path(&self) -> Option<PathBuf> {
        self.target().map(|(path, _)| path.to_path_buf())
    }

    /// Refuses `overwrite` without running averages.
    ///
    /// # Errors
    /// `overwrite` with another kind of average.
    pub fn check(&self, ave: Ave, cx: &BuildCx) -> Result<()> {
        if !self.overwrite || ave == Ave::Running {
            return Ok(());
        }
        Err(Diagnostic::error(Code::CONFLICT, cx.span, "`overwrite` needs `ave running`")
            .help("a file of the latest average only makes sense for an average of everything so far")
            .into())
    }

    /// Writes the header of the file and stores where it ends.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(&self, w: &mut World, key: Numbers, defaults: &[String]) -> Result<()> {
        self.begin_named(w, key, defaults, None)
    }

    /// As [`Output::begin`], with a line of column names below the header.
    ///
    /// # Errors
    /// As [`Output::begin`].
    pub fn begin_named(
        &self,
        w: &mut World,
        key: Numbers,
        defaults: &[String],
        names: Option<&str>,
    ) -> Result<()> {
        let Some((path, append)) = self.target().filter(|_| !w.promised.instead) else {
            return Ok(());
        };
        let mut head = String::new();
        for (given, default) in [&self.title1, &self.title2, &self.title3].into_iter().zip(defaults) {
            let _ = writeln!(head, "{}", given.as_ref().unwrap_or(default));
        }
        if let Some(names) = names {
            let _ = writeln!(head, "{names}");
        }
        let length = Sheet::begin(path, append, &head)?;
        w.memo.insert(key.with("/file"), vec![length as f64]);
        Ok(())
    }

    /// The file that further averages are written to, if any.
    pub fn sheet(&self, w: &World, key: Numbers) -> Option<Sheet> {
        let (path, _) = self.target()?;
        let head = w.memo.get(key.with("/file")).and_then(|m| m.first()).map_or(0, |a| *a as u64);
        Some(Sheet::new(path, self.overwrite.then_some(head)))
    }
}

/// Parses a number format: one conversion for a floating-point number.
///
/// # Errors
/// Any other format.
pub fn number_format(args: &mut Args, _: &BuildCx) -> Result<Format> {
    let word = args.expect("a format such as %g")?;
    match Format::parse(&word.text) {
        Ok(f) if f.specs().count() == 1 && f.specs().all(|s| s.is_float()) => Ok(f),
        _ => {
            let text = format!("`{}` is no format for a number", word.text);
            Err(Diagnostic::error(Code::BAD_VALUE, word.span, text)
                .help("write one, as %20.16g or %10.4f")
                .into())
        }
    }
}

impl FixStyle for AveTime {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        line.output.check(line.ave, cx)?;
        let mut fix = Declared {
            id: cx.id.to_string(),
            schedule: Schedule::new(&line.samples, line.start)?,
            values: vec![],
            vector: line.mode == Mode::Vector,
            ave: line.ave,
            off: vec![],
            output: line.output,
            format: line.format,
            rows: 0,
            extensive: vec![],
            named: vec![],
        };
        let wants = if fix.vector { Wants::Vector } else { Wants::Number };
        for GlobalValue(word) in &line.values {
            for word in cx.expand(word, wants)? {
                fix.take(&word, wants, cx)?;
            }
        }
        fix.off = vec![false; fix.values.len()];
        for At { span, value: k, .. } in line.off {
            match usize::try_from(k - 1).ok().and_then(|k| fix.off.get_mut(k)) {
                Some(off) => *off = true,
                None => {
                    let text = format!("there is no value {k}: values are 1 to {}", fix.values.len());
                    return fail(Code::BAD_VALUE, span, text);
                }
            }
        }
        Ok(Box::new(fix))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    schedule: Schedule,
    values: Vec<ValueRef>,
    vector: bool,
    ave: Ave,
    off: Vec<bool>,
    output: Output,
    format: Format,
    /// Length of the vectors in mode vector; open if it is known only during a run.
    rows: usize,
    /// Which values are extensive.
    extensive: Vec<bool>,
    /// Names of the values (in mode vector, of the rows), where computes name them.
    named: Vec<Option<String>>,
}

impl Declared {
    fn kept(&self) -> Kept {
        Kept::below(Key::new(&format!("ave/time/{}", self.id)))
    }

    /// Parses and adds one value.
    fn take(&mut self, word: &perigrain_lang::Word, wants: Wants, cx: &BuildCx) -> Result<()> {
        let Some(r) = ValueRef::parse(&word.text, word.span)? else {
            return fail(Code::WRONG_KIND, word.span, "c_ID, f_ID or v_name is expected");
        };
        cx.reading(&r, wants)?;
        let shape = cx.shape(&r).unwrap_or_default();
        super::compatible(&r, &shape, self.schedule.every, "Nevery")?;
        if self.vector {
            let rows = if r.index.is_empty() { shape.vector } else { shape.array_rows };
            if !self.values.is_empty() && rows != self.rows && rows != Shape::OPEN && self.rows != Shape::OPEN
            {
                let text = format!("`{r}` has {rows} elements, the values before it {}", self.rows);
                return fail(Code::CONFLICT, word.span, text);
            }
            self.rows = rows;
        }
        let grows = match (self.vector, r.index.is_empty()) {
            (false, _) => cx.names.extensive(&r),
            (true, true) => shape.vector_extensive,
            (true, false) => shape.array_extensive,
        };
        self.extensive.push(grows);
        self.take_names(&r, cx);
        self.values.push(r);
        Ok(())
    }

    /// Stores the name of a value, or the names of the rows of a vector.
    fn take_names(&mut self, r: &ValueRef, cx: &BuildCx) {
        let names = if r.kind == RefKind::Compute { cx.names.elements(&r.name) } else { vec![] };
        match (self.vector, r.index.first()) {
            (false, Some(k)) => {
                let name = k.checked_sub(1).and_then(|k| names.get(k));
                self.named.push(name.map(|name| format!("c_{}[{name}]", r.name)));
            }
            (false, None) => self.named.push(None),
            (true, None) if self.named.is_empty() => self.named = names.into_iter().map(Some).collect(),
            (true, _) => {}
        }
    }

    /// A line of column names below LAMMPS' header, so that a file can be read without the manual.
    fn names_line(&self) -> Option<String> {
        if self.named.iter().all(Option::is_none) {
            return None;
        }
        let names = self.named.iter().enumerate().map(|(k, name)| match name {
            Some(name) => format!(" {name}"),
            None => format!(" {}", self.values[k]),
        });
        let head = if self.vector { "# rows:" } else { "# columns: step" };
        Some(head.to_owned() + &names.collect::<String>())
    }

    fn titles(&self) -> Vec<String> {
        let names: String = self.values.iter().map(|v| format!(" {v}")).collect();
        let first = format!("# Time-averaged data for fix {}", self.id);
        match self.vector {
            false => vec![first, format!("# TimeStep{names}")],
            true => vec![first, "# TimeStep Number-of-rows".into(), format!("# Row{names}")],
        }
    }

    /// Keys of the chunk counts that set the number of rows; these counts stay fixed while rows are summed.
    fn windows(&self, w: &World, slots: &[SlotId]) -> Vec<Numbers> {
        let adds = self.vector && (self.schedule.repeat > 1 || self.ave != Ave::One);
        slots.iter().filter(|_| adds).filter_map(|slot| w.slots.get(*slot).chunks).collect()
    }

    /// The slots of the values.
    fn slots(&self, w: &World) -> Vec<SlotId> {
        let name = |r: &ValueRef| format!("{}_{}", r.kind.letter(), r.name);
        self.values.iter().filter_map(|r| w.slots.find(&name(r))).collect()
    }

    /// The block of one average in the file.
    fn block(&self, step: i64, means: &[f64]) -> String {
        let cols = self.values.len();
        let cells =
            |row: &[f64]| -> String { row.iter().map(|a| self.format.text(&[Value::Float(*a)])).collect() };
        if !self.vector {
            return format!("{step}{}\n", cells(means));
        }
        let mut text = format!("{step} {}\n", means.len() / cols.max(1));
        for (k, row) in means.chunks_exact(cols).enumerate() {
            let _ = writeln!(text, "{}{}", k + 1, cells(row));
        }
        text
    }
}

/// Fills a fix's slot with averages: a scalar or a vector of scalars, one vector or an array of several.
fn offer(w: &mut World, slot: SlotId, step: i64, means: &[f64], cols: usize, vector: bool) {
    let out = w.slots.get_mut(slot);
    out.step = Some(step);
    match (vector, cols) {
        (false, 1) => out.scalar = means.first().copied().unwrap_or(0.0),
        (false, _) | (true, 1) => out.vector = means.to_vec(),
        (true, _) => (out.array, out.array_cols) = (means.to_vec(), cols),
    }
}

impl Fix for Declared {
    fn facts(&self, _: &World) -> Facts {
        Facts { at_rest: AtRest::Acts, counts_steps: true, file: self.output.path(), ..Facts::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.schedule.declare(w, &self.kept());
        let slot = w.slots.id(&format!("f_{}", self.id));
        let rows = if !self.vector {
            1
        } else if self.rows == Shape::OPEN {
            0
        } else {
            self.rows
        };
        *w.slots.get_mut(slot) =
            perigrain_world::Slot { name: format!("f_{}", self.id), ..Default::default() };
        offer(w, slot, w.clock.step, &vec![0.0; rows * self.values.len()], self.values.len(), self.vector);
        let names = self.names_line().filter(|_| !w.settings.lammps());
        self.output.begin_named(w, self.kept().key, &self.titles(), names.as_deref())
    }

    fn remove(&self, w: &mut World) {
        forget(w, self.kept().key);
        self.windows(w, &self.slots(w)).into_iter().for_each(|window| let_go(w, window));
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = self.schedule.when();
        let wants = if self.vector { Wants::Vector } else { Wants::Number };
        let mut readings = vec![];
        for r in &self.values {
            readings.push(cx.reading(r, wants, Stage::EndOfStep, &when)?);
        }
        let (me, kept, slot, span) =
            (self.clone(), self.kept(), cx.slot(&format!("f_{}", self.id)), cx.span());
        let mut sheet = self.output.sheet(cx.world(), kept.key);
        let (repeat, ave, off) = (self.schedule.repeat, self.ave, self.off.clone());
        let averager = Averager { kept, repeat, ave, off };
        let slots = self.slots(cx.world());
        let access = Needs::new().read(SLOTS).write(SLOTS).keep(MEMO);
        let op = StepOp::new(format!("fix {} ave/time", self.id), Stage::EndOfStep, access, move |w, t| {
            let Some(due) = me.schedule.due(w, &kept, t.step) else { return Ok(()) };
            if due.first {
                let last = (me.ave == Ave::One).then(|| me.schedule.last(t.step));
                me.windows(w, &slots)
                    .into_iter()
                    .try_for_each(|window| hold(w, window, t.step, last, span))?;
            }
            let lists: Vec<Vec<f64>> = readings.iter().map(|r| r.list(w)).collect();
            let rows = lists.first().map_or(0, Vec::len);
            if lists.iter().any(|l| l.len() != rows) {
                return fail(Code::CONFLICT, None, "the values to average have different lengths");
            }
            let row_by_row: Vec<f64> = (0..rows).flat_map(|r| lists.iter().map(move |l| l[r])).collect();
            let Some((total, count)) = averager.add(w, &row_by_row, due) else { return Ok(()) };
            let means: Vec<f64> = total.iter().map(|a| a / count).collect();
            offer(w, slot, t.step, &means, lists.len(), me.vector);
            sheet.as_mut().map_or(Ok(()), |s| s.block(&me.block(t.step, &means)))
        });
        Ok(vec![op.when(when).in_setup(true).boxed()])
    }

    fn shape(&self) -> Shape {
        let n = self.values.len();
        let grows = self.extensive.contains(&true);
        let every = self.schedule.freq;
        match (self.vector, n) {
            (false, 1) => Shape { scalar: true, scalar_extensive: grows, every, ..Shape::default() },
            (false, _) => Shape { vector: n, vector_extensive: grows, every, ..Shape::default() },
            (true, 1) => Shape { vector: self.rows, vector_extensive: grows, every, ..Shape::default() },
            (true, _) => {
                Shape { array: n, array_rows: self.rows, array_extensive: grows, every, ..Shape::default() }
            }
        }
    }

    fn extensive(&self, index: &[usize]) -> bool {
        match (self.vector, index) {
            (false, [k]) => self.extensive.get(k - 1).copied().unwrap_or(false),
            _ => self.extensive.contains(&true),
        }
    }
}
