//! Temperatures after subtraction of a velocity bias.

use super::Compute;
use super::temp::{Rules, offer};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, sub};
use perigrain_plan::{Op, Stage, Tick, When};
use perigrain_styles::compute::TemperatureOption;
use perigrain_styles::matter::{Masses, check_masses, sum};
use perigrain_styles::step_op::{Wanted, fill_sums_if};
use perigrain_styles::words::Given;
use perigrain_styles::{BuildCx, Flow, SealCx, Shape};
use perigrain_world::field::{BOX, KIND, MASK, MASS, MEMO, REGIONS, TYPE_MASS, V, X};
use perigrain_world::{GroupId, Slot, SlotId, World};

/// The velocity subtracted from a particle of the group.
pub type Taken<'a> = Box<dyn Fn(usize) -> Vec3 + Sync + 'a>;

/// A velocity bias.
pub trait Streams: Clone + Send + Sync + 'static {
    /// The velocity subtracted from each particle in this step.
    fn taken<'a>(&'a self, w: &'a World, group: GroupId) -> Taken<'a>;

    /// Remaining degrees of freedom; `extra`: the number subtracted, if set by the deck.
    fn freedom(&self, w: &World, group: GroupId, extra: Option<f64>) -> f64;

    /// Components that are removed entirely.
    fn whole(&self) -> [bool; 3] {
        [false; 3]
    }

    /// Particles excluded with all their degrees of freedom; empty if none is.
    fn apart(&self, _w: &World) -> Vec<bool> {
        vec![]
    }

    /// Whether degrees of freedom change at every step and are recounted even where LAMMPS counts others
    /// once.
    fn counts_anew(&self) -> bool {
        false
    }

    /// The number of bins, if particle numbers and temperatures of bins are output instead of a tensor.
    fn bins(&self) -> usize {
        0
    }

    /// The bin of a particle.
    fn bin(&self, _w: &World, _i: usize) -> usize {
        0
    }

    /// The remaining degrees of freedom of a bin with `n` of all particles; `extra` as in `freedom`.
    fn freedom_of_bin(&self, _w: &World, _n: f64, _all: f64, _extra: Option<f64>) -> f64 {
        0.0
    }

    /// Whether the velocity subtracted depends only on sums over the group and on the particle itself.
    fn by_sums(&self) -> bool {
        true
    }

    /// Checks at the beginning of a run that everything the bias depends on exists.
    ///
    /// # Errors
    /// Whatever is missing.
    fn check(&self, _cx: &mut dyn SealCx) -> Result<()> {
        Ok(())
    }
}

/// 2 or 3.
pub fn dimension(w: &World) -> f64 {
    if w.settings.two_dimensional { 2.0 } else { 3.0 }
}

/// A temperature with a bias.
#[derive(Clone)]
pub struct Thermal<S> {
    id: String,
    group: GroupId,
    flow: S,
    rules: Rules,
}

impl<S: Streams> Thermal<S> {
    /// From the line of the deck.
    pub fn new(flow: S, cx: &BuildCx) -> Self {
        Self { id: cx.id.to_string(), group: cx.group, flow, rules: Rules::default() }
    }

    /// Number of particles and temperature of each bin.
    fn by_bin(&self, w: &World, taken: &Taken) -> Vec<f64> {
        let (p, masses, bit) = (&w.particles, Masses::of(w), self.group.bit());
        let mut rows = vec![[0.0; 2]; self.flow.bins()];
        for i in (0..w.n()).filter(|&i| p.mask[i] & bit != 0) {
            let ([x, y, z], row) = (sub(p.v[i], taken(i)), &mut rows[self.flow.bin(w, i)]);
            row[0] += 1.0;
            row[1] += masses.get(i) * (x * x + y * y + z * z);
        }
        let (c, all) = (w.settings.units.constants(), rows.iter().map(|r| r[0]).sum());
        let temperature = |n: f64, twice: f64| {
            let dof = self.flow.freedom_of_bin(w, n, all, self.rules.extra);
            if dof > 0.0 { twice * (c.mvv2e / (dof * c.boltz)) } else { 0.0 }
        };
        rows.into_iter().flat_map(|[n, twice]| [n, temperature(n, twice)]).collect()
    }
}

impl<S: Streams> Compute for Thermal<S> {
    fn shape(&self) -> Shape {
        let shape = Shape { scalar: true, flow: true, ..Shape::default() };
        match self.flow.bins() {
            0 => Shape { vector: 6, vector_extensive: true, ..shape },
            rows => Shape { array: 2, array_rows: rows, ..shape },
        }
    }

    fn op(&self, cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let span = cx.span();
        check_masses(cx.world(), span)?;
        self.flow.check(cx)?;
        let me = self.clone();
        let mut freedom = self.rules.freedom();
        let reads = X | V | MASS | MASK | REGIONS | BOX | MEMO | KIND | TYPE_MASS;
        let wanted = Wanted { slot, stage, when };
        let by_sums = self.flow.by_sums();
        let read = move |w: &World, t: &Tick, out: &mut Slot| {
            let (p, masses, taken) = (&w.particles, Masses::of(w), me.flow.taken(w, me.group));
            let tensor: [f64; 6] = sum(w, me.group, |i| {
                let ([x, y, z], m) = (sub(p.v[i], taken(i)), masses.get(i));
                [m * x * x, m * y * y, m * z * z, m * x * y, m * x * z, m * y * z]
            });
            let present = me.flow.freedom(w, me.group, me.rules.extra);
            let dof = if me.flow.counts_anew() { present } else { freedom.count(w, t, present, out) };
            offer(w, out, tensor[0] + tensor[1] + tensor[2], tensor, dof);
            if me.flow.bins() > 0 {
                (out.array, out.array_cols) = (me.by_bin(w, &taken), 2);
            }
            Ok(())
        };
        Ok(fill_sums_if(by_sums, &self.id, &wanted, reads, read))
    }

    fn flow(&self, w: &World) -> Option<Flow> {
        let (taken, mask, bit) = (self.flow.taken(w, self.group), &w.particles.mask, self.group.bit());
        let taken = (0..w.n()).map(|i| if mask[i] & bit != 0 { taken(i) } else { [0.0; 3] }).collect();
        Some(Flow { taken, group: self.group, whole: self.flow.whole(), apart: self.flow.apart(w) })
    }

    fn modify(&mut self, option: &Given<TemperatureOption>, _cx: &BuildCx) {
        self.rules.modify(option.value);
    }
}
