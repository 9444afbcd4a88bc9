//! fix heat/held: particles of a given temperature.

use super::boundary::{Declared, Does};
use crate::{Fix, FixStyle};
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Param};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct HeldAt;

impl Style for HeldAt {
    fn name(&self) -> &'static str {
        "heat/held"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Gives particles of a solid a temperature, whatever heat that takes.",
            text: "Acts together with `fix heat/peri`, which conducts heat on to other particles, and when that acts. The \
                   temperature is V from the first step on. Bonds join the middles of particles: the temperature is given there, half a \
                   spacing below the surface.\n\n\
                   Scalar (extensive): the heat that the particles have been given since the fix was declared, negative where it was taken.",
            example: "group base intersect plate foot\nfix prop all property/atom temperature heatflow\nfix warm plate heat/peri\n\
                      variable rise equal 20.0+time\nfix hot base heat/held v_rise",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The temperature: a number, or `v_name` of an equal-style variable.
    #[word(name = "V", what = "the temperature")]
    temperature: Param,
}

impl FixStyle for HeldAt {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { temperature: value } = read(args, cx)?;
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Declared { style: "heat/held", id, group, does: Does::Holds, value }))
    }
}
