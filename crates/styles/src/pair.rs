//! What a pair style is: a style that reads its line, and what it declares.

use super::probe::Probe;
use super::{BuildCx, SealCx, Style};
use dyn_clone::DynClone;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_world::World;

/// Type pairs (i ≤ j, from 1) that a `pair_coeff` line covers.
pub type TypePairs = [(u16, u16)];

/// What sub-styles contribute, each with the number of its sub-style, from 0.
pub type ByPart<T> = Vec<(usize, Box<T>)>;

/// A pair style: one file, one line in `PAIRS`.
pub trait PairStyle: Style {
    /// Reads the words after the style's name.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>>;

    /// The keywords of its line, for messages.
    fn options(&self) -> Vec<&'static str> {
        self.doc().syntax.behind().keywords()
    }
}

/// What a pair style declares about itself.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// The style's name.
    pub name: &'static str,
    /// Facts of the scene it needs (`volume`, `density`, `diameter` …), for checks.
    pub needs: &'static [&'static str],
    /// For peridynamic styles: whether forces are true forces (else force densities, as LAMMPS).
    pub true_forces: Option<bool>,
    /// Whether all that its forces can give is held by its contacts: elastic grains without cohesion.
    pub elastic_grains: bool,
    /// Types whose particles belong to peridynamic solids.
    pub solids: Vec<u16>,
    /// A type whose material does not define when its bonds break.
    pub unbreakable: Option<u16>,
    /// The coefficients that `fix adapt` may change, by name.
    pub coefficients: &'static [&'static str],
    /// Whether `pair_modify mix` chooses how it mixes types.
    pub mixes: bool,
    /// Whether its forces follow from places alone while bonds live, so that `statics` finds places without force.
    pub balances: bool,
}

/// How the numbers of two types make those between them (`pair_modify mix`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mix {
    /// √(a b).
    #[default]
    Geometric,
    /// (a + b)/2 for distances, √(a b) for energies.
    Arithmetic,
    /// ((a⁶ + b⁶)/2)^1/6 for distances.
    SixthPower,
}

impl Mix {
    /// The rules by name.
    pub const NAMES: [(&'static str, Mix); 3] =
        [("geometric", Mix::Geometric), ("arithmetic", Mix::Arithmetic), ("sixthpower", Mix::SixthPower)];

    /// Reads a rule.
    ///
    /// # Errors
    /// A word that names none.
    pub fn read(args: &mut Args) -> Result<Self> {
        let name = args.choice("mixing rule", &Self::NAMES.map(|(name, _)| name))?;
        Ok(Self::NAMES.iter().find(|(n, _)| *n == name).map_or(Self::default(), |(_, rule)| *rule))
    }

    /// Of two distances [length].
    pub fn distance(self, a: f64, b: f64) -> f64 {
        match self {
            Mix::Geometric => (a * b).sqrt(),
            Mix::Arithmetic => 0.5 * (a + b),
            Mix::SixthPower => (0.5 * (a.powi(6) + b.powi(6))).powf(1.0 / 6.0),
        }
    }

    /// Of two energies that belong to two distances.
    pub fn energy(self, [a, b]: [f64; 2], [s, t]: [f64; 2]) -> f64 {
        let mean = (a * b).sqrt();
        match self {
            Mix::Geometric | Mix::Arithmetic => mean,
            Mix::SixthPower => 2.0 * mean * (s * t).powi(3) / (s.powi(6) + t.powi(6)),
        }
    }
}

/// An option of a pair style from another command than its own.
pub enum PairOption<'a, 'b> {
    /// How types are mixed.
    Mix(Mix),
    /// The words of `peri_modify`.
    Peri(&'a mut Args<'b>),
}

/// What the deck states about particles, for a check without particles.
#[derive(Clone, Copy, Debug, Default)]
pub struct Deck<'a> {
    /// The density.
    pub density: Option<f64>,
    /// The smallest diameter.
    pub diameter: Option<f64>,
    /// Grains that come during the run.
    pub to_come: &'a [ToCome],
}

impl Deck<'_> {
    /// Density and diameter, where the deck has set both.
    pub fn density_and_diameter(&self) -> Option<(f64, f64)> {
        self.density.zip(self.diameter)
    }
}

/// The lightest and smallest grains of a type that a fix makes during a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToCome {
    /// Their type.
    pub kind: u16,
    /// The bits of their groups.
    pub mask: u32,
    /// The least mass.
    pub mass: f64,
    /// The smallest radius [length].
    pub radius: f64,
}

/// How far forces reach and how fast they change.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scales {
    /// The largest cutoff [length], as LAMMPS has it; `None` without any.
    pub cutoff: Option<f64>,
    /// The longest stable time step by the style's own estimate [time units]; `None` if it has none.
    pub stable_step: Option<f64>,
    /// The same, no longer than the limit of any body of such particles, whatever its shape.
    pub sure_step: Option<f64>,
    /// How long the shortest contact of grains lasts [time units]; `None` if there are none.
    pub contact_time: Option<f64>,
}

/// A declared pair style with its coefficients. A failing line changes nothing: it works on a copy.
pub trait Pair: DynClone + Send {
    /// Its declaration.
    fn facts(&self) -> Facts;

    /// Reads the words of `pair_coeff` after the two types.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<()>;

    /// The value of a coefficient that `fix adapt` may change, or of Young's modulus `E` and Poisson's ratio `nu` of grains, as the deck's
    /// lines set it.
    fn coefficient(&self, _name: &str, _types: (u16, u16)) -> Option<f64> {
        None
    }

    /// Makes what decks may name of it before the first run.
    fn declare(&self, _w: &mut World) {}

    /// Whether a type pair has coefficients, its own or mixed ones.
    fn covers(&self, i: u16, j: u16) -> bool;

    /// Limits the style to some type pairs (as a sub-style of `hybrid`); by default it acts on all.
    fn restrict(&mut self, _pairs: &TypePairs) {}

    /// The sub-styles of a `hybrid`.
    fn parts(&self) -> Vec<&dyn Pair> {
        vec![]
    }

    /// The ops it contributes to a step, in their order.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn ops(&self, cx: &mut dyn SealCx) -> Result<ByPart<dyn Op>>;

    /// Probes for single pairs of particles; with `bonds` also a solid that is no sub-style and whose bonds depend on nothing but
    /// their ends.
    ///
    /// # Errors
    /// What is missing in the scene.
    fn probes(&self, _w: &World, _bonds: bool) -> Result<ByPart<dyn Probe>> {
        Ok(vec![])
    }

    /// How far its forces reach and how fast they change.
    fn scales(&self, _w: &World, _deck: Deck) -> Scales {
        Scales::default()
    }

    /// The longest stable step of solids as they stand, where an estimate is far below it and it can be found soon [time].
    fn limit(&self, _w: &World) -> Option<f64> {
        None
    }

    /// `peri_modify …`, and `pair_modify mix …` where types are mixed by a rule.
    ///
    /// # Errors
    /// By default the pair style has none.
    fn modify(&mut self, option: PairOption, cx: &BuildCx) -> Result<()> {
        match option {
            PairOption::Mix(_) => Ok(()),
            PairOption::Peri(args) => {
                let (span, name) = (args.peek().map_or(cx.span, |w| w.span), self.facts().name);
                fail(Code::CONFLICT, span, format!("`peri_modify` does not concern pair_style {name}"))
            }
        }
    }

    /// Contradictions within the present declarations that a run would trip over, left as notes in `cx`.
    fn check(&self, _cx: &BuildCx) {}
}

dyn_clone::clone_trait_object!(Pair);

#[cfg(test)]
mod tests {
    use super::Mix;

    // Calculated by hand for 1 and 2; for equal numbers each rule gives the same.
    #[test]
    fn rules_of_mixing() {
        let of = Mix::NAMES.map(|(_, rule)| rule.distance(1.0, 2.0));
        assert!((of[0] - 2f64.sqrt()).abs() < 1e-15 && of[1] == 1.5);
        assert!((of[2] - 32.5f64.powf(1.0 / 6.0)).abs() < 1e-15);
        for (_, rule) in Mix::NAMES {
            let same = [rule.distance(3.0, 3.0), rule.energy([3.0; 2], [0.5; 2])];
            assert!(same.iter().all(|a| (a - 3.0).abs() < 1e-14), "{rule:?} {same:?}");
        }
    }
}
