//! fix heat/convect: heat that a fluid takes or gives.

use super::boundary::{Declared, Does};
use crate::{Fix, FixStyle};
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Param};
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct Convect;

impl Style for Convect {
    fn name(&self) -> &'static str {
        "heat/convect"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Cools or heats particles of a solid by the fluid around it.",
            text: "Acts together with `fix heat/peri`, when that acts. Each of the N particles of the group gets H (TINF − T) A/N: the \
                   group is the layer below the surface, A the area of that surface.\n\n\
                   Scalar (extensive): the heat that the fluid has given since the fix was declared, negative where it took some.",
            example: "group base intersect plate foot\nfix prop all property/atom temperature heatflow\nfix warm plate heat/peri\n\
                      fix air base heat/convect 25.0 293.0 area 4.0e-6",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The heat transfer coefficient [energy/(time area temperature)].
    #[word(name = "H", what = "the heat transfer coefficient", non_negative)]
    film: f64,
    /// The temperature of the fluid: a number, or `v_name` of an equal-style variable.
    #[word(name = "TINF", what = "the temperature of the fluid")]
    fluid: Param,
    /// The area that the particles of the group share evenly [area].
    #[word(keyword, name = "A", what = "area", positive, shown = "required")]
    area: Option<f64>,
}

impl FixStyle for Convect {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { film, fluid: value, area } = read(args, cx)?;
        let area = super::boundary::area(area, args)?;
        let (id, group) = (cx.id.to_string(), cx.group);
        Ok(Box::new(Declared { style: "heat/convect", id, group, does: Does::Cools { film, area }, value }))
    }
}
