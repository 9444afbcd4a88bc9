//! Several numbers at a time: the portable form and AVX2+FMA (AVX-512 elsewhere) behind one trait, so that a law is written once.

#[cfg(target_arch = "x86_64")]
pub mod avx512;
pub mod isa;
pub mod rows;
pub mod single;

/// Some `f64` lanes, four or eight. Masks are lanes whose bits are all ones (yes) or all zeros (no).
///
/// All methods are inlined into kernels; the AVX2 form may only be used inside functions compiled for it.
pub trait Lanes: Copy {
    /// How many lanes.
    const WIDTH: usize;
    /// The same number in every lane.
    ///
    /// # Safety
    /// As for every method here: the processor must have what the form needs.
    unsafe fn splat(a: f64) -> Self;
    /// As many consecutive numbers as there are lanes, aligned or not.
    ///
    /// # Safety
    /// `p` must be readable for that many.
    unsafe fn load(p: *const f64) -> Self;
    /// Says that what lies at `p` will be wanted soon, if there is anything.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    #[inline(always)]
    unsafe fn fetch(_p: *const f64) {}
    /// Writes as many consecutive numbers as there are lanes.
    ///
    /// # Safety
    /// `p` must be writable for that many.
    unsafe fn store(self, p: *mut f64);
    /// Lanes `k` from bit `k` of `bits`.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn mask(bits: u8) -> Self;
    /// Sum.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn add(self, b: Self) -> Self;
    /// Difference.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn sub(self, b: Self) -> Self;
    /// Product.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn mul(self, b: Self) -> Self;
    /// Quotient.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn div(self, b: Self) -> Self;
    /// `self * b + c`, rounded once where the processor can.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn fma(self, b: Self, c: Self) -> Self;
    /// `c - self * b`, rounded once where the processor can.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn fnma(self, b: Self, c: Self) -> Self;
    /// Square root.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn sqrt(self) -> Self;
    /// The larger; `b` where either is NaN.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn max(self, b: Self) -> Self;
    /// The smaller; `b` where either is NaN.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn min(self, b: Self) -> Self;
    /// Magnitude.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn abs(self) -> Self;
    /// Mask of the lanes where `self >= b`.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn ge(self, b: Self) -> Self;
    /// Zero where the mask says no.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn keep(self, mask: Self) -> Self;
    /// The lanes of a mask as bits.
    ///
    /// # Safety
    /// See [`Lanes::splat`].
    unsafe fn bits(self) -> u8;
}

/// Lanes as an array: any processor.
#[derive(Clone, Copy)]
pub struct Portable(pub(crate) [f64; 4]);

impl Portable {
    #[inline(always)]
    fn zip(self, b: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self([f(self.0[0], b.0[0]), f(self.0[1], b.0[1]), f(self.0[2], b.0[2]), f(self.0[3], b.0[3])])
    }
}

impl Lanes for Portable {
    const WIDTH: usize = 4;
    #[inline(always)]
    unsafe fn splat(a: f64) -> Self {
        Self([a; 4])
    }
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
    unsafe fn mask(bits: u8) -> Self {
        Self(MASKS[usize::from(bits & 15)].map(f64::from_bits))
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        self.zip(b, |a, b| a + b)
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        self.zip(b, |a, b| a - b)
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        self.zip(b, |a, b| a * b)
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        self.zip(b, |a, b| a / b)
    }
    #[inline(always)]
    unsafe fn fma(self, b: Self, c: Self) -> Self {
        self.zip(b, |a, b| a * b).zip(c, |p, c| p + c)
    }
    #[inline(always)]
    unsafe fn fnma(self, b: Self, c: Self) -> Self {
        self.zip(b, |a, b| a * b).zip(c, |p, c| c - p)
    }
    #[inline(always)]
    unsafe fn sqrt(self) -> Self {
        Self(self.0.map(f64::sqrt))
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        self.zip(b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        self.zip(b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        Self(self.0.map(f64::abs))
    }
    #[inline(always)]
    unsafe fn ge(self, b: Self) -> Self {
        self.zip(b, |a, b| f64::from_bits(if a >= b { u64::MAX } else { 0 }))
    }
    #[inline(always)]
    unsafe fn keep(self, mask: Self) -> Self {
        self.zip(mask, |a, m| f64::from_bits(a.to_bits() & m.to_bits()))
    }
    #[inline(always)]
    unsafe fn bits(self) -> u8 {
        self.0.iter().rev().fold(0, |bits, m| bits << 1 | u8::from(m.to_bits() != 0))
    }
}

/// Lane masks of all four-bit numbers.
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
pub use x86::Avx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Lanes, MASKS};

    /// Lanes in one AVX register.
    #[derive(Clone, Copy)]
    pub struct Avx2(pub(crate) __m256d);

    // SAFETY (all blocks): the caller promises that the processor has AVX2 and FMA, and that pointers are good.
    impl Lanes for Avx2 {
        const WIDTH: usize = 4;
        #[inline(always)]
        unsafe fn splat(a: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(a) })
        }
        #[inline(always)]
        unsafe fn load(p: *const f64) -> Self {
            Self(unsafe { _mm256_loadu_pd(p) })
        }
        #[inline(always)]
        unsafe fn fetch(p: *const f64) {
            unsafe { _mm_prefetch::<_MM_HINT_T0>(p.cast()) }
        }
        #[inline(always)]
        unsafe fn store(self, p: *mut f64) {
            unsafe { _mm256_storeu_pd(p, self.0) }
        }
        #[inline(always)]
        unsafe fn mask(bits: u8) -> Self {
            Self(unsafe { _mm256_loadu_pd(MASKS.get_unchecked(usize::from(bits & 15)).as_ptr().cast()) })
        }
        #[inline(always)]
        unsafe fn add(self, b: Self) -> Self {
            Self(unsafe { _mm256_add_pd(self.0, b.0) })
        }
        #[inline(always)]
        unsafe fn sub(self, b: Self) -> Self {
            Self(unsafe { _mm256_sub_pd(self.0, b.0) })
        }
        #[inline(always)]
        unsafe fn mul(self, b: Self) -> Self {
            Self(unsafe { _mm256_mul_pd(self.0, b.0) })
        }
        #[inline(always)]
        unsafe fn div(self, b: Self) -> Self {
            Self(unsafe { _mm256_div_pd(self.0, b.0) })
        }
        #[inline(always)]
        unsafe fn fma(self, b: Self, c: Self) -> Self {
            Self(unsafe { _mm256_fmadd_pd(self.0, b.0, c.0) })
        }
        #[inline(always)]
        unsafe fn fnma(self, b: Self, c: Self) -> Self {
            Self(unsafe { _mm256_fnmadd_pd(self.0, b.0, c.0) })
        }
        #[inline(always)]
        unsafe fn sqrt(self) -> Self {
            Self(unsafe { _mm256_sqrt_pd(self.0) })
        }
        #[inline(always)]
        unsafe fn max(self, b: Self) -> Self {
            Self(unsafe { _mm256_max_pd(self.0, b.0) })
        }
        #[inline(always)]
        unsafe fn min(self, b: Self) -> Self {
            Self(unsafe { _mm256_min_pd(self.0, b.0) })
        }
        #[inline(always)]
        unsafe fn abs(self) -> Self {
            Self(unsafe { _mm256_andnot_pd(_mm256_set1_pd(-0.0), self.0) })
        }
        #[inline(always)]
        unsafe fn ge(self, b: Self) -> Self {
            Self(unsafe { _mm256_cmp_pd::<_CMP_GE_OQ>(self.0, b.0) })
        }
        #[inline(always)]
        unsafe fn keep(self, mask: Self) -> Self {
            Self(unsafe { _mm256_and_pd(self.0, mask.0) })
        }
        #[inline(always)]
        unsafe fn bits(self) -> u8 {
            unsafe { _mm256_movemask_pd(self.0) as u8 }
        }
    }
}
