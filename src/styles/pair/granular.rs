//! `pair_style granular`: contacts of spheres, with models chosen per pair of types.

mod force;

use super::{Pair, PairStyle, TypePairs};
use crate::diag::{Code, Diagnostic, Result};
use crate::lang::Args;
use crate::laws::contact::driver::{Rule, Rules};
use crate::laws::contact::{Damping, Granular, Twisting};
use crate::neigh::list::{Reach, Wanted};
use crate::plan::Op;
use crate::styles::contact::{Coeff, words};
use crate::styles::{BuildCx, Doc, SealCx, Style};
use crate::world::Compat;
use std::collections::BTreeMap;

/// The style.
pub struct GranularStyle;

impl Style for GranularStyle {
    fn name(&self) -> &'static str {
        "granular"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "pair_style granular [cutoff]\n\
                     pair_coeff i j normal … tangential … [damping …] [rolling …] [twisting …] [limit_damping] \
                     [cutoff C] [average none|particle|body] [curvature both|impactor]\n\
                     normal: none | hooke kn eta | hertz kn eta | hertz/material E eta nu | dmt E eta nu gamma | \
                     jkr E eta nu gamma\n\
                     damping: none | velocity | mass_velocity | viscoelastic | tsuji | coeff_restitution\n\
                     tangential: none | linear_nohistory x_gamma mu | linear_history kt x_gamma mu | \
                     linear_history_classic kt x_gamma mu | mindlin_classic kt x_gamma mu | \
                     mindlin[/force] kt|NULL x_gamma mu | mindlin_rescale[/force] kt|NULL x_gamma mu\n\
                     rolling: none | sds k gamma mu\n\
                     twisting: none | marshall | sds k gamma mu",
            summary: "Contacts of spheres: a law along the normal, damping, friction, rolling and twisting resistance.",
            text: "Spheres with overlap δ = R_i + R_j − r > 0 push each other along the normal with F_n − η v_n; \
                R̄ = R_i R_j/(R_i + R_j), m̄ = m_i m_j/(m_i + m_j), a = √(R̄ δ). `limit_damping` cuts this force off at \
                zero.\n\n\
                Normal: `hooke` F_n = kn δ; `hertz` kn a δ; `hertz/material` 4/3 E* a δ with \
                1/E* = (1−ν_i²)/E_i + (1−ν_j²)/E_j; `dmt` 4/3 E* a δ − 4π γ R̄; `jkr` 4/3 E* a³/R̄ − 4 a √(π γ E* a) \
                with δ = a²/R̄ − 2 √(π γ a/E*): a contact that has been made lasts until it is torn off at −3π γ R̄, \
                beyond touch. `eta` is a damping coefficient or a coefficient of restitution e, as `damping` says.\n\n\
                `damping`: η = eta (`velocity`), eta m̄ (`mass_velocity`), eta a m̄ (`viscoelastic`, the default), \
                √2 α_T(e) √(m̄ k) (`tsuji`), 2β √(m̄ k) for hooke and √5 β √(m̄ k) for the others \
                (`coeff_restitution`, β = −ln e/√(π²+ln²e)); k = F_n/δ. For the last two 0 < e ≤ 1; they do not go \
                with dmt and jkr.\n\n\
                `tangential`: F_t = −k_t ξ − x_gamma η v_t, at most `mu` |F_n|, for dmt and jkr mu |F_n + 2 F_pulloff| \
                with F_n before damping. ξ is the slip accumulated while the contact lasts, turned with the tangent \
                plane and shortened to what slides (Luding 2008). `linear_nohistory` has no spring; `mindlin…` take \
                k_t a for k_t, and with `NULL` k_t = 8 G*, 1/G* = (2−ν_i)/G_i + (2−ν_j)/G_j. `…/force` remembers the \
                force, dF = −k_t a v_t dt; `…_rescale` shrinks what is remembered with a when the contact unloads, so \
                that unloading makes no energy (Thornton et al. 2013). `…_classic` drops the part of ξ along the \
                normal, as pair_style gran/*. Torques act at the middle of the overlap.\n\n\
                `rolling sds`: a spring, dashpot and slider for the rolling velocity R̄ (ω_i − ω_j) × n; its force, at \
                most mu times the normal force, acts only as a torque with arm R̄. `twisting`: the same for the spin \
                about the normal; `marshall` takes k_t a²/2, x_gamma η a²/2 and 2/3 a mu of the tangential model \
                (k_t before any factor a).\n\n\
                Type pairs without a line of their own mix those of the like pairs, of which the words must be the \
                same: geometric means, E* and G* as above. `cutoff` sets the reach of the neighbour list by hand.\n\n\
                Not in LAMMPS: `none` for normal, damping and tangential; `average` divides the force of each contact \
                by the number N of simultaneous ones, of the two particles (the larger number) or of the two bodies; \
                action and reaction stay equal. `curvature impactor` takes R̄ = R of the grain where it meets a \
                peridynamic solid, whose surface counts as flat (Walayat et al., table 1).\n\n\
                `-compat lammps` has LAMMPS' faults: tsuji without its √2; the shear stiffness of mixed types from E* \
                in the place of both moduli; a sliding twist that takes the direction of the spin even where its \
                spring pushes the other way.",
            example: "pair_style granular\n\
                      pair_coeff * * hertz/material 5.0e7 0.7 0.3 damping tsuji tangential mindlin NULL 1.0 0.4",
        }
    }
}

impl PairStyle for GranularStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        if !cx.world.particles.style.sphere {
            return Err(Diagnostic::error(
                Code::WRONG_ORDER,
                cx.span,
                "pair_style granular needs particles with a radius",
            )
            .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
            .into());
        }
        let number = args.peek_text().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
        let cutoff = if number { Some(args.positive("the global cutoff")?) } else { None };
        Ok(Box::new(Declared { cutoff, given: BTreeMap::new(), only: None, memory: "granular".to_string() }))
    }
}

/// The style with its coefficients.
#[derive(Clone)]
struct Declared {
    cutoff: Option<f64>,
    given: BTreeMap<(u16, u16), Coeff>,
    /// As a sub-style: the pairs of types it acts on.
    only: Option<Vec<(u16, u16)>>,
    /// Where contact history is kept in the world.
    memory: String,
}

impl Declared {
    /// The law of a pair of types and its reach: given, or mixed from the like pairs.
    fn rule(&self, i: u16, j: u16, compat: Compat) -> Result<Option<(Rule<Granular>, Reach)>> {
        let reach = |c: Option<f64>| c.or(self.cutoff).map_or(Reach::Touch, Reach::Fixed);
        if let Some(c) = self.given.get(&(i, j)) {
            let rule = Rule { law: c.model.law(compat), average: c.average, curvature: c.curvature };
            return Ok(Some((rule, reach(c.cutoff))));
        }
        let (Some(a), Some(b)) = (self.given.get(&(i, i)), self.given.get(&(j, j))) else { return Ok(None) };
        let refuse = |one: &str, other: &str| {
            let text = format!("types {i} and {j} cannot be mixed: `{one}` and `{other}` differ");
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

    fn acts_on(&self, i: u16, j: u16) -> bool {
        self.only.as_ref().is_none_or(|pairs| pairs.contains(&(i, j)))
    }

    /// Rules and reaches of all pairs of types it acts on.
    fn tables(&self, types: usize, compat: Compat) -> Result<(Rules<Granular>, Wanted)> {
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
    fn name(&self) -> &'static str {
        "granular"
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, _cx: &BuildCx) -> Result<()> {
        let coeff = words::coeff(args, &[])?;
        self.given.extend(pairs.iter().map(|&p| (p, coeff)));
        Ok(())
    }

    fn covers(&self, i: u16, j: u16) -> bool {
        let has = |a: u16, b: u16| self.given.contains_key(&(a.min(b), a.max(b)));
        has(i, j) || (has(i, i) && has(j, j))
    }

    fn restrict(&mut self, pairs: &TypePairs) {
        self.only = Some(pairs.to_vec());
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let w = cx.world();
        let (rules, wanted) = self.tables(w.types, w.settings.compat)?;
        Ok(vec![Box::new(force::Force::new(rules, wanted, self.memory.clone()))])
    }

    fn needs(&self) -> &'static [&'static str] {
        &["diameter", "density"]
    }

    fn check(&self, cx: &BuildCx) {
        let w = cx.world;
        if let Err(e) = self.tables(w.types, w.settings.compat) {
            e.0.into_iter().for_each(|d| cx.note(d));
        }
        if !w.settings.lammps() {
            return;
        }
        if let Some(c) = self.given.values().find(|c| c.model.damping == Damping::Tsuji) {
            let text = "compat lammps: damping tsuji without its factor √2";
            cx.note(Diagnostic::note(Code::COMPAT, c.span, text));
        }
        if let Some(c) = self.given.values().find(|c| c.model.twisting != Twisting::None) {
            let text = "compat lammps: a sliding twist takes the direction of the spin, not of its torque";
            cx.note(Diagnostic::note(Code::COMPAT, c.span, text));
        }
        if let Some(c) = self.mixed_shear() {
            let text =
                "compat lammps: shear stiffness of mixed type pairs from E* in the place of both moduli";
            cx.note(Diagnostic::note(Code::COMPAT, c.span, text));
        }
    }

    fn boxed(&self) -> Box<dyn Pair> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests;
