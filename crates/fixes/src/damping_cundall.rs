//! fix damping/cundall: damping by a fraction of each force, opposed to the velocity and independent of the
//! speed.

use super::resistance::{Factor, Scale};
use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::field::{F, KIND, MASK, OMEGA, SLOTS, TORQUE, V};
use perigrain_world::{GroupId, World};

/// The style.
pub struct DampingCundall;

impl Style for DampingCundall {
    fn name(&self) -> &'static str {
        "damping/cundall"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Takes a part of each force and torque along motion, and adds it against motion.",
            text: "Each component of the force by itself: f ← f (1 − γ_l) where f v ≥ 0, f (1 + γ_l) elsewhere; torques and angular velocities \
                   likewise with γ_a (Cundall 1987; Yade and PFC have the same). The coefficients have no unit, the drag does not depend on speed, and \
                   nothing acts on uniform motion, so that a scene comes to rest at the forces that it has. It depends on the axes and is no law of nature: \
                   a means to an equilibrium.\n\n\
                   Only forces and torques computed before count: declare `fix gravity` after this fix to keep its acceleration whole.",
            example: "fix calm ball damping/cundall 0.2 0.2 scale 2 0.5",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The coefficient of forces.
    gamma_l: f64,
    /// The coefficient of torques.
    gamma_a: f64,
    /// Both coefficients are multiplied by this ratio for a type or range of types, or by an atom-style variable for all; one
    /// of both ways.
    #[word(keyword, name = "type ratio|v_name", placed)]
    scale: Vec<At<At<Factor>>>,
}

impl FixStyle for DampingCundall {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.sphere {
            return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, "fix damping/cundall needs spheres")
                .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
                .into());
        }
        let line: Line = read(args, cx)?;
        let (gamma, scale) = ([line.gamma_l, line.gamma_a], Scale::of(line.scale, cx.world.types)?);
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, gamma, scale }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Coefficients for forces and for torques.
    gamma: [f64; 2],
    scale: Scale,
}

/// Changes a force or torque by the fraction γ of its size, against the velocity, component by component.
#[inline(always)]
fn damp(f: &mut [f64; 3], v: &[f64; 3], gamma: f64) {
    for (f, v) in f.iter_mut().zip(v) {
        *f *= if *f * v >= 0.0 { 1.0 - gamma } else { 1.0 + gamma };
    }
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (bit, [gamma_l, gamma_a]) = (self.group.bit(), self.gamma);
        let factors = self.scale.factors(cx)?;
        let access = Needs::new().read(V | OMEGA | KIND | MASK | SLOTS).write(F | TORQUE);
        let name = format!("fix {} damping/cundall", self.id);
        let op = StepOp::new(name, Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let mut f = std::mem::take(&mut *w.particles.f);
            let mut torque = std::mem::take(&mut *w.particles.torque);
            let world = &*w;
            let p = &world.particles;
            par::each(
                (&mut f[..], &mut torque[..], &p.v[..], &p.omega[..], &p.mask[..]),
                |start, (f, torque, v, omega, mask)| {
                    for k in (0..mask.len()).filter(|k| mask[*k] & bit != 0) {
                        let factor = factors.of(world, start + k);
                        damp(&mut f[k], &v[k], gamma_l * factor);
                        damp(&mut torque[k], &omega[k], gamma_a * factor);
                    }
                },
            );
            *w.particles.f = f;
            *w.particles.torque = torque;
            Ok(())
        });
        Ok(vec![op.boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, at_rest: AtRest::Idle, has_level: true, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn forces_along_motion_lose_and_those_against_it_gain() {
        let mut b = Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        b.world.types = 2;
        b.world.particles.kind[1] = 2;
        b.world.particles.v = vec![[1.0, -1.0, 0.0]; 2].into();
        b.world.particles.omega = vec![[-3.0, 0.0, 3.0]; 2].into();
        b.world.particles.f = vec![[10.0, 10.0, 10.0]; 2].into();
        b.world.particles.torque = vec![[1.0, 1.0, 1.0]; 2].into();
        let fix = b.fix(&DampingCundall, "0.2 0.5 scale 2 0.5").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        let p = &b.world.particles;
        // At rest, a force counts as acting along the motion that it starts.
        assert_eq!(p.f, [[8.0, 12.0, 8.0], [9.0, 11.0, 9.0]]);
        assert_eq!(p.torque, [[1.5, 0.5, 0.5], [1.25, 0.75, 0.75]]);
        for words in ["", "1", "1 x", "1 1 scale 3 1", "1 1 scale v_q", "1 1 x"] {
            assert!(b.fix(&DampingCundall, words).is_err(), "{words}");
        }
    }
}
