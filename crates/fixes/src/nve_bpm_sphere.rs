//! fix nve/bpm/sphere: velocity Verlet of spheres with orientations.

use super::nve_sphere::{Line, ORIENTED, declared};
use super::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_styles::words::{Syntax, Words};
use perigrain_styles::{BuildCx, Doc, Style};

/// The style.
pub struct NveBpmSphere;

impl Style for NveBpmSphere {
    fn name(&self) -> &'static str {
        ORIENTED
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Moves and turns the group's spheres by velocity Verlet, with their orientations.",
            text: "As `fix nve/sphere`; after the first half kick orientations follow the spins, q̇ = ½ ω q over Δt \
                   with the ω of the middle of the step, extrapolated from one step and two halves (Richardson) and \
                   kept at unit length. Bonds that bend and twist (`bond_style bpm/rotational`) need them. `update` \
                   needs particles with dipoles (`atom_style hybrid bpm/sphere dipole`).",
            example: "units lj\natom_style bpm/sphere\nregion b block 0 4 0 4 0 4\ncreate_box 1 b\ncreate_atoms 1 single 2 2 2\n\
                      set group all omega 0 0 0.5\nfix 1 all nve/bpm/sphere\nrun 10",
        }
    }
}

impl FixStyle for NveBpmSphere {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.oriented {
            let text = "fix nve/bpm/sphere needs particles with orientations";
            let d = Diagnostic::error(Code::WRONG_ORDER, cx.span, text);
            return Err(d
                .help("put `atom_style bpm/sphere` (or a hybrid with it) at the top of the deck")
                .into());
        }
        declared(ORIENTED, args, cx)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_plan::Stage;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn bench(n: usize) -> Bench {
        let style = AtomStyle { sphere: true, oriented: true, ..AtomStyle::default() };
        let mut b = Bench::new(style, &vec![[1.0, 0.0, 0.0]; n]);
        b.world.particles.radius = vec![0.5; n].into();
        b
    }

    /// A constant spin rotates by spin times time; one by one and in fours alike.
    #[test]
    fn orientations_follow_spins() {
        let (mut b, dt, steps) = (bench(7), 1e-3, 1000);
        b.world.clock.dt = dt;
        let axis = [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0];
        let omega = axis.map(|a| 1.5 * a);
        b.world.particles.omega = vec![omega; 7].into();
        b.world.particles.mask[6] = 0;
        let fix = b.fix(&NveBpmSphere, "").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        for _ in 0..steps {
            b.stage(&mut ops, Stage::InitialIntegrate).unwrap();
            b.stage(&mut ops, Stage::FinalIntegrate).unwrap();
        }
        let quat = &b.world.particles.quat;
        let exact = perigrain_base::math::body::turn(axis, 1.5);
        for k in 0..4 {
            // Third order in ω Δt/2 per step: 1000 (0.75e-3)³/6.
            assert!((quat[0][k] - exact[k]).abs() < 7e-8, "{:?} {exact:?}", quat[0]);
        }
        assert!(quat[..6].iter().all(|q| q.map(f64::to_bits) == quat[0].map(f64::to_bits)));
        assert_eq!(quat[6], [1.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn spheres_without_orientations_are_refused() {
        let mut b = bench(1);
        // There are no dipoles here.
        assert_eq!(b.fix(&NveBpmSphere, "update dipole").err().unwrap().0[0].code, Code::CONFLICT);
        b.world.particles.style.oriented = false;
        assert_eq!(b.fix(&NveBpmSphere, "").err().unwrap().0[0].code, Code::WRONG_ORDER);
    }
}
