//! fix planeforce: removes the force component normal to a plane.

use super::lineforce::{Held, Line};
use super::{Fix, FixStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct PlaneForce;

impl Style for PlaneForce {
    fn name(&self) -> &'static str {
        "planeforce"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Takes the part of each force along the direction (x, y, z) away.",
            text: "f ← f − (f·n) n with n = (x, y, z) of length 1, the normal of the plane. A particle that starts at \
                   rest, or with a velocity in the plane, stays in its plane. Forces of fixes declared later are not \
                   seen. Acts in the setup of a run too.",
            example: "fix flat foot planeforce 0.0 0.0 1.0",
        }
    }
}

impl FixStyle for PlaneForce {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { along } = read(args, cx)?;
        Ok(Box::new(Held { id: cx.id.to_string(), group: cx.group, name: self.name(), along, plane: true }))
    }
}
