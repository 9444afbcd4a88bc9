//! fix addtorque/atom: a torque added to each sphere.

use super::{Facts, Fix, FixStyle, Minimizing, RegionId, needs_torques};
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::matter::{Chosen, change_torques, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{PerAtom, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{MASK, REGIONS, SLOTS, TORQUE, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct AddTorqueAtom;

impl Style for AddTorqueAtom {
    fn name(&self) -> &'static str {
        "addtorque/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Adds a torque to each sphere of the group.",
            text: "Acts in the setup of a run too. Vector of 3 (extensive): the total torque before the change. `fix \
                   addtorque` turns a group as one body instead.",
            example: "fix spin ball addtorque/atom 0.0 0.0 1.0e-9",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The torque on a sphere [torque]: numbers, or `v_name` of equal- or atom-style variables, evaluated each step.
    #[word(name = "tx ty tz", what = "{}")]
    torque: [PerAtom; 3],
    /// Only at multiples of N.
    #[word(keyword, name = "N", what = "the number of steps between two pushes", from = 1, default = 1)]
    every: i64,
    /// Only spheres inside it at that moment.
    #[word(keyword, name = "ID")]
    region: Option<RegionId>,
}

impl FixStyle for AddTorqueAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        needs_torques(self.name(), cx)?;
        let Line { torque, every, region } = read(args, cx)?;
        let (torque, region) = (torque.map(|p| p.0), region.map(|r| r.0));
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, torque, every, region }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    torque: [Param; 3],
    every: i64,
    region: Option<String>,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let chosen = Chosen::new(cx.world(), self.group, self.region.as_deref(), span)?;
        let when = if self.every == 1 { When::Always } else { When::Every(self.every) };
        let [x, y, z] = &self.torque;
        let mut read = |p: &Param| cx.param(p, Stage::PostForce, &when);
        let torque = [read(x)?, read(y)?, read(z)?];
        let slot = cx.slot(&format!("f_{}", self.id));
        let access = Needs::new().read(X | MASK | REGIONS).write(TORQUE | SLOTS);
        let name = format!("fix {} addtorque/atom", self.id);
        let op = StepOp::new(name, Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let before = change_torques(w, &chosen, |w, i, own| {
                let before = *own;
                own.iter_mut().zip(&torque).for_each(|(own, added)| *own += added.atom(w, i));
                before
            });
            publish(w, slot, t, 0.0, &before);
            Ok(())
        });
        Ok(vec![op.when(when).boxed()])
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
    fn torques_grow_and_the_total_before_is_kept() {
        let mut b =
            Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3], [5.0, 0.0, 0.0]]);
        b.world.particles.torque = vec![[1.0, 2.0, 3.0], [10.0, 20.0, 30.0]].into();
        b.atom.insert("a".into(), vec![-1.0, -2.0]);
        b.equal.insert("e".into(), 7.0);
        let fix = b.fix(&AddTorqueAtom, "1 v_e v_a every 1").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.torque, [[2.0, 9.0, 2.0], [11.0, 27.0, 28.0]]);
        assert_eq!(b.slot_of("f_f").vector, [11.0, 22.0, 33.0]);
        for words in ["0 0", "NULL 0 0", "0 0 0 every 0", "0 0 0 evry 2"] {
            assert!(b.fix(&AddTorqueAtom, words).is_err(), "{words}");
        }
    }
}
