//! fix store/force: stores the forces as they are at this point of the fix list.

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{F, MASK, SLOTS};
use perigrain_world::{GroupId, World};

/// The style.
pub struct StoreForce;

impl Style for StoreForce {
    fn name(&self) -> &'static str {
        "store/force"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Keeps the force on each particle before later fixes change it.",
            text: "Per-atom array, 3 columns: the force at this place in the order of fixes, those of pair styles and of \
                   fixes declared before; 0 outside the group. Useful before `setforce`. Acts in the setup of a run too.",
            example: "fix felt foot store/force\nfix clamp foot setforce 0.0 0.0 0.0",
        }
    }
}

impl FixStyle for StoreForce {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        args.finish()?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        let (id, n) = (w.slots.id(&format!("f_{}", self.id)), w.n());
        let out = w.slots.get_mut(id);
        // A restart file contains the forces stored by the last step.
        if out.atom.len() != 3 * n {
            (out.cols, out.atom) = (3, vec![0.0; 3 * n]);
        }
        Ok(())
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (slot, bit) = (cx.slot(&format!("f_{}", self.id)), self.group.bit());
        let name = format!("fix {} store/force", self.id);
        let op =
            StepOp::new(name, Stage::PostForce, Needs::new().read(F | MASK).write(SLOTS), move |w, t| {
                if t.unchanged {
                    return Ok(());
                }
                let (forces, mask) = (&w.particles.f, &w.particles.mask);
                let out = w.slots.get_mut(slot);
                (out.step, out.cols) = (Some(t.step), 3);
                // With several time step levels, the longer ones are added.
                if t.phase.level == 0 {
                    out.atom.clear();
                }
                out.atom.resize(3 * forces.len(), 0.0);
                let kept = forces.iter().zip(mask).map(|(f, m)| if m & bit != 0 { *f } else { [0.0; 3] });
                out.atom.iter_mut().zip(kept.flatten()).for_each(|(sum, f)| *sum += f);
                Ok(())
            });
        Ok(vec![op.in_every_level().boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { atom: Some(3), ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, at_rest: AtRest::Acts, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn forces_of_the_group() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        b.world.particles.f = vec![[1.0, 2.0, 3.0]; 2].into();
        b.world.particles.mask[0] = 0;
        let fix = b.fix(&StoreForce, "").unwrap();
        fix.declare(&mut b.world).unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.slot_of("f_f").atom, [0.0, 0.0, 0.0, 1.0, 2.0, 3.0]);
        assert!(b.fix(&StoreForce, "1").is_err());
    }
}
