//! The step as data: ops with stages, reads, writes and times.

mod ending;
pub mod explain;
pub mod guard;
mod level;
pub mod meter;
pub mod op;
pub mod run;
pub mod schedule;
pub mod stretch;

pub use guard::{Energy, Guard, Rule};
pub use level::{Level, Phase, Solids};
pub use meter::Meter;
pub use op::{Access, Op, OpClass, Stage, Tick, When};
pub use schedule::{LeftOut, Placed, StepPlan};
pub use stretch::{Act, Beside, Gist, Pull, Stretch, Turns, take_turns};
