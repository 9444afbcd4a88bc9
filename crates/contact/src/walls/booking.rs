//! Data of wall contacts for other parts of the program: springs for the time step; stored energy and work
//! for the energy ledger.

use super::{Spheres, Touch, WallSweep, geometry};
use crate::Granular;
use perigrain_world::contacts::{Contacts, WallSpring, WallTouch};

impl WallSweep {
    /// The springs of the contacts of the last evaluation.
    pub fn springs(&self, grains: &Spheres, law: &Granular, memory: &Contacts) -> Vec<WallSpring> {
        let law = &law.on_wall();
        let spring = |(t, history): (&Touch, &[f64])| {
            let i = t.grain as usize;
            let g = geometry(&t.near, grains.radius[i], grains.mass[i]);
            let (tag, arm) = (grains.tag[i], t.near.distance);
            let [stiffness, damping] = law.resistance(&g, history);
            WallSpring { tag, normal: g.normal, stiffness, damping, arm }
        };
        self.touching.iter().zip(rows(memory)).map(spring).collect()
    }

    /// The contacts of the last evaluation with stored energy and work; `memory` is from that evaluation.
    pub fn touches(&self, grains: &Spheres, law: &Granular, memory: &Contacts) -> Vec<WallTouch> {
        let law = &law.on_wall();
        let touch = |((t, wrench), history): ((&Touch, &crate::Wrench), &[f64])| {
            let i = t.grain as usize;
            let stored = law.stored(&geometry(&t.near, grains.radius[i], grains.mass[i]), history);
            WallTouch {
                grain: t.grain,
                normal: t.near.normal,
                velocity: t.near.velocity,
                force: wrench.force,
                torque: wrench.torque_i,
                push: stored.push,
                stored: [stored.normal, stored.across],
                flows: stored.flows,
            }
        };
        self.contacts().zip(rows(memory)).map(touch).collect()
    }
}

/// The history of each contact.
fn rows(memory: &Contacts) -> impl Iterator<Item = &[f64]> {
    (0..).map(|k| memory.history.get(k * memory.width..(k + 1) * memory.width).unwrap_or(&[]))
}
