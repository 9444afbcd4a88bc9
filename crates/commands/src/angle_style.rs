//! `angle_style` and `angle_coeff`: angles between bonds, which exert nothing here.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::common::{domain, setting};
use perigrain_styles::words::Syntax;
use perigrain_styles::{BuildCx, Doc, Style, lammps};
use perigrain_world::angles::AngleZero;

/// `angle_style`.
pub struct AngleStyleCommand;

/// `angle_coeff`.
pub struct AngleCoeff;

/// The styles.
pub const ANGLE_STYLES: [&str; 1] = ["zero"];

const CHAIN: &str = "units lj\natom_style angle\nregion b block 0 5 0 4 0 4\n\
    create_box 1 b bond/types 1 angle/types 1 extra/bond/per/atom 2 extra/angle/per/atom 1\ncreate_atoms 1 single 1 1 1\ncreate_atoms 1 single 2 1 1\n\
    create_atoms 1 single 3 1 1\nmass 1 1.0\ncreate_bonds single/bond 1 1 2\ncreate_bonds single/bond 1 2 3\ncreate_bonds single/angle 1 1 2 3\n\
    bond_style harmonic\nbond_coeff 1 10.0 1.0\nangle_style zero\nangle_coeff 1 180.0\nfix 1 all nve\nrun 10";

impl Style for AngleStyleCommand {
    fn name(&self) -> &'static str {
        "angle_style"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written("angle_style zero [nocoeff] | none"),
            summary: "Says what angles between bonds do: nothing.",
            text: "Angles come from data files, molecule files and `create_bonds single/angle`; they are kept, counted (`angles`), written by `write_data` and \
                   `write_restart`, and go when one of their bonds or particles goes. `zero` says that they are meant to exert no forces; with \
                   `nocoeff` whatever stands in `angle_coeff` is taken. `none` forgets the style. Styles with forces are refused: bonds bend \
                   here by `bond_style bpm/rotational` or `bpm/beam`.",
            example: CHAIN,
        }
    }
}

impl Style for AngleCoeff {
    fn name(&self) -> &'static str {
        "angle_coeff"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written("angle_coeff T [THETA]"),
            summary: "Coefficients of angle types.",
            text: "T is an angle type or a range such as `*` or `2*4`. THETA [degrees] goes into data files and means nothing else. Every angle type needs a \
                   line when a run begins and an `angle_style` is in force.",
            example: CHAIN,
        }
    }
}

impl CommandStyle for AngleStyleCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let style = cx.world.particles.style;
        let word = a.expect("a style of angles")?;
        let new = match lammps::plain("angle", &word.text) {
            "none" => None,
            "zero" if !style.angled => {
                let text = format!("particles of atom_style {} have no angles", style.name());
                let d = Diagnostic::error(Code::CONFLICT, a.name_span(), text);
                return Err(d.help("`atom_style angle`, alone or in a hybrid, has them").into());
            }
            "zero" => Some(AngleZero { any: a.eat("nocoeff"), ..AngleZero::default() }),
            _ => return Err(lammps::unknown("angle", "angle_style", word, &["zero", "none"])),
        };
        Ok(setting(move |cx| {
            cx.world.bonds.angles.style = new;
            cx.world.touch();
            Ok(())
        }))
    }
}

impl CommandStyle for AngleCoeff {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        domain(cx)?;
        let angles = &cx.world.bonds.angles;
        let Some(any) = angles.style.as_ref().map(|style| style.any) else {
            let text = "angle_coeff comes before any angle_style";
            let d = Diagnostic::error(Code::WRONG_ORDER, a.name_span(), text);
            return Err(d.help("put `angle_style zero` first").into());
        };
        if angles.types == 0 {
            let d = Diagnostic::error(Code::CONFLICT, a.here(), "there are no angle types");
            return Err(d.help("set the number: `create_box … angle/types N`").into());
        }
        let (first, last) = a.type_range(angles.types)?;
        let angle = match (any, a.is_empty()) {
            (true, _) => {
                a.rest();
                0.0
            }
            (false, true) => 0.0,
            (false, false) => a.number("the angle THETA")?,
        };
        Ok(setting(move |cx| {
            let given = cx.world.bonds.angles.style.iter_mut();
            given.for_each(|style| style.given.extend((first..=last).map(|k| (usize::from(k), angle))));
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refused, scene};

    #[test]
    fn styles_without_forces_alone() {
        let w = scene(
            "atom_style angle\nregion b block 0 1 0 1 0 1\ncreate_box 1 b angle/types 3\nangle_style zero\nangle_coeff 2* 120",
        );
        assert_eq!(w.bonds.angles.missing(), [1]);
        assert_eq!(refused(&w, "angle_coeff 4").0, "4");
        assert!(refused(&w, "angle_style harmonic").1.contains("not in perigrain"));
        assert_eq!(refused(&w, "angle_style zeor").0, "zeor");
        assert_eq!(refused(&Default::default(), "angle_style zero").0, "angle_style");
        let w = scene(
            "atom_style bond\nregion b block 0 1 0 1 0 1\ncreate_box 1 b bond/types 1\nangle_style none",
        );
        assert_eq!(refused(&w, "create_bonds single/angle 1 1 2 3").0, "create_bonds");
        assert_eq!(refused(&w, "angle_coeff 1").0, "angle_coeff");
    }
}
