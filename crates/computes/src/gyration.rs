//! compute gyration: radius of gyration and its tensor.

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
pub struct Gyration;

impl Style for Gyration {
    fn name(&self) -> &'static str {
        "gyration"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Radius of gyration of the group.",
            text: "Scalar (intensive), in distance units: R² = Σ m |x − x_cm|² / Σ m with positions unwrapped across \
                   periodic faces. Vector of 6 (intensive), squared distances: Σ m (x − x_cm)_a (x − x_cm)_b / Σ m for xx \
                   yy zz xy xz yz. Zeros where the group has no mass. Under `-compat lammps` Σ m is that of the run's \
                   beginning, also once particles have been lost or have come.",
            example: "compute g all gyration",
        }
    }
}

impl ComputeStyle for Gyration {
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
        Shape { scalar: true, vector: 6, ..Shape::default() }
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
                let [x, y, z, mass] = sum(w, group, |i| {
                    let (m, [x, y, z]) = (masses.get(i), unwrapped(w, i));
                    [x * m, y * m, z * m, m]
                });
                let mass = whole.of(mass);
                let over = |a: f64| if mass > 0.0 { a / mass } else { 0.0 };
                let center = [x, y, z].map(over);
                let [all, tensor @ ..] = sum::<7>(w, group, |i| {
                    let (m, u) = (masses.get(i), unwrapped(w, i));
                    let [x, y, z]: [f64; 3] = std::array::from_fn(|d| u[d] - center[d]);
                    [
                        (x * x + y * y + z * z) * m,
                        m * x * x,
                        m * y * y,
                        m * z * z,
                        m * x * y,
                        m * x * z,
                        m * y * z,
                    ]
                });
                out.scalar = over(all).sqrt();
                out.vector = tensor.map(over).to_vec();
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
    fn a_dumbbell() {
        let mut b = Bench::new(AtomStyle::default(), &[[1.0, 1.0, 0.0], [3.0, -1.0, 0.0]]);
        let c = b.compute(&Gyration, "").unwrap();
        let slot = b.evaluate(&*c).unwrap();
        // By hand: both ends are at (1, -1, 0) from the middle.
        assert_eq!(slot.vector, [1.0, 1.0, 0.0, -1.0, 0.0, 0.0]);
        assert_eq!(slot.scalar, 2f64.sqrt());
        b.world.particles.mask.fill(0);
        assert_eq!(b.evaluate(&*c).unwrap().scalar, 0.0);
    }
}
