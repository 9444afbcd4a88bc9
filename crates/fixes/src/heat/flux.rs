//! fix heat/flux: heat that comes through a surface.

use super::boundary::{Declared, Does};
use crate::{Fix, FixStyle};
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Param};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct Flux;

impl Style for Flux {
    fn name(&self) -> &'static str {
        "heat/flux"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Heats particles of a solid by a power per area.",
            text: "Acts together with `fix heat/peri`, when that acts. Each particle of the group gets Q A divided by the number of its \
                   particles: the group is the layer below the surface, A the area of that surface.\n\n\
                   Scalar (extensive): the heat that has come since the fix was declared.",
            example: "group base intersect plate foot\nfix prop all property/atom temperature heatflow\nfix warm plate heat/peri\n\
                      fix sun base heat/flux 1.0e3 area 4.0e-6",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The heat that comes in [energy/(time area)]: a number, or `v_name` of an equal-style variable; negative where heat leaves.
    #[word(name = "Q", what = "the heat flux")]
    flux: Param,
    /// The area that the particles of the group share evenly [area].
    #[word(keyword, name = "A", what = "area", positive, shown = "required")]
    area: Option<f64>,
}

impl FixStyle for Flux {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { flux: value, area } = read(args, cx)?;
        let area = super::boundary::area(area, args)?;
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Declared { style: "heat/flux", id, group, does: Does::Heats { area }, value }))
    }
}
