//! compute temp/sphere: temperature of spheres that fly and spin.

use super::erotate_sphere::{INERTIA, needs_spheres};
use super::temp::{Rules, offer};
use super::{Compute, ComputeStyle};
use crate::diag::{Code, Diagnostic, Result};
use crate::lang::Args;
use crate::plan::{Op, Stage, When};
use crate::styles::matter::sum;
use crate::styles::step_op::{Wanted, fill};
use crate::styles::{BuildCx, Doc, SealCx, Shape, Style};
use crate::world::{GroupId, SlotId, World};

/// The style.
pub struct TempSphere;

impl Style for TempSphere {
    fn name(&self) -> &'static str {
        "temp/sphere"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: "compute ID group temp/sphere [dof all|rotate]",
            summary: "Temperature of the group's translation and rotation, or of rotation alone.",
            text: "Scalar (intensive): T = Σ (m v² + I ω²)/(dof k_B) with I = 2/5 m R². Each sphere has 6 degrees of \
                   freedom (in two dimensions 3), of rotation alone 3 (1); a particle without a radius only those of its \
                   translation. `extra/dof` of compute_modify is taken off, with `dof all` 3 (2) unless it is said, with \
                   `dof rotate` nothing. 0 where no freedom is left. Vector of 6 \
                   (extensive): Σ (m v_a v_b + I ω_a ω_b) for xx yy zz xy xz yz, in energy units. Spheres are counted anew at \
                   each use (see `compute temp`). `bias` is refused: \
                   temp/com, temp/partial and temp/ramp say the temperature without a flow.",
            example: "compute t all temp/sphere",
        }
    }
}

impl ComputeStyle for TempSphere {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        needs_spheres(self.name(), cx)?;
        let mut rotate = false;
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "dof" => rotate = args.choice("value of dof", &["all", "rotate"])? == "rotate",
                "bias" => {
                    let text = "compute temp/sphere takes no flow away in perigrain";
                    let d = Diagnostic::error(Code::NOT_SUPPORTED, word.span, text);
                    return Err(d
                        .help(
                            "compute temp/com, temp/partial or temp/ramp, and temp/sphere with `dof rotate`",
                        )
                        .into());
                }
                _ => return Err(args.unknown(word, &["dof"])),
            }
        }
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, rotate, rules: Rules::default() }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Rotation alone.
    rotate: bool,
    rules: Rules,
}

impl Declared {
    fn freedom(&self, w: &World) -> f64 {
        let flat = w.settings.two_dimensional;
        let (fly, spin) = if flat { (2.0, 1.0) } else { (3.0, 3.0) };
        let fly = if self.rotate { 0.0 } else { fly };
        let p = &w.particles;
        let [count] = sum(&p.mask, self.group, |i| [if p.radius[i] > 0.0 { fly + spin } else { fly }]);
        let centre = if flat { 2.0 } else { 3.0 };
        // LAMMPS takes the centre's motion off only where translation counts.
        count - self.rules.extra.unwrap_or(if self.rotate { 0.0 } else { centre })
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { scalar: true, vector: 6, vector_extensive: true, ..Shape::default() }
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let me = self.clone();
        let mut freedom = self.rules.freedom();
        let reads = "v omega radius mass mask";
        Ok(fill(&self.id, &Wanted { slot, stage, when }, reads, move |w, t, out| {
            let p = &w.particles;
            let tensor: [f64; 6] = sum(&p.mask, me.group, |i| {
                let (v, o, m) = (p.v[i], p.omega[i], p.mass[i]);
                let fly = if me.rotate { 0.0 } else { m };
                let spin = INERTIA * m * p.radius[i] * p.radius[i];
                let pair = |a: usize, b: usize| fly * v[a] * v[b] + spin * o[a] * o[b];
                [pair(0, 0), pair(1, 1), pair(2, 2), pair(0, 1), pair(0, 2), pair(1, 2)]
            });
            let (twice, dof) = (tensor[0] + tensor[1] + tensor[2], freedom.now(w, t, me.freedom(w)));
            offer(w, out, twice, tensor, dof);
            Ok(())
        }))
    }

    fn modify(&mut self, args: &mut Args, _cx: &BuildCx) -> Result<()> {
        self.rules.modify(args)
    }

    fn boxed(&self) -> Box<dyn Compute> {
        Box::new(self.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::styles::testing::Bench;
    use crate::world::AtomStyle;

    #[test]
    fn freedom_of_points_and_spheres() {
        let mut b = Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3]; 3]);
        b.world.particles.radius = vec![0.5, 0.0, 1.0];
        b.world.particles.v[0] = [1.0, 2.0, 0.0];
        b.world.particles.omega[2] = [0.0, 0.0, 3.0];
        let whole = b.compute(&TempSphere, "").unwrap();
        // m = 2: Σ m v² = 10, Σ I ω² = 0.8 · 9 = 7.2; 2 · 6 + 3 − 3 degrees of freedom; rotation alone 2 · 3.
        let slot = b.evaluate(&*whole).unwrap();
        assert!((slot.scalar - 17.2 / 12.0).abs() < 1e-14 && slot.vector[3] == 4.0);
        let mut spin = b.compute(&TempSphere, "dof rotate").unwrap();
        assert!((b.evaluate(&*spin).unwrap().scalar - 7.2 / 6.0).abs() < 1e-14);
        b.modify("extra/dof 3", |a, cx| spin.modify(a, cx)).unwrap();
        assert!((b.evaluate(&*spin).unwrap().scalar - 7.2 / 3.0).abs() < 1e-14);
        for words in ["dof", "dof some", "bias q", "mass 3"] {
            assert!(b.compute(&TempSphere, words).is_err(), "{words}");
        }
    }
}
