//! compute erotate/sphere: kinetic energy of rotation of spheres.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::sum;
use perigrain_styles::step_op::{Wanted, fill_sums};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{MASK, MASS, OMEGA, RADIUS};
use perigrain_world::{GroupId, SlotId};

/// I / (m R²) of a solid sphere.
pub(super) const INERTIA: f64 = 0.4;

/// The style.
pub struct ErotateSphere;

impl Style for ErotateSphere {
    fn name(&self) -> &'static str {
        "erotate/sphere"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Kinetic energy of the rotation of the group's spheres.",
            text: "Scalar (extensive): Σ ½ I ω² with I = 2/5 m R², in energy units. Particles without a radius \
                   contribute nothing.",
            example: "compute r all erotate/sphere",
        }
    }
}

impl ComputeStyle for ErotateSphere {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        needs_spheres(self.name(), cx)?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group }))
    }
}

/// Refuses a compute of spheres for particles without a radius.
pub(super) fn needs_spheres(name: &str, cx: &BuildCx) -> Result<()> {
    if cx.world.particles.style.sphere {
        return Ok(());
    }
    Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, format!("compute {name} needs spheres"))
        .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
        .into())
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

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let group = self.group;
        Ok(fill_sums(
            &self.id,
            &Wanted { slot, stage, when },
            OMEGA | RADIUS | MASS | MASK,
            move |w, _, out| {
                let p = &w.particles;
                let [sum] = sum(w, group, |i| {
                    let (o, r) = (p.omega[i], p.radius[i]);
                    [(o[0] * o[0] + o[1] * o[1] + o[2] * o[2]) * r * r * p.mass[i]]
                });
                out.scalar = 0.5 * w.settings.units.constants().mvv2e * INERTIA * sum;
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
    fn half_i_omega_squared() {
        let mut b = Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3]; 3]);
        b.world.particles.radius = vec![0.5, 0.0, 1.0].into();
        b.world.particles.omega = vec![[1.0, 2.0, 0.0], [9.0; 3], [0.0, 0.0, 3.0]].into();
        let c = b.compute(&ErotateSphere, "").unwrap();
        // m = 2: ½ · 0.4 · 2 · (0.25 · 5 + 0 + 1 · 9) by hand.
        assert!((b.evaluate(&*c).unwrap().scalar - 4.1).abs() < 1e-14);
        b.world.particles.style.sphere = false;
        assert!(b.compute(&ErotateSphere, "").is_err());
    }
}
