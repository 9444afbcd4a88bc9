//! `dimension`: three or two.

use super::{Act, CommandStyle};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{before_box, setting};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The command.
pub struct Dimension;

impl Style for Dimension {
    fn name(&self) -> &'static str {
        "dimension"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Says whether the scene has three dimensions or lies in the plane z = 0.",
            text: "In two dimensions the z faces are periodic, the box holds z = 0, lattices are flat, temperatures and \
                   pressures count two directions, and particles do not see images along z. Nothing keeps particles in the \
                   plane but what acts on them: `fix enforce2d` takes velocities and forces along z away.",
            example: "dimension 3",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(name = "2|3", what = "the dimension")]
    number: At<i64>,
}

impl CommandStyle for Dimension {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        before_box(cx, "dimension")?;
        let Line { number: At { value, span, .. } } = read(a, cx)?;
        match value {
            n @ (2 | 3) => Ok(setting(move |cx| {
                cx.world.settings.two_dimensional = n == 2;
                Ok(())
            })),
            n => fail(Code::BAD_VALUE, span, format!("the dimension is 2 or 3, not {n}")),
        }
    }
}
