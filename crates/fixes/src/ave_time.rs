//! fix ave/time: averages of global values over time, for other styles and a file.

use super::window::{Ave, Averager, Kept, Schedule, forget};
use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::cformat::{Format, Value};
use perigrain_computes::chunk::{hold, let_go};
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_output::Sheet;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, Wants};
use perigrain_world::field::{MEMO, SLOTS};
use perigrain_world::{Key, Numbers, SlotId, World};
use std::fmt::Write;
use std::path::PathBuf;

/// The style.
pub struct AveTime;

impl Style for AveTime {
    fn name(&self) -> &'static str {
        "ave/time"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "fix ID group ave/time Nevery Nrepeat Nfreq value … [keyword value …]",
            summary: "Averages single numbers or global vectors over time and writes them to a file.",
            text: "A value is `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]`, with ranges such as `[*]` or `[2*4]`, or `v_name`. At every \
                   multiple of Nfreq the average of Nrepeat samples, Nevery steps apart, the last of them at that step, is \
                   offered as `f_ID` and written. The group means nothing.\n\n\
                   `mode scalar|vector`: values are single numbers (default), or whole vectors and columns of arrays. \
                   `ave one|running|window M`: each average for itself, the mean of all so far, or of the last M. \
                   `start N`: no sample before step N. `off k`: the k-th value is not averaged, its latest sample counts. \
                   `file name` and `append name`: where averages go; `overwrite`: only the latest stays there (needs \
                   `ave running`). `format %g`: of each number. `title1 title2 title3`: the lines at the head of the file \
                   (the third in mode vector only). Where the elements of a compute have names, as those of energy/ledger, one more line lists them \
                   (`# columns: step c_e[kinetic] …`, `# rows: …`), not with `compat lammps`.\n\n\
                   Scalar where there is one value and vector where there are several in mode scalar; vector for one, array \
                   with a column per value for several in mode vector. 0 before the first average. Where \
                   rows are those of chunks, their number is held from the first sample of an average to its last, for good with \
                   `ave running` and `ave window`.",
            example: "compute t all temp\nfix mean all ave/time 1 5 10 c_t c_t[*] v_force file mean.txt ave running",
        }
    }
}

/// Where averages are written.
#[derive(Clone, Default)]
pub struct Output {
    /// The file and whether it goes on behind what is there.
    pub file: Option<(PathBuf, bool)>,
    /// Only the latest average stays.
    pub overwrite: bool,
    /// Lines at the head, where given.
    pub titles: [Option<String>; 3],
}

impl Output {
    /// Takes `file`, `append`, `overwrite` or a title with what follows; `false` for any other word.
    ///
    /// # Errors
    /// A missing name or title.
    pub fn read(&mut self, word: &str, args: &mut Args) -> Result<bool> {
        match word {
            "file" | "append" => {
                self.file = Some((PathBuf::from(&args.expect("the file's name")?.text), word == "append"));
            }
            "overwrite" => self.overwrite = true,
            "title1" | "title2" | "title3" => {
                let k = usize::from(word.as_bytes()[5] - b'1');
                self.titles[k] = Some(args.expect("the title")?.text.clone());
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// `overwrite` goes with running averages only.
    ///
    /// # Errors
    /// Another kind.
    pub fn check(&self, ave: Ave, cx: &BuildCx) -> Result<()> {
        if !self.overwrite || ave == Ave::Running {
            return Ok(());
        }
        Err(Diagnostic::error(Code::CONFLICT, cx.span, "`overwrite` needs `ave running`")
            .help("a file of the latest average only makes sense for an average of everything so far")
            .into())
    }

    /// Writes the head of the file and remembers where it ends.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(&self, w: &mut World, key: Numbers, defaults: &[String]) -> Result<()> {
        self.begin_named(w, key, defaults, None)
    }

    /// As [`Output::begin`], with a line of names below the head.
    ///
    /// # Errors
    /// As there.
    pub fn begin_named(
        &self,
        w: &mut World,
        key: Numbers,
        defaults: &[String],
        names: Option<&str>,
    ) -> Result<()> {
        let Some((path, append)) = self.file.as_ref().filter(|_| !w.parts.promised.instead) else {
            return Ok(());
        };
        let mut head = String::new();
        for (given, default) in self.titles.iter().zip(defaults) {
            let _ = writeln!(head, "{}", given.as_ref().unwrap_or(default));
        }
        if let Some(names) = names {
            let _ = writeln!(head, "{names}");
        }
        let length = Sheet::begin(path, *append, &head)?;
        w.memo.insert(key.with("/file"), vec![length as f64]);
        Ok(())
    }

    /// The file for further averages, if there is one.
    pub fn sheet(&self, w: &World, key: Numbers) -> Option<Sheet> {
        let (path, _) = self.file.as_ref()?;
        let head = w.memo.get(key.with("/file")).and_then(|m| m.first()).map_or(0, |a| *a as u64);
        Some(Sheet::new(path, self.overwrite.then_some(head)))
    }
}

/// Takes the format of numbers: one conversion for a number with a point.
///
/// # Errors
/// Any other format.
pub fn number_format(args: &mut Args) -> Result<Format> {
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
        let mut schedule = Schedule::read(args)?;
        let words = leading_values(args)?;
        let mut fix = Declared {
            id: cx.id.to_string(),
            schedule,
            values: vec![],
            vector: false,
            ave: Ave::One,
            off: vec![],
            output: Output::default(),
            format: Format::parse(" %g").unwrap_or_default(),
            rows: 0,
            extensive: vec![],
            named: vec![],
        };
        let mut off = vec![];
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "mode" => fix.vector = args.choice("mode", &["scalar", "vector"])? == "vector",
                "ave" => fix.ave = Ave::read(args)?,
                "start" => schedule.start = args.integer("the first step")?,
                "off" => off.push((args.here(), args.integer("the number of a value")?)),
                "format" => fix.format = number_format(args)?,
                other if fix.output.read(other, args)? => {}
                _ => return Err(args.unknown(word, KEYWORDS)),
            }
        }
        fix.schedule = schedule;
        fix.output.check(fix.ave, cx)?;
        let wants = if fix.vector { Wants::Vector } else { Wants::Number };
        for word in words {
            for word in cx.expand(word, wants)? {
                fix.take(&word, wants, cx)?;
            }
        }
        fix.off = vec![false; fix.values.len()];
        for (span, k) in off {
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

const KEYWORDS: &[&str] =
    &["mode", "ave", "start", "off", "file", "append", "overwrite", "format", "title1", "title2", "title3"];

/// The words up to the first that names no value.
///
/// # Errors
/// No value at all.
pub fn leading_values<'a>(args: &mut Args<'a>) -> Result<Vec<&'a perigrain_lang::Word>> {
    let mut words = vec![];
    while let Some(word) = args.peek().filter(|w| ["c_", "f_", "v_"].iter().any(|p| w.text.starts_with(p))) {
        args.next();
        words.push(word);
    }
    match (words.is_empty(), args.peek()) {
        (false, _) => Ok(words),
        (true, None) => args.expect("a value such as c_ID or v_name").map(|w| vec![w]),
        (true, Some(w)) => {
            let text = format!("`{}` is no value: c_ID, f_ID or v_name is expected", w.text);
            fail(Code::WRONG_KIND, w.span, text)
        }
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
    /// Length of the vectors, in mode vector; open if only a run can tell.
    rows: usize,
    /// Which values grow with the scene.
    extensive: Vec<bool>,
    /// What the values are, in mode vector what the rows are, where computes have names for that.
    named: Vec<Option<String>>,
}

impl Declared {
    fn kept(&self) -> Kept {
        Kept::below(Key::new(&format!("ave/time/{}", self.id)))
    }

    /// Adds a value.
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

    /// Takes note of what a value is, or what the rows of a vector are.
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

    /// A line of names below LAMMPS' own head, for files that are read without the manual.
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

    /// What holds the number of chunks of which values have rows: it is held as long as rows are added up.
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

/// Fills a fix's slot with averages: one number or a vector of them, one vector or an array of several.
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
        Facts {
            counts_steps: true,
            file: self.output.file.as_ref().map(|(path, _)| path.clone()),
            ..Facts::default()
        }
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
