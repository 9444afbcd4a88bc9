//! compute vacf: velocity autocorrelation since the compute was declared.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::Result;
use perigrain_lang::Args;
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::matter::{Whole, count, keep_places, sum};
use perigrain_styles::step_op::{Wanted, fill_sums};
use perigrain_styles::words::{Grammar, Syntax};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{COLUMNS, MASK, V};
use perigrain_world::{GroupId, Registration, SlotId, Under, Vectors, World};

/// The velocities that the present ones are compared with.
static FIRST: Registration = Registration::moved("compute ", " velocity", Under::Record);

/// The style.
pub struct Vacf;

impl Style for Vacf {
    fn name(&self) -> &'static str {
        "vacf"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Grammar::NONE),
            summary: "Velocity autocorrelation of the group since the compute was declared.",
            text: "Vector of 4 (intensive) in squared velocity units: the means of v_x(t) v_x(0), the same along y and z, and their \
                   sum, v(0) being the velocities when the line was read, of particles made since those they began with. Restart \
                   files hold them. Zeros where the group is empty. Under `-compat lammps` sums are divided by the number that the \
                   group had when the run began, also once particles have been lost or have come.",
            example: "compute v all vacf",
        }
    }
    fn registrations(&self) -> &'static [&'static Registration] {
        const { &[&FIRST] }
    }
}

impl ComputeStyle for Vacf {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        args.finish()?;
        let key = FIRST.key(&format!("compute {}", cx.id));
        Ok(Box::new(Declared { id: cx.id.to_string(), key, group: cx.group }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    /// The column of the initial velocities.
    key: Vectors,
    group: GroupId,
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        Shape { vector: 4, ..Shape::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        self.particles_joined(w);
        Ok(())
    }

    fn particles_joined(&self, w: &mut World) {
        let n = w.n();
        w.columns.resize(n);
        keep_places(w, self.key, GroupId::ALL, |w, i| w.particles.v[i]);
    }

    fn remove(&self, w: &mut World) {
        w.columns.remove(self.key);
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        self.particles_joined(cx.world());
        let (me, key, whole) = (self.clone(), self.key, Whole::number(cx.world(), self.group));
        Ok(fill_sums(&self.id, &Wanted { slot, stage, when }, V | MASK | COLUMNS, move |w, _, out| {
            let first = w.columns.get_vector(key).unwrap_or(&[]);
            let [x, y, z] = sum(w, me.group, |i| {
                let (now, then) = (w.particles.v[i], first.get(i).copied().unwrap_or_default());
                std::array::from_fn(|d| now[d] * then[d])
            });
            let n = whole.of(count(w, me.group) as f64);
            // For no particles the sums are zero; LAMMPS does not divide them.
            let over = if n > 0.0 { n } else { 1.0 };
            out.vector = [x, y, z, x + y + z].map(|a| a / over).to_vec();
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
    fn then_and_now() {
        let mut b = Bench::new(AtomStyle::default(), &[[0.0; 3], [1.0; 3]]);
        b.world.particles.v = vec![[1.0, 2.0, 0.0], [3.0, 0.0, 4.0]].into();
        let c = b.compute(&Vacf, "").unwrap();
        c.declare(&mut b.world).unwrap();
        assert_eq!(b.evaluate(&*c).unwrap().vector, [5.0, 2.0, 8.0, 15.0]);
        b.world.particles.v = vec![[2.0, -1.0, 7.0], [0.0, 5.0, 0.5]].into();
        // By hand: (2 + 0)/2, (-2 + 0)/2, (0 + 2)/2.
        assert_eq!(b.evaluate(&*c).unwrap().vector, [1.0, -1.0, 1.0, 1.0]);
        assert!(b.compute(&Vacf, "com yes").is_err());
    }
}
