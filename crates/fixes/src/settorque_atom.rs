//! fix settorque/atom: sets torques to given values.

use super::components::Components;
use super::{Facts, Fix, FixStyle, Minimizing, RegionId, needs_torques};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::matter::{change_torques, publish_levels};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Nullable, PerAtom, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::World;
use perigrain_world::field::{MASK, REGIONS, SLOTS, TORQUE, X};

/// The style.
pub struct SetTorqueAtom;

impl Style for SetTorqueAtom {
    fn name(&self) -> &'static str {
        "settorque/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Replaces components of the torque on each sphere of the group.",
            text: "Only torques computed before count: those of pair styles and of fixes declared earlier. `0 0 0` for \
                   spheres that do not spin keeps them from spinning (`fix freeze` holds places as well). Acts in the \
                   setup of a run too. Vector of 3 (extensive): the total torque before the change.",
            example: "fix still ball settorque/atom 0.0 NULL 0.0",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The torque of a sphere [torque]: numbers, or `v_name` of equal- or atom-style variables, evaluated each step; a component
    /// that is `NULL` stays.
    #[word(name = "tx ty tz", what = "{}")]
    components: [Nullable<PerAtom>; 3],
    /// Only spheres inside it at that moment.
    #[word(keyword, name = "ID")]
    region: Option<RegionId>,
}

impl FixStyle for SetTorqueAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        needs_torques(self.name(), cx)?;
        let line: Line = read(args, cx)?;
        let components = Components::new(line.components, line.region, cx.group);
        Ok(Box::new(Declared { id: cx.id.to_string(), components }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    components: Components,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (chosen, torque) = self.components.seal(cx)?;
        let (level, slot) = (cx.level(), cx.slot(&format!("f_{}", self.id)));
        let access = Needs::new().read(X | MASK | REGIONS).write(TORQUE | SLOTS);
        let name = format!("fix {} settorque/atom", self.id);
        let op = StepOp::new(name, Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            // With several time step levels, the value belongs to one of them.
            let here = level.acts(&t.phase);
            let before = change_torques(w, &chosen, |w, i, own| {
                let before = *own;
                for (own, reading) in own.iter_mut().zip(&torque) {
                    if let Some(reading) = reading {
                        *own = if here { reading.atom(w, i) } else { 0.0 };
                    }
                }
                before
            });
            publish_levels(w, slot, t, &before);
            Ok(())
        });
        Ok(vec![op.in_every_level().boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { vector: 3, vector_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, has_level: true, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn components_are_replaced_and_the_total_is_kept() {
        let mut b =
            Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3], [5.0, 0.0, 0.0]]);
        b.world.particles.torque = vec![[1.0, 2.0, 3.0], [10.0, 20.0, 30.0]].into();
        b.atom.insert("a".into(), vec![-1.0, -2.0]);
        b.equal.insert("e".into(), 7.0);
        let fix = b.fix(&SetTorqueAtom, "NULL v_e v_a").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.torque, [[1.0, 7.0, -1.0], [10.0, 7.0, -2.0]]);
        assert_eq!(b.slot_of("f_f").vector, [11.0, 22.0, 33.0]);
        for words in ["0 0", "0 0 v_no", "0 0 0 every 2"] {
            assert!(b.fix(&SetTorqueAtom, words).is_err(), "{words}");
        }
        b.world.particles.style.sphere = false;
        assert!(b.fix(&SetTorqueAtom, "0 0 0").is_err());
    }
}
