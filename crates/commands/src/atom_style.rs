//! `atom_style`: which columns particles have.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::{before_box, setting};
use perigrain_styles::words::{Alternative, Kind, Part, Syntax, Value, Words, alternatives, read};
use perigrain_styles::{BuildCx, Doc, Style, lammps};
use perigrain_world::AtomStyle;

/// The command.
pub struct AtomStyleCommand;

/// The styles of which a `hybrid` has several.
const SINGLE: [Alternative; 10] = [
    style("atomic", "Mass by type; the default."),
    Alternative {
        parts: &[Part::Maybe(&[Part::bare("flag", Kind::Choice(&alternatives(&FLAGS)))])],
        ..style(
            "sphere",
            "Radius, spin, own mass (LAMMPS: density times 4/3 π r³); the flag 0 or 1 that LAMMPS needs for radii that change \
             (`fix adapt`) is read and not needed.",
        )
    },
    style("peri", "Volume, position at creation, own mass (in LAMMPS' convention its density)."),
    style("bond", "Bonds, molecule IDs, mass by type."),
    style(
        "angle",
        "What `bond` has, and angles between bonds, which are kept and exert nothing (`angle_style zero`).",
    ),
    style("molecular", "As `angle`."),
    style("full", "What `molecular` and `charge` have."),
    style("charge", "A charge, which `fix efield` pulls; charges exert no forces on each other."),
    style(
        "dipole",
        "A charge and a dipole moment, which `fix efield` turns and `fix nve/sphere … update dipole` lets follow the spin \
         (`hybrid sphere dipole`).",
    ),
    style("bpm/sphere", "Bonds, molecule IDs, and what `sphere` has."),
];

/// LAMMPS' flag for radii that change during a run, which they always may here.
const FLAGS: [(&str, ()); 2] = [("0", ()), ("1", ())];

/// All styles.
const ALL: [Alternative; SINGLE.len() + 1] = {
    let hybrid = Alternative {
        parts: &[Part::Many(&[Part::bare("STYLE", Kind::Choice(&SINGLE))], 1)],
        ..style("hybrid", "What each of the styles behind it has; the mass is one column.")
    };
    let mut all = [hybrid; SINGLE.len() + 1];
    let mut k = 0;
    while k < SINGLE.len() {
        all[k] = SINGLE[k];
        k += 1;
    }
    all
};

const fn style(word: &'static str, about: &'static str) -> Alternative {
    Alternative { word, about, parts: &[] }
}

/// The names of the styles.
pub const ATOM_STYLES: [&str; ALL.len()] = {
    let mut names = [""; ALL.len()];
    let mut k = 0;
    while k < names.len() {
        names[k] = ALL[k].word;
        k += 1;
    }
    names
};

/// The words of the line.
#[derive(Words)]
struct Line {
    #[word(name = "style")]
    style: Chosen,
}

/// What the words choose.
struct Chosen(AtomStyle);

impl Value for Chosen {
    const KIND: Kind = Kind::Choice(&ALL);
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        chosen(args).map(Self)
    }
}

impl Style for AtomStyleCommand {
    fn name(&self) -> &'static str {
        "atom_style"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Chooses which properties particles have.",
            text: "It must come before the box. `hybrid sphere peri`, `hybrid sphere bond` … have what each of their styles has.",
            example: "atom_style hybrid sphere peri",
        }
    }
}

impl CommandStyle for AtomStyleCommand {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        before_box(cx, "atom_style")?;
        let Chosen(style) = read::<Line>(a, cx)?.style;
        Ok(setting(move |cx| {
            cx.world.particles.style = style;
            Ok(())
        }))
    }
}

fn chosen(a: &mut Args) -> Result<AtomStyle> {
    let mut style = AtomStyle { chosen: true, ..AtomStyle::default() };
    let first = a.expect("a style")?;
    let mut named = vec![];
    if first.text != "hybrid" {
        add(&mut style, first, &mut named)?;
        if first.text == "sphere" {
            radius_flag(a)?;
        }
        return Ok(style);
    }
    style.hybrid = true;
    add(&mut style, a.expect("a style")?, &mut named)?;
    while let Some(word) = a.next() {
        if style.sphere && is_flag(word) {
            continue;
        }
        add(&mut style, word, &mut named)?;
    }
    Ok(style)
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

/// The flag of `atom_style sphere`.
fn radius_flag(a: &mut Args) -> Result<()> {
    match a.next() {
        Some(word) if !is_flag(word) => {
            fail(Code::EXTRA_ARGUMENT, word.span, "atom_style sphere takes at most the flag 0 or 1")
        }
        _ => Ok(()),
    }
}

fn is_flag(word: &Word) -> bool {
    FLAGS.iter().any(|(flag, ())| *flag == word.text)
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
