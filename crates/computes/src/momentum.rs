//! compute momentum: total linear momentum.

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
pub struct Momentum;

impl Style for Momentum {
    fn name(&self) -> &'static str {
        "momentum"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Linear momentum of the group.",
            text: "Vector of 3 (extensive): Σ m v, in mass · velocity units.",
            example: "compute p all momentum",
        }
    }
}

impl ComputeStyle for Momentum {
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
        Shape { vector: 3, vector_extensive: true, ..Shape::default() }
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
                let total = sum(w, group, |i| p.v[i].map(|v| masses.get(i) * v));
                out.vector.clear();
                out.vector.extend(total);
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
    fn mass_times_velocity() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        b.world.particles.v = vec![[1.0, 2.0, 0.0], [-1.0, 0.0, 4.0]].into();
        let c = b.compute(&Momentum, "").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().vector, [0.0, 4.0, 8.0]); // m = 2
    }
}
