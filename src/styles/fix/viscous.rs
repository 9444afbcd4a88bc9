//! fix viscous: a drag proportional to velocity.

use super::{Fix, FixStyle, Minimizing};
use crate::diag::Result;
use crate::lang::Args;
use crate::plan::{Access, Op, Stage};
use crate::styles::matter::{Chosen, change_forces};
use crate::styles::step_op::StepOp;
use crate::styles::{BuildCx, Doc, SealCx, Style};
use crate::world::GroupId;

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
        let types = cx.world.types;
        let one = args.number("the drag coefficient gamma")?;
        let mut gamma = vec![one; types];
        while let Some(word) = args.next() {
            if word.text != "scale" {
                return Err(args.unknown(word, &["scale"]));
            }
            let (lo, hi) = args.type_range(types)?;
            let ratio = args.number("the ratio of drag coefficients")?;
            (lo..=hi).for_each(|k| gamma[usize::from(k) - 1] = one * ratio);
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, gamma }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Drag coefficient by type − 1.
    gamma: Vec<f64>,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (gamma, span) = (self.gamma.clone(), cx.span());
        let chosen = Chosen::new(cx.world(), self.group, None, span)?;
        let access = Access::new("f v type mask", "f");
        let op = StepOp::new(format!("fix {} viscous", self.id), Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            change_forces::<0>(w, &chosen, |w, i, f| {
                let (v, drag) = (w.particles.v[i], gamma[usize::from(w.particles.kind[i]) - 1]);
                (0..3).for_each(|d| f[d] -= drag * v[d]);
                []
            });
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
    fn drag_by_type() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        b.world.types = 3;
        b.world.particles.kind[1] = 3;
        b.world.particles.v = vec![[1.0, 0.0, -2.0]; 2];
        let fix = b.fix(&Viscous, "2 scale 2* 0.25").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f, [[-2.0, 0.0, 4.0], [-0.5, 0.0, 1.0]]);
        for words in ["", "x", "1 scale 4 1", "1 scale 1", "1 scael 1 1"] {
            assert!(b.fix(&Viscous, words).is_err(), "{words}");
        }
    }
}
