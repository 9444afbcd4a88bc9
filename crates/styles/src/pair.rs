//! What a pair style is: a style that reads its line, and what it declares.

use super::probe::Probe;
use super::{BuildCx, SealCx, Style};
use dyn_clone::DynClone;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_world::World;

/// Type pairs (i ≤ j, from 1) that a `pair_coeff` line speaks of.
pub type TypePairs = [(u16, u16)];

/// What each sub-style contributes: its number, from 0, and its ops or probes.
pub type ByPart<T> = Vec<(usize, Vec<Box<T>>)>;

/// A pair style: one file, one line in `PAIRS`.
pub trait PairStyle: Style {
    /// Reads the words after the style's name.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>>;

    /// The words that may end its line, for messages.
    fn options(&self) -> &'static [&'static str] {
        &[]
    }
}

/// A declared pair style with its coefficients.
pub trait Pair: DynClone + Send {
    /// The style's name.
    fn name(&self) -> &'static str;

    /// Reads the words of `pair_coeff` after the two types.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<()>;

    /// Makes what decks may name of it before the first run.
    fn declare(&self, _w: &mut World) {}

    /// Whether a type pair has coefficients, its own or mixed ones.
    fn covers(&self, i: u16, j: u16) -> bool;

    /// Limits the style to some type pairs (as a sub-style of `hybrid`); by default it acts on all.
    fn restrict(&mut self, _pairs: &TypePairs) {}

    /// The ops it contributes to a step.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>>;

    /// The same by sub-style: its number, from 0, and what it contributes.
    ///
    /// # Errors
    /// As `ops`.
    fn ops_by_part(&self, cx: &mut dyn SealCx) -> Result<ByPart<dyn Op>> {
        Ok(vec![(0, self.ops(cx)?)])
    }

    /// What it, or each sub-style of a `hybrid`, can be asked about single pairs of particles.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn probes(&self, _w: &World) -> Result<Vec<Box<dyn Probe>>> {
        Ok(vec![])
    }

    /// Whom computes can ask what single pairs do to each other: those of `probes`, and solids whose bonds depend on
    /// nothing but their ends.
    ///
    /// # Errors
    /// As `probes`.
    fn singles(&self, w: &World) -> Result<Vec<Box<dyn Probe>>> {
        self.probes(w)
    }

    /// The largest cutoff of its forces [length], as LAMMPS has it; `None` without any.
    fn cutoff(&self, w: &World) -> Option<f64> {
        self.probes(w).ok()?.iter().filter_map(|p| p.cutoff(w)).reduce(f64::max)
    }

    /// The same by sub-style: its number, from 0, and whom to ask.
    ///
    /// # Errors
    /// As `probes`.
    fn probes_by_part(&self, w: &World) -> Result<ByPart<dyn Probe>> {
        Ok(vec![(0, self.probes(w)?)])
    }

    /// `peri_modify …` and the like: options by command name.
    ///
    /// # Errors
    /// By default the pair style has none.
    fn modify(&mut self, command: &str, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let span = args.peek().map_or(cx.span, |w| w.span);
        fail(Code::CONFLICT, span, format!("`{command}` does not concern pair_style {}", self.name()))
    }

    /// Facts of the scene it needs (`volume`, `density`, `diameter` …), for checks.
    fn needs(&self) -> &'static [&'static str] {
        &[]
    }

    /// The longest time step that is stable, by its own estimate [time units]; `None` if it cannot tell. `said` is the
    /// density that the deck has set, for a check without particles.
    fn stable_step(&self, _w: &World, _said: Option<f64>) -> Option<f64> {
        None
    }

    /// How long the shortest contact of grains lasts [time units]; `None` if there are none. `said` is the density and the
    /// smallest diameter that the deck has set, for a check without particles.
    fn contact_time(&self, _w: &World, _said: Option<(f64, f64)>) -> Option<f64> {
        None
    }

    /// For peridynamic styles: whether forces are true forces (else force densities, as LAMMPS).
    fn true_forces(&self) -> Option<bool> {
        None
    }

    /// Whether particles of a type belong to peridynamic solids.
    fn solid(&self, kind: u16) -> bool {
        self.true_forces().is_some() && self.covers(kind, kind)
    }

    /// A type whose material says nothing of when its bonds break.
    fn unbreakable(&self) -> Option<u16> {
        None
    }

    /// The coefficients that `fix adapt` may change, by name.
    fn coefficients(&self) -> &'static [&'static str] {
        &[]
    }

    /// What the deck's lines said of one of them.
    fn coefficient(&self, _name: &str, _types: (u16, u16)) -> Option<f64> {
        None
    }

    /// The sub-styles of a `hybrid`.
    fn parts(&self) -> Vec<&dyn Pair> {
        vec![]
    }

    /// Contradictions within the present declarations that a run would trip over, left as notes in `cx`.
    fn check(&self, _cx: &BuildCx) {}
}

dyn_clone::clone_trait_object!(Pair);
