//! `min_style`: the algorithm of `minimize`.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::common::setting;
use perigrain_styles::words::{Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, Style, lammps};
use perigrain_world::Minimizer;
use perigrain_world::minimizer::MinStyle;

/// The command.
pub struct MinStyleCommand;

impl Style for MinStyleCommand {
    fn name(&self) -> &'static str {
        "min_style"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Chooses the algorithm of `minimize`.",
            text: "`min_modify` sets their numbers; `min_style` puts all of them back to their defaults, as in LAMMPS. LAMMPS' \
                   other styles are refused by name.",
            example: "min_style fire",
        }
    }
}

#[derive(Words)]
struct Line {
    algorithm: Algorithm,
}

/// The algorithms.
#[derive(Words)]
#[word(what = "minimization style", of = MinStyle)]
enum Algorithm {
    /// Conjugate gradients of Polak and Ribière with line searches; the default. Needs energies that belong to the forces.
    Cg,
    /// Steepest descent with the same line searches.
    Sd,
    /// Damped motion with an adaptive time step (Bitzek et al., Phys. Rev. Lett. 97, 170201; Guénolé et al., Comput. Mater. Sci. 175,
    /// 109584). It looks at forces alone and so serves grains, whose contact laws count no energy; it begins with the deck's `timestep`
    /// and masses.
    Fire,
    /// Damped motion with the deck's `timestep` that keeps of its velocity only what points along the forces (Sheppard et al., J. Chem.
    /// Phys. 128, 134106). Looks at forces alone too.
    Quickmin,
}

impl CommandStyle for MinStyleCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        if let Some(refusal) = a
            .peek()
            .filter(|word| !Algorithm::begins(word))
            .and_then(|word| lammps::refusal("min", "minimization style", word))
        {
            return Err(refusal);
        }
        let Line { algorithm } = read(a, cx)?;
        let style = MinStyle::from(algorithm);
        let span = a.span();
        Ok(setting(move |cx| {
            if cx.world.settings.minimizer.modified() {
                let text = "min_style puts all numbers back to their defaults: those of a `min_modify` before it are lost";
                cx.note(
                    Diagnostic::warning(Code::SUSPICIOUS, span, text)
                        .help("use `min_modify` after `min_style`"),
                );
            }
            cx.world.settings.minimizer = Minimizer { style, ..Minimizer::default() };
            Ok(())
        }))
    }
}
