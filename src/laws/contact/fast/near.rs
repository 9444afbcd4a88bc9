//! Which pairs of a list are near each other, four at a time.

use super::has_avx2;
use crate::laws::contact::driver::Grains;
use crate::math::four::{Four, Plain};
use crate::math::vec3::Vec3;
use crate::neigh::slabs::Run;

/// Bits of a list entry that hold a grain; the image stands above them.
pub const PLACE_BITS: u32 = 27;
/// How far the image is shifted.
pub const HERE_BITS: u32 = PLACE_BITS;

/// By bits of a mask: the lanes that are set, in order.
const LANES: [[u32; 4]; 16] = lanes();

/// By bits of a mask, four bits each: how many lanes are set.
const COUNTS: u64 = 0x4332_3221_3221_2110;

const fn lanes() -> [[u32; 4]; 16] {
    let (mut table, mut bits) = ([[0; 4]; 16], 0);
    while bits < 16 {
        let (mut lane, mut count) = (0, 0);
        while lane < 4 {
            if bits >> lane & 1 == 1 {
                table[bits][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
}

/// The grain in a list entry.
#[inline(always)]
pub fn grain(w: u32) -> usize {
    (w & ((1 << PLACE_BITS) - 1)) as usize
}

/// Adds the numbers of those pairs of a list, filled up to fours, to `out` whose surfaces are nearer than `reach`, in order.
///
/// # Safety
/// List entries must be grains.
pub unsafe fn near(
    grains: &Grains,
    shifts: &[[f64; 4]; 32],
    list: [&[u32]; 2],
    reach: f64,
    out: &mut Vec<u32>,
) {
    let at = Places { x: grains.x, radius: grains.radius, shifts };
    // SAFETY: passed on.
    unsafe {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            return near_avx2(at, list, reach, out);
        }
        near_in::<Plain>(at, list, reach, out);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn near_avx2(at: Places, list: [&[u32]; 2], reach: f64, out: &mut Vec<u32>) {
    // SAFETY: passed on.
    unsafe { near_in::<crate::math::four::Avx2>(at, list, reach, out) }
}

#[inline(always)]
unsafe fn near_in<F: Four>(at: Places, [i, w]: [&[u32]; 2], reach: f64, out: &mut Vec<u32>) {
    for k in (0..i.len()).step_by(4) {
        // SAFETY: lists are filled up to fours; entries are grains.
        let bits = unsafe { at.closer::<F>(i.as_ptr().add(k), w.as_ptr().add(k), reach) };
        if out.capacity() - out.len() < 4 {
            out.reserve(4);
        }
        // SAFETY: there is room for four; those that are no hits are behind the end.
        unsafe {
            put(out.as_mut_ptr().add(out.len()), bits, k as u32);
            out.set_len(out.len() + count(bits));
        }
    }
}

/// Puts `first` and the numbers of the lanes that are set, and something behind them.
///
/// # Safety
/// There must be room for four.
#[inline(always)]
pub unsafe fn put(to: *mut u32, bits: u32, first: u32) {
    let [a, b, c, d] = LANES[bits as usize & 15];
    // SAFETY: the caller's promise.
    unsafe { to.cast::<[u32; 4]>().write([first + a, first + b, first + c, first + d]) }
}

/// How many of four lanes are set.
#[inline(always)]
pub fn count(bits: u32) -> usize {
    (COUNTS >> (4 * bits) & 15) as usize
}

/// Grains in the order of places, coordinate by coordinate.
pub(super) struct InOrder {
    x: [Vec<f64>; 3],
    radius: Vec<f64>,
}

impl InOrder {
    /// Copies the grains in this order.
    pub fn new(grains: &Grains, order: &[u32]) -> Self {
        // What is read beyond the end is not used.
        let pick = |of: &dyn Fn(usize) -> f64| {
            let mut list = Vec::with_capacity(order.len() + 4);
            list.extend(order.iter().map(|&i| of(i as usize)));
            list.extend([0.0; 4]);
            list
        };
        let x = [0, 1, 2].map(|d| pick(&|i| grains.x[i][d]));
        Self { x, radius: pick(&|i| grains.radius[i]) }
    }

    /// Calls `hit` with those places of a run, shifted, whose surfaces are nearer than `skin` to that of place `i`, in order.
    ///
    /// # Safety
    /// The processor must have what the form needs.
    #[inline(always)]
    pub unsafe fn near<F: Four>(
        &self,
        i: usize,
        run: &Run,
        shift: &[f64; 4],
        skin: f64,
        mut hit: impl FnMut(usize),
    ) {
        let ([x, y, z], r) = (&self.x, &self.radius);
        let (mut from, end) = (run.from as usize, (run.to as usize).min(r.len() - 4));
        while from < end {
            // SAFETY: `from` is a place, and behind the last one there is room for four more.
            let bits = unsafe {
                let dx = F::splat(x[i]) - (F::load(x.as_ptr().add(from)) + shift[0]);
                let dy = F::splat(y[i]) - (F::load(y.as_ptr().add(from)) + shift[1]);
                let dz = F::splat(z[i]) - (F::load(z.as_ptr().add(from)) + shift[2]);
                let reach = F::splat(r[i]) + F::load(r.as_ptr().add(from)) + skin;
                F::bits((reach * reach).above(dx * dx + dy * dy + dz * dz))
            };
            let mut bits = bits & ((1 << (end - from).min(4)) - 1);
            while bits != 0 {
                hit(from + bits.trailing_zeros() as usize);
                bits &= bits - 1;
            }
            from += 4;
        }
    }
}

/// Where grains are.
#[derive(Clone, Copy)]
pub(super) struct Places<'a> {
    /// Positions.
    pub x: &'a [Vec3],
    /// Radii.
    pub radius: &'a [f64],
    /// How far each image is shifted.
    pub shifts: &'a [[f64; 4]; 32],
}

impl Places<'_> {
    /// Which of four pairs have surfaces nearer than `extra`, as bits.
    #[inline(always)]
    pub unsafe fn closer<F: Four>(&self, i: *const u32, w: *const u32, extra: f64) -> u32 {
        // SAFETY: passed on.
        unsafe {
            let rows = [
                self.apart(*i, *w),
                self.apart(*i.add(1), *w.add(1)),
                self.apart(*i.add(2), *w.add(2)),
                self.apart(*i.add(3), *w.add(3)),
            ];
            let [x, y, z, _]: [F; 4] = F::transpose(rows);
            let r = self.radius.as_ptr();
            let own = [
                *r.add(*i as usize),
                *r.add(*i.add(1) as usize),
                *r.add(*i.add(2) as usize),
                *r.add(*i.add(3) as usize),
            ];
            let other = [
                *r.add(grain(*w)),
                *r.add(grain(*w.add(1))),
                *r.add(grain(*w.add(2))),
                *r.add(grain(*w.add(3))),
            ];
            let reach = F::load(own.as_ptr()) + F::load(other.as_ptr()) + extra;
            F::bits((reach * reach).above(x * x + y * y + z * z))
        }
    }

    /// x_i − x_j of one pair [length], with the bits of [`Places::apart`].
    #[inline(always)]
    pub fn between(&self, i: usize, w: u32) -> Vec3 {
        let (a, b, s) = (self.x[i], self.x[grain(w)], self.shifts[(w >> HERE_BITS) as usize]);
        [a[0] - (b[0] + s[0]), a[1] - (b[1] + s[1]), a[2] - (b[2] + s[2])]
    }

    /// x_i − x_j.
    #[inline(always)]
    pub unsafe fn apart<F: Four>(&self, i: u32, w: u32) -> F {
        // SAFETY: passed on.
        unsafe {
            let a = F::load3(self.x.as_ptr().add(i as usize).cast());
            let b = F::load3(self.x.as_ptr().add(grain(w)).cast());
            let shift = F::load(self.shifts.as_ptr().add((w >> HERE_BITS) as usize).cast());
            a - (b + shift)
        }
    }
}
