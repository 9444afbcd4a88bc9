//! Touching pairs of short lists, found several at a time.

use super::lists::{FILL, Short};
use super::near::Places;
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::vec3::Vec3;
use std::mem::MaybeUninit;
use std::ops::Range;

/// Maximum number of hits, and the number of pairs tested at a time.
pub(super) const ROOM: usize = 256;

/// Whole lanes can be read from any of them.
const ROW: usize = ROOM + FILL;

/// Touching pairs: their numbers in the short list, and the vectors between their centres.
pub(super) struct Found {
    count: usize,
    // Not cleared: that would take longer than testing a short list.
    numbers: MaybeUninit<[u32; ROOM]>,
    /// x_i − x_j, coordinate by coordinate [length].
    apart: MaybeUninit<[[f64; ROW]; 3]>,
}

impl Found {
    /// Empty. Written field by field: a constant would be copied as a whole, buffers included.
    #[inline(always)]
    pub fn new() -> Self {
        let mut new = MaybeUninit::<Self>::uninit();
        // SAFETY: the other fields need no initial value.
        unsafe {
            (&raw mut (*new.as_mut_ptr()).count).write(0);
            new.assume_init()
        }
    }

    /// The number of pairs.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.count
    }

    /// Their numbers in the short list.
    #[inline(always)]
    pub fn numbers(&self) -> &[u32] {
        // SAFETY: this many have been written.
        unsafe { std::slice::from_raw_parts(self.numbers.as_ptr().cast(), self.count) }
    }

    /// Start of the column of x_i − x_j along an axis: one number per pair, followed by room for spare lanes.
    #[inline(always)]
    pub fn apart(&self, d: usize) -> *const f64 {
        debug_assert!(d < 3);
        // SAFETY: one of three rows.
        unsafe { self.apart.as_ptr().cast::<f64>().add(d * ROW) }
    }

    /// Empties it.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Moves the pairs for which `stays` holds to the front, in their order; returns their number.
    pub fn sift(&mut self, mut stays: impl FnMut(u32) -> bool) -> usize {
        let mut kept = 0;
        for at in 0..self.count {
            if stays(self.numbers()[at]) {
                self.shift(at, kept);
                kept += 1;
            }
        }
        kept
    }

    /// Copies a pair to the position of an earlier one.
    fn shift(&mut self, from: usize, at: usize) {
        assert!(from < self.count && at <= from);
        let (numbers, apart) = (self.numbers.as_mut_ptr(), self.apart.as_mut_ptr());
        // SAFETY: both positions have been written.
        unsafe {
            (*numbers)[at] = (*numbers)[from];
            (0..3).for_each(|d| (*apart)[d][at] = (*apart)[d][from]);
        }
    }

    /// Tests some pairs of the short list, and takes those with gaps below `span`; `ALIKE`: all grains have
    /// one known radius.
    ///
    /// # Safety
    /// The range must hold whole groups of pairs of the list, and there must be room for them; list entries
    /// must be grains.
    #[inline(always)]
    pub unsafe fn test<const N: usize, V: Lanes<N>, const ALIKE: bool>(
        &mut self,
        short: &Short,
        at: &Places,
        span: f64,
        pairs: Range<usize>,
    ) {
        let (numbers, apart) =
            (self.numbers.as_mut_ptr().cast::<u32>(), self.apart.as_mut_ptr().cast::<f64>());
        let mut count = self.count;
        for k in pairs.step_by(N) {
            // SAFETY: the caller's guarantee; with different radii each pair has its reach. There is room for
            // all lanes; the next ones overwrite what is beyond `count`.
            unsafe {
                let (i, w) = (short.i.as_ptr().add(k), short.w.as_ptr().add(k));
                let [x, y, z]: Vec3<V> = V::apart(at.x.as_ptr(), i, w, at.shifts);
                let reach = match at.alike {
                    Some(r) if ALIKE => {
                        let reach = V::all(r + r) + span;
                        reach * reach
                    }
                    _ => V::of(short.reach.as_ptr().add(k).cast::<[f64; N]>().read()),
                };
                let near = reach.above(x * x + y * y + z * z);
                x.pack(near, apart.add(count));
                y.pack(near, apart.add(ROW + count));
                z.pack(near, apart.add(2 * ROW + count));
                count += V::put(near, k as u32, numbers.add(count));
            }
        }
        self.count = count;
    }
}
