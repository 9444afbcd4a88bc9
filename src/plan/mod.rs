//! The step as data: ops with stages, reads, writes and times.

pub mod explain;
pub mod guard;
pub mod meter;
pub mod op;
pub mod schedule;
pub mod stretch;

pub use guard::{Energy, Guard, Rule};
pub use meter::Meter;
pub use op::{Access, Beat, Op, OpClass, Phase, Solids, Stage, Tick, When};
pub use schedule::{LeftOut, Placed, StepPlan};
pub use stretch::{Act, Gist, Stretch, take_turns};
