//! Three force components as fixes read them: numbers, variables or `NULL`, with an optional region.

use super::region_keyword;
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Param};
use perigrain_plan::{Stage, When};
use perigrain_styles::common::param_or_null;
use perigrain_styles::matter::Chosen;
use perigrain_styles::{BuildCx, Reading, SealCx};
use perigrain_world::GroupId;

/// `fx fy fz [region ID]`; `NULL` leaves a component unchanged.
#[derive(Clone)]
pub struct Components {
    group: GroupId,
    force: [Option<Param>; 3],
    region: Option<String>,
}

impl Components {
    /// Reads the words to the end of the line; with `per_atom`, atom-style variables are allowed.
    ///
    /// # Errors
    /// Every mistake in them.
    pub fn read(args: &mut Args, cx: &BuildCx, per_atom: bool) -> Result<Self> {
        let mut force = [const { None }; 3];
        for (force, what) in force.iter_mut().zip(["fx", "fy", "fz"]) {
            *force = param_or_null(args, what)?;
            force.iter().try_for_each(|p| cx.param(p, per_atom))?;
        }
        let mut region = None;
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "region" => region = Some(region_keyword(args, cx)?),
                _ => return Err(args.unknown(word, &["region"])),
            }
        }
        Ok(Self { group: cx.group, force, region })
    }

    /// The particles it acts on, and where the component values are found during a run.
    ///
    /// # Errors
    /// A region or variable that is gone.
    pub fn seal(&self, cx: &mut dyn SealCx) -> Result<(Chosen, [Option<Reading>; 3])> {
        let span = cx.span();
        let chosen = Chosen::new(cx.world(), self.group, self.region.as_deref(), span)?;
        let mut force = [None; 3];
        for (reading, param) in force.iter_mut().zip(&self.force) {
            if let Some(p) = param {
                *reading = Some(cx.param(p, Stage::PostForce, &When::Always)?);
            }
        }
        Ok((chosen, force))
    }
}
