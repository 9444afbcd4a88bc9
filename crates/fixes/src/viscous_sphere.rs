//! fix viscous/sphere: a torque against the spin of spheres.

use super::resistance::{Factor, Resistance, Scale};
use super::{Facts, Fix, FixStyle, Minimizing};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op};
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::World;
use perigrain_world::field::{KIND, MASK, OMEGA, SLOTS, TORQUE};

/// The style.
pub struct ViscousSphere;

impl Style for ViscousSphere {
    fn name(&self) -> &'static str {
        "viscous/sphere"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Slows the spin of spheres by a torque proportional to their angular velocity.",
            text: "T ← T − γ ω. Angular velocities are those of the half step at which forces are computed; in the setup of a \
                   run those of the whole step.",
            example: "fix calm ball viscous/sphere 1.0e-9 scale 2 0.5",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The drag coefficient gamma [torque/angular velocity].
    gamma: f64,
    /// The coefficient is γ·ratio for a type or range of types, or γ times an atom-style variable for all; one of both ways.
    #[word(keyword, name = "type ratio|v_name", placed)]
    scale: Vec<At<At<Factor>>>,
}

impl FixStyle for ViscousSphere {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.sphere {
            return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, "fix viscous/sphere needs spheres")
                .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
                .into());
        }
        let line: Line = read(args, cx)?;
        let scale = Scale::of(line.scale, cx.world.types)?;
        Ok(Box::new(Declared(Resistance::new(self.name(), line.gamma, scale, cx))))
    }
}

#[derive(Clone)]
struct Declared(Resistance);

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let needs = Needs::new().read(OMEGA | KIND | MASK | SLOTS).add(TORQUE);
        Ok(vec![self.0.op(needs, (|p| &mut p.torque, |p| &p.omega), cx)?])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { minimizing: Minimizing::Acts, has_level: true, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_plan::Stage;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn drag_by_type_or_by_particle() {
        let mut b = Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3]; 2]);
        b.world.types = 3;
        b.world.particles.kind[1] = 3;
        b.atom.insert("a".into(), vec![3.0, 0.5]);
        for (words, torques) in [
            ("2 scale 2* 0.25", [[-2.0, 0.0, 4.0], [-0.5, 0.0, 1.0]]),
            ("2 scale v_a", [[-6.0, 0.0, 12.0], [-1.0, 0.0, 2.0]]),
        ] {
            b.world.particles.omega = vec![[1.0, 0.0, -2.0]; 2].into();
            b.world.particles.torque = vec![[0.0; 3]; 2].into();
            let fix = b.fix(&ViscousSphere, words).unwrap();
            let mut ops = b.seal(&*fix).unwrap();
            b.stage(&mut ops, Stage::PostForce).unwrap();
            assert_eq!(b.world.particles.torque, torques);
        }
        for words in
            ["", "x", "1 scale 4 1", "1 scale 1", "1 scael 1 1", "1 scale 1 2 scale v_a", "1 scale v_q"]
        {
            assert!(b.fix(&ViscousSphere, words).is_err(), "{words}");
        }
    }
}
