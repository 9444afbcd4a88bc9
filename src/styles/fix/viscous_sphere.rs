//! fix viscous/sphere: a torque against the spin of spheres.

use super::{Fix, FixStyle, Minimizing};
use crate::diag::{Code, Diagnostic, Result, fail};
use crate::lang::{Args, Param};
use crate::par;
use crate::plan::{Access, Op, Stage, When};
use crate::styles::command::common::variable_param;
use crate::styles::step_op::StepOp;
use crate::styles::{BuildCx, Doc, Reading, SealCx, Style};
use crate::world::GroupId;

/// The style.
pub struct ViscousSphere;

impl Style for ViscousSphere {
    fn name(&self) -> &'static str {
        "viscous/sphere"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "fix ID group viscous/sphere gamma [scale type ratio]… | [scale v_name]",
            summary: "Slows the spin of spheres by a torque proportional to their angular velocity.",
            text: "T ← T − γ ω, with γ in torque/angular velocity units. `scale type ratio` makes it γ·ratio for a type \
                   or range of types, `scale v_name` γ times an atom-style variable; one of both ways. Angular velocities \
                   are those of the half step at which forces are computed; in the setup of a run those of the whole step.",
            example: "fix calm ball viscous/sphere 1.0e-9 scale 2 0.5",
        }
    }
}

/// What γ is multiplied by.
#[derive(Clone)]
enum Scale {
    /// By type − 1.
    Kinds(Vec<f64>),
    /// By particle.
    Each(Param),
}

impl FixStyle for ViscousSphere {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let types = cx.world.types;
        let gamma = args.number("the drag coefficient gamma")?;
        if !cx.world.particles.style.sphere {
            return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, "fix viscous/sphere needs spheres")
                .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
                .into());
        }
        let (mut scale, mut given) = (Scale::Kinds(vec![1.0; types]), false);
        while let Some(word) = args.next() {
            if word.text != "scale" {
                return Err(args.unknown(word, &["scale"]));
            }
            if args.peek_text().starts_with("v_") {
                if given {
                    let text = "scale either by type or by a variable";
                    return fail(Code::CONFLICT, word.span.to(args.here()), text);
                }
                let by = variable_param(args, "the factor")?;
                cx.param(&by, true)?;
                scale = Scale::Each(by);
            } else {
                let Scale::Kinds(ratio) = &mut scale else {
                    return fail(Code::CONFLICT, word.span, "scale either by type or by a variable");
                };
                let (lo, hi) = args.type_range(types)?;
                let by = args.number("the ratio of drag coefficients")?;
                (lo..=hi).for_each(|k| ratio[usize::from(k) - 1] = by);
            }
            given = true;
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, gamma, scale }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    gamma: f64,
    scale: Scale,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (gamma, bit) = (self.gamma, self.group.bit());
        let (kinds, each) = match &self.scale {
            Scale::Kinds(ratio) => (ratio.clone(), None),
            Scale::Each(by) => (vec![], Some(cx.param(by, Stage::PostForce, &When::Always)?)),
        };
        let access = Access::new("omega torque type mask", "torque");
        let name = format!("fix {} viscous/sphere", self.id);
        let op = StepOp::new(name, Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let mut torques = std::mem::take(&mut w.particles.torque);
            let world = &*w;
            let p = &world.particles;
            let factor = |i: usize| match each {
                Some(reading) => Reading::atom(&reading, world, i),
                None => kinds[usize::from(p.kind[i]) - 1],
            };
            par::each((&mut torques[..], &p.omega[..], &p.mask[..]), |start, (torque, omega, mask)| {
                for (k, ((torque, omega), mask)) in torque.iter_mut().zip(omega).zip(mask).enumerate() {
                    if mask & bit != 0 {
                        let drag = gamma * factor(start + k);
                        (0..3).for_each(|d| torque[d] -= drag * omega[d]);
                    }
                }
            });
            w.particles.torque = torques;
            Ok(())
        });
        Ok(vec![op.boxed()])
    }

    fn minimizing(&self) -> Minimizing {
        Minimizing::Acts
    }

    fn boxed(&self) -> Box<dyn Fix> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::styles::testing::Bench;
    use crate::world::AtomStyle;

    #[test]
    fn drag_by_type_or_by_particle() {
        let mut b = Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        b.world.types = 3;
        b.world.particles.kind[1] = 3;
        b.atom.insert("a".into(), vec![3.0, 0.5]);
        for (words, torques) in [
            ("2 scale 2* 0.25", [[-2.0, 0.0, 4.0], [-0.5, 0.0, 1.0]]),
            ("2 scale v_a", [[-6.0, 0.0, 12.0], [-1.0, 0.0, 2.0]]),
        ] {
            b.world.particles.omega = vec![[1.0, 0.0, -2.0]; 2];
            b.world.particles.torque = vec![[0.0; 3]; 2];
            let fix = b.fix(&ViscousSphere, words).unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            b.stage(&mut ops, Stage::PostForce).unwrap();
            assert_eq!(b.world.particles.torque, torques);
        }
        for words in
            ["", "x", "1 scale 4 1", "1 scale 1", "1 scael 1 1", "1 scale 1 2 scale v_a", "1 scale v_q"]
        {
            assert!(b.fix(&ViscousSphere, words).is_err(), "{words}");
        }
    }
}
