//! `pair_style zero`: particles that do not feel each other.

use super::{ByPart, Deck, Facts, Pair, PairStyle, Scales, TypePairs};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::words::{Form, Syntax, Words, inner};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::World;
use std::collections::BTreeMap;

/// The style.
pub struct ZeroStyle;

impl Style for ZeroStyle {
    fn name(&self) -> &'static str {
        "zero"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const { &[Form::behind(Line::GRAMMAR), Form::headed("pair_coeff I J", Own::GRAMMAR)] },
            ),
            summary: "No forces between particles.",
            text: "Says that pairs are meant to exert no forces, as in scenes of bonds alone. LAMMPS builds neighbour lists up to \
                   the cutoff; here they are not needed.",
            example: "pair_style zero 0.002\npair_coeff * *",
        }
    }
}

impl PairStyle for ZeroStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Pair>> {
        let Line { cutoff, nocoeff, .. } = inner(args, cx)?;
        Ok(Box::new(Zero { any: nocoeff, cutoff, pairs: BTreeMap::new() }))
    }
}

/// The words of the style.
#[derive(Words)]
struct Line {
    /// The cutoff [length].
    #[word(name = "CUTOFF", positive)]
    cutoff: f64,
    /// `pair_coeff` accepts any words.
    #[word(flag)]
    nocoeff: bool,
    /// LAMMPS' word for lists that have each pair twice; without effect here.
    #[word(flag = "full")]
    _full: bool,
}

/// The words of `pair_coeff`.
#[derive(Words)]
struct Own {
    /// The cutoff, of these types alone [length].
    #[word(name = "CUTOFF", positive)]
    cutoff: Option<f64>,
}

#[derive(Clone)]
struct Zero {
    /// Whatever stands in `pair_coeff` is taken.
    any: bool,
    /// Of pairs of types that have none of their own.
    cutoff: f64,
    /// The cutoffs of pairs of types.
    pairs: BTreeMap<(u16, u16), f64>,
}

impl Pair for Zero {
    fn facts(&self) -> Facts {
        Facts { name: "zero", balances: true, ..Facts::default() }
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, cx: &BuildCx) -> Result<()> {
        let mut cutoff = self.cutoff;
        if self.any {
            args.rest();
        } else {
            cutoff = inner::<Own>(args, cx)?.cutoff.unwrap_or(cutoff);
        }
        self.pairs.extend(pairs.iter().map(|p| (*p, cutoff)));
        Ok(())
    }

    fn covers(&self, i: u16, j: u16) -> bool {
        let has = |a, b| self.pairs.contains_key(&(a, b));
        has(i, j) || (has(i, i) && has(j, j))
    }

    fn ops(&self, _cx: &mut dyn SealCx) -> Result<ByPart<dyn Op>> {
        Ok(vec![])
    }

    fn scales(&self, _w: &World, _deck: Deck) -> Scales {
        Scales { cutoff: self.pairs.values().copied().reduce(f64::max), ..Scales::default() }
    }
}
