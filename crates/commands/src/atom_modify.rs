//! `atom_modify`: how LAMMPS finds and orders particles; accepted, without effect on numbers.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::common::{bad_keyword, before_box, not_here, setting};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct AtomModify;

impl Style for AtomModify {
    fn name(&self) -> &'static str {
        "atom_modify"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "atom_modify [map yes|array|hash] [sort N size] [id yes]",
            summary: "Accepted for the sake of LAMMPS decks: perigrain finds and orders particles by itself.",
            text: "`map` and `id` must come before the box. `first` and `id no` are refused.",
            example: "atom_modify map array sort 0 0.0",
        }
    }
}

impl CommandStyle for AtomModify {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        a.peek().map_or_else(|| a.clone().expect("a keyword").map(|_| ()), |_| Ok(()))?;
        while let Some(word) = a.next() {
            match word.text.as_str() {
                "map" => {
                    before_box(cx, "atom_modify map")?;
                    a.choice("kind of map", &["yes", "array", "hash"])?;
                }
                "sort" => {
                    a.integer_from(0, "the sorting interval")?;
                    a.non_negative("the bin size")?;
                }
                "id" => {
                    before_box(cx, "atom_modify id")?;
                    let value = a.peek().cloned();
                    if let (false, Some(w)) = (a.flag("id")?, value) {
                        return Err(not_here(&w, "particles without ids: atom_modify id"));
                    }
                }
                _ => return Err(bad_keyword(a, word, &["map", "sort", "id"], &["first"])),
            }
        }
        let text = "atom_modify has no effect here: particles are found and ordered without it";
        cx.note(Diagnostic::note(Code::NO_EFFECT, a.name_span(), text));
        Ok(setting(|_| Ok(())))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refused, scene};

    #[test]
    fn is_validated() {
        scene("atom_modify map array sort 1000 0.1 id yes");
        let empty = Default::default();
        assert_eq!(refused(&empty, "atom_modify map tree").0, "tree");
        assert_eq!(refused(&empty, "atom_modify first slow").0, "first");
        assert_eq!(refused(&empty, "atom_modify id no").0, "no");
    }
}
