//! compute temp/sphere: temperature of spheres with translation and rotation.

use super::erotate_sphere::{INERTIA, needs_spheres};
use super::temp::{Rules, offer};
use super::{Compute, ComputeStyle, temp_flow};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::sub;
use perigrain_lang::{Args, ValueRef};
use perigrain_plan::{Op, Stage, Tick, When};
use perigrain_styles::compute::TemperatureOption;
use perigrain_styles::matter::sum;
use perigrain_styles::step_op::{Wanted, fill_sums_if};
use perigrain_styles::words::{Given, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, Flow, SealCx, Shape, Style};
use perigrain_world::field::{BOX, KIND, MASK, MASS, MEMO, OMEGA, RADIUS, REGIONS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, Slot, SlotId, World};

/// The style.
pub struct TempSphere;

impl Style for TempSphere {
    fn name(&self) -> &'static str {
        "temp/sphere"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Temperature of the group's translation and rotation, or of rotation alone.",
            text: "Scalar (intensive): T = Σ (m v² + I ω²)/(dof k_B) with I = 2/5 m R². Each sphere has 6 degrees of \
                   freedom (in two dimensions 3), of rotation alone 3 (1); a particle without a radius only those of its \
                   translation. `extra/dof` of compute_modify is taken off, with `dof all` 3 (2) unless it is given, with \
                   `dof rotate` nothing. 0 where no freedom is left. Vector of 6 \
                   (extensive): Σ (m v_a v_b + I ω_a ω_b) for xx yy zz xy xz yz, in energy units. Spheres are counted anew at \
                   each use (see `compute temp`).\n\n\
                   Under a `bias` a component that is taken away whole counts for no degree of freedom, nor do particles outside the \
                   region. `velocity … temp ID bias yes` then leaves this flow as it is, and compute pressure has the rest as its kinetic part.",
            example: "compute drift all temp/com\ncompute t all temp/sphere bias drift",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(keyword)]
    dof: Freedom,
    /// The flow that this compute temp/com, temp/deform, temp/partial, temp/profile, temp/ramp or temp/region of the same group
    /// takes away from velocities does not count here either.
    #[word(keyword, name = "ID", with = temp_flow::named, kind = Kind::Compute)]
    bias: Option<ValueRef>,
}

/// The degrees of freedom that count.
#[derive(Clone, Copy, Default, PartialEq, Words)]
#[word(what = "value of dof")]
enum Freedom {
    /// Those of translation and rotation.
    #[default]
    All,
    /// Those of rotation alone.
    Rotate,
}

impl ComputeStyle for TempSphere {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        needs_spheres(self.name(), cx)?;
        let Line { dof, bias } = read(args, cx)?;
        let (id, rules, rotate) = (cx.id.to_string(), Rules::default(), dof == Freedom::Rotate);
        Ok(Box::new(Declared { id, group: cx.group, rotate, bias, rules }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    /// Rotation only.
    rotate: bool,
    /// The temperature compute whose bias is subtracted.
    bias: Option<ValueRef>,
    rules: Rules,
}

impl Declared {
    /// Degrees of freedom. Components removed entirely by the bias `flow` and excluded particles have none.
    fn freedom(&self, w: &World, flow: Option<&Flow>) -> f64 {
        let taken = flow.map_or(0.0, |f| f.whole.iter().filter(|d| **d).count() as f64);
        let apart = |i: usize| flow.is_some_and(|f| f.apart.get(i) == Some(&true));
        let flat = w.settings.two_dimensional;
        let (fly, spin) = if flat { (2.0 - taken, 1.0) } else { (3.0 - taken, 3.0) };
        let fly = if self.rotate { 0.0 } else { fly };
        let p = &w.particles;
        let [count] = sum(w, self.group, |i| match p.radius[i] > 0.0 {
            _ if apart(i) => [0.0],
            true => [fly + spin],
            false => [fly],
        });
        let centre = if flat { 2.0 } else { 3.0 };
        // LAMMPS subtracts the motion of the centre only if translation counts.
        count - self.rules.extra.unwrap_or(if self.rotate { 0.0 } else { centre })
    }
}

impl Compute for Declared {
    fn shape(&self) -> Shape {
        let flow = self.bias.is_some();
        Shape { scalar: true, vector: 6, vector_extensive: true, flow, ..Shape::default() }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let me = self.clone();
        let bias = match &self.bias {
            Some(r) => Some(temp_flow::of_group(r, self.group, cx)?),
            None => None,
        };
        let mut freedom = self.rules.freedom();
        let reads = X | V | OMEGA | RADIUS | MASS | MASK | BOX | MEMO | REGIONS | KIND | TYPE_MASS;
        let wanted = Wanted { slot, stage, when };
        // A bias needs all particles.
        let by_sums = bias.is_none();
        let read = move |w: &World, t: &Tick, out: &mut Slot| {
            let p = &w.particles;
            let flow = bias.as_ref().and_then(|b| b.flow(w));
            let tensor: [f64; 6] = sum(w, me.group, |i| {
                let v = flow.as_ref().map_or(p.v[i], |f| sub(p.v[i], f.taken[i]));
                let (o, m) = (p.omega[i], p.mass[i]);
                let fly = if me.rotate { 0.0 } else { m };
                let spin = INERTIA * m * p.radius[i] * p.radius[i];
                let pair = |a: usize, b: usize| fly * v[a] * v[b] + spin * o[a] * o[b];
                [pair(0, 0), pair(1, 1), pair(2, 2), pair(0, 1), pair(0, 2), pair(1, 2)]
            });
            let present = me.freedom(w, flow.as_ref());
            let anew = flow.is_some_and(|f| !f.apart.is_empty());
            let dof = if anew { present } else { freedom.count(w, t, present, out) };
            let twice = tensor[0] + tensor[1] + tensor[2];
            offer(w, out, twice, tensor, dof);
            Ok(())
        };
        Ok(fill_sums_if(by_sums, &self.id, &wanted, reads, read))
    }

    fn bias(&self) -> Option<&ValueRef> {
        self.bias.as_ref()
    }

    fn modify(&mut self, option: &Given<TemperatureOption>, _cx: &BuildCx) {
        self.rules.modify(option.value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::compute::modify;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn freedom_of_points_and_spheres() {
        let mut b = Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[0.0; 3]; 3]);
        b.world.particles.radius = vec![0.5, 0.0, 1.0].into();
        b.world.particles.v[0] = [1.0, 2.0, 0.0];
        b.world.particles.omega[2] = [0.0, 0.0, 3.0];
        let whole = b.compute(&TempSphere, "").unwrap();
        // m = 2: Σ m v² = 10, Σ I ω² = 0.8 · 9 = 7.2; 2 · 6 + 3 − 3 degrees of freedom; rotation only 2 · 3.
        let slot = b.evaluate(&*whole).unwrap();
        assert!((slot.scalar - 17.2 / 12.0).abs() < 1e-14 && slot.vector[3] == 4.0);
        let mut spin = b.compute(&TempSphere, "dof rotate").unwrap();
        assert!((b.evaluate(&*spin).unwrap().scalar - 7.2 / 6.0).abs() < 1e-14);
        b.modify("extra/dof 3", |a, cx| modify(&mut *spin, a, cx)).unwrap();
        assert!((b.evaluate(&*spin).unwrap().scalar - 7.2 / 3.0).abs() < 1e-14);
        for words in ["dof", "dof some", "bias", "bias q", "mass 3"] {
            assert!(b.compute(&TempSphere, words).is_err(), "{words}");
        }
    }
}
