//! One number at a time behind the trait of the lanes, so that lists and energies share the laws' text with the lattice.

use crate::lanes::Lanes;

/// One number.
#[derive(Clone, Copy, Debug)]
pub struct Single(pub f64);

// SAFETY (all methods): plain arithmetic; pointers are good by the caller's promise.
impl Lanes for Single {
    const WIDTH: usize = 1;
    #[inline(always)]
    unsafe fn splat(a: f64) -> Self {
        Self(a)
    }
    #[inline(always)]
    unsafe fn load(p: *const f64) -> Self {
        // SAFETY: readable by the caller's promise.
        Self(unsafe { *p })
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut f64) {
        // SAFETY: writable by the caller's promise.
        unsafe { *p = self.0 }
    }
    #[inline(always)]
    unsafe fn mask(bits: u8) -> Self {
        Self(if bits & 1 == 1 { f64::from_bits(u64::MAX) } else { 0.0 })
    }
    #[inline(always)]
    unsafe fn add(self, b: Self) -> Self {
        Self(self.0 + b.0)
    }
    #[inline(always)]
    unsafe fn sub(self, b: Self) -> Self {
        Self(self.0 - b.0)
    }
    #[inline(always)]
    unsafe fn mul(self, b: Self) -> Self {
        Self(self.0 * b.0)
    }
    #[inline(always)]
    unsafe fn div(self, b: Self) -> Self {
        Self(self.0 / b.0)
    }
    #[inline(always)]
    unsafe fn fma(self, b: Self, c: Self) -> Self {
        Self(self.0 * b.0 + c.0)
    }
    #[inline(always)]
    unsafe fn fnma(self, b: Self, c: Self) -> Self {
        Self(c.0 - self.0 * b.0)
    }
    #[inline(always)]
    unsafe fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    unsafe fn max(self, b: Self) -> Self {
        if self.0 > b.0 { self } else { b }
    }
    #[inline(always)]
    unsafe fn min(self, b: Self) -> Self {
        if self.0 < b.0 { self } else { b }
    }
    #[inline(always)]
    unsafe fn abs(self) -> Self {
        Self(self.0.abs())
    }
    #[inline(always)]
    unsafe fn ge(self, b: Self) -> Self {
        Self(if self.0 >= b.0 { f64::from_bits(u64::MAX) } else { 0.0 })
    }
    #[inline(always)]
    unsafe fn keep(self, mask: Self) -> Self {
        Self(f64::from_bits(self.0.to_bits() & mask.0.to_bits()))
    }
    #[inline(always)]
    unsafe fn bits(self) -> u8 {
        u8::from(self.0.to_bits() != 0)
    }
}
