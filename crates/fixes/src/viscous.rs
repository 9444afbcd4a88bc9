//! fix viscous: a drag proportional to velocity.

use super::resistance::{Resistance, Scale};
use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op};
use perigrain_styles::words::{Syntax, Types, Words, read};
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
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Slows particles down by a drag proportional to their velocity.",
            text: "f ← f − γ v; for peridynamic particles in LAMMPS' convention γ is a force density over a velocity. \
                   Velocities are those of the half step at which forces are computed; in the setup of a run those of the \
                   whole step.",
            example: "fix calm all viscous 1.0e-3 scale 2 0.5",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The drag coefficient gamma [force/velocity].
    gamma: f64,
    /// The coefficient is γ·ratio for a type or range of types.
    #[word(keyword, name = "type ratio", what = "the ratio of coefficients")]
    scale: Vec<(Types, f64)>,
}

impl FixStyle for Viscous {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let scale = Scale::by_type(&line.scale, cx.world.types);
        Ok(Box::new(Declared(Resistance::new(self.name(), line.gamma, scale, cx))))
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
        Facts { minimizing: Minimizing::Acts, at_rest: AtRest::Idle, has_level: true, ..Facts::default() }
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
