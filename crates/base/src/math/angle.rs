//! Angles in lanes.

use super::real::Real;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// tan(3π/8), above which the reciprocal is used.
const STEEP: f64 = 2.414_213_562_373_095;

/// Limit of the rational approximation.
const FLAT: f64 = 0.66;

/// Rounding errors of π/4 and π/2.
const LOW: f64 = 6.123_233_995_736_766e-17;

/// The angle in 0 … π [rad] between the positive x axis and the point (x, y) with y ≥ 0; 0 at the origin. A
/// rational approximation in x² from S. Moshier's Cephes library, accurate to 2 units in the last place.
#[inline(always)]
pub fn angle<R: Real>(y: R, x: R) -> R {
    let (none, flat) = (y.like(0.0), x.abs());
    let steep = y.above(flat * STEEP);
    let middle = y.above(flat * FLAT);
    let above = R::choose(steep, -flat, R::choose(middle, y - flat, y));
    let below = R::choose(steep, y, R::choose(middle, y + flat, flat));
    let base = R::choose(steep, y.like(FRAC_PI_2), R::choose(middle, y.like(FRAC_PI_4), none));
    let rest = R::choose(steep, y.like(LOW), R::choose(middle, y.like(0.5 * LOW), none));
    // Both are zero at the origin.
    let t = above / R::choose(below.above(none), below, y.like(1.0));
    let z = t * t;
    let p = (((z * -8.750608600031904122785e-1 - 1.615753718733365076637e1) * z - 7.500855792314704667340e1)
        * z
        - 1.228866684490136173410e2)
        * z
        - 6.485021904942025371773e1;
    let q = ((((z + 2.485846490142306297962e1) * z + 1.650270098316988542046e2) * z
        + 4.328810604912902668951e2)
        * z
        + 4.853903996359136964868e2)
        * z
        + 1.945506571482613964425e2;
    let angle = base + ((z * p / q * t + rest) + t);
    R::choose(none.above(x), -angle + PI, angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::form::{Form, InLanes};
    use crate::math::lanes::Lanes;

    fn points() -> Vec<[f64; 2]> {
        let mut points = vec![[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [1e-300, 1e-300], [2.0, -2.0]];
        for k in 0..4000 {
            let a = PI * f64::from(k) / 4000.0;
            let r = 10f64.powi(k % 13 - 6);
            points.push([r * a.sin(), r * a.cos()]);
            points.push([1e-9 * a, 1.0]);
        }
        points
    }

    /// Compared with the library's atan2, which is exact to the last place; at most two units apart.
    #[test]
    fn angles_of_points() {
        for [y, x] in points() {
            let (ours, exact) = (angle(y, x), y.atan2(x));
            assert!((ours - exact).abs() <= 2.0 * f64::EPSILON * exact, "{y} {x}: {ours} {exact}");
        }
    }

    struct All<'a>(&'a [[f64; 2]]);

    impl InLanes for All<'_> {
        type Out = Vec<f64>;
        #[inline(always)]
        unsafe fn run<const N: usize, V: Lanes<N>>(self) -> Vec<f64> {
            let mut out = vec![];
            for points in self.0.chunks_exact(N) {
                let (mut y, mut x) = ([0.0; N], [0.0; N]);
                for lane in 0..N {
                    [y[lane], x[lane]] = points[lane];
                }
                // SAFETY: the caller's guarantee.
                let lanes = unsafe { angle(V::of(y), V::of(x)) };
                out.extend(lanes.numbers());
            }
            out
        }
    }

    #[test]
    fn lanes_have_the_bits_of_one_number() {
        let points = points();
        let points = &points[..points.len() / 8 * 8];
        for form in Form::all() {
            // SAFETY: the processor supports this form.
            let lanes = unsafe { form.run(All(points)) };
            let alone = points.iter().map(|[y, x]| angle(*y, *x).to_bits());
            assert!(lanes.iter().map(|a| a.to_bits()).eq(alone), "{form:?}");
        }
    }
}
