//! What state-based laws add up over bonds before there are forces: dilatations and norms of trial states.

use crate::lanes::Lanes;
use crate::law::{Ends, Stretch};

/// What a sweep adds up at both ends before there are forces.
pub trait Term: Sync {
    /// Columns that it reads.
    const COLUMNS: usize;
    /// Numbers that a bond remembers.
    const MEMORY: usize;
    /// Whether it is the stretch itself, for which there are series.
    const STRETCH: bool;
    /// The terms at both ends, over ω w |xi|² V.
    ///
    /// # Safety
    /// See [`Lanes`].
    unsafe fn terms<L: Lanes>(bond: &Stretch<L>, omega: L, ends: &Ends<L>, memory: &[L; 2]) -> (L, L);
}

/// The dilatation: Σ ω w |xi|² s V = mθ/3.
pub struct Dilatation;

impl Term for Dilatation {
    const COLUMNS: usize = 0;
    const MEMORY: usize = 0;
    const STRETCH: bool = true;
    #[inline(always)]
    unsafe fn terms<L: Lanes>(bond: &Stretch<L>, _: L, _: &Ends<L>, _: &[L; 2]) -> (L, L) {
        (bond.s, bond.s)
    }
}

/// The trial state s − θ/3 − e_p of both ends; θ/3 is column 2.
#[inline(always)]
unsafe fn trial<L: Lanes>(bond: &Stretch<L>, [own, far]: &Ends<L>, memory: &[L; 2]) -> (L, L) {
    // SAFETY: passed on to the caller.
    unsafe { (bond.s.sub(own[2]).sub(memory[0]), bond.s.sub(far[2]).sub(memory[1])) }
}

/// The squared norm of the trial state over (15G/m)²: Σ ω² w |xi|² (s − θ/3 − e_p)² V. Columns as [`crate::law::Plastic`].
pub struct Norm;

impl Term for Norm {
    const COLUMNS: usize = 3;
    const MEMORY: usize = 2;
    const STRETCH: bool = false;
    #[inline(always)]
    unsafe fn terms<L: Lanes>(bond: &Stretch<L>, omega: L, ends: &Ends<L>, memory: &[L; 2]) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let (a, b) = trial(bond, ends, memory);
            (a.mul(a).mul(omega), b.mul(b).mul(omega))
        }
    }
}

/// What LAMMPS takes for the norm, over (15G)²: with (θ_i/m_i + θ_j/m_j) in place of 1/m, in 2026 with (1/m_i + 1/m_j).
/// Column 0 is θ/m or 1/m here.
pub struct NormLammps;

impl Term for NormLammps {
    const COLUMNS: usize = 3;
    const MEMORY: usize = 2;
    const STRETCH: bool = false;
    #[inline(always)]
    unsafe fn terms<L: Lanes>(bond: &Stretch<L>, omega: L, ends: &Ends<L>, memory: &[L; 2]) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let both = ends[0][0].add(ends[1][0]);
            let (a, b) = trial(bond, ends, memory);
            let (a, b) = (a.mul(both), b.mul(both));
            (a.mul(a).mul(omega), b.mul(b).mul(omega))
        }
    }
}
