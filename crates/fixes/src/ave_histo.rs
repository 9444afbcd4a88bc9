//! fix ave/histo and ave/histo/weight: histograms over time.

use super::ave_atom::{Input, Source};
use super::ave_time::{Mode, Output};
use super::bins::{Beyond, Bins, Histogram};
use super::window::{Ave, Averager, Due, Kept, Samples, Schedule, forget};
use super::{AtRest, Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_base::math::cformat::{general, shortest};
use perigrain_computes::reduce::BIG;
use perigrain_lang::{Args, ValueRef, Word};
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, GlobalValue, Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, Wants};
use perigrain_world::field::{F, MASK, MEMO, SLOTS, V, X};
use perigrain_world::{GroupId, Key, Numbers, Slot, World};
use std::fmt::Write;

/// `fix ave/histo`.
pub struct AveHisto;

/// `fix ave/histo/weight`.
pub struct AveHistoWeight;

const PAGE: &str = "All values are of one kind (global, per atom, local). At every multiple of Nfreq the histogram of the samples is \
    offered and written. Only particles of the group count.\n\n\
    Vector of 4: values counted, values not counted, smallest and largest. Array with a row per bin: its centre, its count, \
    its share. Under `-compat lammps` smallest and largest of `ave running` begin at 0, as in LAMMPS 22Jul2025.";

#[derive(Words)]
struct Line {
    #[word(flatten)]
    samples: Samples,
    /// The lower end of the first bin.
    #[word(what = "lo")]
    lo: At<f64>,
    /// The upper end of the last bin.
    #[word(what = "hi")]
    hi: At<f64>,
    /// The number of bins.
    #[word(name = "Nbin", with = bins, kind = Kind::Whole)]
    bins: usize,
    /// What is counted: `x y z vx vy vz fx fy fz`, `c_ID`, `c_ID[k]`, `f_ID`, `f_ID[k]` with ranges such as `[*]`, and `v_name`.
    #[word(name = "value", least = 1)]
    values: Vec<Sorted>,
    #[word(keyword)]
    mode: Mode,
    /// Which values of a style that has several.
    #[word(keyword)]
    kind: Option<Level>,
    #[word(keyword, shown = "one")]
    ave: Ave,
    /// No sample before this step.
    #[word(keyword, name = "N", what = "the first step", default = 0)]
    start: i64,
    #[word(keyword)]
    beyond: Beyond,
    #[word(flatten)]
    output: Output,
}

/// Which values of a style that has several.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "kind")]
enum Level {
    /// Its global vector or array.
    Global,
    /// Its values per particle.
    Peratom,
    /// Its local values: of pairs, bonds and the like.
    Local,
}

/// A value that is sorted into bins, as it stands there.
struct Sorted(Word);

impl Value for Sorted {
    const KIND: Kind = Kind::Attribute;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect("a value such as vx, c_ID or v_name")?;
        if Self::begins(word) {
            return Ok(Self(word.clone()));
        }
        fail(Code::WRONG_KIND, word.span, "a value is expected: x … fz, c_ID, f_ID or v_name")
    }
    fn begins(word: &Word) -> bool {
        Input::attribute(&word.text).is_some() || GlobalValue::begins(word)
    }
}

fn bins(args: &mut Args, _: &BuildCx) -> Result<usize> {
    args.count("the number of bins", BYTES_PER_BIN)
}

impl Style for AveHisto {
    fn name(&self) -> &'static str {
        "ave/histo"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Counts how often values fall into each of equal bins, over time.",
            text: PAGE,
            example: "fix h all ave/histo 1 1 1 -2.0 2.0 8 vx vy vz mode vector file speeds.txt beyond end",
        }
    }
}

impl Style for AveHistoWeight {
    fn name(&self) -> &'static str {
        "ave/histo/weight"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "As fix ave/histo, but each value counts as much as its weight.",
            text: "Exactly two values of the same length: the first is sorted into bins, the second is what it adds to its \
                   bin. Everything else is as for [fix ave/histo](fix_ave_histo.md).",
            example: "fix h all ave/histo/weight 1 1 1 -2.0 2.0 8 vz c_dmg mode vector",
        }
    }
}

impl FixStyle for AveHisto {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        build(args, cx, false)
    }
}

impl FixStyle for AveHistoWeight {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        build(args, cx, true)
    }
}

/// Counts of this sample and of all so far, and a row of what is shown.
const BYTES_PER_BIN: f64 = 80.0;

fn build(args: &mut Args, cx: &BuildCx, weight: bool) -> Result<Box<dyn Fix>> {
    let line: Line = read(args, cx)?;
    let Line { samples, lo, hi, bins, values, mode, kind, ave, start, beyond, output } = line;
    if lo.value >= hi.value && !lo.unknown && !hi.unknown {
        let text = format!("hi must be above lo: {} is not above {}", hi.value, lo.value);
        return fail(Code::BAD_VALUE, hi.span, text);
    }
    output.check(ave, cx)?;
    let schedule = Schedule::new(&samples, start)?;
    let (inputs, wants) = inputs(&values, mode == Mode::Vector, kind, schedule.every, cx)?;
    if weight && inputs.len() != 2 {
        let text = format!("two values are needed, one to sort and its weight: here are {}", inputs.len());
        return fail(Code::BAD_VALUE, values[0].0.span, text);
    }
    let bins = Bins { lo: lo.value, hi: hi.value, inner: bins, beyond };
    let (id, group) = (cx.id.to_string(), cx.group);
    Ok(Box::new(Declared { id, group, schedule, bins, inputs, wants, weight, ave, output }))
}

/// The inputs, all of one kind.
fn inputs(
    words: &[Sorted],
    vector: bool,
    kind: Option<Level>,
    every: i64,
    cx: &BuildCx,
) -> Result<(Vec<Input>, Wants)> {
    let mut found: Vec<(Input, Wants, Span)> = vec![];
    for Sorted(word) in words {
        if let Some(input) = Input::attribute(&word.text) {
            found.push((input, Wants::PerAtom, word.span));
            continue;
        }
        let wants = if vector { kind_of(word, kind, cx)? } else { Wants::Number };
        for word in cx.expand(word, wants)? {
            let Some(r) = ValueRef::parse(&word.text, word.span)? else { continue };
            cx.reading(&r, wants)?;
            super::compatible(&r, &cx.shape(&r).unwrap_or_default(), every, "Nevery")?;
            found.push((Input::Value(r), wants, word.span));
        }
    }
    let wants = found.first().map_or(Wants::Number, |f| f.1);
    if let Some((.., span)) = found.iter().find(|f| f.1 != wants) {
        return fail(
            Code::CONFLICT,
            *span,
            "values of different kinds (global, per atom, local) in one histogram",
        );
    }
    if wants == Wants::PerAtom && !vector {
        return fail(Code::CONFLICT, found[0].2, "per-atom values need `mode vector`");
    }
    Ok((found.into_iter().map(|f| f.0).collect(), wants))
}

/// What kind of values a reference has in mode vector.
fn kind_of(word: &Word, kind: Option<Level>, cx: &BuildCx) -> Result<Wants> {
    let head = word.text.split('[').next().unwrap_or(&word.text);
    let shape = match ValueRef::parse(head, word.span)? {
        Some(r) => cx.shape(&r).unwrap_or_default(),
        None => Shape::default(),
    };
    Ok(match kind {
        Some(Level::Peratom) => Wants::PerAtom,
        Some(Level::Local) => Wants::Local,
        Some(Level::Global) => Wants::Vector,
        None if shape.vector > 0 || shape.array > 0 => Wants::Vector,
        None if shape.atom.is_some() => Wants::PerAtom,
        None if shape.local > 0 => Wants::Local,
        None => Wants::Vector,
    })
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    schedule: Schedule,
    bins: Bins,
    inputs: Vec<Input>,
    wants: Wants,
    weight: bool,
    ave: Ave,
    output: Output,
}

impl Declared {
    fn kept(&self) -> Kept {
        let style = if self.weight { "ave/histo/weight" } else { "ave/histo" };
        Kept::below(Key::new(&format!("{style}/{}", self.id)))
    }

    /// The current values of one input.
    fn list(&self, w: &World, source: &Source) -> Vec<f64> {
        match source {
            Source::Reading(r) if self.wants != Wants::PerAtom => r.list(w),
            _ => {
                let bit = self.group.bit();
                let chosen = (0..w.n()).filter(|&i| w.particles.mask[i] & bit != 0);
                chosen.map(|i| source.atom(w, i)).collect()
            }
        }
    }

    /// Adds one sample to those `before` in the same average: one sum, in LAMMPS' order.
    fn sample(&self, w: &World, sources: &[Source], before: Option<Vec<f64>>) -> Result<Histogram> {
        let mut h = Histogram::new(&self.bins);
        if let Some(counts) = before.filter(|b| b.len() == h.counts.len()) {
            h.counts = counts;
        }
        if let (true, [values, weights]) = (self.weight, sources) {
            let (values, weights) = (self.list(w, values), self.list(w, weights));
            if values.len() != weights.len() {
                return fail(Code::CONFLICT, None, "there are not as many weights as values");
            }
            values.iter().zip(&weights).for_each(|(v, weight)| h.add(&self.bins, *v, *weight));
            return Ok(h);
        }
        for source in sources {
            self.list(w, source).iter().for_each(|v| h.add(&self.bins, *v, 1.0));
        }
        Ok(h)
    }

    /// Smallest and largest value over all samples of the average; `one` holds those of this sample.
    fn extremes(&self, w: &mut World, key: Numbers, one: [f64; 2], due: Due) -> [f64; 2] {
        let lammps = w.settings.lammps();
        let list = w.memo.get_or(key, Vec::new);
        let fold = |list: &[f64]| {
            list.chunks_exact(2)
                .fold([f64::INFINITY, f64::NEG_INFINITY], |e, p| [e[0].min(p[0]), e[1].max(p[1])])
        };
        let keep = match self.ave {
            Ave::One => 0,
            Ave::Running => 1,
            Ave::Window(m) => m - 1,
        };
        if due.first {
            if self.ave == Ave::Running && !list.is_empty() {
                let all = fold(list);
                *list = all.to_vec();
            }
            let spare = (list.len() / 2).saturating_sub(keep) * 2;
            list.drain(..spare);
            if self.ave == Ave::Running && list.is_empty() && lammps {
                list.extend([0.0, 0.0]);
            }
            list.extend(one);
        } else if let [.., lo, hi] = &mut list[..] {
            (*lo, *hi) = (lo.min(one[0]), hi.max(one[1]));
        }
        let [lo, hi] = fold(list);
        // For no values, the same result as `compute reduce`.
        if lo > hi { [BIG, -BIG] } else { [lo, hi] }
    }

    /// The block of one histogram in the file.
    fn block(&self, step: i64, stats: &[f64; 4], rows: &[f64]) -> String {
        let mut text = format!("{step} {}", self.bins.count());
        for a in stats {
            let _ = write!(text, " {}", shortest(*a));
        }
        text.push('\n');
        for (k, row) in rows.chunks_exact(3).enumerate() {
            let cells: Vec<String> = row.iter().map(|a| general(*a, 6)).collect();
            let _ = writeln!(text, "{} {}", k + 1, cells.join(" "));
        }
        text
    }

    fn titles(&self) -> Vec<String> {
        vec![
            format!("# Histogrammed data for fix {}", self.id),
            "# TimeStep Number-of-bins Total-counts Missing-counts Min-value Max-value".into(),
            "# Bin Coord Count Count/Total".into(),
        ]
    }

    /// Centre, count and fraction of every bin.
    fn rows(&self, counts: &[f64]) -> Vec<f64> {
        let bins = self.bins.count();
        let all = counts.get(bins).copied().unwrap_or(0.0);
        let share = |c: f64| if all == 0.0 { 0.0 } else { c / all };
        (0..bins)
            .flat_map(|k| {
                let count = counts.get(k).copied().unwrap_or(0.0);
                [self.bins.centre(k), count, share(count)]
            })
            .collect()
    }
}

impl Fix for Declared {
    fn facts(&self, _: &World) -> Facts {
        Facts { at_rest: AtRest::Acts, file: self.output.path(), ..Facts::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        self.schedule.declare(w, &self.kept());
        let name = format!("f_{}", self.id);
        let slot = w.slots.id(&name);
        let (vector, array) = (vec![0.0; 4], self.rows(&[]));
        *w.slots.get_mut(slot) =
            Slot { name, step: Some(w.clock.step), vector, array, array_cols: 3, ..Slot::default() };
        self.output.begin(w, self.kept().key, &self.titles())
    }

    fn remove(&self, w: &mut World) {
        forget(w, self.kept().key);
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let when = self.schedule.when();
        let mut sources = vec![];
        for input in &self.inputs {
            sources.push(input.source(cx, self.wants, Stage::EndOfStep, &when)?);
        }
        let (me, kept, slot) = (self.clone(), self.kept(), cx.slot(&format!("f_{}", self.id)));
        let (so_far, extremes) = (kept.key.with("/bins"), kept.key.with("/extremes"));
        let mut sheet = self.output.sheet(cx.world(), kept.key);
        let averager = Averager { kept, repeat: 1, ave: self.ave, off: vec![] };
        let access = Needs::new().read(SLOTS | X | V | F | MASK).write(SLOTS).keep(MEMO);
        let op = StepOp::new(format!("fix {} ave/histo", self.id), Stage::EndOfStep, access, move |w, t| {
            let Some(due) = me.schedule.due(w, &kept, t.step) else { return Ok(()) };
            let before = w.memo.remove(so_far).filter(|_| !due.first);
            let one = me.sample(w, &sources, before)?;
            let [lo, hi] = me.extremes(w, extremes, one.extremes, due);
            if !due.last {
                w.memo.insert(so_far, one.counts);
                return Ok(());
            }
            let whole = Due { first: true, last: true };
            let Some((counts, _)) = averager.add(w, &one.counts, whole) else { return Ok(()) };
            let (bins, rows) = (me.bins.count(), me.rows(&counts));
            let stats = [counts[bins], counts[bins + 1], lo, hi];
            let out = w.slots.get_mut(slot);
            (out.step, out.vector, out.array_cols) = (Some(t.step), stats.to_vec(), 3);
            out.array.clone_from(&rows);
            sheet.as_mut().map_or(Ok(()), |s| s.block(&me.block(t.step, &stats, &rows)))
        });
        Ok(vec![op.when(when).in_setup(true).boxed()])
    }

    fn shape(&self) -> Shape {
        let (array_rows, every) = (self.bins.count(), self.schedule.freq);
        Shape { vector: 4, array: 3, array_rows, every, ..Shape::default() }
    }
}
