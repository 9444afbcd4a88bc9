//! fix enforce2d: keeps a two-dimensional system in its plane.

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::Args;
use perigrain_plan::{BlockSums, Needs, Op, ParticleBlock, Room, Stage, Tick};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::field::{F, MASK, OMEGA, TORQUE, V};
use perigrain_world::{GroupId, World};

/// The style.
pub struct Enforce2d;

impl Style for Enforce2d {
    fn name(&self) -> &'static str {
        "enforce2d"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Sets velocity and force along z to zero in two-dimensional scenes.",
            text: "Acts on vz and fz of the particles of the group and, for spheres, on the components of angular velocity \
                   and torque that would turn them out of the plane (x and y). Needs `dimension 2`. Forces of fixes \
                   declared later are not seen: declare it last. Acts in the setup of a run too.",
            example: "fix flat all enforce2d",
        }
    }
}

impl FixStyle for Enforce2d {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.settings.two_dimensional {
            let text = "fix enforce2d belongs to two-dimensional scenes";
            return Err(Diagnostic::error(Code::CONFLICT, cx.span, text)
                .help("use `dimension 2` before the box is created, or leave this fix out")
                .into());
        }
        args.finish()?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
}

/// Sets velocities and forces along z to zero.
pub(super) fn flatten([v, f]: [&mut [Vec3]; 2], mask: &[u32], bit: u32) {
    for ((v, f), _) in v.iter_mut().zip(f).zip(mask).filter(|(_, m)| *m & bit != 0) {
        (v[2], f[2]) = (0.0, 0.0);
    }
}

/// Sets spins and torques about x and y to zero, if there are any.
pub(super) fn flatten_turning([omega, torque]: [&mut [Vec3]; 2], mask: &[u32], bit: u32) {
    for ((a, b), _) in omega.iter_mut().zip(torque).zip(mask).filter(|(_, m)| *m & bit != 0) {
        (*a, *b) = ([0.0, 0.0, a[2]], [0.0, 0.0, b[2]]);
    }
}

impl Fix for Declared {
    fn ops(&self, _cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (bit, access) = (self.group.bit(), Needs::new().read(MASK).write(V | F | OMEGA | TORQUE));
        let flatten = move |_: &World, t: &Tick, room: &mut Room| {
            room.flatten(bit, move |s: &mut ParticleBlock<'_>| {
                let mask = s.mask();
                flatten([&mut s.v, &mut s.f], mask, bit);
                flatten_turning([&mut s.omega, &mut s.torque], mask, bit);
                BlockSums::default()
            });
            !t.unchanged
        };
        let name = format!("fix {} enforce2d", self.id);
        let op = StepOp::new(name, Stage::PostForce, access, |_, _| Ok(())).fusing(flatten, |_, _, _| {});
        Ok(vec![op.in_every_level().boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts {
            minimizing: Minimizing::Acts,
            at_rest: AtRest::Holds([false, false, true]),
            ..Facts::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn nothing_leaves_the_plane() {
        let sphere = AtomStyle { sphere: true, sphere_mass: true, ..AtomStyle::default() };
        let mut b = Bench::new(sphere, &[[0.0; 3]; 2]);
        assert!(b.fix(&Enforce2d, "").is_err());
        b.world.settings.two_dimensional = true;
        for column in [&mut b.world.particles.v, &mut b.world.particles.f] {
            *column = vec![[1.0, 2.0, 3.0]; 2].into();
        }
        b.world.particles.omega = vec![[1.0, 2.0, 3.0]; 2].into();
        b.world.particles.torque = vec![[1.0, 2.0, 3.0]; 2].into();
        b.world.particles.mask[1] = 0;
        let fix = b.fix(&Enforce2d, "").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        let p = &b.world.particles;
        assert_eq!((p.v[0], p.f[0]), ([1.0, 2.0, 0.0], [1.0, 2.0, 0.0]));
        assert_eq!((p.omega[0], p.torque[0]), ([0.0, 0.0, 3.0], [0.0, 0.0, 3.0]));
        assert_eq!((p.v[1], p.torque[1]), ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]));
        assert!(b.fix(&Enforce2d, "1").is_err());
    }
}
