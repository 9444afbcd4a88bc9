//! fix nve: velocity Verlet at constant energy.

use super::kick;
use super::{AtRest, Facts, Fix, FixStyle, Moves};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_styles::matter::check_masses;
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::field::{F, KIND, MASK, MASS, TRAVEL, TYPE_MASS, V, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct Nve;

impl Style for Nve {
    fn name(&self) -> &'static str {
        "nve"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Moves the particles of the group by velocity Verlet.",
            text: "Each step: v += Δt/2 · f/m, then x += Δt · v, then new forces, then again v += Δt/2 · f/m \
                   (Swope et al. 1982). Printed velocities belong to whole steps. For peridynamic particles \
                   in LAMMPS' convention f is a force density and m the density. Spheres are moved but not \
                   turned: for that use `nve/sphere`.",
            example: "fix 1 all nve",
        }
    }
}

impl FixStyle for Nve {
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
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (group, span) = (self.group, cx.span());
        check_masses(cx.world(), span)?;
        let name = format!("fix {} nve", self.id);
        let idle = |_: &mut World, _: &Tick| Ok(());
        let first = StepOp::new(
            name.clone(),
            Stage::InitialIntegrate,
            Needs::new().read(F | MASS | MASK | TYPE_MASS | KIND).add(TRAVEL).write(X | V),
            idle,
        );
        let second = StepOp::new(
            name,
            Stage::FinalIntegrate,
            Needs::new().read(F | MASS | MASK | TYPE_MASS | KIND).add(TRAVEL).write(V | X),
            idle,
        );
        let first = kick::first(first.in_every_level().reporting(), group, None);
        let second = kick::second(second.in_every_level().reporting(), group, None);
        Ok(vec![first.boxed(), second.boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { moves: Moves::Freely, at_rest: AtRest::Frees, ..Facts::default() }
    }
}

/// ½ Δt in units that turn force/mass into velocity.
pub fn half_step(w: &World, dt: f64) -> f64 {
    0.5 * dt * w.settings.units.constants().ftm2v
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    // Binary fractions, so that every result is exact: m = 2, f = 4, dt = 0.5.
    #[test]
    fn a_step_is_two_half_kicks_around_a_drift() {
        for peri in [false, true] {
            let mut b = Bench::new(AtomStyle { peri, ..AtomStyle::default() }, &[[1.0, 0.0, 0.0]; 2]);
            b.world.clock.dt = 0.5;
            b.world.particles.f = vec![[4.0, 0.0, -8.0]; 2].into();
            b.world.particles.v = vec![[1.0, 0.0, 0.0]; 2].into();
            b.world.particles.mask[1] = 0;
            let fix = b.fix(&Nve, "").unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            b.stage(&mut ops, Stage::InitialIntegrate).unwrap();
            assert_eq!(b.world.particles.v, [[1.5, 0.0, -1.0], [1.0, 0.0, 0.0]]);
            assert_eq!(b.world.particles.x, [[1.75, 0.0, -0.5], [1.0, 0.0, 0.0]]);
            b.stage(&mut ops, Stage::FinalIntegrate).unwrap();
            assert_eq!(b.world.particles.v[0], [2.0, 0.0, -2.0]);
        }
    }

    #[test]
    fn every_type_needs_a_mass() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]]);
        b.world.type_mass = vec![None].into();
        let fix = b.fix(&Nve, "").unwrap();
        let e = b.seal(&*fix).err().unwrap();
        assert_eq!(e.0[0].message, "atom type 1 has no mass");
        assert!(b.fix(&Nve, "1.0").is_err());
    }
}
