//! Kicks of one vector and of four, and the force components that are kept.

use perigrain_base::math::real::Real;
use perigrain_base::math::threes::{self, Threes};
use perigrain_base::math::vec3::Vec3;

/// v += by · f, `KICKS` times.
#[inline(always)]
pub(super) fn kick<const KICKS: usize>(v: &mut Vec3, f: &Vec3, by: f64) {
    for d in 0..3 {
        let dv = by * f[d];
        for _ in 0..KICKS {
            v[d] += dv;
        }
    }
}

/// Masks of the components of four vectors that are kept, where some are not.
pub(super) type Parts<F> = Option<[<F as Real>::Mask; 3]>;

/// The components of `which` that are not zero.
///
/// # Safety
/// The processor must support the form.
#[inline(always)]
pub(super) unsafe fn parts_of<F: Threes>(which: Vec3) -> [F::Mask; 3] {
    // SAFETY: the caller's guarantee.
    unsafe {
        let ([a, b, c], zero) = (threes::repeated::<F>(which), F::splat(0.0));
        [a.above(zero), b.above(zero), c.above(zero)]
    }
}

/// Keeps these components; the others become zero.
///
/// # Safety
/// The processor must support the form.
#[inline(always)]
pub(super) unsafe fn only<F: Threes>([a, b, c]: [F; 3], parts: &Parts<F>) -> [F; 3] {
    let Some([p, q, r]) = *parts else { return [a, b, c] };
    // SAFETY: the caller's guarantee.
    let zero = unsafe { F::splat(0.0) };
    [F::choose(p, a, zero), F::choose(q, b, zero), F::choose(r, c, zero)]
}

/// [`kick`] of four vectors with only these components kept; returns the result.
///
/// # Safety
/// The processor must support the form.
#[inline(always)]
pub(super) unsafe fn kicked<F: Threes, const KICKS: usize>(
    v: &mut [Vec3; 4],
    parts: &Parts<F>,
    [fa, fb, fc]: [F; 3],
    by: F,
) -> [F; 3] {
    let p = v.as_flattened_mut().as_mut_ptr();
    // SAFETY: twelve numbers; the rest is the caller's guarantee.
    unsafe {
        let ([a, b, c], [ba, bb, bc]) = (only(threes::load::<F>(p), parts), by.spread());
        let (da, db, dc) = (ba * fa, bb * fb, bc * fc);
        let mut now = [a, b, c];
        for _ in 0..KICKS {
            now = [now[0] + da, now[1] + db, now[2] + dc];
        }
        threes::store(now, p);
        now
    }
}
