//! Four numbers side by side: a plain array for any processor, one AVX register where there is one, same bits.

use super::pair::Pair;
use super::real::{Real, lane_by_lane};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Four lanes that a formula is evaluated on at once, and the moves between rows in memory and lanes.
///
/// Only [`Four::load`] makes values from nothing: where it may be called, the operators may be used.
pub trait Four: Real {
    /// Whether it is worth compiling loops for special cases.
    const FAST: bool;
    /// Four consecutive numbers, aligned or not.
    ///
    /// # Safety
    /// `p` must be readable for four numbers; the processor must have what the form needs.
    unsafe fn load(p: *const f64) -> Self;
    /// Writes four consecutive numbers.
    ///
    /// # Safety
    /// `p` must be writable for four numbers.
    unsafe fn store(self, p: *mut f64);
    /// Three consecutive numbers and a zero.
    ///
    /// # Safety
    /// `p` must be readable for three numbers; the processor must have what the form needs.
    unsafe fn load3(p: *const f64) -> Self;
    /// Two numbers.
    type Two: Pair;
    /// See [`Lanes::pairs`].
    fn pairs_of(x: Self, y: Self) -> [Self; 2];
    /// The same number four times.
    ///
    /// # Safety
    /// The processor must have what the form needs.
    unsafe fn splat(a: f64) -> Self;
    /// Element `l` of row `k` becomes element `k` of row `l`.
    fn transpose(rows: [Self; 4]) -> [Self; 4];
    /// Yes in lane `k` where bit `k` is set (`self` lends only its kind).
    fn with_bits(self, bits: u8) -> Self::Mask;
    /// Lane `k` of a mask as bit `k`.
    fn bits(mask: Self::Mask) -> u8;
    /// The lanes with these numbers; all of them have to be below four.
    fn at(self, lanes: [u32; 4]) -> Self;
}

/// Four lanes as an array.
#[derive(Clone, Copy, Debug)]
pub struct Plain(pub(in crate::math) [f64; 4]);

impl Plain {
    #[inline(always)]
    fn zip(self, b: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self([f(self.0[0], b.0[0]), f(self.0[1], b.0[1]), f(self.0[2], b.0[2]), f(self.0[3], b.0[3])])
    }
}

/// The eight operators of a number, each from one expression of two values in lanes.
macro_rules! operators {
    (@ [$($of:tt)*] $lanes:ty, $a:ident $b:ident: $trait:ident $method:ident $e:expr) => {
        impl<$($of)*> $trait for $lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, $b: Self) -> Self {
                let $a = self;
                $e
            }
        }
        impl<$($of)*> $trait<f64> for $lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, $b: f64) -> Self {
                let ($a, $b) = (self, self.like($b));
                $e
            }
        }
    };
    ([$($of:tt)*] $lanes:ty, $a:ident $b:ident: $add:expr, $sub:expr, $mul:expr, $div:expr) => {
        operators! { @ [$($of)*] $lanes, $a $b: Add add $add }
        operators! { @ [$($of)*] $lanes, $a $b: Sub sub $sub }
        operators! { @ [$($of)*] $lanes, $a $b: Mul mul $mul }
        operators! { @ [$($of)*] $lanes, $a $b: Div div $div }
    };
}

pub(super) use operators;

operators! { [] Plain, a b:
    a.zip(b, |a, b| a + b),
    a.zip(b, |a, b| a - b),
    a.zip(b, |a, b| a * b),
    a.zip(b, |a, b| a / b)
}

impl Neg for Plain {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.map(|a| -a))
    }
}

impl Real for Plain {
    type Mask = [bool; 4];

    #[inline(always)]
    fn like(self, a: f64) -> Self {
        Self([a; 4])
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }
    #[inline(always)]
    fn most(self, other: Self) -> Self {
        self.zip(other, Real::most)
    }
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        self.zip(other, Real::least)
    }
    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn fnma(self, b: Self, c: Self) -> Self {
        c - self * b
    }
    #[inline(always)]
    fn above(self, other: Self) -> [bool; 4] {
        std::array::from_fn(|k| self.0[k] > other.0[k])
    }
    #[inline(always)]
    fn at_least(self, other: Self) -> [bool; 4] {
        std::array::from_fn(|k| self.0[k] >= other.0[k])
    }
    #[inline(always)]
    fn keep(self, mask: [bool; 4]) -> Self {
        Self(std::array::from_fn(|k| if mask[k] { self.0[k] } else { 0.0 }))
    }
    #[inline(always)]
    fn both(a: [bool; 4], b: [bool; 4]) -> [bool; 4] {
        std::array::from_fn(|k| a[k] && b[k])
    }
    #[inline(always)]
    fn choose(mask: [bool; 4], yes: Self, no: Self) -> Self {
        Self(std::array::from_fn(|k| if mask[k] { yes.0[k] } else { no.0[k] }))
    }
    #[inline(always)]
    fn any(mask: [bool; 4]) -> bool {
        mask.iter().any(|m| *m)
    }
    #[inline(always)]
    fn each_of<const K: usize>(of: [Self; K], f: impl Fn([f64; K]) -> f64) -> Self {
        Self(lane_by_lane(of.map(|a| a.0), f))
    }
}

impl Four for Plain {
    const FAST: bool = false;
    #[inline(always)]
    unsafe fn load(p: *const f64) -> Self {
        // SAFETY: readable by the caller's promise.
        Self(unsafe { p.cast::<[f64; 4]>().read() })
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut f64) {
        // SAFETY: writable by the caller's promise.
        unsafe { p.cast::<[f64; 4]>().write(self.0) }
    }
    #[inline(always)]
    unsafe fn load3(p: *const f64) -> Self {
        // SAFETY: readable by the caller's promise.
        let [a, b, c] = unsafe { p.cast::<[f64; 3]>().read() };
        Self([a, b, c, 0.0])
    }
    #[inline(always)]
    fn at(self, lanes: [u32; 4]) -> Self {
        Self(lanes.map(|k| self.0[k as usize & 3]))
    }
    type Two = [f64; 2];
    #[inline(always)]
    fn pairs_of(x: Self, y: Self) -> [Self; 2] {
        [0, 1].map(|k| Self([x.0[k], y.0[k], x.0[k + 2], y.0[k + 2]]))
    }
    #[inline(always)]
    unsafe fn splat(a: f64) -> Self {
        Self([a; 4])
    }
    #[inline(always)]
    fn transpose(rows: [Self; 4]) -> [Self; 4] {
        std::array::from_fn(|l| Self(std::array::from_fn(|k| rows[k].0[l])))
    }
    #[inline(always)]
    fn with_bits(self, bits: u8) -> [bool; 4] {
        std::array::from_fn(|k| bits >> k & 1 == 1)
    }
    #[inline(always)]
    fn bits(mask: [bool; 4]) -> u8 {
        (0..4).map(|k| u8::from(mask[k]) << k).sum()
    }
}

/// Whether the processor has AVX2 and FMA.
pub fn has_avx2() -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        false
    }
}

#[cfg(target_arch = "x86_64")]
pub use super::eight::{Avx512, gathers_pay, has_avx512};
#[cfg(target_arch = "x86_64")]
pub use x86::Avx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;
    use std::ops::{Add, Div, Mul, Neg, Sub};

    use super::{Four, Real};
    use crate::math::lanes::Lanes;
    use crate::math::pair::Sse;
    use crate::math::real::{EXPONENT, lane_by_lane};

    /// By bits of a mask: all bits of the lanes that are set.
    static MASKS: [[u64; 4]; 16] = {
        let mut masks = [[0; 4]; 16];
        let mut bits = 0;
        while bits < 16 {
            let mut lane = 0;
            while lane < 4 {
                if bits >> lane & 1 == 1 {
                    masks[bits][lane] = u64::MAX;
                }
                lane += 1;
            }
            bits += 1;
        }
        masks
    };

    /// Four lanes in one AVX register. There is a value of this type only where the processor has AVX2 and FMA: its
    /// constructors are unsafe and promise that.
    #[derive(Clone, Copy, Debug)]
    pub struct Avx2(pub(in crate::math) __m256d);

    // SAFETY (all blocks): a value exists, so the processor has AVX2 and FMA; or the caller promises that.

    operators! { [] Avx2, a b:
        Avx2(unsafe { _mm256_add_pd(a.0, b.0) }),
        Avx2(unsafe { _mm256_sub_pd(a.0, b.0) }),
        Avx2(unsafe { _mm256_mul_pd(a.0, b.0) }),
        Avx2(unsafe { _mm256_div_pd(a.0, b.0) })
    }

    impl Neg for Avx2 {
        type Output = Self;
        #[inline(always)]
        fn neg(self) -> Self {
            Self(unsafe { _mm256_xor_pd(_mm256_set1_pd(-0.0), self.0) })
        }
    }

    impl Real for Avx2 {
        type Mask = __m256d;

        #[inline(always)]
        fn like(self, a: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(a) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm256_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn abs(self) -> Self {
            Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
        }
        #[inline(always)]
        fn power_of_two(self) -> Self {
            let bits = unsafe { _mm256_castpd_si256((self + EXPONENT).0) };
            Self(unsafe { _mm256_castsi256_pd(_mm256_slli_epi64::<52>(bits)) })
        }
        #[inline(always)]
        fn most(self, other: Self) -> Self {
            Self(unsafe { _mm256_max_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn least(self, other: Self) -> Self {
            Self(unsafe { _mm256_min_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn fma(self, b: Self, c: Self) -> Self {
            Self(unsafe { _mm256_fmadd_pd(self.0, b.0, c.0) })
        }
        #[inline(always)]
        fn fnma(self, b: Self, c: Self) -> Self {
            Self(unsafe { _mm256_fnmadd_pd(self.0, b.0, c.0) })
        }
        #[inline(always)]
        fn above(self, other: Self) -> __m256d {
            unsafe { _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn at_least(self, other: Self) -> __m256d {
            unsafe { _mm256_cmp_pd::<_CMP_GE_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn keep(self, mask: __m256d) -> Self {
            Self(unsafe { _mm256_and_pd(self.0, mask) })
        }
        #[inline(always)]
        fn both(a: __m256d, b: __m256d) -> __m256d {
            unsafe { _mm256_and_pd(a, b) }
        }
        #[inline(always)]
        fn choose(mask: __m256d, yes: Self, no: Self) -> Self {
            Self(unsafe { _mm256_blendv_pd(no.0, yes.0, mask) })
        }
        #[inline(always)]
        fn any(mask: __m256d) -> bool {
            unsafe { _mm256_movemask_pd(mask) != 0 }
        }
        #[inline(always)]
        fn each_of<const K: usize>(of: [Self; K], f: impl Fn([f64; K]) -> f64) -> Self {
            let a = lane_by_lane(of.map(Self::numbers), f);
            Self(unsafe { _mm256_loadu_pd(a.as_ptr()) })
        }
    }

    impl Four for Avx2 {
        const FAST: bool = true;
        #[inline(always)]
        unsafe fn load(p: *const f64) -> Self {
            Self(unsafe { _mm256_loadu_pd(p) })
        }
        #[inline(always)]
        unsafe fn store(self, p: *mut f64) {
            unsafe { _mm256_storeu_pd(p, self.0) }
        }
        #[inline(always)]
        unsafe fn load3(p: *const f64) -> Self {
            Self(unsafe { _mm256_maskload_pd(p, _mm256_setr_epi64x(-1, -1, -1, 0)) })
        }
        #[inline(always)]
        fn at(self, [a, b, c, d]: [u32; 4]) -> Self {
            // Each lane is two halves.
            let [p, q, r, s] = [a, b, c, d].map(|k| 2 * k as i32);
            unsafe {
                let halves = _mm256_setr_epi32(p, p + 1, q, q + 1, r, r + 1, s, s + 1);
                Self(_mm256_castps_pd(_mm256_permutevar8x32_ps(_mm256_castpd_ps(self.0), halves)))
            }
        }
        type Two = Sse;
        #[inline(always)]
        fn pairs_of(x: Self, y: Self) -> [Self; 2] {
            unsafe { [Self(_mm256_unpacklo_pd(x.0, y.0)), Self(_mm256_unpackhi_pd(x.0, y.0))] }
        }
        #[inline(always)]
        unsafe fn splat(a: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(a) })
        }
        #[inline(always)]
        fn transpose(rows: [Self; 4]) -> [Self; 4] {
            let [a, b, c, d] = rows;
            unsafe {
                let (ab, cd) = (_mm256_unpacklo_pd(a.0, b.0), _mm256_unpacklo_pd(c.0, d.0));
                let (hi_ab, hi_cd) = (_mm256_unpackhi_pd(a.0, b.0), _mm256_unpackhi_pd(c.0, d.0));
                [
                    Self(_mm256_permute2f128_pd::<0x20>(ab, cd)),
                    Self(_mm256_permute2f128_pd::<0x20>(hi_ab, hi_cd)),
                    Self(_mm256_permute2f128_pd::<0x31>(ab, cd)),
                    Self(_mm256_permute2f128_pd::<0x31>(hi_ab, hi_cd)),
                ]
            }
        }
        #[inline(always)]
        fn with_bits(self, bits: u8) -> __m256d {
            unsafe { _mm256_loadu_pd(MASKS[usize::from(bits & 15)].as_ptr().cast()) }
        }
        #[inline(always)]
        fn bits(mask: __m256d) -> u8 {
            unsafe { _mm256_movemask_pd(mask) as u8 }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::Lanes;

    /// Every operation on a few numbers, as bits.
    unsafe fn all<F: Four>() -> Vec<u64> {
        let (a, b) = ([1.5, -2.25, 0.0, 9.0], [0.3, 7.0, -0.0, f64::NAN]);
        let mut out = vec![];
        // SAFETY: arrays of four numbers.
        let (a, b) = unsafe { (F::load(a.as_ptr()), F::load(b.as_ptr())) };
        let mut put = |x: F| {
            let mut y = [0.0; 4];
            // SAFETY: an array of four numbers.
            unsafe { x.store(y.as_mut_ptr()) };
            // No standard fixes the sign of a NaN.
            out.extend(y.map(|y: f64| if y.is_nan() { 7 } else { y.to_bits() }));
        };
        for x in [a + b, a - b, a * b, a / b, -a, a.abs(), a.abs().sqrt(), a + 0.1, a - 0.1, a * 3.0, a / 7.0]
        {
            put(x);
        }
        for x in [a.most(b), b.most(a), a.least(b), b.least(a), a.each(f64::cbrt), a.like(4.0)] {
            put(x);
        }
        let mask = a.above(b);
        put(F::choose(mask, a, b));
        [mask, a.at_least(b), a.with_bits(0b1010)].into_iter().for_each(|mask| put((a + 1.0).keep(mask)));
        // Exact, so that it makes no difference how often it is rounded.
        [a.fma(a.like(2.0), b.like(0.5)), a.fnma(a.like(-4.0), a)].into_iter().for_each(&mut put);
        F::transpose([a, b, a + b, a - b]).into_iter().for_each(&mut put);
        let none = F::both(mask, b.above(a));
        // SAFETY: arrays of four numbers.
        unsafe {
            let (three, mut four) = ([3.0, -4.0, 5.0, 6.0], [7.0; 4]);
            put(F::load3(three.as_ptr()));
            for (k, pairs) in F::pairs_of(a, b).into_iter().enumerate() {
                let pair = F::Two::load(pairs.numbers().as_ptr().add(2 * k));
                pair.add_to(four.as_mut_ptr());
                pair.take_from(four.as_mut_ptr().add(1 + k));
                put(pairs);
            }
            put(F::load(four.as_ptr()));
        }
        [[0, 1, 2, 3], [3, 1, 0, 2], [2, 2, 3, 0]].into_iter().for_each(|at| put(a.at(at)));
        out.extend((0..16).map(|bits| u64::from(F::bits(a.with_bits(bits)))));
        out.extend([F::bits(mask), F::any(mask).into(), F::any(none).into()].map(u64::from));
        out
    }

    #[test]
    fn both_forms_give_the_same_bits() {
        // SAFETY: the portable form needs nothing.
        let plain = unsafe { all::<Plain>() };
        assert_eq!(plain[plain.len() - 3..], [1, 1, 0]);
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            // SAFETY: just asked.
            assert_eq!(unsafe { all::<Avx2>() }, plain);
        }
    }
}
