//! What contacts of grains tell the ledger of energy: what they do beside their elastic forces.

use super::{Grains, Rules, Sweep};
use crate::{Geometry, Granular, Wrench};
use perigrain_base::math::vec3::{dot, scale, sub};
use perigrain_world::contacts::{Contacts, PairTouch};

/// A contact as the ledger books it; `history` is what it remembers after it has acted, `share` the part of the law's force that
/// counts.
pub(crate) fn touch(
    ends: [u32; 2],
    (law, share): (&Granular, f64),
    g: &Geometry,
    history: &[f64],
    w: &Wrench,
) -> PairTouch {
    let [push, held] = law.pressing(g, history).map(|a| share * a);
    let (central, pressing) = (dot(w.force, g.normal), if law.flows() { push } else { 0.0 });
    PairTouch {
        ends,
        damping: scale(central - push, g.normal),
        across: sub(w.force, scale(central, g.normal)),
        torques: [w.torque_i, w.torque_j],
        pressing: scale(pressing, g.normal),
        held,
    }
}

impl Sweep {
    /// Adds the contacts of the last evaluation with what they do; `memory` is that of this evaluation.
    pub fn tell(&self, grains: &Grains, rules: &Rules, memory: &Contacts, all: &mut Vec<PairTouch>) {
        self.each(grains, rules, memory, |c| {
            let ends = [c.pair.i, c.pair.j];
            all.push(touch(ends, (c.law, c.share), &c.geometry, c.history, c.wrench));
        });
    }
}
