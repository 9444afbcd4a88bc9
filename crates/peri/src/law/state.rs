//! What the sites of a body carry under a law, and what its bonds remember.

use crate::cauchy::Continuum;
use crate::law::freed::Freed;
use crate::law::moment::Held;

/// What the sites (cells or records) of a body carry under a state-based law, and what its bonds remember.
/// Columns start with as many unused entries as their owner says.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct SiteState {
    /// Weighted volume m = Σ ω w |xi|² V over the family at the start.
    pub weighted: Vec<f64>,
    /// Σ ω² w |xi|² V over it: how far the yield surface is.
    pub spread: Vec<f64>,
    /// Dilatation θ.
    pub theta: Vec<f64>,
    /// Dilatation at the last step that advanced.
    pub before: Vec<f64>,
    /// The part of it that is not yet relaxed.
    pub unrelaxed: Vec<f64>,
    /// Accumulated plastic multiplier.
    pub plastic: Vec<f64>,
    /// What broken bonds have left; nothing under LAMMPS' laws.
    pub freed: Freed,
    /// What sites have under correspondence; nothing under other laws.
    pub continuum: Continuum,
    /// Numbers that each bond remembers; the layout knows the order.
    pub memory: Vec<f64>,
    /// The form of that under the viscous law.
    pub held: Held,
    /// Whether the bonds of a chunk of lattice cells remember anything, 0 or 1; not kept for lists.
    pub touched: Vec<u8>,
    /// Whether a lattice row has ever had a bond with something to remember: first and last coordinate.
    pub awake: Vec<(i32, i32)>,
    /// What the kernels read: up to `COLUMNS` columns, a stride apart.
    #[serde(skip)]
    pub columns: Vec<f64>,
    /// What bonds remembered before this evaluation, where LAMMPS' energies need it.
    #[serde(skip)]
    pub earlier: Vec<f64>,
    /// Sums being added up.
    #[serde(skip)]
    pub sums: Vec<f64>,
    /// Constants of the first sweep, as those of the forces' sweep.
    pub tables: Vec<f64>,
    /// Coordinates of each row beyond which no site has a dilatation.
    #[serde(skip)]
    pub active: Vec<(i32, i32)>,
}

impl SiteState {
    /// Whether the law has states at all.
    pub fn is_empty(&self) -> bool {
        self.weighted.is_empty()
    }

    /// What the energies of bonds depend on.
    pub fn remembered(&self) -> &[f64] {
        if self.earlier.is_empty() { &self.memory } else { &self.earlier }
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        8 * (self.weighted.len()
            + self.spread.len()
            + self.theta.len()
            + self.before.len()
            + self.unrelaxed.len()
            + self.plastic.len()
            + self.freed.numbers()
            + self.memory.len()
            + self.earlier.len()
            + self.columns.len()
            + self.sums.len()
            + self.tables.len()
            + self.active.len()
            + self.awake.len())
            + self.touched.len()
            + self.continuum.bytes()
    }
}
