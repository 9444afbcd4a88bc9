//! compute erotate/sphere/atom: kinetic energy of rotation of each sphere.

use super::erotate_sphere::{INERTIA, needs_spheres};
use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::dot;
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::step_op::{Wanted, fill, per_particle};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{MASK, MASS, OMEGA, RADIUS};
use perigrain_world::{GroupId, SlotId};

/// The style.
pub struct ErotateSphereAtom;

impl Style for ErotateSphereAtom {
    fn name(&self) -> &'static str {
        "erotate/sphere/atom"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Kinetic energy of each sphere's rotation.",
            text: "Per-atom vector: ½ I ω² with I = 2/5 m R², in energy units; 0 outside the group and for particles \
                   without a radius.",
            example: "compute spin all erotate/sphere/atom",
        }
    }
}

impl ComputeStyle for ErotateSphereAtom {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        needs_spheres(self.name(), cx)?;
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

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let group = self.group;
        Ok(fill(&self.id, &Wanted { slot, stage, when }, OMEGA | RADIUS | MASS | MASK, move |w, _, out| {
            let p = &w.particles;
            let half = 0.5 * w.settings.units.constants().mvv2e * INERTIA;
            per_particle(w, group, out, |i| {
                let (o, r) = (p.omega[i], p.radius[i]);
                half * dot(o, o) * r * r * p.mass[i]
            });
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn each_its_own() {
        let mut b = Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3]; 3]);
        b.world.particles.radius = vec![0.5, 0.0, 1.0].into();
        b.world.particles.omega = vec![[1.0, 2.0, 0.0], [9.0; 3], [0.0, 0.0, 3.0]].into();
        let c = b.compute(&ErotateSphereAtom, "").unwrap();
        // m = 2: ½ · 0.4 · 2 · (0.25 · 5, 0, 1 · 9) by hand.
        let got = &b.evaluate(&*c).unwrap().atom;
        assert!(got.iter().zip([0.5, 0.0, 3.6]).all(|(a, b)| (a - b).abs() < 1e-14), "{got:?}");
        b.world.particles.style.sphere = false;
        assert!(b.compute(&ErotateSphereAtom, "").is_err());
    }
}
