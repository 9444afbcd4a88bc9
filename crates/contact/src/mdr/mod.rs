//! Plastic, adhesive grains that are compressed far beyond small overlaps (normal model `mdr`).
//!
//! The law of Zunker & Kamrin (2024), doi 10.1016/j.jmps.2023.105492 and 10.1016/j.jmps.2023.105493, as in
//! LAMMPS 22Jul2025: each grain is pressed by a rigid plane in the middle of the contact ([`Side`]), grows by
//! the volume displaced plastically, and responds with its bulk modulus when little of its surface is free
//! ([`State`]).

mod adhesion;
mod deeds;
mod pairs;
mod press;
mod screen;
mod side;
mod state;
mod walls;

pub use deeds::Sum;
pub use pairs::Meetings;
pub use side::{Pressed, Side};
pub use state::{BEGIN, BEGUN, SIDES, State, begin, begun};
pub use walls::{far_pushed, gather, press};

use perigrain_base::math::elementary::exp;
use perigrain_base::math::real::Real;

/// Material of the grains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus E [pressure].
    pub young: f64,
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Yield stress Y [pressure].
    pub yield_stress: f64,
    /// Surface energy γ [energy/area].
    pub cohesion: f64,
    /// ψ_b: the free fraction of the surface below which the bulk responds.
    pub confinement: f64,
}

impl Material {
    /// E_c = E/(1 − ν²), for a grain against a rigid plane.
    pub fn plane(&self) -> f64 {
        self.young / (1.0 - self.poisson * self.poisson)
    }

    /// Shear modulus.
    pub fn shear(&self) -> f64 {
        0.5 * self.young / (1.0 + self.poisson)
    }

    /// Bulk modulus κ.
    pub fn bulk(&self) -> f64 {
        self.young / (3.0 * (1.0 - 2.0 * self.poisson))
    }

    /// p_Y, the mean pressure at which a grain of radius R yields at depth δ.
    #[inline(always)]
    pub fn hardness<R: Real>(&self, depth: R, radius: R) -> R {
        (exp(depth * -4.4 / radius) * 1.75 + 1.0) * self.yield_stress
    }
}

/// How contacts are evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Manner {
    /// With LAMMPS' iteration of adhesion; no contact yields in the setup.
    pub lammps: bool,
    /// In the setup of a run.
    pub setup: bool,
    /// Whether an energy ledger is kept.
    pub booked: bool,
}

impl Manner {
    /// Whether damping uses the stiffness of the previous step, which is zero for a new contact, as in
    /// LAMMPS' setup.
    fn takes_before(self) -> bool {
        self.lammps && self.setup
    }
}

/// History size of a contact of two grains: both sides, then the largest overlap.
pub const PAIR: usize = 2 * side::WIDTH + 1;

/// History size of a contact with a wall.
pub const WALL: usize = side::WIDTH;

/// Normal results of a contact for the rest of the law: force, stiffness for damping, area, and returnable
/// energy (if an energy ledger is kept). These numbers are at the end of the history.
pub const PRECOMPUTED: usize = 4;

/// After a setup, which only evaluates forces: restores `rows` of `width` numbers to `before`; LAMMPS keeps
/// the largest depths it has seen.
pub fn undo(before: &[f64], rows: &mut [f64], width: usize, lammps: bool) {
    for (old, new) in before.chunks_exact(width).zip(rows.chunks_exact_mut(width)) {
        for (k, (old, new)) in old.iter().zip(new).enumerate() {
            let depth = k == 2 * side::WIDTH || k % side::WIDTH == side::DEEPEST;
            if !(lammps && depth) {
                *new = *old;
            }
        }
    }
}

#[cfg(test)]
mod tests;
