//! Plastic, adhesive grains that are pressed together far beyond small overlaps (normal model `mdr`).
//!
//! The law of Zunker & Kamrin (2024), doi 10.1016/j.jmps.2023.105492 and 10.1016/j.jmps.2023.105493, as LAMMPS
//! 22Jul2025 has it: each grain is pressed by a rigid plane in the middle of the contact ([`Side`]), grows by what is
//! displaced plastically, and answers with its bulk modulus where little of its surface is free ([`State`]).

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
pub use state::{State, begin, begun};
pub use walls::{far_pushed, gather, press};

use perigrain_base::math::elementary::exp;
use perigrain_base::math::real::Real;

/// What grains of such a powder are made of.
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
    /// ψ_b: the free part of the surface below which the bulk answers.
    pub confinement: f64,
}

impl Material {
    /// E_c = E/(1 − ν²), of a grain against a rigid plane.
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

    /// p_Y, the mean pressure under which a grain of radius R flows at depth δ.
    #[inline(always)]
    pub fn hardness<R: Real>(&self, depth: R, radius: R) -> R {
        (exp(depth * -4.4 / radius) * 1.75 + 1.0) * self.yield_stress
    }
}

/// How contacts are evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Manner {
    /// With LAMMPS' iteration of adhesion; in setup no contact yields.
    pub lammps: bool,
    /// In the setup of a run.
    pub setup: bool,
    /// Somebody keeps a ledger of energy.
    pub booked: bool,
}

impl Manner {
    /// Whether damping sees the stiffness of the step before, none in a new contact, as in LAMMPS' setup.
    fn takes_before(self) -> bool {
        self.lammps && self.setup
    }
}

/// How many numbers a contact of two grains remembers: both sides, then the largest overlap.
pub const PAIR: usize = 2 * side::WIDTH + 1;

/// How many numbers a contact with a wall remembers.
pub const WALL: usize = side::WIDTH;

/// What a contact does along its normal, for the rest of the law: force, stiffness that damping sees, area, energy that it can give back
/// where somebody keeps a ledger. These numbers stand at the end of what the contact remembers.
pub const TOLD: usize = 4;

/// After a setup, in which forces are only evaluated: `rows` of `width` numbers are `before` again; but LAMMPS keeps the
/// largest depths it has seen.
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
