//! fix drag: a force of constant strength towards a point.

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::common::orthogonal;
use perigrain_styles::matter::{Chosen, change_forces, publish};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Nullable, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, F, MASK, SLOTS, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct Drag;

impl Style for Drag {
    fn name(&self) -> &'static str {
        "drag"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Pulls each particle of the group towards a point with a force of constant strength.",
            text: "Distances are those to the nearest periodic image. Acts in the setup of a run too. Vector of 3 \
                   (extensive): the total force that was added.",
            example: "fix home grains drag 0.0 0.0 NULL 1.0e-3 0.002",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The target [length]; a coordinate that is `NULL` does not count: with `NULL NULL z` the target is a plane.
    #[word(name = "x y z", what = "{}")]
    target: [Nullable<f64>; 3],
    /// The force fmag [force] towards the target; away from it where it is negative.
    #[word(name = "fmag", what = "the force fmag")]
    strength: f64,
    /// The distance delta [length]: nearer particles feel nothing.
    #[word(non_negative, what = "the distance delta")]
    delta: f64,
}

impl FixStyle for Drag {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { target, strength, delta } = read(args, cx)?;
        let target = target.map(|at| at.0);
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, target, strength, delta }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    target: [Option<f64>; 3],
    strength: f64,
    delta: f64,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let span = cx.span();
        let chosen = Chosen::new(cx.world(), self.group, None, span)?;
        let (target, strength, delta) = (self.target, self.strength, self.delta);
        let slot = cx.slot(&format!("f_{}", self.id));
        let access = Needs::new().read(X | MASK | BOX).add(F).write(SLOTS);
        let op = StepOp::new(format!("fix {} drag", self.id), Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let domain = w.domain()?.clone();
            if domain.tilted() && target.contains(&None) {
                return Err(orthogonal("fix drag towards a line or plane"));
            }
            let total = change_forces::<3>(w, &chosen, |w, i, f| {
                let x = w.particles.x[i];
                let away = std::array::from_fn(|d| target[d].map_or(0.0, |c| x[d] - c));
                let away = domain.minimum_image(away);
                let r = (away[0] * away[0] + away[1] * away[1] + away[2] * away[2]).sqrt();
                if r <= delta {
                    return [0.0; 3];
                }
                let pull = strength / r;
                let added = away.map(|a| -(pull * a));
                (0..3).for_each(|d| f[d] += added[d]);
                added
            });
            publish(w, slot, t, 0.0, &total);
            Ok(())
        });
        Ok(vec![op.one_by_one().with_sums().boxed()])
    }

    fn shape(&self) -> Shape {
        Shape { vector: 3, vector_extensive: true, ..Shape::default() }
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Absent, at_rest: AtRest::Acts, has_level: true, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // By hand: the first is 5 from (0, 0, any z), the second nearer than delta, the third across the periodic
    // face.
    #[test]
    fn towards_a_line() {
        let mut b = Bench::new(AtomStyle::default(), &[[3.0, 4.0, 7.0], [0.5, 0.0, 0.0], [9.0, 0.0, 0.0]]);
        b.world.particles.f = vec![[0.0; 3]; 3].into();
        let fix = b.fix(&Drag, "0 0 NULL 10 1").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f, [[-6.0, -8.0, 0.0], [0.0; 3], [-10.0, 0.0, 0.0]]);
        assert_eq!(b.slot_of("f_f").vector, [-16.0, -8.0, 0.0]);
        for words in ["0 0 0 1", "0 0 v_a 1 1", "0 0 0 1 -1"] {
            assert!(b.fix(&Drag, words).is_err(), "{words}");
        }
    }
}
