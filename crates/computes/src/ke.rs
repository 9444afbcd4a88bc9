//! compute ke: translational kinetic energy.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Masses, check_masses, sum};
use perigrain_styles::step_op::{Wanted, fill_sums};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{KIND, MASK, MASS, TYPE_MASS, V};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct Ke;

impl Style for Ke {
    fn name(&self) -> &'static str {
        "ke"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Kinetic energy of the group's translation.",
            text: "Scalar (extensive): Σ ½ m v², in energy units. Rotation of spheres is not included (see \
                   `erotate/sphere`). For peridynamic particles in LAMMPS' convention m is the density, so that the \
                   sum is one of energy densities.",
            example: "compute k all ke",
        }
    }
}

impl ComputeStyle for Ke {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, span) = (self.group, cx.span());
        check_masses(cx.world(), span)?;
        Ok(fill_sums(
            &self.id,
            &Wanted { slot, stage, when },
            V | MASS | MASK | KIND | TYPE_MASS,
            move |w, _, out| {
                let (p, masses) = (&w.particles, Masses::of(w));
                let [mv2] = sum(w, group, |i| {
                    let v = p.v[i];
                    [masses.get(i) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])]
                });
                out.scalar = 0.5 * w.settings.units.constants().mvv2e * mv2;
                Ok(())
            },
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn half_m_v_squared() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 3]);
        b.world.particles.v = vec![[1.0, 2.0, 0.0], [0.0, 0.0, 4.0], [9.0, 9.0, 9.0]].into();
        b.world.particles.mask[2] = 0;
        let c = b.compute(&Ke, "").unwrap();
        // m = 2: 5 + 16 by hand.
        assert_eq!(b.evaluate(&*c).unwrap().scalar, 21.0);
        b.world.settings.units = perigrain_base::units::UnitSystem::Electron;
        assert_eq!(b.evaluate(&*c).unwrap().scalar, 0.5 * 1.06657236 * 42.0);
    }
}
