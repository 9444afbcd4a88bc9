//! fix nve/noforce: motion at constant velocity, without regard to forces.

use super::{Facts, Fix, FixStyle, Moves};
use perigrain_base::diag::Result;
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::field::{MASK, V, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct NveNoForce;

impl Style for NveNoForce {
    fn name(&self) -> &'static str {
        "nve/noforce"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Moves the particles of the group with their present velocity; forces do not change it.",
            text: "x ← x + Δt v. For walls of particles that are moved along, with a velocity given by `velocity … set`.",
            example: "fix drive foot nve/noforce",
        }
    }
}

impl FixStyle for NveNoForce {
    fn build(&self, _args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
}

impl Fix for Declared {
    fn ops(&self, _cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (bit, access) = (self.group.bit(), Needs::new().read(V | MASK).write(X));
        let name = format!("fix {} nve/noforce", self.id);
        let op = StepOp::new(name, Stage::InitialIntegrate, access, move |w, t| {
            let p = &mut w.particles;
            par::each((&mut p.x[..], &p.v[..], &p.mask[..]), |_, (x, v, mask)| {
                for ((x, v), _) in x.iter_mut().zip(v).zip(mask).filter(|(_, m)| **m & bit != 0) {
                    (0..3).for_each(|d| x[d] += t.dt * v[d]);
                }
            });
            Ok(())
        });
        Ok(vec![op.innermost().boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { moves: Moves::Prescribed, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn only_places_change() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        b.world.clock.dt = 0.5;
        (b.world.particles.v[0], b.world.particles.f[0]) = ([1.0, 2.0, 3.0], [9.0; 3]);
        let fix = b.fix(&NveNoForce, "").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::InitialIntegrate).unwrap();
        assert_eq!((b.world.particles.x[0], b.world.particles.v[0]), ([0.5, 1.0, 1.5], [1.0, 2.0, 3.0]));
    }
}
