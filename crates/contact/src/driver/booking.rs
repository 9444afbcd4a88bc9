//! Contributions of grain contacts to the energy ledger: work apart from their elastic forces.

use super::{Grains, Rules, Sweep};
use perigrain_base::math::vec3::{add, dot, scale, sub};
use perigrain_world::contacts::{Contacts, PairWork};

impl Sweep {
    /// Adds the contributions of the last evaluation; `memory` is from that evaluation.
    pub fn book(&self, grains: &Grains, rules: &Rules, memory: &Contacts, all: &mut PairWork) {
        self.each(grains, rules, memory, |c| {
            let (i, j, n) = (c.pair.i as usize, c.pair.j as usize, c.geometry.normal);
            let [push, held] = c.law.pressing(&c.geometry, c.history).map(|a| c.share * a);
            let central = dot(c.wrench.force, n);
            let damping = scale(central - push, n);
            let across = sub(c.wrench.force, scale(central, n));
            for (sums, force) in [(&mut all.damping, damping), (&mut all.across, across)] {
                sums[i] = add(sums[i], force);
                sums[j] = sub(sums[j], force);
            }
            all.torque[i] = add(all.torque[i], c.wrench.torque_i);
            all.torque[j] = add(all.torque[j], c.wrench.torque_j);
            if c.law.flows() {
                all.pressing[i] = add(all.pressing[i], scale(push, n));
                all.pressing[j] = sub(all.pressing[j], scale(push, n));
                all.held += held;
            }
        });
    }
}
