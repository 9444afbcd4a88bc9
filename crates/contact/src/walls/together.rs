//! What touching spheres do, several contacts at a time: one by one a drum's wall takes a quarter of its step.

use super::{Spheres, Touch, geometry};
use crate::fast::InLanes;
use crate::{Advance, ContactLaw, Geometry, MOST_MEMORY, Motion, Wrench};
use perigrain_base::math::lanes::Lanes;

/// Contacts of one law.
pub(super) struct Together<'a, L> {
    pub law: &'a L,
    pub grains: &'a Spheres<'a>,
    pub touching: &'a [Touch],
    /// What each contact remembers: rows of as many numbers as the law asks for, [`MOST_MEMORY`] at most.
    pub history: &'a mut [f64],
    /// What each contact does.
    pub wrenches: &'a mut [Wrench],
    pub step: Advance,
}

/// Lanes of numbers by contact.
struct Gathered<const N: usize> {
    grain: [u32; N],
    normal: [[f64; N]; 3],
    overlap: [f64; N],
    radius: [f64; N],
    curvature: [f64; N],
    mass: [f64; N],
    /// Of the wall.
    velocity: [[f64; N]; 3],
    history: [[f64; N]; MOST_MEMORY],
}

impl<const N: usize> Gathered<N> {
    /// Contact `k` in a lane.
    #[inline(always)]
    fn take<L>(&mut self, lane: usize, all: &Together<L>, k: usize, width: usize) {
        let touch = &all.touching[k];
        let i = touch.grain as usize;
        let g = geometry(&touch.near, all.grains.radius[i], all.grains.mass[i]);
        self.grain[lane] = touch.grain;
        for d in 0..3 {
            self.normal[d][lane] = g.normal[d];
            self.velocity[d][lane] = touch.near.velocity[d];
        }
        self.overlap[lane] = g.overlap;
        self.radius[lane] = g.radii[0];
        self.curvature[lane] = g.curvature;
        self.mass[lane] = g.mass;
        for part in 0..width {
            self.history[part][lane] = all.history[k * width + part];
        }
    }
}

impl<L: ContactLaw> InLanes for Together<'_, L> {
    type Out = ();

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let (count, width) = (self.touching.len(), self.law.memory());
        for first in (0..count).step_by(N) {
            let mut all = Gathered {
                grain: [0; N],
                normal: [[0.0; N]; 3],
                overlap: [0.0; N],
                radius: [0.0; N],
                curvature: [0.0; N],
                mass: [0.0; N],
                velocity: [[0.0; N]; 3],
                history: [[0.0; N]; MOST_MEMORY],
            };
            for lane in 0..N {
                // Lanes without a contact repeat the last one.
                all.take(lane, &self, (first + lane).min(count - 1), width);
            }
            // SAFETY: the processor has what the form needs; grains are particles.
            let (wrench, history) = unsafe {
                let [x, y, z] = all.normal;
                let geometry = Geometry {
                    normal: [V::of(x), V::of(y), V::of(z)],
                    overlap: V::of(all.overlap),
                    radii: [V::of(all.radius), V::all(0.0)],
                    curvature: V::of(all.curvature),
                    mass: V::of(all.mass),
                };
                let (v, spin) = (self.grains.v.as_ptr(), self.grains.omega.as_ptr());
                let grain = all.grain.as_ptr();
                let own = Motion { velocity: V::vectors(v, grain), spin: V::vectors(spin, grain) };
                let [x, y, z] = all.velocity;
                let wall = Motion { velocity: [V::of(x), V::of(y), V::of(z)], spin: [V::all(0.0); 3] };
                let mut history = [V::all(0.0); MOST_MEMORY];
                for part in 0..width {
                    history[part] = V::of(all.history[part]);
                }
                (self.law.contact(&geometry, &own, &wall, &mut history[..width], self.step), history)
            };
            let past = &mut self.history[first * width..(first + N).min(count) * width];
            for part in 0..width {
                let numbers = history[part].numbers();
                for lane in 0..N.min(count - first) {
                    past[lane * width + part] = numbers[lane];
                }
            }
            for d in 0..3 {
                let (force, own, other) =
                    (wrench.force[d].numbers(), wrench.torque_i[d].numbers(), wrench.torque_j[d].numbers());
                for lane in 0..N.min(count - first) {
                    let w = &mut self.wrenches[first + lane];
                    (w.force[d], w.torque_i[d], w.torque_j[d]) = (force[lane], own[lane], other[lane]);
                }
            }
        }
    }
}
