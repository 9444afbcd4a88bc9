//! What state-based laws add up over bonds before there are forces: dilatations and norms of trial states.

use crate::law::stretch::{Ends, Stretch};
use perigrain_base::math::real::Real;

/// The sums of a sweep: which.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sum {
    /// Dilatations.
    Dilatation,
    /// Norms of trial states.
    Norm,
    /// The same as LAMMPS reckons them.
    NormLammps,
}

/// What a sweep adds up at both ends before there are forces.
pub trait Term: Sync {
    /// Columns that it reads.
    const COLUMNS: usize;
    /// Numbers that a bond remembers.
    const MEMORY: usize;
    /// Whether it is the stretch itself, for which there are series.
    const STRETCH: bool;
    /// The terms at both ends, over ω w |xi|² V.
    fn terms<R: Real>(bond: &Stretch<R>, omega: R, ends: &Ends<R>, memory: &[R; 2]) -> (R, R);
}

/// The dilatation: Σ ω w |xi|² s V = mθ/3.
pub struct Dilatation;

impl Term for Dilatation {
    const COLUMNS: usize = 0;
    const MEMORY: usize = 0;
    const STRETCH: bool = true;
    #[inline(always)]
    fn terms<R: Real>(bond: &Stretch<R>, _: R, _: &Ends<R>, _: &[R; 2]) -> (R, R) {
        (bond.s, bond.s)
    }
}

/// The trial state s − θ/3 − e_p of both ends; θ/3 is column 2.
#[inline(always)]
fn trial<R: Real>(bond: &Stretch<R>, [own, far]: &Ends<R>, memory: &[R; 2]) -> (R, R) {
    (bond.s - own[2] - memory[0], bond.s - far[2] - memory[1])
}

/// The squared norm of the trial state over (15G/m)²: Σ ω² w |xi|² (s − θ/3 − e_p)² V. Columns as `eps` has them.
pub struct Norm;

impl Term for Norm {
    const COLUMNS: usize = 3;
    const MEMORY: usize = 2;
    const STRETCH: bool = false;
    #[inline(always)]
    fn terms<R: Real>(bond: &Stretch<R>, omega: R, ends: &Ends<R>, memory: &[R; 2]) -> (R, R) {
        let (a, b) = trial(bond, ends, memory);
        (a * a * omega, b * b * omega)
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
    fn terms<R: Real>(bond: &Stretch<R>, omega: R, ends: &Ends<R>, memory: &[R; 2]) -> (R, R) {
        let both = ends[0][0] + ends[1][0];
        let (a, b) = trial(bond, ends, memory);
        let (a, b) = (a * both, b * both);
        (a * a * omega, b * b * omega)
    }
}
