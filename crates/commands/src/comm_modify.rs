//! `comm_modify`: what LAMMPS' processes send each other; one process here.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::{Args, Word};
use perigrain_styles::common::setting;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};
use perigrain_world::GroupId;

/// The command.
pub struct CommModify;

impl Style for CommModify {
    fn name(&self) -> &'static str {
        "comm_modify"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Accepted for the sake of LAMMPS decks: every process has the whole box.",
            text: "All velocities are at hand, whatever `vel` says, and all particles, whatever their cutoffs.",
            example: "comm_modify vel yes",
        }
    }
}

#[derive(Words)]
#[word(least = 1)]
struct Line {
    #[word(keyword, what = "vel")]
    vel: Option<bool>,
    #[word(keyword, name = "R", what = "the cutoff", non_negative)]
    cutoff: Option<f64>,
    #[word(keyword)]
    mode: Option<Mode>,
    #[word(keyword, name = "ID")]
    group: Option<GroupId>,
    #[word(keyword = "cutoff/multi", name = "TYPE R", what = "the cutoff")]
    multi: Vec<(Word, f64)>,
    #[word(keyword = "cutoff/multi/old", name = "TYPE R", what = "the cutoff")]
    multi_old: Vec<(Word, f64)>,
    #[word(flag = "reduce/multi")]
    reduce: bool,
}

/// How LAMMPS' processes exchange particles.
#[derive(Words)]
#[word(what = "mode")]
enum Mode {
    Single,
    Multi,
    #[word("multi/old")]
    MultiOld,
}

impl CommandStyle for CommModify {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        let _: Line = read(a, cx)?;
        let text = "comm_modify has no effect here: every process has the whole box";
        cx.note(Diagnostic::note(Code::NO_EFFECT, a.name_span(), text));
        Ok(setting(|_| Ok(())))
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{refused, scene};

    #[test]
    fn is_validated() {
        scene(
            "comm_modify vel yes cutoff 0.5 mode multi group all cutoff/multi 1*2 0.3\nnewton on off\nprocessors * 1 1 map xyz grid numa numa_nodes 0\ndimension 3",
        );
        let empty = Default::default();
        assert_eq!(refused(&empty, "comm_modify velo yes").0, "velo");
        assert_eq!(refused(&empty, "comm_modify mode many").0, "many");
        assert_eq!(refused(&empty, "comm_modify group some").0, "some");
        assert_eq!(refused(&empty, "newton maybe").0, "maybe");
        assert_eq!(refused(&empty, "processors 2 0 1").0, "0");
        assert_eq!(refused(&empty, "processors * * * map zz").0, "zz");
        assert_eq!(refused(&empty, "processors * * * part 1 2 multiple").0, "part");
        assert_eq!(refused(&empty, "dimension 4").0, "4");
    }
}
