//! `timestep`: the step size.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::common::setting;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct Timestep;

impl Style for Timestep {
    fn name(&self) -> &'static str {
        "timestep"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Sets the step size [time].",
            text: "Holds from the next step on; elapsed time is kept. Default by units: lj 0.005, real 1, metal 0.001, si and cgs \
                   1e-8, electron 0.001, micro 2, nano 0.00045.",
            example: "timestep 1.0e-8",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The time step [time].
    #[word(name = "DT")]
    dt: At<f64>,
}

impl CommandStyle for Timestep {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let Line { dt: At { value: dt, span, unknown, .. } } = read(a, cx)?;
        if dt <= 0.0 {
            let text = format!("a time step of {dt} leads nowhere, or back");
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, span, text));
        }
        Ok(setting(move |cx| {
            cx.world.clock.set_dt(dt);
            cx.world.unseen.length = unknown;
            Ok(())
        }))
    }
}
