//! Three force components as fixes read them: numbers, variables or `NULL`, with an optional region.

use super::RegionId;
use perigrain_base::diag::Result;
use perigrain_lang::Param;
use perigrain_plan::{Stage, When};
use perigrain_styles::matter::Chosen;
use perigrain_styles::words::Nullable;
use perigrain_styles::{Reading, SealCx};
use perigrain_world::GroupId;

/// `fx fy fz [region ID]`; `NULL` leaves a component unchanged.
#[derive(Clone)]
pub struct Components {
    group: GroupId,
    force: [Option<Param>; 3],
    region: Option<String>,
}

impl Components {
    /// From the words of a line.
    pub fn new<P: Into<Param>>(force: [Nullable<P>; 3], region: Option<RegionId>, group: GroupId) -> Self {
        Self { group, force: force.map(|p| p.0.map(Into::into)), region: region.map(|r| r.0) }
    }

    /// The components that are the number 0 for all particles of the group; `None` where one has another value, or a region chooses.
    pub fn zeros(&self) -> Option<[bool; 3]> {
        let zero = |p: &Option<Param>| match p {
            None => Some(false),
            Some(Param::Number(a)) if *a == 0.0 => Some(true),
            Some(_) => None,
        };
        let [x, y, z] = &self.force;
        Some([zero(x)?, zero(y)?, zero(z)?]).filter(|_| self.region.is_none())
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
