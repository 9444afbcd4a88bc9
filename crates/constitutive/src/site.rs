//! What a law is given for one site, and what it returns.

use crate::tensor::{Mat3, Sym3, UNIT};

/// What a site remembers of its past. That of a site without a past is `Memory::default()`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Memory {
    /// C_p⁻¹, the inverse of the plastic right Cauchy-Green tensor: xx yy zz yz xz xy; the unit tensor at birth.
    pub plastic: Sym3,
    /// Equivalent plastic strain ε̄.
    pub strain: f64,
    /// Damage D, from 0 (intact) to 1 (bears no tension).
    pub damage: f64,
    /// Sum of Δε̄/ε_f, or the largest principal stress so far over the tensile strength: damage begins where it reaches 1.
    pub wear: f64,
    /// Yield stress or tensile strength at which damage began; 0 before [pressure].
    pub onset: f64,
}

impl Memory {
    /// How many numbers a memory has.
    pub const NUMBERS: usize = 10;

    /// All its numbers, for a table with one row per site.
    pub fn numbers(&self) -> [f64; Self::NUMBERS] {
        let [xx, yy, zz, yz, xz, xy] = self.plastic;
        [xx, yy, zz, yz, xz, xy, self.strain, self.damage, self.wear, self.onset]
    }

    /// The memory that has these numbers.
    pub fn from_numbers([xx, yy, zz, yz, xz, xy, strain, damage, wear, onset]: [f64; Self::NUMBERS]) -> Self {
        Self { plastic: [xx, yy, zz, yz, xz, xy], strain, damage, wear, onset }
    }
}

impl Default for Memory {
    fn default() -> Self {
        Self { plastic: UNIT, strain: 0.0, damage: 0.0, wear: 0.0, onset: 0.0 }
    }
}

/// The circumstances of one evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Time since the memory was written [time]; 0: rates have no effect.
    pub dt: f64,
    /// Temperature of the site [temperature]; `None`: laws take their reference temperature.
    pub temperature: Option<f64>,
    /// Spacing of the sites Δx, over which the strain of a crack is spread [length].
    pub spacing: f64,
    /// Whether the returned memory is that of the new state. A trial (`false`) has the same stress and returns the memory that
    /// it was given.
    pub advance: bool,
}

/// What a law returns for one site.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response {
    /// First Piola-Kirchhoff stress P: force per area of the reference configuration [pressure].
    pub piola: Mat3,
    /// The memory of the new state, or the given one in a trial.
    pub memory: Memory,
    /// Stored elastic energy per reference volume [energy/volume].
    pub energy: f64,
    /// Plastic work of this step per reference volume: the mean of the yield stress before and after times Δε̄
    /// [energy/volume].
    pub dissipated: f64,
    /// Elastic energy that growing damage set free in this step, per reference volume [energy/volume].
    pub released: f64,
    /// Equivalent stress of Mises √(3/2)|dev τ| of the Kirchhoff stress τ = P Fᵀ, which yield stresses limit [pressure].
    pub mises: f64,
}

/// Why a site has no stress.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// The deformation gradient has a determinant that is not positive.
    #[error("matter is turned inside out (det F = {0:.3e})")]
    Inverted(f64),
    /// Matter is so flat or so long that its strain is no number.
    #[error("strains are beyond the precision of numbers (det F = {0:.3e})")]
    Flat(f64),
    /// The deformation gradient has entries that are no finite numbers.
    #[error("the deformation gradient is not finite")]
    NotFinite,
    /// A crack in one layer of sites would set more energy free than it takes.
    #[error(
        "a spacing of {spacing:.3e} is too coarse: stress that falls over G_f needs less than 2 E G_f/f_t² = {most:.3e}"
    )]
    Coarse {
        /// The spacing [length].
        spacing: f64,
        /// What it must be below [length].
        most: f64,
    },
    /// No plastic strain returns the stress to the yield surface.
    #[error("no plastic strain returns a trial stress of {0:.3e} to the yield surface")]
    NoReturn(f64),
}
