//! Eight numbers side by side in one AVX-512 register, with the bits of four and four.

use super::four::{Avx2, Lanes, operators};
use super::pair::Sse;
use super::real::Real;
use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Whether the processor has the parts of AVX-512 that are used here.
pub fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("avx2")
}

/// Eight lanes in one register. There is a value of this type only where the processor has AVX-512: what makes one from
/// nothing is unsafe and promises that.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(__m512d);

// SAFETY (all blocks): a value exists, so the processor has AVX-512; or the caller promises that.

operators! { Avx512, a b:
    Add add Avx512(unsafe { _mm512_add_pd(a.0, b.0) });
    Sub sub Avx512(unsafe { _mm512_sub_pd(a.0, b.0) });
    Mul mul Avx512(unsafe { _mm512_mul_pd(a.0, b.0) });
    Div div Avx512(unsafe { _mm512_div_pd(a.0, b.0) });
}

impl Neg for Avx512 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(unsafe { _mm512_xor_pd(_mm512_set1_pd(-0.0), self.0) })
    }
}

impl Real for Avx512 {
    type Mask = __mmask8;

    #[inline(always)]
    fn like(self, a: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(a) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(unsafe { _mm512_andnot_pd(_mm512_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    fn most(self, other: Self) -> Self {
        Self(unsafe { _mm512_max_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn least(self, other: Self) -> Self {
        Self(unsafe { _mm512_min_pd(self.0, other.0) })
    }
    #[inline(always)]
    fn above(self, other: Self) -> __mmask8 {
        unsafe { _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn both(a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }
    #[inline(always)]
    fn choose(mask: __mmask8, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn any(mask: __mmask8) -> bool {
        mask != 0
    }
    #[inline(always)]
    fn each(self, f: impl Fn(f64) -> f64) -> Self {
        let a = self.numbers().map(f);
        Self(unsafe { _mm512_loadu_pd(a.as_ptr()) })
    }
}

/// Two halves side by side.
#[inline(always)]
unsafe fn joined(low: Avx2, high: Avx2) -> __m512d {
    unsafe { _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low.0), high.0) }
}

#[inline(always)]
unsafe fn halves(v: __m512d) -> [Avx2; 2] {
    unsafe { [Avx2(_mm512_castpd512_pd256(v)), Avx2(_mm512_extractf64x4_pd::<1>(v))] }
}

#[inline(always)]
unsafe fn quarters(v: __m512d) -> [Sse; 4] {
    unsafe {
        let [Avx2(low), Avx2(high)] = halves(v);
        [
            Sse(_mm256_castpd256_pd128(low)),
            Sse(_mm256_extractf128_pd::<1>(low)),
            Sse(_mm256_castpd256_pd128(high)),
            Sse(_mm256_extractf128_pd::<1>(high)),
        ]
    }
}

impl Lanes<8> for Avx512 {
    type Row = Avx2;
    type Pair = Sse;
    #[inline(always)]
    fn of_rows(rows: [Avx2; 8]) -> [Self; 4] {
        let [a, b, c, d, e, f, g, h] = rows;
        unsafe {
            let (ac, bd, eg, fh) = (joined(a, c), joined(b, d), joined(e, g), joined(f, h));
            // x and z of rows a b | c d, of rows e f | g h; then y and w.
            let (xz, xz2) = (_mm512_unpacklo_pd(ac, bd), _mm512_unpacklo_pd(eg, fh));
            let (yw, yw2) = (_mm512_unpackhi_pd(ac, bd), _mm512_unpackhi_pd(eg, fh));
            [
                Self(_mm512_shuffle_f64x2::<0b10_00_10_00>(xz, xz2)),
                Self(_mm512_shuffle_f64x2::<0b10_00_10_00>(yw, yw2)),
                Self(_mm512_shuffle_f64x2::<0b11_01_11_01>(xz, xz2)),
                Self(_mm512_shuffle_f64x2::<0b11_01_11_01>(yw, yw2)),
            ]
        }
    }
    #[inline(always)]
    fn to_rows(lanes: [Self; 4]) -> [Avx2; 8] {
        let [Self(x), Self(y), Self(z), Self(w)] = lanes;
        unsafe {
            // x and y of every other row; then z and w.
            let (xy0, xy1) = (_mm512_unpacklo_pd(x, y), _mm512_unpackhi_pd(x, y));
            let (zw0, zw1) = (_mm512_unpacklo_pd(z, w), _mm512_unpackhi_pd(z, w));
            let (low, high) =
                (_mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11), _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15));
            let (ac, eg) = (_mm512_permutex2var_pd(xy0, low, zw0), _mm512_permutex2var_pd(xy0, high, zw0));
            let (bd, fh) = (_mm512_permutex2var_pd(xy1, low, zw1), _mm512_permutex2var_pd(xy1, high, zw1));
            let ([a, c], [b, d], [e, g], [f, h]) = (halves(ac), halves(bd), halves(eg), halves(fh));
            [a, b, c, d, e, f, g, h]
        }
    }
    #[inline(always)]
    fn pairs(x: Self, y: Self) -> [Sse; 8] {
        unsafe {
            let (even, odd) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
            let ([a, c, e, g], [b, d, f, h]) = (quarters(even), quarters(odd));
            [a, b, c, d, e, f, g, h]
        }
    }
    #[inline(always)]
    unsafe fn all(a: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(a) })
    }
    #[inline(always)]
    unsafe fn of(a: [f64; 8]) -> Self {
        Self(unsafe { _mm512_loadu_pd(a.as_ptr()) })
    }
    #[inline(always)]
    fn numbers(self) -> [f64; 8] {
        let mut out = [0.0; 8];
        unsafe { _mm512_storeu_pd(out.as_mut_ptr(), self.0) };
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::four::Four;
    use crate::math::pair::Pair;

    /// The same operations on eight numbers in these lanes.
    fn several<const N: usize, V: Lanes<N>>(rows: [V::Row; N]) -> Vec<[f64; N]> {
        let [a, b, c, d] = V::of_rows(rows);
        let mask = V::both(a.above(b), c.above(d));
        let back = V::to_rows([a + b, b - c, c * d, d / a]);
        let [p, q, r, s] = V::of_rows(back);
        let two = V::pairs(a * b, c);
        let mut sums = [[1.0; 2]; N];
        for (sum, pair) in sums.iter_mut().zip(two) {
            // SAFETY: two numbers.
            unsafe { pair.add_to(sum.as_mut_ptr()) };
        }
        let none = if V::any(V::both(mask, b.above(a))) { a } else { -a };
        [
            a,
            b,
            p,
            q,
            r,
            s,
            c.abs().sqrt(),
            a.most(b),
            a.least(c),
            V::choose(mask, a, d),
            none,
            a.each(f64::cbrt),
        ]
        .map(|v| v.numbers())
        .into_iter()
        .chain([0, 1].map(|d| sums.map(|s| s[d])))
        .collect()
    }

    #[test]
    fn eight_lanes_have_the_bits_of_four() {
        if !has_avx512() {
            return;
        }
        let table: [[f64; 4]; 8] =
            std::array::from_fn(|k| std::array::from_fn(|l| (k as f64 - 3.5) * (l as f64 + 0.7) / 0.3));
        // SAFETY: the processor was asked; arrays of four numbers.
        let row = |k: usize| unsafe { Avx2::load(table[k].as_ptr()) };
        let eight = several::<8, Avx512>(std::array::from_fn(row));
        let low = several::<4, Avx2>(std::array::from_fn(row));
        let high = several::<4, Avx2>(std::array::from_fn(|k| row(k + 4)));
        for ((e, l), h) in eight.iter().zip(&low).zip(&high) {
            let (first, second) = e.split_at(4);
            assert_eq!(first.iter().map(|a| a.to_bits()).collect::<Vec<_>>(), l.map(f64::to_bits));
            assert_eq!(second.iter().map(|a| a.to_bits()).collect::<Vec<_>>(), h.map(f64::to_bits));
        }
    }
}
