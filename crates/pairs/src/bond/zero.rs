//! bond zero: bonds without forces.

use super::{BondForce, BondStyle, Pull, Stretched};
use perigrain_base::diag::Result;
use perigrain_base::math::cformat::general;
use perigrain_lang::Args;
use perigrain_plan::Op;
use perigrain_styles::words::{Form, Syntax, Words, inner, read};
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
                const { &[Form::behind(Line::GRAMMAR), Form::headed("bond_coeff T", Own::GRAMMAR)] },
            ),
            summary: "Bonds without forces: they join particles only in name.",
            text: "With `nocoeff` one deck serves for several styles.",
            example: "units lj\natom_style bond\nregion b block 0 4 0 4 0 4\ncreate_box 1 b bond/types 1 extra/bond/per/atom 2\n\
                      create_atoms 1 single 1 1 1\ncreate_atoms 1 single 2 1 1\nmass 1 1.0\n\
                      create_bonds single/bond 1 1 2\nbond_style zero\nbond_coeff 1\nfix 1 all nve\nrun 10",
        }
    }
}

impl BondStyle for ZeroStyle {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn BondForce>> {
        let Line { nocoeff } = inner(args, cx)?;
        Ok(Box::new(Zero { any: nocoeff, lengths: BTreeMap::new() }))
    }
}

/// The words of the style.
#[derive(Words)]
struct Line {
    /// `bond_coeff` takes whatever stands there.
    #[word(flag)]
    nocoeff: bool,
}

/// The words of `bond_coeff`.
#[derive(Words)]
struct Own {
    /// The length r0, which goes into data files and means nothing else [length].
    #[word(name = "r0")]
    length: Option<f64>,
}

#[derive(Clone)]
struct Zero {
    /// Whatever stands in `bond_coeff` is taken.
    any: bool,
    lengths: BTreeMap<u16, f64>,
}

impl BondForce for Zero {
    fn name(&self) -> &'static str {
        "zero"
    }

    fn coeff(&mut self, kinds: &[u16], args: &mut Args, cx: &BuildCx) -> Result<()> {
        let mut length = 0.0;
        if self.any {
            args.rest();
        } else {
            length = read::<Own>(args, cx)?.length.unwrap_or(0.0);
        }
        self.lengths.extend(kinds.iter().map(|&k| (k, length)));
        Ok(())
    }

    fn covers(&self, kind: u16) -> bool {
        self.lengths.contains_key(&kind)
    }

    fn ops(&self, _cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        Ok(vec![])
    }

    fn single(&self, _w: &World, bond: &Stretched) -> Option<Pull> {
        self.covers(bond.kind).then(Pull::default)
    }

    fn written(&self, kind: u16) -> Option<String> {
        self.lengths.get(&kind).map(|r| general(*r, 16))
    }
}
