//! The loops of the lattice as kernels, and the choice among their forms.

use std::marker::PhantomData;

use crate::lanes::isa::{Isa, Kernel};
use crate::lattice::chunk::{CELLS, CLOSED, Chunk, SUMS};
use crate::lattice::energies::{Looking, sums};
use crate::lattice::kernels::{Cells, add_up, pull};
use crate::law::BondLaw;
use crate::law::terms::Term;

/// Adds forces; see [`pull`].
struct Pull<
    'a,
    W,
    const DEGREE: usize,
    const MASKED: bool,
    const TRACK: bool,
    const VARIOUS: bool,
    const HALF: bool,
>(&'a Chunk<'a>, &'a Cells<'a>, PhantomData<W>);

impl<
    W: BondLaw,
    const DEGREE: usize,
    const MASKED: bool,
    const TRACK: bool,
    const VARIOUS: bool,
    const HALF: bool,
> Kernel for Pull<'_, W, DEGREE, MASKED, TRACK, VARIOUS, HALF>
{
    type Out = (f64, f64);
    #[inline(always)]
    unsafe fn run<L: Isa>(self) -> (f64, f64) {
        // SAFETY: the caller's promise.
        unsafe {
            match HALF {
                true => pull::<L::Four, W, DEGREE, MASKED, TRACK, VARIOUS, true>(self.0, self.1),
                false => pull::<L, W, DEGREE, MASKED, TRACK, VARIOUS, false>(self.0, self.1),
            }
        }
    }
}

/// Adds up a term; see [`add_up`].
struct AddUp<'a, T, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool, const HALF: bool>(
    &'a Chunk<'a>,
    &'a Cells<'a>,
    PhantomData<T>,
);

impl<T: Term, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool, const HALF: bool> Kernel
    for AddUp<'_, T, DEGREE, MASKED, VARIOUS, HALF>
{
    type Out = ();
    #[inline(always)]
    unsafe fn run<L: Isa>(self) {
        // SAFETY: the caller's promise.
        unsafe {
            match HALF {
                true => add_up::<L::Four, T, DEGREE, MASKED, VARIOUS, true>(self.0, self.1),
                false => add_up::<L, T, DEGREE, MASKED, VARIOUS, false>(self.0, self.1),
            }
        }
    }
}

/// Energies and virials; see [`sums`].
pub struct Sums<'a, W> {
    /// The chunk.
    pub chunk: &'a Chunk<'a>,
    /// What its cells have.
    pub cells: &'a Cells<'a>,
    /// What energies need besides.
    pub look: &'a Looking<'a>,
    /// The law.
    pub law: PhantomData<W>,
}

impl<W: BondLaw> Kernel for Sums<'_, W> {
    type Out = [[f64; CELLS]; SUMS];
    #[inline(always)]
    unsafe fn run<L: Isa>(self) -> Self::Out {
        // SAFETY: the caller's promise.
        unsafe { sums::<L, W>(self.chunk, self.cells, self.look) }
    }
}

/// Adds forces with the kernel for a degree and the other choices.
///
/// # Safety
/// As for [`pull`].
#[inline]
pub unsafe fn run<K: Isa, W: BondLaw>(
    a: &Chunk,
    s: &Cells,
    degree: usize,
    masked: bool,
    track: bool,
) -> (f64, f64) {
    macro_rules! pull {
        ($($choice:tt)*) => { K::call(Pull::<W, $($choice)*>(a, s, PhantomData)) };
    }
    // SAFETY: the caller's promise.
    unsafe {
        if a.various.is_some() {
            if const { K::ALL_FORMS && W::PLAIN } {
                return match degree {
                    3 => pull!(3, true, true, true, false),
                    5 => pull!(5, true, true, true, false),
                    7 => pull!(7, true, true, true, false),
                    10 | 16 => pull!(16, true, true, true, false),
                    _ => pull!(CLOSED, true, true, true, false),
                };
            }
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
            (3 | 5 | 7, _, true, true) => pull!(7, true, true, false, true),
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
pub unsafe fn run_term<K: Isa, T: Term>(a: &Chunk, s: &Cells, degree: usize, masked: bool) {
    macro_rules! add_up {
        ($($choice:tt)*) => { K::call(AddUp::<T, $($choice)*>(a, s, PhantomData)) };
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
