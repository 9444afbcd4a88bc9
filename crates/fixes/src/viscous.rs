//! fix viscous: a drag proportional to velocity.

use super::resistance::Resistance;
use super::{Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::World;
use perigrain_world::field::{F, KIND, MASK, V};

/// The style.
pub struct Viscous;

impl Style for Viscous {
    fn name(&self) -> &'static str {
        "viscous"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "fix ID group viscous gamma [scale type ratio]…",
            summary: "Slows particles down by a drag proportional to their velocity.",
            text: "f ← f − γ v, with γ in force/velocity units (force density/velocity for peridynamic particles in \
                   LAMMPS' convention). `scale type ratio` makes it γ·ratio for a type or range of types. Velocities are \
                   those of the half step at which forces are computed; in the setup of a run those of the whole step.",
            example: "fix calm all viscous 1.0e-3 scale 2 0.5",
        }
    }
}

impl FixStyle for Viscous {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        Ok(Box::new(Declared(Resistance::read(self.name(), false, args, cx)?)))
    }
}

#[derive(Clone)]
struct Declared(Resistance);

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let needs = Needs::new().read(V | KIND | MASK).add(F);
        Ok(vec![self.0.op(needs, (|p| &mut p.f, |p| &p.v), cx)?])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, has_level: true, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_plan::Stage;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn drag_by_type() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        b.world.types = 3;
        b.world.particles.kind[1] = 3;
        b.world.particles.v = vec![[1.0, 0.0, -2.0]; 2].into();
        let fix = b.fix(&Viscous, "2 scale 2* 0.25").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f, [[-2.0, 0.0, 4.0], [-0.5, 0.0, 1.0]]);
        for words in ["", "x", "1 scale 4 1", "1 scale 1", "1 scael 1 1"] {
            assert!(b.fix(&Viscous, words).is_err(), "{words}");
        }
    }
}
