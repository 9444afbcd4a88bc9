//! What touching spheres do, several contacts of one law at a time: one by one a drum's wall takes a quarter of its step, a bed of
//! plastic grains a fifth.

use super::{Advance, ContactLaw, Geometry, MOST_MEMORY, Motion, Wrench};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::Lanes;

/// Fewer contacts are evaluated one by one.
const FEW: usize = 3;

/// Contacts of one law.
pub(super) struct Together<'a, L, M> {
    pub law: &'a L,
    /// Where and how contact k touches: geometry, how the first and the second side move.
    pub met: M,
    /// What each contact remembers: rows of `width` numbers.
    pub history: &'a mut [f64],
    pub width: usize,
    /// What each contact does.
    pub wrenches: &'a mut [Wrench],
    pub step: Advance,
}

impl<L: ContactLaw, M: FnMut(usize) -> (Geometry, [Motion; 2])> Together<'_, L, M> {
    /// Evaluates them all.
    pub fn evaluate(mut self) {
        if self.wrenches.len() >= FEW && self.width <= MOST_MEMORY {
            // SAFETY: this processor has what its own form needs.
            return unsafe { Form::here().run(self) };
        }
        for (k, w) in self.wrenches.iter_mut().enumerate() {
            let (geometry, [own, other]) = (self.met)(k);
            let remembered = &mut self.history[k * self.width..][..self.width];
            *w = self.law.contact(&geometry, &own, &other, remembered, self.step);
        }
    }
}

/// Lanes of numbers by contact.
struct Gathered<const N: usize> {
    normal: [[f64; N]; 3],
    overlap: [f64; N],
    radii: [[f64; N]; 2],
    curvature: [f64; N],
    mass: [f64; N],
    velocity: [[[f64; N]; 3]; 2],
    spin: [[[f64; N]; 3]; 2],
    history: [[f64; N]; MOST_MEMORY],
}

impl<const N: usize> Gathered<N> {
    /// With nothing in the lanes.
    #[inline(always)]
    fn new() -> Self {
        Self {
            normal: [[0.0; N]; 3],
            overlap: [0.0; N],
            radii: [[0.0; N]; 2],
            curvature: [0.0; N],
            mass: [0.0; N],
            velocity: [[[0.0; N]; 3]; 2],
            spin: [[[0.0; N]; 3]; 2],
            history: [[0.0; N]; MOST_MEMORY],
        }
    }

    /// A contact in a lane.
    #[inline(always)]
    fn take(&mut self, lane: usize, (g, motions): (Geometry, [Motion; 2]), remembered: &[f64]) {
        for d in 0..3 {
            self.normal[d][lane] = g.normal[d];
            for side in 0..2 {
                self.velocity[side][d][lane] = motions[side].velocity[d];
                self.spin[side][d][lane] = motions[side].spin[d];
            }
        }
        self.overlap[lane] = g.overlap;
        self.radii[0][lane] = g.radii[0];
        self.radii[1][lane] = g.radii[1];
        self.curvature[lane] = g.curvature;
        self.mass[lane] = g.mass;
        for (part, number) in remembered.iter().enumerate() {
            self.history[part][lane] = *number;
        }
    }

    /// How one side moves.
    ///
    /// # Safety
    /// The processor must have what the lanes need.
    #[inline(always)]
    unsafe fn motion<V: Lanes<N>>(&self, side: usize) -> Motion<V> {
        let ([a, b, c], [x, y, z]) = (self.velocity[side], self.spin[side]);
        // SAFETY: passed on.
        unsafe { Motion { velocity: [V::of(a), V::of(b), V::of(c)], spin: [V::of(x), V::of(y), V::of(z)] } }
    }
}

impl<L: ContactLaw, M: FnMut(usize) -> (Geometry, [Motion; 2])> InLanes for Together<'_, L, M> {
    type Out = ();

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(mut self) {
        let (count, width) = (self.wrenches.len(), self.width);
        // Each group writes all of its lanes.
        let mut all = Gathered::<N>::new();
        for first in (0..count).step_by(N) {
            for lane in 0..N {
                // Lanes without a contact repeat the last one.
                let k = (first + lane).min(count - 1);
                all.take(lane, (self.met)(k), &self.history[k * width..][..width]);
            }
            // SAFETY: the processor has what the form needs.
            let (wrench, history) = unsafe {
                let [x, y, z] = all.normal;
                let geometry = Geometry {
                    normal: [V::of(x), V::of(y), V::of(z)],
                    overlap: V::of(all.overlap),
                    radii: [V::of(all.radii[0]), V::of(all.radii[1])],
                    curvature: V::of(all.curvature),
                    mass: V::of(all.mass),
                };
                let (own, other) = (all.motion::<V>(0), all.motion::<V>(1));
                let mut history = [V::all(0.0); MOST_MEMORY];
                for part in 0..width {
                    history[part] = V::of(all.history[part]);
                }
                (self.law.contact(&geometry, &own, &other, &mut history[..width], self.step), history)
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
