//! The loops over a sealed plan: steps in time, minimization, load steps, cycles.

pub mod fatigue;
pub mod guarded;
pub mod levels;
pub mod minimize;
mod path;
pub mod staggered;
pub mod statics;
pub mod verlet;

use crate::StepPlan;
use levels::Levels;
use perigrain_base::diag::Result;
use perigrain_world::World;
use staggered::Staggered;
pub use verlet::{Made, Outcome, Watch, verlet};

/// How the steps of a run are made.
#[derive(Clone, Debug, PartialEq)]
pub enum Pace {
    /// All alike.
    Even,
    /// Long ones for grains and short ones for solids.
    Staggered(Staggered),
    /// Of several lengths within each other.
    Levels(Levels),
}

impl Pace {
    /// Forces at the start of a run and its first outputs; `unchanged`: the scene is as the last run left it.
    ///
    /// # Errors
    /// The first op's that fails.
    pub fn setup(&self, plan: &mut StepPlan, w: &mut World, unchanged: bool) -> Result<()> {
        match self {
            Pace::Even => verlet::setup(plan, w, unchanged),
            Pace::Staggered(s) => staggered::setup(plan, w, unchanged, s),
            Pace::Levels(l) => levels::setup(plan, w, unchanged, l),
        }
    }

    /// Makes the steps `clock.first + 1 ..= clock.last`.
    ///
    /// # Errors
    /// The first op's that fails; the world is then as that op left it.
    pub fn run(&self, plan: &mut StepPlan, w: &mut World, watch: &mut dyn Watch) -> Result<Outcome> {
        match self {
            Pace::Even => verlet(plan, w, watch),
            Pace::Staggered(s) => {
                verlet::steps(plan, w, watch, |plan, w, t, _| staggered::step(plan, w, t, s))
            }
            Pace::Levels(l) => verlet::steps(plan, w, watch, |plan, w, t, _| levels::step(plan, w, t, l)),
        }
    }
}
