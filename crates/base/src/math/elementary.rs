//! Exponential function and arcsine in lanes, with the same bits for a single number and for all lanes.
//!
//! With calls of the math library for each lane, plastic grains would spend a tenth of a step there. The
//! coefficients interpolate at Chebyshev points, computed with 60 digits.

use super::real::{ROUND, Real};
use std::f64::consts::{FRAC_PI_2, LOG2_E};

/// ln 2 in two parts: integer multiples of the first by up to 2¹¹ are exact.
const LN_2: [f64; 2] = [f64::from_bits(0x3fe6_2e42_fefa_3800), f64::from_bits(0x3d2e_f357_93c7_6730)];

/// Outside these the exponential function is infinite, or 0.
const RANGE: [f64; 2] = [-746.0, 710.0];

/// (eʳ − 1 − r)/r² for |r| ≤ ln(2)/2: interpolates within 3e-17.
const EXP: [f64; 10] = [
    0.5,
    0.16666666666666669,
    0.04166666666662413,
    0.008333333333330062,
    0.0013888888917213717,
    0.00019841269863053618,
    2.4801521295954376e-05,
    2.7557268459997064e-06,
    2.7620088445409746e-07,
    2.510038549551032e-08,
];

/// (asin(s)/s − 1)/z for z = s² up to a quarter: interpolates within 2e-15, a relative error of 6e-17 of the
/// arcsine.
const ASIN: [f64; 12] = [
    0.1666666666666665,
    0.07500000000020764,
    0.044642857103423646,
    0.03038194736709848,
    0.02237204763174451,
    0.017355259955786323,
    0.013929652902326633,
    0.011875494382636922,
    0.0078029494773533175,
    0.01603551434914882,
    -0.010749050339697808,
    0.028169218060881414,
];

/// Σ cₖ xᵏ with an even number of coefficients, two at a time: this halves the dependency chain.
#[inline(always)]
pub fn polynomial<R: Real, const N: usize>(x: R, c: &[f64; N]) -> R {
    let (square, mut sum) = (x * x, x.like(0.0));
    for k in (0..N / 2).rev() {
        sum = sum * square + (x * c[2 * k + 1] + c[2 * k]);
    }
    sum
}

/// eˣ, within two units in the last place; subnormal results within their last place.
#[inline(always)]
pub fn exp<R: Real>(x: R) -> R {
    // In this order NaN stays NaN.
    let x = x.like(RANGE[1]).least(x.like(RANGE[0]).most(x));
    let n = x * LOG2_E + ROUND - ROUND;
    let r = x - n * LN_2[0] - n * LN_2[1];
    let one = r * r * polynomial(r, &EXP) + r + 1.0;
    // In two factors, because 2ⁿ itself may overflow or underflow.
    let half = n * 0.5 + ROUND - ROUND;
    one * half.power_of_two() * (n - half).power_of_two()
}

/// Arcsine of −1 … 1, within two units in the last place.
#[inline(always)]
pub fn asin<R: Real>(x: R) -> R {
    let (size, half) = (x.abs(), x.like(0.5));
    // Beyond one half the angle is π/2 minus twice that of √((1 − |x|)/2).
    let far = size.above(half);
    let z = R::choose(far, half - size * 0.5, size * size);
    let s = R::choose(far, z.sqrt(), size);
    let angle = s + s * z * polynomial(z, &ASIN);
    let angle = R::choose(far, x.like(FRAC_PI_2) - angle * 2.0, angle);
    R::choose(x.like(0.0).above(x), -angle, angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::form::{Form, InLanes};
    use crate::math::lanes::Lanes;

    /// Difference of two numbers in units in the last place.
    fn off(a: f64, b: f64) -> u64 {
        a.to_bits().abs_diff(b.to_bits())
    }

    /// Numbers from `a` to `b`.
    fn between(a: f64, b: f64) -> impl Iterator<Item = f64> {
        (0..=20_000).map(move |k| a + (b - a) * f64::from(k) / 20_000.0)
    }

    #[test]
    fn exponentials_are_those_of_the_library() {
        for x in between(-708.0, 709.7).chain(between(-5.0, 5.0)).chain(between(-1e-9, 1e-9)) {
            assert!(off(exp(x), x.exp()) <= 2, "{x}: {} {}", exp(x), x.exp());
        }
        for x in between(-745.0, -708.0) {
            assert!((exp(x) - x.exp()).abs() <= 2.0 * f64::from_bits(1), "{x}: {} {}", exp(x), x.exp());
        }
        let ends = [f64::NEG_INFINITY, -1e4, 0.0, -0.0, 709.8, 1e4, f64::INFINITY].map(exp);
        assert_eq!(ends, [0.0, 0.0, 1.0, 1.0, f64::INFINITY, f64::INFINITY, f64::INFINITY]);
        assert!(exp(f64::NAN).is_nan());
    }

    #[test]
    fn arcsines_are_those_of_the_library() {
        for x in between(-1.0, 1.0).chain(between(0.4999, 0.5001)).chain(between(0.99999, 1.0)) {
            assert!(off(asin(x), x.asin()) <= 2, "{x}: {} {}", asin(x), x.asin());
        }
        assert_eq!([asin(0.0), asin(1.0), asin(-1.0)], [0.0, FRAC_PI_2, -FRAC_PI_2]);
        assert!(asin(f64::NAN).is_nan() && asin(1.0 + 1e-9).is_nan());
    }

    /// Both functions for some numbers.
    struct Both<'a>(&'a [f64], &'a mut Vec<[f64; 2]>);

    impl InLanes for Both<'_> {
        type Out = ();

        #[inline(always)]
        unsafe fn run<const N: usize, V: Lanes<N>>(self) {
            for some in self.0.chunks_exact(N) {
                // SAFETY: the caller's guarantee.
                let x = unsafe { V::of(std::array::from_fn(|k| some[k])) };
                let [e, a] = [exp(x * 300.0), asin(x)].map(V::numbers);
                self.1.extend((0..N).map(|k| [e[k], a[k]]));
            }
        }
    }

    #[test]
    fn lanes_have_the_bits_of_one_number() {
        let numbers: Vec<f64> = between(-1.3, 1.3).take(20_000).chain([f64::NAN; 8]).collect();
        for form in Form::all() {
            let mut out = vec![];
            // SAFETY: the processor supports this form.
            unsafe { form.run(Both(&numbers, &mut out)) };
            assert_eq!(out.len(), numbers.len());
            for (x, [e, a]) in numbers.iter().zip(out) {
                let same = |a: f64, b: f64| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();
                assert!(same(e, exp(300.0 * x)) && same(a, asin(*x)), "{form:?} {x}: {e} {a}");
            }
        }
    }
}
