//! Two numbers evaluated together: a long formula with a dependency chain is evaluated for two inputs in an
//! interleaved way.

use super::real::Real;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Two numbers, or lanes of numbers. Each has the bits that it would have alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twice<R>(pub [R; 2]);

macro_rules! operators {
    ($($trait:ident $method:ident)*) => { $(
        impl<R: Real> $trait for Twice<R> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: Self) -> Self {
                Self([self.0[0].$method(b.0[0]), self.0[1].$method(b.0[1])])
            }
        }
        impl<R: Real> $trait<f64> for Twice<R> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, b: f64) -> Self {
                Self([self.0[0].$method(b), self.0[1].$method(b)])
            }
        }
    )* };
}

operators! { Add add Sub sub Mul mul Div div }

impl<R: Real> Neg for Twice<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self([-self.0[0], -self.0[1]])
    }
}

impl<R: Real> Real for Twice<R> {
    type Mask = [R::Mask; 2];

    #[inline(always)]
    fn like(self, a: f64) -> Self {
        Self([self.0[0].like(a), self.0[1].like(a)])
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self([self.0[0].sqrt(), self.0[1].sqrt()])
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self([self.0[0].abs(), self.0[1].abs()])
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self([self.0[0].power_of_two(), self.0[1].power_of_two()])
    }
    #[inline(always)]
    fn most(self, other: Self) -> Self {
        Self([self.0[0].most(other.0[0]), self.0[1].most(other.0[1])])
    }
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        Self([self.0[0].least(other.0[0]), self.0[1].least(other.0[1])])
    }
    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        Self([self.0[0].fma(b.0[0], c.0[0]), self.0[1].fma(b.0[1], c.0[1])])
    }
    #[inline(always)]
    fn fnma(self, b: Self, c: Self) -> Self {
        Self([self.0[0].fnma(b.0[0], c.0[0]), self.0[1].fnma(b.0[1], c.0[1])])
    }
    #[inline(always)]
    fn above(self, other: Self) -> Self::Mask {
        [self.0[0].above(other.0[0]), self.0[1].above(other.0[1])]
    }
    #[inline(always)]
    fn at_least(self, other: Self) -> Self::Mask {
        [self.0[0].at_least(other.0[0]), self.0[1].at_least(other.0[1])]
    }
    #[inline(always)]
    fn keep(self, mask: Self::Mask) -> Self {
        Self([self.0[0].keep(mask[0]), self.0[1].keep(mask[1])])
    }
    #[inline(always)]
    fn both(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        [R::both(a[0], b[0]), R::both(a[1], b[1])]
    }
    #[inline(always)]
    fn choose(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self([R::choose(mask[0], yes.0[0], no.0[0]), R::choose(mask[1], yes.0[1], no.0[1])])
    }
    #[inline(always)]
    fn any(mask: Self::Mask) -> bool {
        R::any(mask[0]) || R::any(mask[1])
    }
    #[inline(always)]
    fn each_of<const K: usize>(of: [Self; K], f: impl Fn([f64; K]) -> f64) -> Self {
        Self([R::each_of(of.map(|a| a.0[0]), &f), R::each_of(of.map(|a| a.0[1]), &f)])
    }
}
