//! `pair_style zero`: particles that do not feel each other.

use super::{ByPart, Deck, Facts, Pair, PairStyle, Scales, TypePairs};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::words::Syntax;
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
            syntax: Syntax::Written("pair_style zero CUTOFF [nocoeff] [full]\npair_coeff I J [CUTOFF]"),
            summary: "No forces between particles.",
            text: "Says that pairs are meant to exert no forces, as in scenes of bonds alone. LAMMPS builds neighbour lists up to \
                   the cutoff; here they are not needed. With `nocoeff` pair_coeff accepts any words.",
            example: "pair_style zero 0.002\npair_coeff * *",
        }
    }
}

impl PairStyle for ZeroStyle {
    fn build(&self, args: &mut Args, _cx: &BuildCx) -> Result<Box<dyn Pair>> {
        let cutoff = args.positive("the cutoff")?;
        let mut any = false;
        loop {
            if args.eat("nocoeff") {
                any = true;
            } else if !args.eat("full") {
                break;
            }
        }
        Ok(Box::new(Zero { any, cutoff, pairs: BTreeMap::new() }))
    }

    fn options(&self) -> &'static [&'static str] {
        &["nocoeff", "full"]
    }
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
        Facts { name: "zero", ..Facts::default() }
    }

    fn coeff(&mut self, pairs: &TypePairs, args: &mut Args, _cx: &BuildCx) -> Result<()> {
        let mut cutoff = self.cutoff;
        if self.any {
            args.rest();
        } else if !args.is_empty() {
            cutoff = args.positive("the cutoff")?;
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
