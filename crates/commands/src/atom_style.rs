//! `atom_style`: which columns particles have.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{before_box, setting};
use perigrain_styles::words::Syntax;
use perigrain_styles::{BuildCx, Doc, Style, lammps};
use perigrain_world::AtomStyle;

/// The command.
pub struct AtomStyleCommand;

/// The styles.
pub const ATOM_STYLES: [&str; 11] = [
    "atomic",
    "sphere",
    "peri",
    "bond",
    "angle",
    "molecular",
    "full",
    "charge",
    "dipole",
    "bpm/sphere",
    "hybrid",
];

impl Style for AtomStyleCommand {
    fn name(&self) -> &'static str {
        "atom_style"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Written(
                "atom_style atomic | sphere [0|1] | peri | bond | angle | molecular | full | charge | dipole | bpm/sphere | hybrid STYLE STYLE …",
            ),
            summary: "Says which properties particles have.",
            text: "Must come before the box. Default: `atomic`.\n\n\
                   - `atomic`: mass by type.\n\
                   - `sphere`: radius, spin, own mass (LAMMPS: density times 4/3 π r³); the flag that LAMMPS needs for radii that \
                   change (`fix adapt`) is read and not needed.\n\
                   - `peri`: volume, position at creation, own mass (in LAMMPS' convention its density).\n\
                   - `bond`: bonds, molecule IDs, mass by type.\n\
                   - `angle` and `molecular`: what `bond` has, and angles between bonds, which are kept and exert nothing \
                   (`angle_style zero`).\n\
                   - `charge`: a charge, which `fix efield` pulls; charges do not feel each other here.\n\
                   - `full`: what `molecular` and `charge` have.\n\
                   - `dipole`: a charge and a dipole moment, which `fix efield` turns and `fix nve/sphere … update dipole` lets \
                   follow the spin (`hybrid sphere dipole`).\n\
                   - `bpm/sphere`: bonds, molecule IDs, and what `sphere` has.\n\
                   - `hybrid sphere peri`, `hybrid sphere bond` …: what each of them has; the mass is one column.",
            example: "atom_style hybrid sphere peri",
        }
    }
}

impl CommandStyle for AtomStyleCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        before_box(cx, "atom_style")?;
        let mut style = AtomStyle { chosen: true, ..AtomStyle::default() };
        let first = a.expect("a style")?;
        let mut named = vec![];
        if first.text != "hybrid" {
            add(&mut style, first, &mut named)?;
            if first.text == "sphere" {
                radius_flag(a)?;
            }
            return Ok(choose(style));
        }
        style.hybrid = true;
        add(&mut style, a.expect("a style")?, &mut named)?;
        while let Some(word) = a.next() {
            if style.sphere && matches!(word.text.as_str(), "0" | "1") {
                check_radius_flag(word)?;
                continue;
            }
            add(&mut style, word, &mut named)?;
        }
        Ok(choose(style))
    }
}

fn choose(style: AtomStyle) -> Box<dyn Act> {
    setting(move |cx| {
        cx.world.particles.style = style;
        Ok(())
    })
}

fn add(style: &mut AtomStyle, word: &Word, before: &mut Vec<String>) -> Result<()> {
    if before.contains(&word.text) {
        return fail(Code::BAD_VALUE, word.span, format!("atom_style `{}` is named twice", word.text));
    }
    before.push(word.text.clone());
    match lammps::plain("atom", &word.text) {
        name if style.add(name) => Ok(()),
        _ => Err(lammps::unknown("atom", "atom_style", word, &ATOM_STYLES)),
    }
}

/// `atom_style sphere 0|1`: LAMMPS' flag for radii that change during a run, which they always may here.
fn radius_flag(a: &mut Args) -> Result<()> {
    match a.next() {
        Some(word) => check_radius_flag(word),
        None => Ok(()),
    }
}

fn check_radius_flag(word: &Word) -> Result<()> {
    match word.text.as_str() {
        "0" | "1" => Ok(()),
        _ => fail(Code::EXTRA_ARGUMENT, word.span, "atom_style sphere takes at most the flag 0 or 1"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refused, scene};

    #[test]
    fn hybrid_has_both() {
        let s = scene("atom_style hybrid sphere peri").particles.style;
        assert!(s.sphere && s.peri && s.chosen);
        // Oracle: particles of `hybrid sphere peri` start with mass 1, of `hybrid peri sphere` with π/6.
        assert!(!s.sphere_mass && scene("atom_style hybrid peri sphere").particles.style.sphere_mass);
        assert!(!scene("atom_style sphere 0").particles.style.peri);
    }

    #[test]
    fn refuses_by_name() {
        let empty = Default::default();
        assert!(refused(&empty, "atom_style body nparticle 2 6").1.contains("not in perigrain"));
        assert_eq!(refused(&empty, "atom_style hybrid peri peri").0, "peri");
        assert_eq!(refused(&empty, "atom_style spere").0, "spere");
    }
}
