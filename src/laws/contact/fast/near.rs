//! Which pairs of a list are near each other, several at a time.

use super::form::Form;
use crate::laws::contact::driver::Grains;
#[cfg(target_arch = "x86_64")]
use crate::math::four::Avx512;
use crate::math::four::{Four, Lanes, PLACE_BITS, Plain, place};
use crate::math::vec3::Vec3;
use crate::neigh::slabs::Run;

/// Adds the numbers of those pairs of a list, filled up, to `out` whose surfaces are nearer than `reach`, in order.
///
/// # Safety
/// List entries must be grains; the processor must have what the form needs.
pub unsafe fn near(
    form: Form,
    grains: &Grains,
    shifts: &[[f64; 4]; 32],
    list: [&[u32]; 2],
    reach: f64,
    out: &mut Vec<u32>,
) {
    let at = Places { x: grains.x, radius: grains.radius, shifts };
    // SAFETY: passed on.
    unsafe {
        match form {
            #[cfg(target_arch = "x86_64")]
            Form::Gathers => near_gathers(at, list, reach, out),
            #[cfg(target_arch = "x86_64")]
            Form::Eight => near_avx512(at, list, reach, out),
            #[cfg(target_arch = "x86_64")]
            Form::Four => near_avx2(at, list, reach, out),
            Form::Plain => near_in::<4, Plain>(at, list, reach, out),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl,popcnt")]
unsafe fn near_gathers(at: Places, list: [&[u32]; 2], reach: f64, out: &mut Vec<u32>) {
    // SAFETY: passed on.
    unsafe { near_in::<8, Avx512<true>>(at, list, reach, out) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl,popcnt")]
unsafe fn near_avx512(at: Places, list: [&[u32]; 2], reach: f64, out: &mut Vec<u32>) {
    // SAFETY: passed on.
    unsafe { near_in::<8, Avx512<false>>(at, list, reach, out) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn near_avx2(at: Places, list: [&[u32]; 2], reach: f64, out: &mut Vec<u32>) {
    // SAFETY: passed on.
    unsafe { near_in::<4, crate::math::four::Avx2>(at, list, reach, out) }
}

#[inline(always)]
unsafe fn near_in<const N: usize, V: Lanes<N>>(
    at: Places,
    [i, w]: [&[u32]; 2],
    reach: f64,
    out: &mut Vec<u32>,
) {
    for k in (0..i.len()).step_by(N) {
        if out.capacity() - out.len() < N {
            out.reserve(N);
        }
        // SAFETY: lists are filled up; entries are grains. There is room for all lanes; those that are no hits are behind the
        // end.
        unsafe {
            let hits = at.closer::<N, V>(i.as_ptr().add(k), w.as_ptr().add(k), reach);
            let count = V::put(hits, k as u32, out.as_mut_ptr().add(out.len()));
            out.set_len(out.len() + count);
        }
    }
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
    /// Which of some pairs have surfaces nearer than `extra`.
    ///
    /// # Safety
    /// As many entries as there are lanes must be grains; the processor must have what the form needs.
    #[inline(always)]
    pub unsafe fn closer<const N: usize, V: Lanes<N>>(
        &self,
        i: *const u32,
        w: *const u32,
        extra: f64,
    ) -> V::Mask {
        // SAFETY: passed on.
        unsafe {
            let [x, y, z] = V::apart(self.x.as_ptr(), i, w, self.shifts);
            let r = self.radius.as_ptr();
            let reach = V::pick(r, i) + V::pick(r, w) + extra;
            (reach * reach).above(x * x + y * y + z * z)
        }
    }

    /// x_i − x_j of one pair [length], with the bits of [`Lanes::apart`].
    #[inline(always)]
    pub fn between(&self, i: usize, w: u32) -> Vec3 {
        let (a, b, s) = (self.x[i], self.x[place(w)], self.shifts[(w >> PLACE_BITS) as usize]);
        [a[0] - (b[0] + s[0]), a[1] - (b[1] + s[1]), a[2] - (b[2] + s[2])]
    }
}
