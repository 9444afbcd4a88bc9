//! Buffers of a batch: data that groups of contacts pass from stage to stage, and vectors to be added to
//! memory.

use super::GROUPS;
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::pair::Pair;
use perigrain_base::math::vec3::Vec3;
use std::mem::MaybeUninit;

/// A buffer with one value per group, not cleared: that would take longer than the contacts of a small slab.
pub(super) struct Room<T>(MaybeUninit<[T; GROUPS]>);

impl<T: Copy> Room<T> {
    /// An empty buffer.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self(MaybeUninit::uninit())
    }

    /// # Safety
    /// `group` must be below the number of groups.
    #[inline(always)]
    pub(super) unsafe fn put(&mut self, group: usize, value: T) {
        debug_assert!(group < GROUPS);
        // SAFETY: the caller's guarantee.
        unsafe { self.0.as_mut_ptr().cast::<T>().add(group).write(value) }
    }

    /// # Safety
    /// A value must have been put there.
    #[inline(always)]
    pub(super) unsafe fn at(&self, group: usize) -> &T {
        // SAFETY: the caller's guarantee.
        unsafe { &*self.0.as_ptr().cast::<T>().add(group) }
    }
}

/// Vectors in lanes, arranged for output: x and y interleaved, of lanes 0, 2, 4 … and of lanes 1, 3, 5 …, and
/// z.
#[derive(Clone, Copy)]
pub(super) struct Outgoing<const N: usize> {
    pub(super) xy: [[f64; N]; 2],
    pub(super) z: [f64; N],
}

impl<const N: usize> Outgoing<N> {
    #[inline(always)]
    pub(super) fn of<V: Lanes<N>>([x, y, z]: Vec3<V>) -> Self {
        let [even, odd] = V::pairs(x, y);
        Self { xy: [even.numbers(), odd.numbers()], z: z.numbers() }
    }

    #[inline(always)]
    pub(super) unsafe fn lane<P: Pair>(&self, lane: usize) -> (P, f64) {
        // SAFETY: two numbers in one row of the array.
        let xy = unsafe { P::load(self.xy.as_ptr().cast::<f64>().add(lane % 2 * N + lane / 2 * 2)) };
        (xy, self.z[lane])
    }

    /// The vector of a lane.
    #[inline(always)]
    pub(super) fn numbers(&self, lane: usize) -> Vec3 {
        let xy = &self.xy[lane % 2][lane / 2 * 2..];
        [xy[0], xy[1], self.z[lane]]
    }

    /// Adds the vector of a lane to the row of grain `i`.
    #[inline(always)]
    pub(super) unsafe fn add<P: Pair>(&self, to: *mut f64, lane: usize, i: u32) {
        // SAFETY: the caller's guarantee.
        unsafe {
            let ((xy, z), to) = (self.lane::<P>(lane), to.add(3 * i as usize));
            xy.add_to(to);
            *to.add(2) += z;
        }
    }

    /// Adds the vector of a lane to the row of grain `i` and subtracts it from that of grain `j`.
    #[inline(always)]
    pub(super) unsafe fn act<P: Pair>(&self, to: *mut f64, lane: usize, i: u32, j: u32) {
        // SAFETY: the caller's guarantee.
        unsafe {
            let (xy, z) = self.lane::<P>(lane);
            let (to, from) = (to.add(3 * i as usize), to.add(3 * j as usize));
            xy.add_to(to);
            *to.add(2) += z;
            xy.take_from(from);
            *from.add(2) -= z;
        }
    }
}
