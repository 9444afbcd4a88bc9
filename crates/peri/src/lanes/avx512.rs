//! Lanes in one AVX-512 register: the arithmetic of the AVX2 form, so the same bits, eight at a time.

use crate::lanes::Lanes;
use std::arch::x86_64::*;

/// Whether the processor has the parts of AVX-512 that are used here.
pub fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
        && is_x86_feature_detected!("fma")
}

/// Lanes in one AVX-512 register.
#[derive(Clone, Copy)]
pub struct Avx512(pub(crate) __m512d);

// SAFETY (all blocks): the caller promises that the processor has AVX-512 F and DQ, and that pointers are good.
impl Lanes for Avx512 {
    const WIDTH: usize = 8;
    #[inline(always)]
    unsafe fn splat(a: f64) -> Self {
        Self(unsafe { _mm512_set1_pd(a) })
    }
    #[inline(always)]
    unsafe fn load(p: *const f64) -> Self {
        Self(unsafe { _mm512_loadu_pd(p) })
    }
    #[inline(always)]
    unsafe fn fetch(p: *const f64) {
        unsafe { _mm_prefetch::<_MM_HINT_T0>(p.cast()) }
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut f64) {
        unsafe { _mm512_storeu_pd(p, self.0) }
    }
    #[inline(always)]
    unsafe fn mask(bits: u8) -> Self {
        Self(unsafe { _mm512_castsi512_pd(_mm512_movm_epi64(bits)) })
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        Self(unsafe { _mm512_add_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        Self(unsafe { _mm512_sub_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        Self(unsafe { _mm512_mul_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        Self(unsafe { _mm512_div_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn fma(self, b: Self, c: Self) -> Self {
        Self(unsafe { _mm512_fmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    unsafe fn fnma(self, b: Self, c: Self) -> Self {
        Self(unsafe { _mm512_fnmadd_pd(self.0, b.0, c.0) })
    }
    #[inline(always)]
    unsafe fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_pd(self.0) })
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        Self(unsafe { _mm512_max_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        Self(unsafe { _mm512_min_pd(self.0, b.0) })
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        Self(unsafe { _mm512_andnot_pd(_mm512_set1_pd(-0.0), self.0) })
    }
    #[inline(always)]
    unsafe fn ge(self, b: Self) -> Self {
        unsafe { Self::mask(_mm512_cmp_pd_mask::<_CMP_GE_OQ>(self.0, b.0)) }
    }
    #[inline(always)]
    unsafe fn keep(self, mask: Self) -> Self {
        Self(unsafe { _mm512_and_pd(self.0, mask.0) })
    }
    #[inline(always)]
    unsafe fn bits(self) -> u8 {
        unsafe { _mm512_movepi64_mask(_mm512_castpd_si512(self.0)) }
    }
}
