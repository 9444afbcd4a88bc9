//! `angle_style` and `angle_coeff`: angles between bonds, which exert nothing here.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::common::{domain, setting};
use perigrain_styles::words::{
    Alternative, Kind, Part, Syntax, Types, Value, Words, alternatives, inner, read,
};
use perigrain_styles::{BuildCx, Doc, Style, lammps};
use perigrain_world::angles::AngleZero;

/// `angle_style`.
pub struct AngleStyleCommand;

/// `angle_coeff`.
pub struct AngleCoeff;

/// The styles.
pub const ANGLE_STYLES: [&str; 1] = ["zero"];

/// The word behind `zero`.
const NOCOEFF: &str = "nocoeff";

/// The words of `angle_style`.
#[derive(Words)]
struct Line {
    #[word(name = "style")]
    style: Chosen,
}

/// What the words choose.
struct Chosen(Option<AngleZero>);

impl Value for Chosen {
    const KIND: Kind = Kind::Choice(&[
        Alternative {
            word: ANGLE_STYLES[0],
            about: "Angles exert no forces; with `nocoeff` whatever stands in `angle_coeff` is taken.",
            parts: &[Part::Maybe(&[Part::bare(NOCOEFF, Kind::Choice(&alternatives(&[(NOCOEFF, ())])))])],
        },
        Alternative { word: "none", about: "Takes the style back.", parts: &[] },
    ]);
    fn value(_: &str, a: &mut Args, cx: &BuildCx) -> Result<Self> {
        chosen(a, cx).map(Self)
    }
}

/// The first word of `angle_coeff`.
#[derive(Words)]
struct Coeff {
    /// An angle type or a range such as `*` or `2*4`.
    #[word(name = "T", with = angle_types, kind = Kind::Types)]
    types: Types,
}

/// The words of `angle_coeff`.
#[derive(Words)]
struct CoeffLine {
    #[word(flatten)]
    coeff: Coeff,
    /// An angle [degrees], which goes into data files and means nothing else.
    #[word(name = "THETA", what = "the angle THETA")]
    theta: Option<f64>,
}

fn angle_types(a: &mut Args, cx: &BuildCx) -> Result<Types> {
    a.type_range(cx.world.bonds.angles.types).map(|(first, last)| Types(first, last))
}

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
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Says what angles between bonds do: nothing.",
            text: "Angles come from data files, molecule files and `create_bonds single/angle`; they are kept, counted (`angles`), written by `write_data` and \
                   `write_restart`, and go when one of their bonds or particles goes. Styles with forces are refused: bonds bend \
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
            syntax: Syntax::Behind(CoeffLine::GRAMMAR),
            summary: "Coefficients of angle types.",
            text: "Every angle type needs a line when a run begins and an `angle_style` is in force.",
            example: CHAIN,
        }
    }
}

impl CommandStyle for AngleStyleCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let Chosen(new) = read::<Line>(a, cx)?.style;
        Ok(setting(move |cx| {
            cx.world.bonds.angles.style = new;
            cx.world.touch();
            Ok(())
        }))
    }
}

fn chosen(a: &mut Args, cx: &BuildCx) -> Result<Option<AngleZero>> {
    let style = cx.world.particles.style;
    let word = a.expect("a style of angles")?;
    match lammps::plain("angle", &word.text) {
        "none" => Ok(None),
        "zero" if !style.angled => {
            let text = format!("particles of atom_style {} have no angles", style.name());
            let d = Diagnostic::error(Code::CONFLICT, a.name_span(), text);
            Err(d.help("`atom_style angle`, alone or in a hybrid, has them").into())
        }
        "zero" => Ok(Some(AngleZero { any: a.eat(NOCOEFF), ..AngleZero::default() })),
        _ => Err(lammps::unknown("angle", "angle_style", word, &["zero", "none"])),
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
        let (Coeff { types: Types(first, last) }, angle) = if any {
            let coeff = inner(a, cx)?;
            a.rest();
            (coeff, 0.0)
        } else {
            let CoeffLine { coeff, theta } = read(a, cx)?;
            (coeff, theta.unwrap_or(0.0))
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
