//! `reset_timestep`: the step counter.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::common::setting;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct ResetTimestep;

impl Style for ResetTimestep {
    fn name(&self) -> &'static str {
        "reset_timestep"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Sets the step counter; elapsed time becomes N times the step size, or T.",
            text: "The scene is left alone. Refused while a fix counts steps: `ave/atom`, `ave/chunk`, `ave/time`, `dt/reset`, \
                   `pour` or `vector`; and while a dump has written snapshots into a file that keeps growing.",
            example: "reset_timestep 0",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The step.
    #[word(name = "N", from = 0)]
    step: i64,
    /// The time, if it is not to be N times the step size [time].
    #[word(keyword, name = "T")]
    time: Option<f64>,
}

impl CommandStyle for ResetTimestep {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let Line { step, time } = read(a, cx)?;
        if let Some((id, style)) = cx.names.counting_fix(cx.world) {
            let text = format!("the step cannot be reset while fix `{id}` ({style}) counts on it");
            let help = format!("put `unfix {id}` before this line, and the fix again after it");
            return Err(Diagnostic::error(Code::CONFLICT, cx.span, text).help(help).into());
        }
        if let Some(id) = cx.names.growing_dump() {
            let text = format!(
                "the step cannot be reset while dump `{id}` is writing: its file would have steps twice"
            );
            let help = format!("put `undump {id}` before this line, and the dump again after it");
            return Err(Diagnostic::error(Code::CONFLICT, cx.span, text).help(help).into());
        }
        Ok(setting(move |cx| {
            let clock = &mut cx.world.clock;
            clock.reset(step);
            if let Some(t) = time {
                clock.time_base = t;
            }
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refused, scene};

    // Oracle: `timestep 0.1`, `reset_timestep 5` prints time 0.5; `reset_timestep 7 time 3.5` prints 3.5.
    #[test]
    fn time_follows_the_counter() {
        let w = scene("timestep 0.1\nreset_timestep 5");
        assert_eq!((w.clock.step, w.clock.time()), (5, 0.5));
        assert_eq!(scene("timestep 0.1\nreset_timestep 7 time 3.5").clock.time(), 3.5);
        assert_eq!(refused(&w, "reset_timestep -1").0, "-1");
    }
}
