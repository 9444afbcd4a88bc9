//! compute com: centre of mass.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Masses, Whole, check_masses, sum, unwrapped};
use perigrain_styles::step_op::{Wanted, fill_sums};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{BOX, IMAGE, KIND, MASK, MASS, TYPE_MASS, X};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct Com;

impl Style for Com {
    fn name(&self) -> &'static str {
        "com"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Centre of mass of the group.",
            text: "Vector of 3 (intensive): Σ m x / Σ m with positions unwrapped across periodic faces, in distance \
                   units; zeros where the group has no mass. Under `-compat lammps` Σ m is \
                   that of the run's beginning, also once particles have been lost or have come.",
            example: "compute c ball com",
        }
    }
}

impl ComputeStyle for Com {
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
        Shape { vector: 3, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (group, span) = (self.group, cx.span());
        check_masses(cx.world(), span)?;
        let whole = Whole::mass(cx.world(), group);
        Ok(fill_sums(
            &self.id,
            &Wanted { slot, stage, when },
            X | IMAGE | MASS | MASK | BOX | KIND | TYPE_MASS,
            move |w, _, out| {
                let masses = Masses::of(w);
                let [x, y, z, m] = sum(w, group, |i| {
                    let (m, [x, y, z]) = (masses.get(i), unwrapped(w, i));
                    [x * m, y * m, z * m, m]
                });
                let m = whole.of(m);
                // With zero mass the sums are zero; LAMMPS does not divide them.
                let over = if m > 0.0 { m } else { 1.0 };
                out.vector.clear();
                out.vector.extend([x, y, z].map(|k| k / over));
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
    fn unwrapped_mean() {
        let mut b = Bench::new(AtomStyle { peri: true, ..AtomStyle::default() }, &[[1.0; 3], [2.0; 3]]);
        b.world.particles.mass = vec![1.0, 3.0].into();
        b.world.particles.image[1] = [1, 0, -1]; // The box is 20 wide.
        let c = b.compute(&Com, "").unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().vector, [16.75, 1.75, -13.25]);
        b.world.particles.mask.fill(0);
        assert_eq!(b.evaluate(&*c).unwrap().vector, [0.0; 3]);
    }
}
