//! Numbers that formulas are written for: one `f64`, or several side by side.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number, or lanes of numbers, on which a formula is evaluated at once; every lane gets the bits that the formula
/// gives for `f64` alone, but for [`Real::fma`] and [`Real::fnma`]. Plain numbers may stand on the right of operators.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// Whether this is one number: then it is worth asking what need not be evaluated.
    const ONE: bool = false;
    /// Yes or no for every lane.
    type Mask: Copy;

    /// The same number in every lane (`self` lends only its kind).
    fn like(self, a: f64) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// The larger of two; `other` where either is NaN.
    fn most(self, other: Self) -> Self;
    /// The smaller of two; `other` where either is NaN.
    fn least(self, other: Self) -> Self;
    /// `self b + c`: rounded once in lanes of processors that can, in two roundings elsewhere and for `f64`.
    fn fma(self, b: Self, c: Self) -> Self;
    /// `c − self b`, rounded as [`Real::fma`].
    fn fnma(self, b: Self, c: Self) -> Self;
    /// Where `self > other`.
    fn above(self, other: Self) -> Self::Mask;
    /// Where `self ≥ other`.
    fn at_least(self, other: Self) -> Self::Mask;
    /// Where both say yes.
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `self` where the mask says yes, else zero.
    fn keep(self, mask: Self::Mask) -> Self;
    /// `yes` where the mask says so, else `no`. Both are evaluated.
    fn choose(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Whether some lane says yes.
    fn any(mask: Self::Mask) -> bool;
    /// 2ⁿ of whole numbers n from −1022 to 1023.
    #[inline(always)]
    fn power_of_two(self) -> Self {
        self.each(power_of_two)
    }
    /// A function of several numbers without a form in lanes, lane by lane.
    fn each_of<const K: usize>(of: [Self; K], f: impl Fn([f64; K]) -> f64) -> Self;
    /// A function without a form in lanes (powers, angles), lane by lane.
    #[inline(always)]
    fn each(self, f: impl Fn(f64) -> f64) -> Self {
        Self::each_of([self], |[a]| f(a))
    }
}

impl Real for f64 {
    const ONE: bool = true;
    type Mask = bool;

    #[inline(always)]
    fn like(self, a: f64) -> f64 {
        a
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        self.sqrt()
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        self.abs()
    }
    #[inline(always)]
    fn most(self, other: f64) -> f64 {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn least(self, other: f64) -> f64 {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn fma(self, b: f64, c: f64) -> f64 {
        self * b + c
    }
    #[inline(always)]
    fn fnma(self, b: f64, c: f64) -> f64 {
        c - self * b
    }
    #[inline(always)]
    fn above(self, other: f64) -> bool {
        self > other
    }
    #[inline(always)]
    fn at_least(self, other: f64) -> bool {
        self >= other
    }
    #[inline(always)]
    fn keep(self, mask: bool) -> f64 {
        if mask { self } else { 0.0 }
    }
    #[inline(always)]
    fn both(a: bool, b: bool) -> bool {
        a && b
    }
    #[inline(always)]
    fn choose(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn each_of<const K: usize>(of: [f64; K], f: impl Fn([f64; K]) -> f64) -> f64 {
        f(of)
    }
}

/// 3·2⁵¹: added to and taken from a number of up to 2⁵¹ this rounds it to a whole one.
pub(super) const ROUND: f64 = 6_755_399_441_055_744.0;

/// Added to a whole number n this makes the last bits those of n + 1023, the exponent of 2ⁿ.
pub(super) const EXPONENT: f64 = ROUND + 1023.0;

/// [`Real::power_of_two`].
#[inline(always)]
fn power_of_two(n: f64) -> f64 {
    f64::from_bits((n + EXPONENT).to_bits() << 52)
}

/// The larger one; a NaN counts as infinite.
#[inline(always)]
pub fn largest(a: f64, b: f64) -> f64 {
    if b <= a {
        a
    } else if b.is_nan() {
        f64::INFINITY
    } else {
        b
    }
}

/// [`Real::each_of`] of the numbers in lanes.
#[inline(always)]
pub(super) fn lane_by_lane<const N: usize, const K: usize>(
    of: [[f64; N]; K],
    f: impl Fn([f64; K]) -> f64,
) -> [f64; N] {
    std::array::from_fn(|lane| f(of.map(|a| a[lane])))
}
