//! `newton`: LAMMPS' choice of the process that computes a pair at a processor's border; accepted, without effect.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::setting;
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct Newton;

impl Style for Newton {
    fn name(&self) -> &'static str {
        "newton"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "newton on|off [on|off]",
            summary: "Accepted for the sake of LAMMPS decks: every pair is computed once, whatever the flags.",
            text: "One flag for pairs and bonds, or one each. That for bonds must not change once the box exists.",
            example: "newton off",
        }
    }
}

impl CommandStyle for Newton {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let pair = a.flag("newton")?;
        let bond = if a.is_empty() { pair } else { a.flag("newton for bonds")? };
        if cx.world.domain.is_some() && cx.world.settings.newton.bond != bond {
            let text = "`newton` for bonds must be set before the simulation box is defined";
            return fail(Code::WRONG_ORDER, cx.span, text);
        }
        let text = "newton has no effect here: every pair is computed once";
        cx.note(Diagnostic::note(Code::NO_EFFECT, a.name_span(), text));
        Ok(setting(move |cx| {
            cx.world.settings.newton = perigrain_world::Newton { pair, bond };
            Ok(())
        }))
    }
}
