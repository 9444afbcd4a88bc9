//! The loops of the lattice as kernels, and the choice among their forms.

use std::marker::PhantomData;

use crate::lattice::chunk::{CELLS, CLOSED, Chunk, SUMS};
use crate::lattice::energies::{Looking, sums};
use crate::lattice::kernels::{Cells, add_up, pull};
use crate::law::formula::BondLaw;
use crate::law::terms::Term;
use perigrain_base::math::form::{Form, InLanes, Isa};
use perigrain_base::math::four::Plain;
#[cfg(target_arch = "x86_64")]
use perigrain_base::math::four::{Avx2, Avx512};
use perigrain_base::math::lanes::Lanes;

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
> InLanes for Pull<'_, W, DEGREE, MASKED, TRACK, VARIOUS, HALF>
{
    type Out = (f64, f64);
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> (f64, f64) {
        // SAFETY: the caller's promise.
        unsafe { pull::<N, V, W, DEGREE, MASKED, TRACK, VARIOUS, HALF>(self.0, self.1) }
    }
}

/// Adds up a term; see [`add_up`].
struct AddUp<'a, T, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool, const HALF: bool>(
    &'a Chunk<'a>,
    &'a Cells<'a>,
    PhantomData<T>,
);

impl<T: Term, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool, const HALF: bool> InLanes
    for AddUp<'_, T, DEGREE, MASKED, VARIOUS, HALF>
{
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        // SAFETY: the caller's promise.
        unsafe { add_up::<N, V, T, DEGREE, MASKED, VARIOUS, HALF>(self.0, self.1) }
    }
}

/// Energies and virials; see [`sums`].
struct Sums<'a, W> {
    /// The chunk.
    chunk: &'a Chunk<'a>,
    /// What its cells have.
    cells: &'a Cells<'a>,
    /// What energies need besides.
    look: &'a Looking<'a>,
    /// The law.
    law: PhantomData<W>,
}

impl<W: BondLaw> InLanes for Sums<'_, W> {
    type Out = [[f64; CELLS]; SUMS];
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> Self::Out {
        // SAFETY: the caller's promise.
        unsafe { sums::<N, V, W>(self.chunk, self.cells, self.look) }
    }
}

/// A call for the instruction set of a form.
macro_rules! for_form {
    ($form:expr, $K:ident => $e:expr) => {
        match $form {
            #[cfg(target_arch = "x86_64")]
            Form::Gathers { .. } | Form::Eight { .. } => {
                type $K = Avx512<false>;
                $e
            }
            #[cfg(target_arch = "x86_64")]
            Form::Four { .. } => {
                type $K = Avx2;
                $e
            }
            Form::Plain => {
                type $K = Plain;
                $e
            }
        }
    };
}

/// Adds forces with the kernel for a form of this processor, a degree and the other choices. Without `masked` all bonds of all eight cells
/// must live, or what comes out is wrong.
#[inline]
pub fn run<W: BondLaw>(
    form: Form,
    (a, s): (&Chunk, &Cells),
    degree: usize,
    masked: bool,
    track: bool,
) -> (f64, f64) {
    for_form!(form, K => forces::<K, W>((a, s), degree, masked, track))
}

/// [`run`] with an instruction set.
#[inline]
fn forces<K: Isa, W: BondLaw>(
    (a, s): (&Chunk, &Cells),
    degree: usize,
    masked: bool,
    track: bool,
) -> (f64, f64) {
    macro_rules! pull {
        (half $($choice:tt)*) => { K::run_four(Pull::<W, $($choice)*, true>(a, s, PhantomData)) };
        ($($choice:tt)*) => { K::run(Pull::<W, $($choice)*, false>(a, s, PhantomData)) };
    }
    // SAFETY: forms are those of the processor; for memory, chunk and cells answer.
    unsafe {
        if a.various.is_some() {
            if const { K::FAST && W::PLAIN } {
                return match degree {
                    3 => pull!(3, true, true, true),
                    5 => pull!(5, true, true, true),
                    7 => pull!(7, true, true, true),
                    10 | 16 => pull!(16, true, true, true),
                    _ => pull!(CLOSED, true, true, true),
                };
            }
            return pull!(CLOSED, true, true, true);
        }
        if const { !K::FAST } {
            return pull!(CLOSED, true, true, false);
        }
        if const { !W::ALL_FORMS } {
            return match degree {
                3 | 5 | 7 => pull!(7, true, true, false),
                10 | 16 => pull!(16, true, true, false),
                _ => pull!(CLOSED, true, true, false),
            };
        }
        match (degree, masked, track, s.half) {
            (3, _, false, true) => pull!(half 3, true, false, false),
            (5, _, false, true) => pull!(half 5, true, false, false),
            (7, _, false, true) => pull!(half 7, true, false, false),
            (10, _, false, true) => pull!(half 10, true, false, false),
            (16, _, false, true) => pull!(half 16, true, false, false),
            (3 | 5 | 7, _, true, true) => pull!(half 7, true, true, false),
            (3, false, false, _) => pull!(3, false, false, false),
            (3, true, false, _) => pull!(3, true, false, false),
            (3, _, true, _) => pull!(3, true, true, false),
            (5, false, false, _) => pull!(5, false, false, false),
            (5, true, false, _) => pull!(5, true, false, false),
            (7, false, false, _) => pull!(7, false, false, false),
            (7, true, false, _) => pull!(7, true, false, false),
            (5 | 7, _, true, _) => pull!(7, true, true, false),
            (10, _, false, _) => pull!(10, true, false, false),
            (16, _, false, _) => pull!(16, true, false, false),
            (10 | 16, _, true, _) => pull!(16, true, true, false),
            _ => pull!(CLOSED, true, true, false),
        }
    }
}

/// Adds up a term with the kernel for a form of this processor and a degree; as [`run`].
#[inline]
pub fn run_term<T: Term>(form: Form, (a, s): (&Chunk, &Cells), degree: usize, masked: bool) {
    for_form!(form, K => terms::<K, T>((a, s), degree, masked))
}

/// [`run_term`] with an instruction set.
#[inline]
fn terms<K: Isa, T: Term>((a, s): (&Chunk, &Cells), degree: usize, masked: bool) {
    macro_rules! add_up {
        (half $($choice:tt)*) => { K::run_four(AddUp::<T, $($choice)*, true>(a, s, PhantomData)) };
        ($($choice:tt)*) => { K::run(AddUp::<T, $($choice)*, false>(a, s, PhantomData)) };
    }
    // SAFETY: forms are those of the processor; for memory, chunk and cells answer.
    unsafe {
        if a.various.is_some() {
            return add_up!(CLOSED, true, true);
        }
        if const { !K::FAST } {
            return add_up!(CLOSED, true, false);
        }
        match (degree, masked, s.half) {
            (3, _, true) => add_up!(half 3, true, false),
            (5, _, true) => add_up!(half 5, true, false),
            (7, _, true) => add_up!(half 7, true, false),
            (10, _, true) => add_up!(half 10, true, false),
            (16, _, true) => add_up!(half 16, true, false),
            (3, false, _) => add_up!(3, false, false),
            (3, true, _) => add_up!(3, true, false),
            (5, false, _) => add_up!(5, false, false),
            (5, true, _) => add_up!(5, true, false),
            (7, false, _) => add_up!(7, false, false),
            (7, true, _) => add_up!(7, true, false),
            (10, _, _) => add_up!(10, true, false),
            (16, _, _) => add_up!(16, true, false),
            _ => add_up!(CLOSED, true, false),
        }
    }
}

/// Energies and virials of a chunk's bonds, with the kernel for a form of this processor; see [`sums`].
pub fn run_sums<W: BondLaw>(
    form: Form,
    (chunk, cells): (&Chunk, &Cells),
    look: &Looking,
) -> [[f64; CELLS]; SUMS] {
    // SAFETY: as for forces.
    unsafe { form.run(Sums::<W> { chunk, cells, look, law: PhantomData }) }
}
