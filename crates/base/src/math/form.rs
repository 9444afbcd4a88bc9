//! How many contacts or bonds are evaluated at a time, and with which instructions.

use super::four::Plain;
#[cfg(target_arch = "x86_64")]
use super::four::{Avx2, Avx512, gathers_pay, has_avx2, has_avx512};
use super::lanes::Lanes;

/// How many of them are evaluated at a time; all forms have the same bits, but where formulas say [`fma`](super::real::Real::fma). There are
/// only forms that this processor has: other crates cannot make one of those that need something of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Eight, with AVX-512 and its gathering loads.
    #[cfg(target_arch = "x86_64")]
    #[non_exhaustive]
    Gathers,
    /// Eight, with AVX-512.
    #[cfg(target_arch = "x86_64")]
    #[non_exhaustive]
    Eight,
    /// Four, with AVX2.
    #[cfg(target_arch = "x86_64")]
    #[non_exhaustive]
    Four,
    /// Four, on any processor.
    Plain,
}

impl Form {
    /// The fastest one of this processor.
    pub fn here() -> Self {
        #[cfg(target_arch = "x86_64")]
        if has_avx512() {
            return if gathers_pay() { Self::Gathers } else { Self::Eight };
        } else if has_avx2() {
            return Self::Four;
        }
        Self::Plain
    }

    /// The same in lanes of four.
    #[must_use]
    pub fn in_fours(self) -> Self {
        #[cfg(target_arch = "x86_64")]
        if self != Self::Plain {
            // Whatever has AVX-512 has AVX2.
            return Self::Four;
        }
        self
    }

    /// Runs a loop in this form.
    ///
    /// # Safety
    /// What the loop requires must hold.
    #[inline]
    pub unsafe fn run<W: InLanes>(self, work: W) -> W::Out {
        // SAFETY: passed on.
        unsafe {
            match self {
                #[cfg(target_arch = "x86_64")]
                Self::Gathers if const { W::PICKS } => Avx512::<true>::run(work),
                #[cfg(target_arch = "x86_64")]
                Self::Gathers | Self::Eight => Avx512::<false>::run(work),
                #[cfg(target_arch = "x86_64")]
                Self::Four => Avx2::run(work),
                Self::Plain => Plain::run(work),
            }
        }
    }

    /// All that this processor has.
    pub fn all() -> Vec<Self> {
        let mut all = vec![Self::Plain];
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(has_avx2().then_some(Self::Four));
            all.extend([Self::Eight, Self::Gathers].into_iter().filter(|_| has_avx512()));
        }
        all
    }
}

/// A loop that is written once for any form. Its `run` is to be inlined always and has no closures that work on lanes: only then
/// is it compiled for the instructions of the form.
pub trait InLanes {
    /// What comes out.
    type Out;
    /// Whether it picks numbers out of lists, so that a form with gathering loads is worth compiling.
    const PICKS: bool = true;
    /// Runs it.
    ///
    /// # Safety
    /// The processor must have what these lanes need, and what the loop's own documentation requires must hold.
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> Self::Out;
}

/// The instruction set of some lanes, where a form is chosen before the loop is.
pub trait Isa {
    /// Whether loops for special cases are worth compiling: where processors have AVX2 the portable form is there to compare with.
    const FAST: bool;
    /// Runs a loop in these lanes.
    ///
    /// # Safety
    /// The processor must have what the lanes need, and what the loop requires must hold.
    unsafe fn run<W: InLanes>(work: W) -> W::Out;
    /// Runs it with these instructions in four lanes.
    ///
    /// # Safety
    /// As [`Isa::run`].
    unsafe fn run_four<W: InLanes>(work: W) -> W::Out;
}

impl Isa for Plain {
    const FAST: bool = !cfg!(target_arch = "x86_64");
    #[inline]
    unsafe fn run<W: InLanes>(work: W) -> W::Out {
        // SAFETY: passed on.
        unsafe { work.run::<4, Self>() }
    }
    #[inline]
    unsafe fn run_four<W: InLanes>(work: W) -> W::Out {
        // SAFETY: passed on.
        unsafe { Self::run(work) }
    }
}

/// The instruction set of some lanes, by the features that they need.
#[cfg(target_arch = "x86_64")]
macro_rules! isa {
    ($lanes:ty, $n:literal, $features:literal) => {
        impl Isa for $lanes {
            const FAST: bool = true;
            #[inline]
            unsafe fn run<W: InLanes>(work: W) -> W::Out {
                #[target_feature(enable = $features)]
                unsafe fn compiled<W: InLanes>(work: W) -> W::Out {
                    // SAFETY: passed on.
                    unsafe { work.run::<$n, $lanes>() }
                }
                // SAFETY: the caller's promise includes the features.
                unsafe { compiled(work) }
            }
            #[inline]
            unsafe fn run_four<W: InLanes>(work: W) -> W::Out {
                #[target_feature(enable = $features)]
                unsafe fn compiled<W: InLanes>(work: W) -> W::Out {
                    // SAFETY: passed on.
                    unsafe { work.run::<4, Avx2>() }
                }
                // SAFETY: the caller's promise includes the features.
                unsafe { compiled(work) }
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
isa!(Avx2, 4, "avx2,fma");
#[cfg(target_arch = "x86_64")]
isa!(Avx512<false>, 8, "avx2,fma,avx512f,avx512dq,avx512vl,popcnt");
#[cfg(target_arch = "x86_64")]
isa!(Avx512<true>, 8, "avx2,fma,avx512f,avx512dq,avx512vl,popcnt");
