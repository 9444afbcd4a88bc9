//! `atom_modify`: how LAMMPS finds and orders particles; accepted, without effect on numbers.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{before_box, setting};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct AtomModify;

impl Style for AtomModify {
    fn name(&self) -> &'static str {
        "atom_modify"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Accepted for the sake of LAMMPS decks: perigrain finds and orders particles by itself.",
            text: "`map` and `id` must come before the box.",
            example: "atom_modify map array sort 0 0.0",
        }
    }
}

#[derive(Words)]
#[word(least = 1, refused = "first")]
struct Line {
    /// How particles are found by their ids.
    #[word(keyword)]
    map: Option<Map>,
    /// How often particles are sorted, and the size of bins.
    #[word(keyword)]
    sort: Option<Sorting>,
    /// Whether particles have ids; `no` is refused.
    #[word(keyword, what = "id")]
    id: Option<At<bool>>,
}

/// How LAMMPS finds particles by their ids.
#[derive(Words)]
#[word(what = "kind of map")]
enum Map {
    Yes,
    Array,
    Hash,
}

/// How LAMMPS sorts particles.
#[derive(Words)]
struct Sorting {
    /// The sorting interval [steps].
    #[word(name = "N", from = 0)]
    _interval: i64,
    /// The bin size [length].
    #[word(name = "size", non_negative)]
    _size: f64,
}

impl CommandStyle for AtomModify {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let line: Line = read(a, cx)?;
        if line.map.is_some() {
            before_box(cx, "atom_modify map")?;
        }
        if let Some(id) = line.id {
            before_box(cx, "atom_modify id")?;
            if !id.value {
                let text = "particles without ids: atom_modify id `no` is not in perigrain yet";
                return fail(Code::NOT_SUPPORTED, id.span, text);
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
