//! Selects nearby pairs of a list, several at a time.

use super::lists::FILL;
use super::search::Watched;
use crate::driver::Grains;
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::{Lanes, PLACE_BITS, place};
use perigrain_base::math::vec3::Vec3;
use std::ops::Range;

/// Appends the numbers of the pairs of a padded list with gaps below `reach` to `out`, in order.
///
/// # Safety
/// List entries must be grains; the processor must support the form.
pub unsafe fn near(
    form: Form,
    grains: &Grains,
    shifts: &[[f64; 4]; 32],
    list: [&[u32]; 2],
    reach: f64,
    out: &mut Vec<u32>,
) {
    let at = Places::new(grains, shifts);
    // SAFETY: the caller's guarantee.
    unsafe { form.run(Near { at, list, reach, out }) }
}

/// The loop of [`near`].
struct Near<'a> {
    at: Places<'a>,
    list: [&'a [u32]; 2],
    reach: f64,
    out: &'a mut Vec<u32>,
}

impl InLanes for Near<'_> {
    type Out = ();

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self { at, list: [i, w], reach, out } = self;
        for k in (0..i.len()).step_by(N) {
            if out.capacity() - out.len() < N {
                out.reserve(N);
            }
            // SAFETY: lists are padded; entries are grains. There is room for all lanes; those without a hit
            // are beyond the end.
            unsafe {
                let hits = at.closer::<N, V>(i.as_ptr().add(k), w.as_ptr().add(k), reach);
                let count = V::put(hits, k as u32, out.as_mut_ptr().add(out.len()));
                out.set_len(out.len() + count);
            }
        }
    }
}

/// Grains in consecutive order, coordinate by coordinate.
pub(super) struct InOrder {
    x: [Vec<f64>; 3],
    radius: Vec<f64>,
}

impl InOrder {
    /// Copies these grains at the positions of their images.
    pub fn new(grains: &Grains, watched: &Watched, shifts: &[[f64; 4]; 32]) -> Self {
        // Whole lanes can be read from any of them; values beyond the end are not used.
        let room = || Vec::with_capacity(watched.grains.len() + FILL);
        let mut copy = Self { x: [room(), room(), room()], radius: room() };
        for (image, which) in watched.by_image() {
            let shift = shifts[image as usize];
            for d in 0..3 {
                copy.x[d].extend(which.iter().map(|i| grains.x[*i as usize][d] + shift[d]));
            }
            copy.radius.extend(which.iter().map(|i| grains.radius[*i as usize]));
        }
        copy.x.iter_mut().chain([&mut copy.radius]).for_each(|list| list.extend([0.0; FILL]));
        copy
    }

    /// Calls `hit` for each grain of the range `others` whose gap to grain `i` is below `skin`, in order.
    ///
    /// # Safety
    /// The grains must exist; the processor must support the form.
    #[inline(always)]
    pub unsafe fn near<const N: usize, V: Lanes<N>>(
        &self,
        i: usize,
        others: Range<usize>,
        skin: f64,
        mut hit: impl FnMut(usize),
    ) {
        let [x, y, z] = self.x.each_ref().map(Vec::as_ptr);
        let r = self.radius.as_ptr();
        // SAFETY: this grain exists.
        let own = unsafe { [V::all(*x.add(i)), V::all(*y.add(i)), V::all(*z.add(i)), V::all(*r.add(i))] };
        let mut hits = [0; FILL];
        for from in others.clone().step_by(N) {
            // SAFETY: there is room for whole lanes behind the last one, and for all of them in `hits`.
            let count = unsafe {
                let dx = own[0] - V::of(x.add(from).cast::<[f64; N]>().read());
                let dy = own[1] - V::of(y.add(from).cast::<[f64; N]>().read());
                let dz = own[2] - V::of(z.add(from).cast::<[f64; N]>().read());
                let reach = own[3] + V::of(r.add(from).cast::<[f64; N]>().read()) + skin;
                let near = (reach * reach).above(dx * dx + dy * dy + dz * dz);
                V::put(near, from as u32, hits.as_mut_ptr())
            };
            for k in &hits[..count] {
                // Lanes behind the last one hold other grains.
                if *k as usize >= others.end {
                    break;
                }
                hit(*k as usize);
            }
        }
    }
}

/// Positions of grains.
#[derive(Clone, Copy)]
pub(super) struct Places<'a> {
    /// Positions.
    pub x: &'a [Vec3],
    /// Radii.
    pub radius: &'a [f64],
    /// The radius of all grains, if equal.
    pub alike: Option<f64>,
    /// Displacement of each image.
    pub shifts: &'a [[f64; 4]; 32],
}

impl<'a> Places<'a> {
    /// For these grains.
    pub fn new(grains: &Grains<'a>, shifts: &'a [[f64; 4]; 32]) -> Self {
        Self { x: grains.x, radius: grains.radius, alike: None, shifts }
    }

    /// Which of some pairs have gaps below `extra`.
    ///
    /// # Safety
    /// One entry per lane, each of which must be a grain; the processor must support the form.
    #[inline(always)]
    pub unsafe fn closer<const N: usize, V: Lanes<N>>(
        &self,
        i: *const u32,
        w: *const u32,
        extra: f64,
    ) -> V::Mask {
        // SAFETY: the caller's guarantee.
        unsafe {
            let [x, y, z] = V::apart(self.x.as_ptr(), i, w, self.shifts);
            let r = self.radius.as_ptr();
            let mut j = [0; N];
            for lane in 0..N {
                j[lane] = place(*w.add(lane)) as u32;
            }
            let reach = V::pick(r, i) + V::pick(r, j.as_ptr()) + extra;
            (reach * reach).above(x * x + y * y + z * z)
        }
    }

    /// The squared distance of the centres of a pair with this gap, with the same bits as [`Places::closer`].
    #[inline(always)]
    pub fn reach(&self, i: u32, w: u32, extra: f64) -> f64 {
        let reach = self.radius[i as usize] + self.radius[place(w)] + extra;
        reach * reach
    }

    /// x_i − x_j of one pair [length], with the same bits as [`Lanes::apart`].
    #[inline(always)]
    pub fn between(&self, i: usize, w: u32) -> Vec3 {
        let (a, b, s) = (self.x[i], self.x[place(w)], self.shifts[(w >> PLACE_BITS) as usize]);
        [a[0] - (b[0] + s[0]), a[1] - (b[1] + s[1]), a[2] - (b[2] + s[2])]
    }
}
