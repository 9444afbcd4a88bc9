//! How many contacts or bonds are evaluated at a time, and with which instructions.

use super::four::Plain;
#[cfg(target_arch = "x86_64")]
use super::four::{Avx2, Avx512, gathers_pay, has_avx2, has_avx512};
use super::lanes::Lanes;

/// How many of them are evaluated at a time; all forms have the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// Eight, with AVX-512 and its gathering loads.
    #[cfg(target_arch = "x86_64")]
    Gathers,
    /// Eight, with AVX-512.
    #[cfg(target_arch = "x86_64")]
    Eight,
    /// Four, with AVX2.
    #[cfg(target_arch = "x86_64")]
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

    /// Runs a loop in this form.
    ///
    /// # Safety
    /// The processor must have what the form needs, and the loop what it asks for.
    #[inline]
    pub unsafe fn run<W: InLanes>(self, work: W) -> W::Out {
        // SAFETY: passed on.
        unsafe {
            match self {
                #[cfg(target_arch = "x86_64")]
                Self::Gathers => gathers(work),
                #[cfg(target_arch = "x86_64")]
                Self::Eight => eight(work),
                #[cfg(target_arch = "x86_64")]
                Self::Four => four(work),
                Self::Plain => work.run::<4, Plain>(),
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
    /// Runs it.
    ///
    /// # Safety
    /// The processor must have what these lanes need; what else it asks for, the loop tells.
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> Self::Out;
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl,popcnt")]
unsafe fn gathers<W: InLanes>(work: W) -> W::Out {
    // SAFETY: passed on.
    unsafe { work.run::<8, Avx512<true>>() }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl,popcnt")]
unsafe fn eight<W: InLanes>(work: W) -> W::Out {
    // SAFETY: passed on.
    unsafe { work.run::<8, Avx512<false>>() }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn four<W: InLanes>(work: W) -> W::Out {
    // SAFETY: passed on.
    unsafe { work.run::<4, Avx2>() }
}
