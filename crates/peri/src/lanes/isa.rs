//! Kernels and instruction sets: a kernel is written once for any lanes and compiled for each set that processors may have.

#[cfg(target_arch = "x86_64")]
use crate::lanes::Avx2;
#[cfg(target_arch = "x86_64")]
use crate::lanes::avx512::Avx512;
use crate::lanes::rows::Rows;
use crate::lanes::{Lanes, Portable};

/// A loop over lanes with what it works on.
pub trait Kernel {
    /// What it gives.
    type Out;
    /// Runs it. To be inlined always: only then it is compiled for the instruction set of its caller.
    ///
    /// # Safety
    /// The processor must have the instruction set; each kernel says what else.
    unsafe fn run<L: Isa>(self) -> Self::Out;
}

/// An instruction set, by its widest lanes.
pub trait Isa: Rows + Sync + 'static {
    /// Lanes of four.
    type Four: Lanes;
    /// Whether there are forms without root and division for small stretches, and those without masks and tracking. Where
    /// processors have AVX2, the portable kernels are there to compare with, and one form does.
    const ALL_FORMS: bool = true;
    /// Runs a kernel compiled for this set.
    ///
    /// # Safety
    /// As for [`Kernel::run`].
    unsafe fn call<T: Kernel>(kernel: T) -> T::Out;
}

impl Isa for Portable {
    type Four = Self;
    const ALL_FORMS: bool = !cfg!(target_arch = "x86_64");
    unsafe fn call<T: Kernel>(kernel: T) -> T::Out {
        // SAFETY: the caller's promise.
        unsafe { kernel.run::<Self>() }
    }
}

/// The instruction set of some lanes, by the features that they need.
#[cfg(target_arch = "x86_64")]
macro_rules! isa {
    ($lanes:ty, $features:literal) => {
        impl Isa for $lanes {
            type Four = Avx2;
            #[inline]
            unsafe fn call<T: Kernel>(kernel: T) -> T::Out {
                #[target_feature(enable = $features)]
                unsafe fn compiled<T: Kernel>(kernel: T) -> T::Out {
                    // SAFETY: the caller's promise.
                    unsafe { kernel.run::<$lanes>() }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { compiled(kernel) }
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
isa!(Avx2, "avx2,fma");
#[cfg(target_arch = "x86_64")]
isa!(Avx512, "avx512f,avx512dq,avx512vl,avx2,fma");
