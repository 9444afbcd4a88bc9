//! compute ke/atom: kinetic energy of each particle.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Masses, check_masses};
use perigrain_styles::step_op::{Wanted, fill, per_particle};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{KIND, MASK, MASS, TYPE_MASS, V};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct KeAtom;

impl Style for KeAtom {
    fn name(&self) -> &'static str {
        "ke/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Kinetic energy of each particle's translation.",
            text: "Per-atom vector: ½ m v², in energy units; 0 outside the group.",
            example: "compute hot all ke/atom",
        }
    }
}

impl ComputeStyle for KeAtom {
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
        Shape { atom: Some(1), ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, span) = (self.group, cx.span());
        check_masses(cx.world(), span)?;
        Ok(fill(
            &self.id,
            &Wanted { slot, stage, when },
            V | MASS | MASK | KIND | TYPE_MASS,
            move |w, _, out| {
                let (p, masses) = (&w.particles, Masses::of(w));
                let half = 0.5 * w.settings.units.constants().mvv2e;
                per_particle(w, group, out, |i| {
                    let v = p.v[i];
                    half * masses.get(i) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
                });
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
    fn each_its_own() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 3]);
        b.world.particles.v = vec![[1.0, 2.0, 0.0], [0.0, 0.0, 4.0], [9.0, 9.0, 9.0]].into();
        b.world.particles.mask[2] = 0;
        let c = b.compute(&KeAtom, "").unwrap();
        // m = 2, by hand.
        assert_eq!(b.evaluate(&*c).unwrap().atom, [5.0, 16.0, 0.0]);
    }
}
