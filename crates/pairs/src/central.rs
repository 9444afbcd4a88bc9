//! Pair styles whose forces act along the line between two points, within a cutoff of their types: one driver for all such laws.

mod op;
mod probe;
mod table;

use super::{ByPart, Deck, Facts, Mix, Pair, PairOption, Scales, TypePairs};
use op::Push;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::probe::Probe;
use perigrain_styles::{BuildCx, SealCx};
use perigrain_world::World;
use perigrain_world::field::Fields;
use probe::CentralProbe;
use std::collections::BTreeMap;
use std::marker::PhantomData;
pub use table::Table;

/// Coefficients of a pair of types: the cutoff and two numbers of the law.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coeff {
    /// Where the force ends [length].
    pub cutoff: f64,
    /// Numbers of the law: a stiffness or an energy, and a damping.
    pub own: [f64; 2],
}

/// A force along the line between two points.
pub trait Law: Send + Sync + 'static {
    /// The pair style's name.
    const NAME: &'static str;
    /// The names of its own numbers, all of which `fix adapt` may change.
    const NUMBERS: &'static [&'static str];
    /// Fields that it reads besides places.
    const READS: Fields;
    /// Whether computes can probe single pairs; those pairs then report their part of the virials of particles.
    const SINGLE: bool;

    /// Reads the words of `pair_coeff`; `global` is the cutoff of the style's line.
    ///
    /// # Errors
    /// Every mistake in the line.
    fn read(args: &mut Args, global: f64, cx: &BuildCx) -> Result<Coeff>;

    /// The coefficients between two types.
    fn mixed(a: &Coeff, b: &Coeff, rule: Mix) -> Coeff;

    /// F/r, positive apart, and the energy of two points at the distance `r`, `d` = x_i − x_j; `relative` is v_i − v_j.
    fn at(c: &Coeff, d: Vec3, r: f64, relative: impl Fn() -> Vec3) -> [f64; 2];
}

/// A declared style: coefficients by pair of types.
pub struct Declared<L> {
    /// The cutoff of its own line [length].
    global: f64,
    given: BTreeMap<(u16, u16), Coeff>,
    /// The pairs of types on which it acts, as a sub-style.
    only: Option<Vec<(u16, u16)>>,
    /// How types without a line of their own are mixed.
    rule: Mix,
    law: PhantomData<L>,
}

impl<L> Clone for Declared<L> {
    fn clone(&self) -> Self {
        Self { given: self.given.clone(), only: self.only.clone(), law: PhantomData, ..*self }
    }
}

impl<L: Law> Declared<L> {
    /// Without coefficients yet.
    pub fn new(global: f64) -> Self {
        Self { global, given: BTreeMap::new(), only: None, rule: Mix::default(), law: PhantomData }
    }

    /// Coefficients of two types, and whether they are mixed of those of each.
    fn coeff_of(&self, i: u16, j: u16) -> Option<(Coeff, bool)> {
        let types = (i.min(j), i.max(j));
        if let Some(c) = self.given.get(&types) {
            return Some((*c, false));
        }
        let (a, b) = (self.given.get(&(i, i))?, self.given.get(&(j, j))?);
        Some((L::mixed(a, b, self.rule), true))
    }

    /// The pairs of types that the style acts on, with their coefficients.
    fn pairs(&self, types: usize) -> impl Iterator<Item = ((u16, u16), (Coeff, bool))> + '_ {
        let types = types as u16;
        let all = (1..=types).flat_map(move |i| (i..=types).map(move |j| (i, j)));
        let own = all.filter(|pair| self.only.as_ref().is_none_or(|only| only.contains(pair)));
        own.filter_map(|(i, j)| Some(((i, j), self.coeff_of(i, j)?)))
    }
}

impl<L: Law> Pair for Declared<L> {
    fn facts(&self) -> Facts {
        Facts { name: L::NAME, coefficients: L::NUMBERS, mixes: true, ..Facts::default() }
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let coeff = L::read(args, self.global, cx)?;
        self.given.extend(pairs.iter().map(|p| (*p, coeff)));
        Ok(())
    }

    fn coefficient(&self, name: &str, (i, j): (u16, u16)) -> Option<f64> {
        let place = L::NUMBERS.iter().position(|n| *n == name)?;
        Some(self.coeff_of(i, j)?.0.own[place])
    }

    fn covers(&self, i: u16, j: u16) -> bool {
        self.coeff_of(i, j).is_some()
    }

    fn restrict(&mut self, pairs: &TypePairs) {
        self.only = Some(pairs.to_vec());
    }

    fn modify(&mut self, option: PairOption, cx: &BuildCx) -> Result<()> {
        match option {
            PairOption::Mix(rule) => self.rule = rule,
            PairOption::Peri(_) => {
                let text = format!("`peri_modify` does not concern pair_style {}", L::NAME);
                return fail(Code::CONFLICT, cx.span, text);
            }
        }
        Ok(())
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<ByPart<dyn Op>> {
        Ok(vec![(0, Box::new(Push::new(Table::new(self, cx.world()))))])
    }

    fn probes(&self, w: &World, _bonds: bool) -> Result<ByPart<dyn Probe>> {
        if !L::SINGLE {
            return Ok(vec![]);
        }
        Ok(vec![(0, Box::new(CentralProbe::new(Table::new(self, w))))])
    }

    fn scales(&self, w: &World, _deck: Deck) -> Scales {
        // A deck that is only checked may not have its types yet.
        let given = self.given.values().map(|c| c.cutoff);
        let mixed = self.pairs(w.types).map(|(_, (c, _))| c.cutoff);
        Scales { cutoff: given.chain(mixed).reduce(f64::max), ..Scales::default() }
    }
}
