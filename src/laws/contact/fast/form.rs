//! How many contacts are evaluated at a time, and with which instructions.

#[cfg(target_arch = "x86_64")]
use crate::math::four::{gathers_pay, has_avx2, has_avx512};

/// How many contacts are evaluated at a time; all forms have the same bits.
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

    /// All that this processor has.
    #[cfg(test)]
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
