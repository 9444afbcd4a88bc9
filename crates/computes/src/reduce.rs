//! Computes reduce and reduce/region: a sum, an extreme or a mean of per-particle values.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::par;
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::Chosen;
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Reading, SealCx, Shape, Style, Wants};
use perigrain_world::field::{F, MASK, REGIONS, V, X};
use perigrain_world::{GroupId, Key, Region, SlotId, World};

/// `compute … reduce`.
pub struct Reduce;

/// `compute … reduce/region`.
pub struct ReduceRegion;

impl Style for Reduce {
    fn name(&self) -> &'static str {
        "reduce"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Sums, extremes and means of per-atom or local values over the group.",
            text: "One input gives a scalar, several a vector; sums are extensive, all else intensive. For an empty group: 0, but \
                   1e20 for `min` and `minabs` and −1e20 for `max`. NaNs never are extremes.\n\n\
                   LAMMPS 22Jul2025 gives 1e20 for every `minabs` and, where there are several inputs, does not divide `aveabs` by the \
                   number of particles; perigrain does so only under `-compat lammps`. LAMMPS' `sumabs` of several inputs is unset \
                   memory; perigrain's is the sum.",
            example: "compute worst all reduce max c_dmg",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "mode")]
    mode: Mode,
    /// Values per particle: `x y z vx vy vz fx fy fz`, `c_ID`, `c_ID[k]`, `c_ID[*]`, `f_ID`, `f_ID[k]`, and `v_name` of an atom-style
    /// variable.
    #[word(name = "input", what = "at least one input, as `vx` or `c_ID`", kind = Kind::Attribute, least = 1)]
    inputs: Vec<Word>,
    /// The i-th result is the i-th input's value where the j-th input has its extreme; for the modes `min` and `max`.
    #[word(keyword, name = "i j", what = "the number of an input", from = 1)]
    replace: Vec<[At<usize>; 2]>,
    #[word(keyword = "inputs", placed)]
    level: Option<At<Level>>,
}

#[derive(Words)]
struct OfRegion {
    /// The region.
    #[word(name = "region-ID")]
    region: Key<Region>,
    #[word(flatten)]
    line: Line,
}

/// What is read.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "kind of inputs")]
enum Level {
    /// Values per particle, of those of the group.
    Peratom,
    /// Local values (`compute property/local` …), of which all count, whatever the group.
    Local,
}

/// The reduction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "mode of compute reduce")]
enum Mode {
    /// The sum.
    Sum,
    /// The smallest value.
    Min,
    /// The largest value.
    Max,
    /// The mean.
    Ave,
    /// The sum of squares.
    #[word("sumsq")]
    SumSquares,
    /// The mean of squares.
    #[word("avesq")]
    AveSquares,
    /// The sum of absolute values.
    SumAbs,
    /// The mean of absolute values.
    AveAbs,
    /// The smallest absolute value.
    MinAbs,
    /// The largest absolute value.
    MaxAbs,
}

/// LAMMPS' extreme of an empty set.
pub const BIG: f64 = 1e20;

impl Mode {
    /// The contribution of one value.
    fn term(self, a: f64) -> f64 {
        match self {
            Mode::SumSquares | Mode::AveSquares => a * a,
            Mode::SumAbs | Mode::AveAbs | Mode::MinAbs | Mode::MaxAbs => a.abs(),
            _ => a,
        }
    }

    /// The neutral element, and the operation on two values.
    fn fold(self) -> (f64, fn(f64, f64) -> f64) {
        match self {
            Mode::Min | Mode::MinAbs => (f64::INFINITY, f64::min),
            Mode::Max => (f64::NEG_INFINITY, f64::max),
            Mode::MaxAbs => (0.0, f64::max),
            _ => (0.0, |a, b| a + b),
        }
    }

    fn extensive(self) -> bool {
        matches!(self, Mode::Sum | Mode::SumSquares | Mode::SumAbs)
    }

    /// The result from the folded value and the number of values.
    fn finish(self, folded: f64, count: usize, artefact: Artefact) -> f64 {
        match self {
            Mode::MinAbs if artefact.lammps => BIG,
            Mode::AveAbs if artefact.lammps && artefact.several => folded,
            Mode::Min | Mode::MinAbs if count == 0 => BIG,
            Mode::Max if count == 0 => -BIG,
            Mode::Ave | Mode::AveSquares | Mode::AveAbs if count > 0 => folded / count as f64,
            _ => folded,
        }
    }
}

/// Conditions for the wrong results of LAMMPS 22Jul2025.
#[derive(Clone, Copy)]
struct Artefact {
    /// LAMMPS' numbers are requested.
    lammps: bool,
    /// There are several inputs.
    several: bool,
}

/// A per-particle value.
#[derive(Clone, Debug)]
enum Input {
    /// Component (0 to 2) of position, velocity or force.
    Column(Column, usize),
    /// Value of a compute, fix or variable.
    Value(ValueRef),
}

#[derive(Clone, Copy, Debug)]
enum Column {
    Position,
    Velocity,
    Force,
}

impl Column {
    fn of(self, w: &World) -> &[[f64; 3]] {
        match self {
            Column::Position => &w.particles.x,
            Column::Velocity => &w.particles.v,
            Column::Force => &w.particles.f,
        }
    }
}

impl Style for ReduceRegion {
    fn name(&self) -> &'static str {
        "reduce/region"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(OfRegion::GRAMMAR),
            summary: "As compute reduce, for particles that are in a region at that moment.",
            text: "Results are those of compute reduce; a particle counts while it is in the group and inside \
                   the region.",
            example: "compute deep all reduce/region half max vz",
        }
    }
}

impl ComputeStyle for Reduce {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        Ok(Box::new(Declared::new(None, &read(args, cx)?, cx)?))
    }
}

impl ComputeStyle for ReduceRegion {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let OfRegion { region, line } = read(args, cx)?;
        Ok(Box::new(Declared::new(Some(region.text().to_string()), &line, cx)?))
    }
}

/// Inputs of `replace i j`, counted from 0.
fn replaced(pair: [At<usize>; 2], mode: Mode, inputs: usize) -> Result<[usize; 2]> {
    let [first, _] = pair;
    if let Some(At { value, span, .. }) = pair.into_iter().find(|n| n.value > inputs && !n.unknown) {
        return fail(Code::BAD_VALUE, span, format!("there are {inputs} inputs, not {value}"));
    }
    if !matches!(mode, Mode::Min | Mode::Max) {
        return fail(Code::CONFLICT, first.span, "`replace` needs the mode `min` or `max`");
    }
    let [i, j] = pair.map(|n| n.value.min(inputs).saturating_sub(1));
    if i == j && pair.iter().all(|n| !n.unknown) {
        return fail(Code::BAD_VALUE, first.span, "`replace` needs two different inputs");
    }
    Ok([i, j])
}

fn read_input(word: &Word, local: bool, cx: &BuildCx, inputs: &mut Vec<Input>) -> Result<()> {
    let text = word.text.as_str();
    let columns = [("", Column::Position), ("v", Column::Velocity), ("f", Column::Force)];
    for (prefix, column) in columns {
        if let Some(d) = ["x", "y", "z"].iter().position(|d| text.strip_prefix(prefix) == Some(d)) {
            if local {
                let text = format!("`{text}` is a value per particle: leave `inputs local` out");
                return fail(Code::CONFLICT, word.span, text);
            }
            inputs.push(Input::Column(column, d));
            return Ok(());
        }
    }
    let wants = if local { Wants::Local } else { Wants::PerAtom };
    for word in cx.expand(word, wants)? {
        match ValueRef::parse(&word.text, word.span)? {
            Some(r) if !matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom) => {
                cx.reading(&r, wants)?;
                inputs.push(Input::Value(r));
            }
            _ => {
                return Err(Diagnostic::error(
                    Code::UNKNOWN_KEYWORD,
                    word.span,
                    format!("`{}` is no input of compute reduce", word.text),
                )
                .help("inputs are x y z vx vy vz fx fy fz, c_ID, c_ID[k], f_ID, f_ID[k] and v_name")
                .into());
            }
        }
    }
    Ok(())
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    region: Option<String>,
    mode: Mode,
    inputs: Vec<Input>,
    local: bool,
    /// Pairs: the result replaced, and the input whose extreme selects the particle.
    replace: Vec<[usize; 2]>,
}

impl Declared {
    fn new(region: Option<String>, line: &Line, cx: &BuildCx) -> Result<Self> {
        let (mode, local) = (line.mode, line.level.filter(|level| level.value == Level::Local));
        let mut inputs = vec![];
        for word in &line.inputs {
            read_input(word, local.is_some(), cx, &mut inputs)?;
        }
        if inputs.is_empty() {
            return fail(Code::MISSING_ARGUMENT, cx.span, "at least one input is missing, as `vx` or `c_ID`");
        }
        let replace = line.replace.iter().map(|pair| replaced(*pair, mode, inputs.len()));
        let replace = replace.collect::<Result<Vec<_>>>()?;
        if let (Some(At { span, .. }), true) = (local, region.is_some()) {
            return fail(Code::CONFLICT, span, "local values are in no region: use compute reduce");
        }
        let local = local.is_some();
        let touched = mode == Mode::MinAbs || (mode == Mode::AveAbs && inputs.len() > 1);
        if touched {
            cx.fault(cx.span, "`minabs` is 1e20, and `aveabs` of several inputs is a sum", false);
        }
        Ok(Self { id: cx.id.to_string(), group: cx.group, region, mode, inputs, local, replace })
    }
}

/// An input during a run.
enum Source {
    Column(Column, usize),
    Reading(Reading),
}

impl Source {
    fn value(&self, w: &World, i: usize) -> f64 {
        match self {
            Source::Column(c, d) => c.of(w)[i][*d],
            Source::Reading(r) => r.atom(w, i),
        }
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        let (several, extensive) = (self.inputs.len() > 1, self.mode.extensive());
        Shape {
            scalar: !several,
            vector: if several { self.inputs.len() } else { 0 },
            scalar_extensive: extensive,
            vector_extensive: extensive,
            ..Shape::default()
        }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (mode, local, replace, span) = (self.mode, self.local, self.replace.clone(), cx.span());
        let wants = if local { Wants::Local } else { Wants::PerAtom };
        let mut sources = vec![];
        for input in &self.inputs {
            sources.push(match input {
                Input::Column(c, d) => Source::Column(*c, *d),
                Input::Value(r) => Source::Reading(cx.reading(r, wants, stage, when)?),
            });
        }
        let chosen = Chosen::new(cx.world(), self.group, self.region.as_deref(), span)?;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, X | V | F | MASK | REGIONS, move |w, _, out| {
            let chosen = chosen.resolve(w);
            let p = &w.particles;
            let has = |i: usize| chosen.has(p.mask[i], p.x[i]);
            let artefact = Artefact { lammps: w.settings.lammps(), several: sources.len() > 1 };
            let mut places = vec![None; sources.len()];
            out.vector.clear();
            for (k, source) in sources.iter().enumerate() {
                let sought = replace.iter().any(|[_, j]| *j == k);
                let (folded, n) = match source {
                    Source::Reading(r) if local => {
                        let list = r.list(w);
                        let folded = fold(list.len(), mode, |_| true, |i| list[i]);
                        places[k] = (0..list.len()).find(|&i| sought && list[i] == folded);
                        (folded, list.len())
                    }
                    _ => {
                        let folded = fold(w.n(), mode, has, |i| source.value(w, i));
                        places[k] = (0..w.n()).find(|&i| sought && has(i) && source.value(w, i) == folded);
                        (
                            folded,
                            par::reduce(w.n(), |r| r.filter(|&i| has(i)).count(), |a, b| a + b).unwrap_or(0),
                        )
                    }
                };
                out.vector.push(mode.finish(folded, n, artefact));
            }
            for [i, j] in &replace {
                if let Some(at) = places[*j] {
                    out.vector[*i] = match &sources[*i] {
                        Source::Reading(r) if local => r.list(w).get(at).copied().unwrap_or(0.0),
                        source => source.value(w, at),
                    };
                }
            }
            if let [one] = out.vector[..] {
                out.scalar = one;
                out.vector.clear();
            }
            Ok(())
        }))
    }
}

fn fold(
    n: usize,
    mode: Mode,
    has: impl Fn(usize) -> bool + Sync,
    value: impl Fn(usize) -> f64 + Sync,
) -> f64 {
    let (none, join) = mode.fold();
    let chunk = |range: std::ops::Range<usize>| {
        range.filter(|&i| has(i)).fold(none, |a, i| join(a, mode.term(value(i))))
    };
    par::reduce(n, chunk, join).unwrap_or(none)
}

#[cfg(test)]
mod tests;
