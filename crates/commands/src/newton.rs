//! `newton`: LAMMPS' choice of the process that computes a pair at a processor's border; accepted, without effect.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::setting;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct Newton;

impl Style for Newton {
    fn name(&self) -> &'static str {
        "newton"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Accepted for the sake of LAMMPS decks: every pair is computed once, whatever the flags.",
            text: "The flag for bonds must not change once the box exists.",
            example: "newton off",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The flag of pairs.
    #[word(what = "newton")]
    pair: bool,
    /// The flag of bonds; without it that of pairs.
    #[word(what = "newton for bonds")]
    bond: Option<bool>,
}

impl CommandStyle for Newton {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let Line { pair, bond } = read(a, cx)?;
        let bond = bond.unwrap_or(pair);
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
