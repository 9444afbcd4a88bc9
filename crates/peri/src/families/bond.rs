//! Single bonds as families show them: partners, bonds that may break, bonds that do.

/// One partner of a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbour {
    /// The partner's index.
    pub partner: u32,
    /// Whether the bond still lives.
    pub alive: bool,
    /// What it weighs, where bonds are weighed one at a time.
    pub weight: Option<f64>,
}

/// A bond that may break.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Cells or records.
    pub ends: [u32; 2],
    /// Stencil vector, or place in the list.
    pub bond: u32,
    /// Present stretch.
    pub stretch: f64,
    /// Critical stretch.
    pub s00: f64,
    /// Its rise under compression.
    pub alpha: f64,
}

/// A bond that breaks, with the body on a lattice that has it, or `shares::LIST`, and the square of its length.
#[derive(Debug)]
pub(crate) struct Broken {
    pub(crate) body: usize,
    pub(crate) bond: Candidate,
    pub(crate) square: f64,
}
