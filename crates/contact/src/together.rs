//! Evaluates several contacts of one law at a time. One by one, the wall of a drum takes a quarter of its
//! step and a bed of plastic grains a fifth.

use super::{Advance, Ends, Geometry, Granular, MOST_MEMORY, Motion, Wrench};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::{Lanes, load_rows, store_rows};
use perigrain_base::math::vec3::Vec3;

/// Fewer contacts are evaluated one by one, because the lanes would mostly repeat a contact.
const FEW: usize = 3;

/// Four numbers of a row.
const FOUR: usize = 4;

/// The two sides of some contacts.
pub(super) trait Met {
    /// The grain on the first side of contact `k`.
    fn own(&self, k: usize) -> u32;
    /// Motion of the second side.
    fn other(&self, k: usize) -> Motion;
    /// The grains on the second sides, if these are grains.
    fn others<const N: usize>(&self, k: [usize; N]) -> Option<[u32; N]>;
    /// Both sides, if these are grains; the first has the smaller tag.
    fn ends(&self, g: &Geometry, _k: usize) -> Ends {
        Ends::of(g)
    }
}

/// Contacts of one law.
pub(super) struct Together<'a, M> {
    pub law: &'a Granular,
    /// Geometry.
    pub geometry: &'a [Geometry],
    pub met: M,
    /// Velocities of all grains.
    pub v: &'a [Vec3],
    /// Angular velocities.
    pub omega: &'a [Vec3],
    /// Histories: rows of `width` numbers.
    pub history: &'a mut [f64],
    pub width: usize,
    /// Force and torques of each contact.
    pub wrenches: &'a mut [Wrench],
    pub step: Advance,
}

impl<M: Met> Together<'_, M> {
    /// Evaluates all contacts.
    pub fn evaluate(self) {
        let n = self.geometry.len();
        assert!(self.wrenches.len() == n && self.history.len() == n * self.width);
        if n >= FEW && self.width <= MOST_MEMORY {
            assert_eq!(self.v.len(), self.omega.len());
            // SAFETY: this processor supports its own form; the columns have one row per contact.
            return unsafe { Form::here().run(self) };
        }
        for (k, w) in self.wrenches.iter_mut().enumerate() {
            let i = self.met.own(k) as usize;
            let own = Motion { velocity: self.v[i], spin: self.omega[i] };
            let remembered = &mut self.history[k * self.width..][..self.width];
            let g = &self.geometry[k];
            let ends = if self.law.needs_ends() { self.met.ends(g, k) } else { Ends::none(0.0) };
            *w = self.law.contact_of(g, [&own, &self.met.other(k)], ends, remembered, self.step);
        }
    }

    /// Motion of grains.
    ///
    /// # Safety
    /// The processor must support the lanes.
    #[inline(always)]
    unsafe fn motion<const N: usize, V: Lanes<N>>(&self, grains: [u32; N]) -> Motion<V> {
        for grain in grains {
            assert!((grain as usize) < self.v.len());
        }
        let at = grains.as_ptr();
        // SAFETY: the caller's guarantee; these grains exist, and angular velocities have the same length.
        unsafe {
            Motion { velocity: V::vectors(self.v.as_ptr(), at), spin: V::vectors(self.omega.as_ptr(), at) }
        }
    }

    /// Motion of the second sides.
    ///
    /// # Safety
    /// As [`Together::motion`].
    #[inline(always)]
    unsafe fn other<const N: usize, V: Lanes<N>>(&self, k: [usize; N]) -> Motion<V> {
        // SAFETY: the caller's guarantee.
        unsafe {
            if let Some(grains) = self.met.others(k) {
                return self.motion(grains);
            }
            let (mut velocity, mut spin) = ([[0.0; N]; 3], [[0.0; N]; 3]);
            for lane in 0..N {
                let motion = self.met.other(k[lane]);
                for d in 0..3 {
                    velocity[d][lane] = motion.velocity[d];
                    spin[d][lane] = motion.spin[d];
                }
            }
            let ([a, b, c], [x, y, z]) = (velocity, spin);
            Motion { velocity: [V::of(a), V::of(b), V::of(c)], spin: [V::of(x), V::of(y), V::of(z)] }
        }
    }
}

impl<M: Met> InLanes for Together<'_, M> {
    type Out = ();

    /// There must be at least one contact, and one row per contact in each column.
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let (count, width) = (self.geometry.len(), self.width);
        let (geometry, history) = (self.geometry.as_ptr().cast_mut(), self.history.as_mut_ptr());
        let wrenches = self.wrenches.as_mut_ptr();
        for first in (0..count).step_by(N) {
            let (null, mut k, mut own) = (std::ptr::null_mut::<f64>(), [0; N], [0; N]);
            let (mut touch, mut past, mut done) = ([null; N], [null; N], [null; N]);
            for lane in 0..N {
                // Lanes without a contact repeat the last one and write identical values.
                k[lane] = (first + lane).min(count - 1);
                own[lane] = self.met.own(k[lane]);
                // SAFETY: each of these contacts has its rows. Geometry is only read.
                unsafe {
                    touch[lane] = geometry.add(k[lane]).cast();
                    past[lane] = history.add(k[lane] * width);
                    done[lane] = wrenches.add(k[lane]).cast();
                }
            }
            // SAFETY: the processor supports the form; a geometry is eight numbers, a wrench nine.
            unsafe {
                let [nx, ny, nz, overlap] = load_rows(&touch, 0);
                let [ri, rj, curvature, mass] = load_rows(&touch, FOUR);
                let g = Geometry { normal: [nx, ny, nz], overlap, radii: [ri, rj], curvature, mass };
                let (own, other) = (self.motion::<N, V>(own), self.other::<N, V>(k));
                let mut history = remembered::<N, V>(&past, width);
                let mut ends = Ends::none(overlap);
                if self.law.needs_ends() {
                    let mut inertia = [0.0; N];
                    for lane in 0..N {
                        inertia[lane] = self.met.ends(&self.geometry[k[lane]], k[lane]).inertia;
                    }
                    ends.inertia = V::of(inertia);
                }
                let w = self.law.contact_of(&g, [&own, &other], ends, &mut history[..width], self.step);
                remember(&past, &history[..width]);
                let ([a, b, c], [d, e, f], [x, y, z]) = (w.force, w.torque_i, w.torque_j);
                store_rows(&done, 0, [a, b, c, d]);
                store_rows(&done, FOUR, [e, f, x, y]);
                let z = z.numbers();
                for lane in 0..N {
                    *done[lane].add(2 * FOUR) = z[lane];
                }
            }
        }
    }
}

/// Start of the group of four, out of `width` numbers, that continues at `part`: the last group may repeat
/// some.
#[inline(always)]
fn four_of(width: usize, part: usize) -> usize {
    part.min(width - FOUR)
}

/// Histories: `width` numbers of each row, padded with zeros.
///
/// # Safety
/// The processor must support the lanes, and the rows must exist.
#[inline(always)]
unsafe fn remembered<const N: usize, V: Lanes<N>>(rows: &[*mut f64; N], width: usize) -> [V; MOST_MEMORY] {
    // SAFETY: the caller's guarantee.
    unsafe {
        let mut lanes = [V::all(0.0); MOST_MEMORY];
        if width < FOUR {
            for part in 0..width {
                let mut numbers = [0.0; N];
                for lane in 0..N {
                    numbers[lane] = *rows[lane].add(part);
                }
                lanes[part] = V::of(numbers);
            }
            return lanes;
        }
        for part in (0..width).step_by(FOUR) {
            let at = four_of(width, part);
            [lanes[at], lanes[at + 1], lanes[at + 2], lanes[at + 3]] = load_rows(rows, at);
        }
        lanes
    }
}

/// Writes histories back.
///
/// # Safety
/// As [`remembered`].
#[inline(always)]
unsafe fn remember<const N: usize, V: Lanes<N>>(rows: &[*mut f64; N], lanes: &[V]) {
    let width = lanes.len();
    // SAFETY: the caller's guarantee.
    unsafe {
        if width < FOUR {
            for part in 0..width {
                let numbers = lanes[part].numbers();
                for lane in 0..N {
                    *rows[lane].add(part) = numbers[lane];
                }
            }
            return;
        }
        for part in (0..width).step_by(FOUR) {
            let at = four_of(width, part);
            store_rows(rows, at, [lanes[at], lanes[at + 1], lanes[at + 2], lanes[at + 3]]);
        }
    }
}
