//! Two numbers side by side.

/// Two numbers and their way into memory. Sums are read in the parts in which they are written: a processor passes a number
/// on from a store to a load soon after only where the load lies within the store.
pub trait Pair: Copy {
    /// Both from memory.
    ///
    /// # Safety
    /// `p` must be readable for two numbers.
    unsafe fn load(p: *const f64) -> Self;
    /// Adds both to what stands at `p`.
    ///
    /// # Safety
    /// `p` must be readable and writable for two numbers.
    unsafe fn add_to(self, p: *mut f64);
    /// Takes both from what stands at `p`.
    ///
    /// # Safety
    /// As [`Pair::add_to`].
    unsafe fn take_from(self, p: *mut f64);
}

impl Pair for [f64; 2] {
    #[inline(always)]
    unsafe fn load(p: *const f64) -> Self {
        // SAFETY: passed on.
        unsafe { p.cast::<Self>().read() }
    }
    #[inline(always)]
    unsafe fn add_to(self, p: *mut f64) {
        // SAFETY: passed on.
        let to = unsafe { &mut *p.cast::<[f64; 2]>() };
        *to = [to[0] + self[0], to[1] + self[1]];
    }
    #[inline(always)]
    unsafe fn take_from(self, p: *mut f64) {
        // SAFETY: passed on.
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
        // SAFETY: passed on; every processor of this kind has SSE2.
        Self(unsafe { std::arch::x86_64::_mm_loadu_pd(p) })
    }
    #[inline(always)]
    unsafe fn add_to(self, p: *mut f64) {
        use std::arch::x86_64::*;
        // SAFETY: passed on; every processor of this kind has SSE2.
        unsafe { _mm_storeu_pd(p, _mm_add_pd(_mm_loadu_pd(p), self.0)) }
    }
    #[inline(always)]
    unsafe fn take_from(self, p: *mut f64) {
        use std::arch::x86_64::*;
        // SAFETY: passed on; every processor of this kind has SSE2.
        unsafe { _mm_storeu_pd(p, _mm_sub_pd(_mm_loadu_pd(p), self.0)) }
    }
}
