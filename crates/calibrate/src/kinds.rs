//! What words of a `calibrate` line choose.

use perigrain_base::diag::Span;
use perigrain_styles::words::Words;

/// How the cross-section of a sample is measured.
#[derive(Clone, Copy, Debug, PartialEq, Words)]
#[word(what = "shape")]
pub enum Shape {
    /// The section is the product of both widths.
    Block,
    /// The section is π D²/4 with the mean D of both widths.
    Cylinder,
    /// The section.
    Area(#[word(name = "A", what = "the area", positive)] f64),
}

/// How the linear system is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Conjugate gradients from the affine field until the energy is known to the tolerance.
    Pcg,
    /// From zero until |r|₂ of the linear system and of the nonlinear one is below these [force].
    Paper([f64; 2]),
}

/// What solves for a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solver {
    /// `calibrate dsm`.
    Dsm,
    /// `calibrate ste`.
    Ste,
    /// `calibrate periodic`.
    Periodic,
}

/// What a map shows of the surroundings of each particle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Map {
    /// K along the three axes if all of the body were so.
    Stiffness,
    /// By which part that is below the mean.
    Deviation,
}

/// Which number a fit is to reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// K.
    Stiffness,
    /// E.
    Young,
    /// ν.
    Poisson,
    /// The largest force over the section.
    Strength,
}

/// A number to reach.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// Which.
    pub quantity: Quantity,
    /// What it is to be.
    pub value: f64,
}

/// A coefficient to vary.
#[derive(Clone, Debug)]
pub struct Vary {
    /// The type of bonds.
    pub kind: u16,
    /// The coefficient's name.
    pub name: String,
    /// The words.
    pub span: Span,
}
