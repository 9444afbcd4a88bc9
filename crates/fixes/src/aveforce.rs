//! fix aveforce: every particle of a group feels the mean force of the group.

use super::components::Components;
use super::{Facts, Fix, FixStyle, Minimizing, RegionId};
use perigrain_base::diag::Result;
use perigrain_lang::{Args, Param};
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::matter::{change_forces, publish_levels};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Nullable, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::World;
use perigrain_world::field::{F, MASK, SLOTS, X};

/// The style.
pub struct AveForce;

impl Style for AveForce {
    fn name(&self) -> &'static str {
        "aveforce"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Gives all particles of the group the mean of their forces, plus a given force.",
            text: "f ← ⟨f⟩ + (fx, fy, fz): masses do not count. Forces of fixes declared later are not seen. Acts in \
                   the setup of a run too. Vector of 3 (extensive): the total force before the change.",
            example: "fix stiff foot aveforce NULL NULL 0.0",
        }
    }
}

#[derive(Words)]
struct Line {
    /// What is added to the mean [force]: numbers, or `v_name` of equal-style variables, evaluated each step; a component that is
    /// `NULL` stays.
    #[word(name = "fx fy fz", what = "{}")]
    components: [Nullable<Param>; 3],
    /// Only particles inside it at that moment.
    #[word(keyword, name = "ID")]
    region: Option<RegionId>,
}

impl FixStyle for AveForce {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
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
        let (chosen, force) = self.components.seal(cx)?;
        let level = cx.level();
        let slot = cx.slot(&format!("f_{}", self.id));
        let access = Needs::new().read(X | MASK).write(F | SLOTS);
        let op = StepOp::new(format!("fix {} aveforce", self.id), Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            // With several time step levels, the added force acts at one of them.
            let here = level.acts(&t.phase);
            let [count, before @ ..] = change_forces::<4>(w, &chosen, |_, _, f| [1.0, f[0], f[1], f[2]]);
            if count > 0.0 {
                let mean: [Option<f64>; 3] = std::array::from_fn(|d| {
                    force[d].map(|r| before[d] / count + if here { r.get(w) } else { 0.0 })
                });
                change_forces::<0>(w, &chosen, |_, _, f| {
                    (0..3).for_each(|d| f[d] = mean[d].unwrap_or(f[d]));
                    []
                });
            }
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
    fn the_mean_of_the_group() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 3]);
        b.world.particles.f = vec![[1.0, 2.0, 3.0], [3.0, 4.0, 5.0], [9.0; 3]].into();
        b.world.particles.mask[2] = 0;
        b.equal.insert("e".into(), 10.0);
        let fix = b.fix(&AveForce, "0 NULL v_e").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f, [[2.0, 2.0, 14.0], [2.0, 4.0, 14.0], [9.0; 3]]);
        assert_eq!(b.slot_of("f_f").vector, [4.0, 6.0, 8.0]);
        for words in ["0 0", "0 0 v_no", "0 0 0 region q", "0 0 0 foo"] {
            assert!(b.fix(&AveForce, words).is_err(), "{words}");
        }
    }
}
