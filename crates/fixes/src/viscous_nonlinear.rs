//! fix viscous/nonlinear: the drag of a fluid on spheres, at any Reynolds number.

use super::{AtRest, Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{Vec3, length};
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::field::{F, MASK, RADIUS, V};
use perigrain_world::{GroupId, World};
use std::f64::consts::PI;

/// The style.
pub struct ViscousNonlinear;

impl Style for ViscousNonlinear {
    fn name(&self) -> &'static str {
        "viscous/nonlinear"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Fluid::GRAMMAR),
            summary: "Slows spheres down by the drag of a fluid around them.",
            text: "A fluid that rests, or flows at V, pulls at each sphere by F = −C_d ρ π r² |u| u/2, u = v − V, with \
                   the drag coefficient of Schiller and Naumann (1933) C_d = 24/Re (1 + 0.15 Re^0.687), Re = 2 ρ |u| \
                   r/μ; for small Re this is Stokes' 6 π μ r u, and it holds up to Re about 800. No buoyancy.\n\n\
                   Velocities are those of the half step at which forces are computed; in the setup of a run those of \
                   the whole step. As in LAMMPS from 4 Jul 2026 on. Units in which mass · length/time² is no force \
                   (`real`, `metal` …) are refused.",
            example: "fix air ball viscous/nonlinear 1.2 1.8e-5 velocity 0.0 0.0 0.4",
        }
    }
}

/// The fluid around the spheres.
#[derive(Clone, Words)]
struct Fluid {
    /// The density of the fluid [mass/volume].
    #[word(name = "rho", positive)]
    density: f64,
    /// The dynamic viscosity of the fluid [pressure·time].
    #[word(name = "mu", positive, what = "the viscosity of the fluid")]
    viscosity: f64,
    /// The velocity of the fluid [velocity]; without it the fluid rests.
    #[word(keyword, name = "Vx Vy Vz", what = "the velocity {} of the fluid")]
    velocity: [f64; 3],
}

impl FixStyle for ViscousNonlinear {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.sphere {
            return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, "fix viscous/nonlinear needs spheres")
                .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
                .into());
        }
        let units = cx.world.settings.units;
        if units.constants().ftm2v != 1.0 {
            let text = format!("in units {} a drag by mass and velocity is no force", units.name());
            let d = Diagnostic::error(Code::NOT_SUPPORTED, cx.span, text);
            return Err(d.help("take units lj, si, cgs, micro or nano").into());
        }
        let fluid: Fluid = read(args, cx)?;
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, fluid }))
    }
}

impl Fluid {
    /// F/u of a sphere that moves with u [force/velocity]: 6 π μ r (1 + 0.15 Re^0.687), the page's formula
    /// with 24/Re inserted.
    fn drag(&self, radius: f64, speed: f64) -> f64 {
        let reynolds = 2.0 * self.density * speed * radius / self.viscosity;
        6.0 * PI * self.viscosity * radius * (1.0 + 0.15 * reynolds.powf(0.687))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    fluid: Fluid,
}

impl Fix for Declared {
    fn ops(&self, _: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (bit, fluid) = (self.group.bit(), self.fluid.clone());
        let access = Needs::new().read(V | RADIUS | MASK).add(F);
        let name = format!("fix {} viscous/nonlinear", self.id);
        let op = StepOp::new(name, Stage::PostForce, access, move |w, t| {
            if t.unchanged {
                return Ok(());
            }
            let p = &mut w.particles;
            par::each((&mut p.f[..], &p.v[..], &p.radius[..], &p.mask[..]), |_, (f, v, radius, mask)| {
                for (((f, v), radius), mask) in f.iter_mut().zip(v).zip(radius).zip(mask) {
                    if mask & bit != 0 {
                        let u: Vec3 = std::array::from_fn(|d| v[d] - fluid.velocity[d]);
                        let drag = fluid.drag(*radius, length(u));
                        (0..3).for_each(|d| f[d] -= drag * u[d]);
                    }
                }
            });
            Ok(())
        });
        Ok(vec![op.boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, at_rest: AtRest::Idle, has_level: true, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn drag_of_stokes_and_of_schiller_and_naumann() {
        let mut b = Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        b.world.particles.v = vec![[0.0, 0.0, -1.0], [1e-9, 0.0, 0.0]].into();
        b.world.particles.radius = vec![0.05, 0.05].into();
        let fix = b.fix(&ViscousNonlinear, "1000 0.5").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        // Re = 1000·1·0.1/0.5 = 200: C_d = 24/200 (1 + 0.15·200^0.687) = 0.8057, F = C_d·1000·π·0.05²/2.
        let c = 24.0 / 200.0 * (1.0 + 0.15 * 200f64.powf(0.687));
        assert!((c - 0.8057).abs() < 5e-4);
        let f = &b.world.particles.f;
        assert!((f[0][2] / (0.5 * c * 1000.0 * PI * 0.0025) - 1.0).abs() < 1e-14, "{f:?}");
        assert!((f[1][0] / (-6.0 * PI * 0.5 * 0.05 * 1e-9) - 1.0).abs() < 1e-4, "{f:?}");
        // A particle that moves with the fluid feels no force.
        let fix = b.fix(&ViscousNonlinear, "1000 0.5 velocity 0 0 -1").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.world.particles.f = vec![[0.0; 3]; 2].into();
        b.stage(&mut ops, Stage::PostForce).unwrap();
        assert_eq!(b.world.particles.f[0], [0.0; 3]);
        for words in ["", "1", "-1 1", "1 0", "1 1 velocity 1 2", "1 1 speed 1 2 3"] {
            assert!(b.fix(&ViscousNonlinear, words).is_err(), "{words}");
        }
    }
}
