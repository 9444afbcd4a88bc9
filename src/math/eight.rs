//! Eight numbers side by side in one AVX-512 register, with the bits of four and four.

use super::four::{Avx2, Four, Lanes, operators};
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
fn joined(low: Avx2, high: Avx2) -> Avx512 {
    Avx512(unsafe { _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low.0), high.0) })
}

impl Lanes<8> for Avx512 {
    type Row = Avx2;
    #[inline(always)]
    fn of_rows(rows: [Avx2; 8]) -> [Self; 4] {
        let [a, b, c, d, e, f, g, h] = rows;
        let ([x, y, z, w], [p, q, r, s]) = (Avx2::transpose([a, b, c, d]), Avx2::transpose([e, f, g, h]));
        [joined(x, p), joined(y, q), joined(z, r), joined(w, s)]
    }
    #[inline(always)]
    fn to_rows(lanes: [Self; 4]) -> [Avx2; 8] {
        let low = |v: Self| Avx2(unsafe { _mm512_castpd512_pd256(v.0) });
        let high = |v: Self| Avx2(unsafe { _mm512_extractf64x4_pd::<1>(v.0) });
        let [x, y, z, w] = lanes;
        let [a, b, c, d] = Avx2::transpose([low(x), low(y), low(z), low(w)]);
        let [e, f, g, h] = Avx2::transpose([high(x), high(y), high(z), high(w)]);
        [a, b, c, d, e, f, g, h]
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

    /// The same operations on eight numbers in these lanes.
    fn several<const N: usize, V: Lanes<N>>(rows: [V::Row; N]) -> Vec<[f64; N]> {
        let [a, b, c, d] = V::of_rows(rows);
        let mask = V::both(a.above(b), c.above(d));
        let back = V::to_rows([a + b, b - c, c * d, d / a]);
        let [p, q, r, s] = V::of_rows(back);
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
        .into()
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
