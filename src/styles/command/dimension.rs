//! `dimension`: three.

use super::common::{before_box, setting};
use super::{Act, CommandStyle};
use crate::diag::{Code, Result, fail};
use crate::lang::Args;
use crate::styles::{BuildCx, Doc, Style};

/// The command.
pub struct Dimension;

impl Style for Dimension {
    fn name(&self) -> &'static str {
        "dimension"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "dimension 3",
            summary: "Says that the scene has three dimensions.",
            text: "LAMMPS also knows two-dimensional scenes; perigrain refuses `dimension 2` for now.",
            example: "dimension 3",
        }
    }
}

impl CommandStyle for Dimension {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        before_box(cx, "dimension")?;
        let span = a.here();
        match a.integer("the dimension")? {
            3 => Ok(setting(|_| Ok(()))),
            2 => fail(Code::NOT_SUPPORTED, span, "two-dimensional scenes are not in perigrain yet"),
            n => fail(Code::BAD_VALUE, span, format!("the dimension is 3, not {n}")),
        }
    }
}
