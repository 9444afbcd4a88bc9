//! Heat through the contacts of the fast loop.

use super::lists::{Short, weights};
use super::near::{Places, near};
use super::{Fast, NONE};
use crate::driver::Grains;
use crate::{ContactLaw, Geometry};
use perigrain_base::math::lanes::place;
use perigrain_base::par;

impl<L: ContactLaw> Fast<L> {
    /// Adds the heat that flows through the contacts of the last evaluation to `flow` [energy/time], from the temperatures of
    /// all grains, in the order of `grains`.
    ///
    /// # Panics
    /// If there is not a number for each grain.
    pub fn conduct(&self, grains: &Grains, temperature: &[f64], flow: &mut [f64]) {
        assert!(
            temperature.len() == grains.x.len() && flow.len() == grains.x.len(),
            "a number for each grain"
        );
        let flow = par::Shared::new(flow);
        self.each_list(&weights(&self.lists), |k| {
            let short = &self.lists[k].short;
            let mut hits = vec![];
            // SAFETY: list entries are grains; the processor has what its form needs.
            unsafe { near(self.form, grains, &self.shifts, [&short.i, &short.w], self.span, &mut hits) };
            for k in hits {
                let (i, j) = (short.i[k as usize] as usize, place(short.w[k as usize]));
                let Some(conductance) = self.conductance(grains, short, k as usize) else { continue };
                let into = conductance * (temperature[j] - temperature[i]);
                // SAFETY: both are grains of this slab and the next one, which each_list keeps apart.
                unsafe {
                    flow.get(i..i + 1)[0] += into;
                    flow.get(j..j + 1)[0] -= into;
                }
            }
        });
    }

    /// That of pair `k` of a short list, if its grains touch, or stick together, and conduct.
    fn conductance(&self, grains: &Grains, short: &Short, k: usize) -> Option<f64> {
        let (i, w) = (short.i[k] as usize, short.w[k]);
        let at = Places::new(grains, &self.shifts);
        let (j, d) = (place(w), at.between(i, w));
        let which = self.laws.which(grains.kind[i], grains.kind[j]);
        let law = self.laws.distinct.get(usize::from(which)).filter(|_| which != NONE)?;
        let radii = [grains.radius[i], grains.radius[j]];
        // Who has touched in the last evaluation carries its number: before or after that was counted on.
        let lasts = short.history[(k + 1) * self.width - 1] == self.now;
        let gap = if lasts { law.gap(radii[0] * radii[1] / (radii[0] + radii[1])) } else { 0.0 };
        // No conductance depends on masses.
        law.conductance(&Geometry::of_spheres(d, radii, [1.0; 2], gap)?)
    }
}
