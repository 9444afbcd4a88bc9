//! compute reduce: one number from one value per particle: a sum, an extreme, a mean.

use super::{Compute, ComputeStyle};
use crate::diag::{Code, Diagnostic, Result, fail};
use crate::lang::{Args, RefKind, ValueRef, Word};
use crate::par;
use crate::plan::{Op, Stage, When};
use crate::styles::matter::count;
use crate::styles::step_op::{Wanted, fill};
use crate::styles::{BuildCx, Doc, Reading, SealCx, Shape, Style, Wants};
use crate::world::{GroupId, SlotId, World};

/// The style.
pub struct Reduce;

impl Style for Reduce {
    fn name(&self) -> &'static str {
        "reduce"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "compute ID group reduce sum|min|max|ave|sumsq|avesq|sumabs|aveabs|minabs|maxabs input …",
            summary: "Sums, extremes and means of per-atom values over the group.",
            text: "Inputs: `x y z vx vy vz fx fy fz`, `c_ID`, `c_ID[k]`, `c_ID[*]`, `f_ID`, `f_ID[k]`, and `v_name` of an \
                   atom-style variable. One input gives a scalar, several a vector; sums are extensive, all else \
                   intensive. For an empty group: 0, but 1e20 for `min` and `minabs` and −1e20 for `max`. NaNs never \
                   are extremes. The keywords `replace` and `inputs` are refused. LAMMPS 22Jul2025 gives 1e20 for every `minabs` and, where there are \
                   several inputs, does not divide `aveabs` by the number of particles; perigrain does so only under \
                   `-compat lammps`. LAMMPS' `sumabs` of several inputs is unset memory; perigrain's is the sum.",
            example: "compute worst all reduce max c_dmg",
        }
    }
}

/// What is done with the values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Sum,
    Min,
    Max,
    Ave,
    SumSquares,
    AveSquares,
    SumAbs,
    AveAbs,
    MinAbs,
    MaxAbs,
}

const MODES: &[&str] =
    &["sum", "min", "max", "ave", "sumsq", "avesq", "sumabs", "aveabs", "minabs", "maxabs"];

/// What LAMMPS says of the extreme of nothing.
const BIG: f64 = 1e20;

impl Mode {
    fn named(name: &str) -> Self {
        use Mode::*;
        let all = [Sum, Min, Max, Ave, SumSquares, AveSquares, SumAbs, AveAbs, MinAbs, MaxAbs];
        all[MODES.iter().position(|m| *m == name).unwrap_or(0)]
    }

    /// What one value contributes.
    fn term(self, a: f64) -> f64 {
        match self {
            Mode::SumSquares | Mode::AveSquares => a * a,
            Mode::SumAbs | Mode::AveAbs | Mode::MinAbs | Mode::MaxAbs => a.abs(),
            _ => a,
        }
    }

    /// The result of no values, and how two are joined.
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

    /// The result from what all values together gave and their number.
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

/// What decides whether LAMMPS 22Jul2025 goes wrong.
#[derive(Clone, Copy)]
struct Artefact {
    /// Its numbers are wanted.
    lammps: bool,
    /// There are several inputs.
    several: bool,
}

/// A per-particle value.
#[derive(Clone, Debug)]
enum Input {
    /// Component (0 to 2) of position, velocity or force.
    Column(Column, usize),
    /// A compute's, fix's or variable's.
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

impl ComputeStyle for Reduce {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        let mode = Mode::named(args.choice("mode of compute reduce", MODES)?);
        let mut inputs = vec![];
        while let Some(word) = args.next() {
            read_input(word, cx, &mut inputs)?;
        }
        if inputs.is_empty() {
            args.expect("at least one input, as `vx` or `c_ID`")?;
        }
        let touched = mode == Mode::MinAbs || (mode == Mode::AveAbs && inputs.len() > 1);
        if touched && cx.world.settings.lammps() {
            let text = "compat lammps: `minabs` is 1e20, and `aveabs` of several inputs is a sum";
            cx.note(Diagnostic::note(Code::COMPAT, cx.span, text));
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, mode, inputs }))
    }
}

fn read_input(word: &Word, cx: &BuildCx, inputs: &mut Vec<Input>) -> Result<()> {
    let text = word.text.as_str();
    let columns = [("", Column::Position), ("v", Column::Velocity), ("f", Column::Force)];
    for (prefix, column) in columns {
        if let Some(d) = ["x", "y", "z"].iter().position(|d| text.strip_prefix(prefix) == Some(d)) {
            inputs.push(Input::Column(column, d));
            return Ok(());
        }
    }
    if matches!(text, "replace" | "inputs") {
        return fail(
            Code::NOT_SUPPORTED,
            word.span,
            format!("the keyword `{text}` of compute reduce is not in perigrain"),
        );
    }
    for word in cx.expand(word, Wants::PerAtom)? {
        match ValueRef::parse(&word.text, word.span)? {
            Some(r) if !matches!(r.kind, RefKind::ComputeAtom | RefKind::FixAtom) => {
                cx.value(&r, true)?;
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
    mode: Mode,
    inputs: Vec<Input>,
}

/// An input as it is read during a run.
enum Source {
    Column(Column, usize),
    Reading(Reading),
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
        let (group, mode) = (self.group, self.mode);
        let mut sources = vec![];
        for input in &self.inputs {
            sources.push(match input {
                Input::Column(c, d) => Source::Column(*c, *d),
                Input::Value(r) => Source::Reading(cx.value(r, stage, when)?),
            });
        }
        Ok(fill(&self.id, &Wanted { slot, stage, when }, "x v f mask", move |w, _, out| {
            let n = count(w, group);
            let artefact = Artefact { lammps: w.settings.lammps(), several: sources.len() > 1 };
            out.vector.clear();
            for source in &sources {
                let folded = match source {
                    Source::Column(c, d) => reduced(w, group, mode, |i| c.of(w)[i][*d]),
                    Source::Reading(r) => reduced(w, group, mode, |i| r.atom(w, i)),
                };
                out.vector.push(mode.finish(folded, n, artefact));
            }
            if let [one] = out.vector[..] {
                out.scalar = one;
                out.vector.clear();
            }
            Ok(())
        }))
    }

    fn boxed(&self) -> Box<dyn Compute> {
        Box::new(self.clone())
    }
}

fn reduced(w: &World, group: GroupId, mode: Mode, value: impl Fn(usize) -> f64 + Sync) -> f64 {
    let (mask, bit) = (&w.particles.mask, group.bit());
    let (none, join) = mode.fold();
    let chunk = |range: std::ops::Range<usize>| {
        range.filter(|&i| mask[i] & bit != 0).fold(none, |a, i| join(a, mode.term(value(i))))
    };
    par::reduce(mask.len(), chunk, join).unwrap_or(none)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::styles::testing::Bench;
    use crate::world::{AtomStyle, Compat};

    fn scene() -> Bench {
        let mut b = Bench::new(
            AtomStyle::default(),
            &[[1.0, 1.0, 1.0], [-2.5, 1.5, 0.0], [4.0, 3.5, 2.0], [9.0, 9.0, 9.0]],
        );
        b.world.particles.mask[3] = 0;
        b
    }

    fn value(b: &mut Bench, words: &str) -> f64 {
        let c = b.compute(&Reduce, words).unwrap();
        b.evaluate(&*c).unwrap().scalar
    }

    #[test]
    fn all_modes() {
        let mut b = scene();
        // Of 1, -2.5, 4 by hand.
        let expected = [2.5, -2.5, 4.0, 2.5 / 3.0, 23.25, 23.25 / 3.0, 7.5, 2.5, 1.0, 4.0];
        for (mode, a) in MODES.iter().zip(expected) {
            assert_eq!(value(&mut b, &format!("{mode} x")), a, "{mode}");
        }
        // Oracle: LAMMPS 22Jul2025 prints the sum for aveabs of several inputs, and 1e20 for minabs.
        b.world.settings.compat = Compat::Lammps;
        assert_eq!((value(&mut b, "aveabs x"), value(&mut b, "minabs x")), (2.5, 1e20));
        let c = b.compute(&Reduce, "aveabs x x").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().vector, [7.5, 7.5]);
    }

    // Oracle: an empty group gives 1e20, -1e20, 0, 0 for min, max, maxabs, ave.
    #[test]
    fn nothing_has_lammps_extremes() {
        let mut b = scene();
        b.world.particles.mask.fill(0);
        let got = ["min", "max", "maxabs", "ave"].map(|m| value(&mut b, &format!("{m} x")));
        assert_eq!(got, [1e20, -1e20, 0.0, 0.0]);
    }

    #[test]
    fn several_inputs_make_a_vector() {
        let mut b = scene();
        b.atom.insert("a".into(), vec![1.0, 2.0, 3.0, 4.0]);
        b.computes.insert("p".into(), Shape { atom: Some(2), ..Shape::default() });
        let s = b.world.slots.id("c_p");
        let slot = b.world.slots.get_mut(s);
        (slot.cols, slot.atom) = (2, vec![1.0, 10.0, 2.0, 20.0, 3.0, 30.0, 4.0, 40.0]);
        let c = b.compute(&Reduce, "sum z v_a c_p[2] c_p[*]").unwrap();
        assert_eq!(c.shape().vector, 5);
        assert_eq!(b.evaluate(&*c).unwrap().vector, [3.0, 6.0, 60.0, 6.0, 60.0]);
    }

    #[test]
    fn mistakes_are_named() {
        let mut b = scene();
        b.equal.insert("e".into(), 1.0);
        for words in
            ["", "sum", "total x", "sum q", "sum c_no", "sum v_e", "max x y replace 1 2", "sum C_a[1]"]
        {
            assert!(b.compute(&Reduce, words).is_err(), "{words}");
        }
        assert_eq!(b.compute(&Reduce, "max x replace 1 2").err().unwrap().0[0].code, Code::NOT_SUPPORTED);
    }
}
