//! Granular pair styles with their coefficients: rules by pair of types, given or mixed.

use super::force::Force;
use super::heating::conducts;
use super::mdr::PLASTIC_GRAIN;
use super::mdr::Press;
use crate::contact::{Coeff, durations, words};
use crate::contact_probe::{ContactProbe, Own};
use crate::{ByPart, Deck, Facts, Pair, Scales, TypePairs};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_contact::driver::{Average, Curvature, Rule, Rules};
use perigrain_contact::mdr::{Material, State};
use perigrain_contact::normal::{plastic, plastic_grain};
use perigrain_contact::{Cohesion, Damping, Model, Twisting};
use perigrain_lang::Args;
use perigrain_neigh::list::{Reach, Wanted};
use perigrain_plan::Op;
use perigrain_styles::probe::Probe;
use perigrain_styles::{BuildCx, SealCx};
use perigrain_world::columns::{HEATFLOW, TEMPERATURE};
use perigrain_world::{Compat, Constant, World};
use std::collections::BTreeMap;

/// Whether a model is one of those that LAMMPS does wrong.
type HasFault = fn(&Model) -> bool;

/// What LAMMPS does wrong in which models, and whether the LAMMPS of 2026 has mended it.
const FAULTS: [(HasFault, &str, bool); 4] = [
    (|m| m.damping == Damping::Tsuji, "damping tsuji without its factor √2", true),
    (
        |m| m.synchronized,
        "synchronized_verlet whose forces act along the normal of the middle of the step",
        false,
    ),
    (Model::slides_loosely, "springs of contacts that lose the contact radius when they slide", true),
    (
        |m| m.twisting != Twisting::None,
        "a sliding twist in the direction of the spin, not of its torque",
        false,
    ),
];

/// The laws of `pair_style granular` by pair of types, for walls that lend them.
pub static GRANULAR_RULES: Constant<Rules> = Constant::new("granular/rules");

/// A granular pair style with its coefficients.
#[derive(Clone)]
pub struct Declared {
    /// The style; contact history is kept under its name.
    name: &'static str,
    cutoff: Option<f64>,
    /// The coefficients of all pairs of types, if the style's own line gives them.
    all: Option<Coeff>,
    given: BTreeMap<(u16, u16), Coeff>,
    /// As a sub-style: the pairs of types it acts on.
    only: Option<Vec<(u16, u16)>>,
}

/// `pair_style gran/*`: one model for all pairs of types.
///
/// # Errors
/// Every mistake in the line, and particles without a radius.
pub fn classic(
    name: &'static str,
    hertz: bool,
    history: bool,
    args: &mut Args,
    cx: &BuildCx,
) -> Result<Box<dyn Pair>> {
    needs_spheres(name, cx)?;
    let span = args.here();
    let numbers = crate::contact::classic::line(args, hertz, cx)?;
    let model = Model::classic(hertz, history, &numbers);
    let (average, curvature, cutoff) = (Average::None, Curvature::Both, None);
    let all = Some(Coeff { model, other: None, average, curvature, cutoff, span });
    Ok(Box::new(Declared { all, ..Declared::new(name, None) }))
}

/// Refuses particles without a radius.
pub fn needs_spheres(name: &str, cx: &BuildCx) -> Result<()> {
    if cx.world.particles.style.sphere {
        return Ok(());
    }
    let text = format!("pair_style {name} needs particles with a radius");
    Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, text)
        .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
        .into())
}

impl Declared {
    /// Without coefficients yet.
    pub fn new(name: &'static str, cutoff: Option<f64>) -> Self {
        Self { name, cutoff, all: None, given: BTreeMap::new(), only: None }
    }

    /// The law of a pair of types and its reach: given, or mixed from the like pairs.
    fn rule(&self, i: u16, j: u16, compat: Compat) -> Result<Option<(Rule, Reach)>> {
        let reach = |c: Option<f64>| c.or(self.cutoff).map_or(Reach::Touch, Reach::Fixed);
        if let Some(c) = self.given.get(&(i, j)) {
            let law = match &c.other {
                Some((other, _)) => c.model.beside(other, compat),
                None => c.model.law(compat),
            };
            let rule = Rule { law, average: c.average, curvature: c.curvature };
            return Ok(Some((rule, reach(c.cutoff))));
        }
        let (Some(a), Some(b)) = (self.given.get(&(i, i)), self.given.get(&(j, j))) else { return Ok(None) };
        let refuse = |one: &str, other: &str| {
            let what =
                if one == other { format!("{one} differs") } else { format!("`{one}` and `{other}` differ") };
            let text = format!("types {i} and {j} cannot be mixed: {what}");
            Diagnostic::error(Code::CONFLICT, b.span, text)
                .label(a.span, "the other one")
                .help(format!("give this pair a line of its own: `pair_coeff {i} {j} …`"))
        };
        if a.average != b.average || a.curvature != b.curvature {
            return Err(refuse("average/curvature", "average/curvature").into());
        }
        let law = a.model.mixed(&b.model, compat).map_err(|e| refuse(e.0, e.1))?;
        let cutoff = a.cutoff.zip(b.cutoff).map(|(p, q)| (p * q).sqrt());
        Ok(Some((Rule { law, average: a.average, curvature: a.curvature }, reach(cutoff))))
    }

    /// A type whose Mindlin stiffness from its material is mixed with that of another material.
    fn mixed_shear(&self) -> Option<&Coeff> {
        let null = |c: &Coeff| c.model.tangential.stiffness.is_none();
        let like = |k: &(u16, u16)| k.0 == k.1;
        let types: Vec<_> = self.given.iter().filter(|(k, c)| like(k) && null(c)).collect();
        let meets = |a: u16, b: u16| a < b && self.acts_on(a, b) && !self.given.contains_key(&(a, b));
        let unlike = |a: &Coeff, b: &Coeff| a.model.normal.material() != b.model.normal.material();
        let pairs = types.iter().flat_map(|a| types.iter().map(move |b| (a, b)));
        pairs.into_iter().find(|(a, b)| meets(a.0.0, b.0.0) && unlike(a.1, b.1)).map(|(a, _)| a.1)
    }

    /// What plastic grains are made of: all of one kind, and nothing else in the style.
    fn mdr(&self) -> Result<Option<(Material, Span)>> {
        let normal = |c: &Coeff| c.model.normal;
        let first = self.given.values().find_map(|c| Some((c, plastic(&normal(c))?)));
        let Some((first, material)) = first else { return Ok(None) };
        let Some(other) = self.given.values().find(|c| normal(c) != normal(first)) else {
            return Ok(Some((material, first.span)));
        };
        Err(Diagnostic::error(
            Code::CONFLICT,
            other.span,
            "all pairs of types have the same normal model `mdr`, or none",
        )
        .label(first.span, "`mdr` here")
        .help("write the same numbers for all: `pair_coeff * * mdr E nu Y gamma psi_b e …`")
        .into())
    }

    /// Lends the laws of `granular` to walls, which are sealed after pair styles.
    fn lend(&self, w: &mut World, rules: &Rules) {
        if self.name != "granular" {
            return;
        }
        let types = w.types;
        let all = w.facts.remove(*GRANULAR_RULES).filter(|all| all.types() == types);
        let mut all = all.unwrap_or_else(|| Rules::new(types));
        rules.pairs().for_each(|([i, j], rule)| all.set(i, j, *rule));
        w.facts.insert(*GRANULAR_RULES, all);
    }

    fn acts_on(&self, i: u16, j: u16) -> bool {
        self.only.as_ref().is_none_or(|pairs| pairs.contains(&(i, j)))
    }

    /// Rules and reaches of all pairs of types it acts on.
    fn tables(&self, types: usize, compat: Compat) -> Result<(Rules, Wanted)> {
        let (mut rules, mut wanted) = (Rules::new(types), Wanted::new(types));
        for i in 1..=types as u16 {
            for j in i..=types as u16 {
                if !self.acts_on(i, j) {
                    continue;
                }
                if let Some((rule, reach)) = self.rule(i, j, compat)? {
                    rules.set(i, j, rule);
                    wanted.set(i, j, reach);
                }
            }
        }
        Ok((rules, wanted))
    }
}

impl Pair for Declared {
    fn facts(&self) -> Facts {
        let elastic = |m: &Model| !m.normal.pulls() && !m.normal.in_grains() && m.cohesion == Cohesion::None;
        let elastic_grains = self.given.values().all(|c| elastic(&c.model));
        Facts { name: self.name, needs: &["diameter", "density"], elastic_grains, ..Facts::default() }
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let coeff = match self.all {
            Some(all) => all,
            None => words::coeff(args, cx, &[])?,
        };
        if let (Some((_, span)), Some((i, _))) = (coeff.other, pairs.iter().find(|(i, j)| i == j)) {
            let text = format!(
                "`material` is that of the second of two types, and this line is for type {i} itself too"
            );
            return Err(Diagnostic::error(Code::CONFLICT, span, text)
                .help("name two types, as in `pair_coeff 1 2 …`, or leave the word out")
                .into());
        }
        self.given.extend(pairs.iter().map(|&p| (p, coeff)));
        Ok(())
    }

    fn coefficient(&self, name: &str, types: (u16, u16)) -> Option<f64> {
        let (young, poisson) = self.given.get(&types)?.model.normal.material()?;
        match name {
            "E" => Some(young),
            "nu" => Some(poisson),
            _ => None,
        }
    }

    fn declare(&self, w: &mut World) {
        if let Ok((rules, _)) = self.tables(w.types, w.settings.compat) {
            self.lend(w, &rules);
        }
        if self.given.values().any(|c| c.model.normal.in_grains()) {
            State::declare(w);
        }
    }

    fn covers(&self, i: u16, j: u16) -> bool {
        let has = |a: u16, b: u16| self.given.contains_key(&(a.min(b), a.max(b)));
        has(i, j) || (has(i, i) && has(j, j))
    }

    fn restrict(&mut self, pairs: &TypePairs) {
        self.only = Some(pairs.to_vec());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<ByPart<dyn Op>> {
        let w = cx.world();
        let (rules, wanted) = self.tables(w.types, w.settings.compat)?;
        let columns = &w.columns;
        if conducts(&rules)
            && [&TEMPERATURE, &HEATFLOW].iter().any(|role| columns.property(***role).is_none())
        {
            let text = "contacts that conduct heat need particles with a temperature";
            return Err(Diagnostic::error(Code::INCOMPLETE, cx.span(), text)
                .help("add `fix ID all property/atom temperature heatflow` and `set group all temperature …`")
                .into());
        }
        let press = self.mdr()?.map(|(material, span)| Press::new(material, span));
        if press.is_some() {
            // Walls look it up: pair styles are sealed before fixes.
            if let Some(grain) = self.given.values().find_map(|c| plastic_grain(&c.model.normal)) {
                cx.world().facts.insert(*PLASTIC_GRAIN, grain);
            }
        }
        self.lend(cx.world(), &rules);
        let types = cx.world().types;
        Ok(vec![(0, Box::new(Force::new(self.name, rules, wanted, types, press)))])
    }

    fn probes(&self, w: &World, _bonds: bool) -> Result<ByPart<dyn Probe>> {
        let (rules, wanted) = self.tables(w.types, w.settings.compat)?;
        let own = match self.name {
            "granular" if self.mdr()?.is_some() => Own::Mdr,
            "granular" => Own::Granular,
            _ => Own::Gran,
        };
        Ok(vec![(0, Box::new(ContactProbe::new(self.name, rules, wanted, own)))])
    }

    fn scales(&self, w: &World, deck: Deck) -> Scales {
        let probes = self.probes(w, false).unwrap_or_default();
        let cutoff = probes.iter().filter_map(|(_, p)| p.cutoff(w)).reduce(f64::max);
        let rules = self.tables(w.types, w.settings.compat).ok();
        let contact_time = rules.and_then(|(rules, _)| durations::between_grains(w, &rules, deck));
        Scales { cutoff, contact_time, ..Scales::default() }
    }

    fn check(&self, cx: &BuildCx) {
        let w = cx.world;
        if let Err(e) = self.mdr() {
            e.0.into_iter().for_each(|d| cx.note(d));
        }
        if let Err(e) = self.tables(w.types, w.settings.compat) {
            e.0.into_iter().for_each(|d| cx.note(d));
        }
        for (has, fault, mended) in FAULTS {
            if let Some(c) = self.given.values().find(|c| has(&c.model)) {
                cx.fault(c.span, fault, mended);
            }
        }
        if let Some(c) = self.mixed_shear() {
            let fault = "the shear stiffness of mixed type pairs from E* in the place of both moduli";
            cx.fault(c.span, fault, false);
        }
    }
}

#[cfg(test)]
mod tests;
