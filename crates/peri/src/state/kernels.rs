//! The loops of state-based laws compiled for each instruction set, and the choice among their forms.

use super::super::chunk::{CELLS, CLOSED, Chunk, Plain, SUMS};
#[cfg(target_arch = "x86_64")]
use super::super::chunk::{Wide, Widest};
#[cfg(target_arch = "x86_64")]
use super::super::lanes::Avx2;
use super::super::lanes::Portable;
use super::chunk::{Cells, Looking, add_up, pull, sums};
use super::law::BondLaw;
use super::terms::Term;

/// The kernels of one instruction set.
pub trait StateKernels: Sync {
    /// See [`Kernels::ALL_FORMS`](super::super::chunk::Kernels::ALL_FORMS).
    const ALL_FORMS: bool;
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
        const HALF: bool,
    >(
        a: &Chunk,
        s: &Cells,
    ) -> (f64, f64);
    /// Adds up a term; see [`add_up`].
    ///
    /// # Safety
    /// As for [`add_up`].
    unsafe fn add_up<
        T: Term,
        const DEGREE: usize,
        const MASKED: bool,
        const VARIOUS: bool,
        const HALF: bool,
    >(
        a: &Chunk,
        s: &Cells,
    );
    /// Energies and virials; see [`sums`].
    ///
    /// # Safety
    /// As for [`sums`].
    unsafe fn state_sums<W: BondLaw>(a: &Chunk, s: &Cells, look: &Looking) -> [[f64; CELLS]; SUMS];
}

/// Kernels of one instruction set from those for its lanes, and for those of half a chunk.
macro_rules! compiled_for {
    ($kernels:ty, $lanes:ty, $half:ty $(, $features:literal)?) => {
        impl StateKernels for $kernels {
            const ALL_FORMS: bool = <$kernels as super::super::chunk::Kernels>::ALL_FORMS;
            unsafe fn pull<
                W: BondLaw,
                const DEGREE: usize,
                const MASKED: bool,
                const TRACK: bool,
                const VARIOUS: bool,
                const HALF: bool,
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
                    const HALF: bool,
                >(
                    a: &Chunk,
                    s: &Cells,
                ) -> (f64, f64) {
                    // SAFETY: the caller's promise.
                    unsafe {
                        match HALF {
                            true => pull::<$half, W, DEGREE, MASKED, TRACK, VARIOUS, true>(a, s),
                            false => pull::<$lanes, W, DEGREE, MASKED, TRACK, VARIOUS, false>(a, s),
                        }
                    }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner::<W, DEGREE, MASKED, TRACK, VARIOUS, HALF>(a, s) }
            }
            unsafe fn add_up<
                T: Term,
                const DEGREE: usize,
                const MASKED: bool,
                const VARIOUS: bool,
                const HALF: bool,
            >(
                a: &Chunk,
                s: &Cells,
            ) {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner<
                    T: Term,
                    const DEGREE: usize,
                    const MASKED: bool,
                    const VARIOUS: bool,
                    const HALF: bool,
                >(
                    a: &Chunk,
                    s: &Cells,
                ) {
                    // SAFETY: the caller's promise.
                    unsafe {
                        match HALF {
                            true => add_up::<$half, T, DEGREE, MASKED, VARIOUS, true>(a, s),
                            false => add_up::<$lanes, T, DEGREE, MASKED, VARIOUS, false>(a, s),
                        }
                    }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner::<T, DEGREE, MASKED, VARIOUS, HALF>(a, s) }
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

compiled_for!(Plain, Portable, Portable);
#[cfg(target_arch = "x86_64")]
compiled_for!(Wide, Avx2, Avx2, "avx2,fma");
#[cfg(target_arch = "x86_64")]
compiled_for!(Widest, super::super::lanes512::Avx512, Avx2, "avx512f,avx512dq,avx512vl,avx2,fma");

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
    macro_rules! pull {
        ($($choice:tt)*) => { K::pull::<W, $($choice)*>(a, s) };
    }
    // SAFETY: the caller's promise.
    unsafe {
        if a.various.is_some() {
            return pull!(CLOSED, true, true, true, false);
        }
        if const { !K::ALL_FORMS } {
            return pull!(CLOSED, true, true, false, false);
        }
        if const { !W::ALL_FORMS } {
            return match degree {
                3 | 5 | 7 => pull!(7, true, true, false, false),
                10 | 16 => pull!(16, true, true, false, false),
                _ => pull!(CLOSED, true, true, false, false),
            };
        }
        match (degree, masked, track, s.half) {
            (3, _, false, true) => pull!(3, true, false, false, true),
            (5, _, false, true) => pull!(5, true, false, false, true),
            (7, _, false, true) => pull!(7, true, false, false, true),
            (10, _, false, true) => pull!(10, true, false, false, true),
            (16, _, false, true) => pull!(16, true, false, false, true),
            (3, false, false, _) => pull!(3, false, false, false, false),
            (3, true, false, _) => pull!(3, true, false, false, false),
            (3, _, true, _) => pull!(3, true, true, false, false),
            (5, false, false, _) => pull!(5, false, false, false, false),
            (5, true, false, _) => pull!(5, true, false, false, false),
            (7, false, false, _) => pull!(7, false, false, false, false),
            (7, true, false, _) => pull!(7, true, false, false, false),
            (5 | 7, _, true, _) => pull!(7, true, true, false, false),
            (10, _, false, _) => pull!(10, true, false, false, false),
            (16, _, false, _) => pull!(16, true, false, false, false),
            (10 | 16, _, true, _) => pull!(16, true, true, false, false),
            _ => pull!(CLOSED, true, true, false, false),
        }
    }
}

/// Adds up a term with the kernel for a degree.
///
/// # Safety
/// As for [`add_up`].
#[inline]
pub unsafe fn run_term<K: StateKernels, T: Term>(a: &Chunk, s: &Cells, degree: usize, masked: bool) {
    macro_rules! add_up {
        ($($choice:tt)*) => { K::add_up::<T, $($choice)*>(a, s) };
    }
    // SAFETY: the caller's promise.
    unsafe {
        if a.various.is_some() {
            return add_up!(CLOSED, true, true, false);
        }
        if const { !K::ALL_FORMS } {
            return add_up!(CLOSED, true, false, false);
        }
        match (degree, masked, s.half) {
            (3, _, true) => add_up!(3, true, false, true),
            (5, _, true) => add_up!(5, true, false, true),
            (7, _, true) => add_up!(7, true, false, true),
            (10, _, true) => add_up!(10, true, false, true),
            (16, _, true) => add_up!(16, true, false, true),
            (3, false, _) => add_up!(3, false, false, false),
            (3, true, _) => add_up!(3, true, false, false),
            (5, false, _) => add_up!(5, false, false, false),
            (5, true, _) => add_up!(5, true, false, false),
            (7, false, _) => add_up!(7, false, false, false),
            (7, true, _) => add_up!(7, true, false, false),
            (10, _, _) => add_up!(10, true, false, false),
            (16, _, _) => add_up!(16, true, false, false),
            _ => add_up!(CLOSED, true, false, false),
        }
    }
}
