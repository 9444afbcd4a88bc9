//! The loops of state-based laws compiled for each instruction set, and the choice among their forms.

use super::super::chunk::{CELLS, CLOSED, Chunk, Plain, SUMS};
#[cfg(target_arch = "x86_64")]
use super::super::chunk::{Wide, Widest};
use super::super::lanes::Portable;
use super::chunk::{Cells, Looking, add_up, pull, sums};
use super::law::BondLaw;
use super::terms::Term;

/// The kernels of one instruction set.
pub trait StateKernels: Sync {
    /// Adds forces; see [`pull`].
    ///
    /// # Safety
    /// As for [`pull`].
    unsafe fn pull<
        W: BondLaw,
        const DEGREE: usize,
        const MASKED: bool,
        const TRACK: bool,
        const VARIOUS: bool,
    >(
        a: &Chunk,
        s: &Cells,
    ) -> (f64, f64);
    /// Adds up a term; see [`add_up`].
    ///
    /// # Safety
    /// As for [`add_up`].
    unsafe fn add_up<T: Term, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool>(
        a: &Chunk,
        s: &Cells,
    );
    /// Energies and virials; see [`sums`].
    ///
    /// # Safety
    /// As for [`sums`].
    unsafe fn state_sums<W: BondLaw>(a: &Chunk, s: &Cells, look: &Looking) -> [[f64; CELLS]; SUMS];
}

/// Kernels of one instruction set from those for its lanes.
macro_rules! compiled_for {
    ($kernels:ty, $lanes:ty $(, $features:literal)?) => {
        impl StateKernels for $kernels {
            unsafe fn pull<
                W: BondLaw,
                const DEGREE: usize,
                const MASKED: bool,
                const TRACK: bool,
                const VARIOUS: bool,
            >(
                a: &Chunk,
                s: &Cells,
            ) -> (f64, f64) {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner<
                    W: BondLaw,
                    const DEGREE: usize,
                    const MASKED: bool,
                    const TRACK: bool,
                    const VARIOUS: bool,
                >(
                    a: &Chunk,
                    s: &Cells,
                ) -> (f64, f64) {
                    // SAFETY: the caller's promise.
                    unsafe { pull::<$lanes, W, DEGREE, MASKED, TRACK, VARIOUS>(a, s) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner::<W, DEGREE, MASKED, TRACK, VARIOUS>(a, s) }
            }
            unsafe fn add_up<T: Term, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool>(
                a: &Chunk,
                s: &Cells,
            ) {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner<T: Term, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool>(
                    a: &Chunk,
                    s: &Cells,
                ) {
                    // SAFETY: the caller's promise.
                    unsafe { add_up::<$lanes, T, DEGREE, MASKED, VARIOUS>(a, s) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner::<T, DEGREE, MASKED, VARIOUS>(a, s) }
            }
            unsafe fn state_sums<W: BondLaw>(a: &Chunk, s: &Cells, look: &Looking) -> [[f64; CELLS]; SUMS] {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner<W: BondLaw>(a: &Chunk, s: &Cells, look: &Looking) -> [[f64; CELLS]; SUMS] {
                    // SAFETY: the caller's promise.
                    unsafe { sums::<$lanes, W>(a, s, look) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner::<W>(a, s, look) }
            }
        }
    };
}

compiled_for!(Plain, Portable);
#[cfg(target_arch = "x86_64")]
compiled_for!(Wide, super::super::lanes::Avx2, "avx2,fma");
#[cfg(target_arch = "x86_64")]
compiled_for!(Widest, super::super::lanes512::Avx512, "avx512f,avx512dq,avx512vl,avx2,fma");

/// Adds forces with the kernel for a degree and the other choices.
///
/// # Safety
/// As for [`pull`].
#[inline]
pub unsafe fn run<K: StateKernels, W: BondLaw>(
    a: &Chunk,
    s: &Cells,
    degree: usize,
    masked: bool,
    track: bool,
) -> (f64, f64) {
    // SAFETY: the caller's promise.
    unsafe {
        if a.various.is_some() {
            return K::pull::<W, CLOSED, true, true, true>(a, s);
        }
        match (degree, masked, track) {
            (3, false, false) => K::pull::<W, 3, false, false, false>(a, s),
            (3, false, true) => K::pull::<W, 3, false, true, false>(a, s),
            (3, true, false) => K::pull::<W, 3, true, false, false>(a, s),
            (3, true, true) => K::pull::<W, 3, true, true, false>(a, s),
            (5 | 7, false, false) => K::pull::<W, 7, false, false, false>(a, s),
            (5 | 7, _, _) => K::pull::<W, 7, true, true, false>(a, s),
            _ => K::pull::<W, CLOSED, true, true, false>(a, s),
        }
    }
}

/// Adds up a term with the kernel for a degree.
///
/// # Safety
/// As for [`add_up`].
#[inline]
pub unsafe fn run_term<K: StateKernels, T: Term>(a: &Chunk, s: &Cells, degree: usize, masked: bool) {
    // SAFETY: the caller's promise.
    unsafe {
        if a.various.is_some() {
            return K::add_up::<T, CLOSED, true, true>(a, s);
        }
        match (degree, masked) {
            (3, false) => K::add_up::<T, 3, false, false>(a, s),
            (3, true) => K::add_up::<T, 3, true, false>(a, s),
            (5 | 7, false) => K::add_up::<T, 7, false, false>(a, s),
            (5 | 7, true) => K::add_up::<T, 7, true, false>(a, s),
            _ => K::add_up::<T, CLOSED, true, false>(a, s),
        }
    }
}
