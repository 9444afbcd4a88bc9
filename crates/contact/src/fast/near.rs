//! Which pairs of a list are near each other, several at a time.

use super::lists::FILL;
use super::search::Watched;
use crate::driver::Grains;
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::{Lanes, PLACE_BITS, place};
use perigrain_base::math::vec3::Vec3;
use std::ops::Range;

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
    let at = Places::new(grains, shifts);
    // SAFETY: passed on.
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
            // SAFETY: lists are filled up; entries are grains. There is room for all lanes; those that are no hits are behind
            // the end.
            unsafe {
                let hits = at.closer::<N, V>(i.as_ptr().add(k), w.as_ptr().add(k), reach);
                let count = V::put(hits, k as u32, out.as_mut_ptr().add(out.len()));
                out.set_len(out.len() + count);
            }
        }
    }
}

/// Grains one behind the other, coordinate by coordinate.
pub(super) struct InOrder {
    x: [Vec<f64>; 3],
    radius: Vec<f64>,
}

impl InOrder {
    /// Copies these grains, as they are seen in their images.
    pub fn new(grains: &Grains, watched: &Watched, shifts: &[[f64; 4]; 32]) -> Self {
        // Whole lanes can be read from any of them: what is read beyond the end is not used.
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

    /// Calls `hit` with those of some others, one behind the other, whose surfaces are nearer than `skin` to that of grain `i`, in order.
    ///
    /// # Safety
    /// There must be these; the processor must have what the form needs.
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
        // SAFETY: there is this grain.
        let own = unsafe { [V::all(*x.add(i)), V::all(*y.add(i)), V::all(*z.add(i)), V::all(*r.add(i))] };
        let mut hits = [0; FILL];
        for from in others.clone().step_by(N) {
            // SAFETY: behind the last one there is room for whole lanes, and in `hits` for all of them.
            let count = unsafe {
                let dx = own[0] - V::of(x.add(from).cast::<[f64; N]>().read());
                let dy = own[1] - V::of(y.add(from).cast::<[f64; N]>().read());
                let dz = own[2] - V::of(z.add(from).cast::<[f64; N]>().read());
                let reach = own[3] + V::of(r.add(from).cast::<[f64; N]>().read()) + skin;
                let near = (reach * reach).above(dx * dx + dy * dy + dz * dz);
                V::put(near, from as u32, hits.as_mut_ptr())
            };
            for k in &hits[..count] {
                // Behind the last one others stand.
                if *k as usize >= others.end {
                    break;
                }
                hit(*k as usize);
            }
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
    /// The radius of all, if it is the same.
    pub alike: Option<f64>,
    /// How far each image is shifted.
    pub shifts: &'a [[f64; 4]; 32],
}

impl<'a> Places<'a> {
    /// Those of these grains.
    pub fn new(grains: &Grains<'a>, shifts: &'a [[f64; 4]; 32]) -> Self {
        Self { x: grains.x, radius: grains.radius, alike: None, shifts }
    }

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
            let mut j = [0; N];
            for lane in 0..N {
                j[lane] = place(*w.add(lane)) as u32;
            }
            let reach = V::pick(r, i) + V::pick(r, j.as_ptr()) + extra;
            (reach * reach).above(x * x + y * y + z * z)
        }
    }

    /// The square of how far apart the centres of a pair are whose surfaces are this far apart, with the bits of
    /// [`Places::closer`].
    #[inline(always)]
    pub fn reach(&self, i: u32, w: u32, extra: f64) -> f64 {
        let reach = self.radius[i as usize] + self.radius[place(w)] + extra;
        reach * reach
    }

    /// x_i − x_j of one pair [length], with the bits of [`Lanes::apart`].
    #[inline(always)]
    pub fn between(&self, i: usize, w: u32) -> Vec3 {
        let (a, b, s) = (self.x[i], self.x[place(w)], self.shifts[(w >> PLACE_BITS) as usize]);
        [a[0] - (b[0] + s[0]), a[1] - (b[1] + s[1]), a[2] - (b[2] + s[2])]
    }
}
