//! fix lineforce: keeps only the force component along a line.

use super::{Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, dot};
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
pub use perigrain_walls::shared::direction;
use perigrain_world::field::{F, MASK};
use perigrain_world::{GroupId, World};

/// The style.
pub struct LineForce;

impl Style for LineForce {
    fn name(&self) -> &'static str {
        "lineforce"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Leaves of each force only the part along the direction (x, y, z).",
            text: "f ← (f·n) n with n = (x, y, z) of length 1. A particle that starts at rest, or with a velocity along \
                   the line, stays on its line. Forces of fixes declared later are not seen. Acts in the setup of a run \
                   too.",
            example: "fix rail foot lineforce 0.0 1.0 1.0",
        }
    }
}

/// The words of fix lineforce and fix planeforce.
#[derive(Words)]
pub struct Line {
    /// The direction, of any length but 0.
    #[word(name = "x y z", what = "{}", with = direction, kind = Kind::Number)]
    pub along: [f64; 3],
}

impl FixStyle for LineForce {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { along } = read(args, cx)?;
        Ok(Box::new(Held { id: cx.id.to_string(), group: cx.group, name: self.name(), along, plane: false }))
    }
}

/// A declared fix lineforce or planeforce.
#[derive(Clone)]
pub struct Held {
    /// The fix's ID.
    pub id: String,
    /// Group of particles it acts on.
    pub group: GroupId,
    /// The style's name.
    pub name: &'static str,
    /// The direction, of length 1.
    pub along: Vec3,
    /// Removes the component along the direction instead of keeping it.
    pub plane: bool,
}

impl Fix for Held {
    fn ops(&self, _cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (bit, n, plane) = (self.group.bit(), self.along, self.plane);
        let name = format!("fix {} {}", self.id, self.name);
        let op = StepOp::new(name, Stage::PostForce, Needs::new().read(MASK).write(F), move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let p = &mut w.particles;
            par::each((&mut p.f[..], &p.mask[..]), |_, (f, mask)| {
                for (f, _) in f.iter_mut().zip(mask).filter(|(_, m)| **m & bit != 0) {
                    let part = dot(*f, n);
                    *f = std::array::from_fn(|d| if plane { f[d] - part * n[d] } else { part * n[d] });
                }
            });
            Ok(())
        });
        Ok(vec![op.one_by_one().in_every_level().boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::planeforce::PlaneForce;
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn along_a_line_and_in_a_plane() {
        for (style, held) in [
            (&LineForce as &dyn FixStyle, [[0.0, 0.0, 4.0], [1.0, 2.0, 3.0]]),
            (&PlaneForce, [[1.0, 2.0, 0.0], [1.0, 2.0, 3.0]]),
        ] {
            let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
            b.world.particles.f = vec![[1.0, 2.0, 4.0], [1.0, 2.0, 3.0]].into();
            b.world.particles.mask[1] = 0;
            let fix = b.fix(style, "0 0 -2").unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            b.stage(&mut ops, Stage::PostForce).unwrap();
            assert_eq!(b.world.particles.f, held);
            for words in ["", "1 2", "0 0 0", "1 2 z", "1 2 3 4"] {
                let whole = b.fix(style, words);
                assert!(whole.is_err() || words == "1 2 3 4", "{words}");
            }
        }
    }
}
