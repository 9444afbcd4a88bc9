//! `mass`: the mass of each type, where particles have none of their own.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::common::{domain, setting};
use perigrain_styles::words::{Syntax, Types, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct Mass;

impl Style for Mass {
    fn name(&self) -> &'static str {
        "mass"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Sets the mass of all particles of a type (atom_style atomic).",
            text: "Particles of the styles sphere and peri have masses of their own: `set … mass` or `set … density`; where they \
                   are in a hybrid with bonds, the line is taken for LAMMPS' decks, without effect.",
            example: "mass * 1.0",
        }
    }
}

#[derive(Words)]
struct Line {
    /// A type, or a range such as `*` or `2*4`.
    #[word(name = "TYPE")]
    types: Types,
    /// The mass [mass].
    #[word(name = "M", positive)]
    mass: f64,
}

impl CommandStyle for Mass {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        domain(cx)?;
        let style = cx.world.particles.style;
        if style.own_mass() && !style.idle_type_mass() {
            let text = "every particle of this atom_style has its own mass";
            let d = Diagnostic::error(Code::CONFLICT, a.name_span(), text);
            return Err(d.help("write `set type 1 mass …` or `set group all density …`").into());
        }
        let Line { types: Types(lo, hi), mass } = read(a, cx)?;
        if style.idle_type_mass() {
            let text = "masses of types have no effect here: every particle has its own";
            cx.note(Diagnostic::note(Code::NO_EFFECT, a.name_span(), text));
            return Ok(setting(|_| Ok(())));
        }
        Ok(setting(move |cx| {
            cx.world.type_mass[usize::from(lo) - 1..usize::from(hi)].fill(Some(mass));
            cx.world.spread_type_masses();
            cx.world.touch();
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refused, scene};

    #[test]
    fn by_type_and_range() {
        let w = scene("region b block 0 1 0 1 0 1\ncreate_box 3 b\nmass * 2\nmass 2*3 4.5");
        assert_eq!(w.type_mass, [Some(2.0), Some(4.5), Some(4.5)]);
        assert_eq!(refused(&w, "mass 4 1.0").0, "4");
        assert_eq!(refused(&w, "mass 1 0").0, "0");
        let s = scene("atom_style sphere\nregion b block 0 1 0 1 0 1\ncreate_box 1 b");
        assert_eq!(refused(&s, "mass 1 1.0").0, "mass");
        let s =
            scene("atom_style hybrid sphere bond\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\nmass 1 1.0");
        assert_eq!(s.type_mass, [None]);
    }
}
