//! fix freeze: holds grains in place.

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::Args;
use perigrain_pairs::FROZEN;
use perigrain_plan::{BlockSums, Needs, Op, ParticleBlock, Room, Stage, Tick};
use perigrain_styles::matter::publish_levels;
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{F, MASK, SLOTS, TORQUE};
use perigrain_world::{GroupId, World};

/// The style.
pub struct Freeze;

impl Style for Freeze {
    fn name(&self) -> &'static str {
        "freeze"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Takes all force and torque from the group's spheres.",
            text: "What acts on these spheres is set to zero, so that they keep their velocity under any integrator; \
                   granular contacts with others take them for infinitely heavy. Only what was computed before counts: \
                   forces of pair styles and of fixes declared earlier. Acts in the setup of a run too. \
                   Several at a time hold a group each (LAMMPS has one). Vector of 3 (extensive): the total force on its own group before the change.",
            example: "fix still ball freeze",
        }
    }
}

impl FixStyle for Freeze {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        args.finish()?;
        if !cx.world.particles.style.sphere {
            return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, "fix freeze needs spheres")
                .help("put `atom_style sphere` at the top of the deck, or use `fix setforce 0 0 0`")
                .into());
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group }))
    }
}

/// Sets forces and torques (if any) of particles with the bit to zero, and sums the forces [force].
#[inline(always)]
pub(super) fn hold(f: &mut [Vec3], torque: &mut [Vec3], mask: &[u32], bit: u32, taken: &mut [f64; 3]) {
    // Frozen grains are contiguous in memory: most groups of eight have none.
    for (k, eight) in mask.chunks(8).enumerate() {
        if eight.iter().fold(0, |all, m| all | m) & bit == 0 {
            continue;
        }
        for i in (8 * k..).zip(eight).filter(|(_, m)| **m & bit != 0).map(|(i, _)| i) {
            (0..3).for_each(|d| taken[d] += f[i][d]);
            f[i] = [0.0; 3];
            torque.get_mut(i).into_iter().for_each(|torque| *torque = [0.0; 3]);
        }
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
}

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        w.facts.get_or_default(*FROZEN).push((self.id.clone(), self.group));
        Ok(())
    }

    fn remove(&self, w: &mut World) {
        if let Some(frozen) = w.facts.get_mut(*FROZEN) {
            frozen.retain(|(id, _)| *id != self.id);
        }
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (slot, bit) = (cx.slot(&format!("f_{}", self.id)), self.group.bit());
        let access = Needs::new().read(MASK).write(F | TORQUE | SLOTS);
        let hold = move |_: &World, t: &Tick, room: &mut Room| {
            let act = move |s: &mut ParticleBlock<'_>| {
                let mut sums = BlockSums::default();
                let mask = s.mask();
                hold(&mut s.f, &mut s.torque, mask, bit, &mut sums.sums);
                sums
            };
            if !t.unchanged {
                room.hold(bit, act);
            }
            !t.unchanged
        };
        let took = move |w: &mut World, t: &Tick, sums: BlockSums| publish_levels(w, slot, t, &sums.sums);
        let name = format!("fix {} freeze", self.id);
        let op = StepOp::new(name, Stage::PostForce, access, |_, _| Ok(())).fusing(hold, took);
        Ok(vec![op.in_every_level().boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Absent, at_rest: AtRest::Holds([true; 3]), ..Facts::default() }
    }

    fn shape(&self) -> Shape {
        Shape { vector: 3, vector_extensive: true, ..Shape::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn forces_and_torques_vanish_and_their_sum_is_published() {
        let style = AtomStyle { sphere: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &[[0.0; 3], [5.0; 3], [7.0; 3]]);
        b.world.particles.f = vec![[1.0, 2.0, 3.0], [10.0, 20.0, 30.0], [4.0; 3]].into();
        b.world.particles.torque = vec![[1.0; 3]; 3].into();
        b.world.particles.mask[2] = 0;
        let fix = b.fix(&Freeze, "").unwrap();
        fix.declare(&mut b.world).unwrap();
        assert_eq!(b.world.facts.get(*FROZEN).unwrap()[..], [("f".to_string(), GroupId::ALL)]);
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        let p = &b.world.particles;
        assert_eq!(p.f, [[0.0; 3], [0.0; 3], [4.0; 3]]);
        assert_eq!(p.torque, [[0.0; 3], [0.0; 3], [1.0; 3]]);
        assert_eq!(b.slot_of("f_f").vector, [11.0, 22.0, 33.0]);
        // Another one remains when this one is deleted.
        b.world.facts.get_or_default(*FROZEN).push(("other".into(), GroupId::ALL));
        fix.remove(&mut b.world);
        assert_eq!(b.world.facts.get(*FROZEN).unwrap()[..], [("other".to_string(), GroupId::ALL)]);
    }
}
