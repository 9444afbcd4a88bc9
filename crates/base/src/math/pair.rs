//! Two numbers in one register.

/// Two numbers with loads and stores. Sums are read with the same width as they are written: a processor
/// forwards a recent store to a load only if the load lies within the store.
pub trait Pair: Copy {
    /// Loads both.
    ///
    /// # Safety
    /// `p` must be readable for two numbers.
    unsafe fn load(p: *const f64) -> Self;
    /// Adds both to the numbers at `p`.
    ///
    /// # Safety
    /// `p` must be readable and writable for two numbers.
    unsafe fn add_to(self, p: *mut f64);
    /// Subtracts both from the numbers at `p`.
    ///
    /// # Safety
    /// As for [`Pair::add_to`].
    unsafe fn take_from(self, p: *mut f64);
}

impl Pair for [f64; 2] {
    #[inline(always)]
    unsafe fn load(p: *const f64) -> Self {
        // SAFETY: the caller's guarantee.
        unsafe { p.cast::<Self>().read() }
    }
    #[inline(always)]
    unsafe fn add_to(self, p: *mut f64) {
        // SAFETY: the caller's guarantee.
        let to = unsafe { &mut *p.cast::<[f64; 2]>() };
        *to = [to[0] + self[0], to[1] + self[1]];
    }
    #[inline(always)]
    unsafe fn take_from(self, p: *mut f64) {
        // SAFETY: the caller's guarantee.
        let to = unsafe { &mut *p.cast::<[f64; 2]>() };
        *to = [to[0] - self[0], to[1] - self[1]];
    }
}

/// Two numbers in one register.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
pub struct Sse(pub(in crate::math) std::arch::x86_64::__m128d);

#[cfg(target_arch = "x86_64")]
impl Pair for Sse {
    #[inline(always)]
    unsafe fn load(p: *const f64) -> Self {
        // SAFETY: the caller's guarantee; every x86-64 processor has SSE2.
        Self(unsafe { std::arch::x86_64::_mm_loadu_pd(p) })
    }
    #[inline(always)]
    unsafe fn add_to(self, p: *mut f64) {
        use std::arch::x86_64::*;
        // SAFETY: the caller's guarantee; every x86-64 processor has SSE2.
        unsafe { _mm_storeu_pd(p, _mm_add_pd(_mm_loadu_pd(p), self.0)) }
    }
    #[inline(always)]
    unsafe fn take_from(self, p: *mut f64) {
        use std::arch::x86_64::*;
        // SAFETY: the caller's guarantee; every x86-64 processor has SSE2.
        unsafe { _mm_storeu_pd(p, _mm_sub_pd(_mm_loadu_pd(p), self.0)) }
    }
}
