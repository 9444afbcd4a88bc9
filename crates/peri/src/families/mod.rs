//! Peridynamic families: what bonds exist, what they are made of, and which still live.

pub(crate) mod bond;
pub mod bond_weights;
pub(crate) mod cell;
pub(crate) mod cells;
mod criterion;
pub(crate) mod excluded;
mod free;
mod kin;
pub mod lattice;
pub mod law;
pub mod list;
mod measures;
pub(crate) mod near;
pub(crate) mod options;
pub(crate) mod scatter;
pub mod shares;
mod sound;
pub(crate) mod table;
pub mod tiles;
pub(crate) mod view;

use crate::contact::memory::Memory;
pub use crate::law::material::{Influence, Moduli};
use bond::Broken;
pub use bond::{Candidate, Neighbour};
pub use bond_weights::{BondWeights, Factors, Weighed};
pub use cell::Edges;
pub(crate) use cell::{BoxStrain, Cell};
pub use cells::Cells;
pub use criterion::Criterion;
pub use excluded::Excluded;
pub(crate) use free::Moved;
pub use law::Law;
pub use measures::Measures;
pub use near::{NearPair, NearPairs};
pub use options::{FamilyOptions, ForceUnit, Layout, VolumeRule};

pub use scatter::Scatter;
pub use table::{PmbCoeff, PmbTable};
pub use view::{Bounds, PeriTally, PeriView};

/// All families of a scene: state only; `setup` makes them, `lattice` and `list` sweep them.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Families {
    /// Coefficients in force.
    pub table: PmbTable,
    /// Rules the families were built with.
    pub options: FamilyOptions,
    /// What bonds do.
    pub law: Law,
    /// Coefficients by type of bond − 1, where families are what a table of bonds says (`bond_style bpm/peri`).
    #[serde(default)]
    pub of_bonds: Vec<PmbCoeff>,
    /// The work that breaks a bond by pair of types (row by row) [energy/volume²], if bonds break by that.
    #[serde(default)]
    pub work_limits: Vec<f64>,
    /// The change of that table that families have taken in last.
    #[serde(default)]
    pub seen: u64,
    /// Whether a step has been advanced: nothing breaks before.
    pub breaking_enabled: bool,
    /// Bodies on a lattice.
    pub lattices: Vec<lattice::LatticeBody>,
    /// All other bonds.
    pub list: list::ListBody,
    /// Reference positions, per particle, where they are not the positions at creation.
    pub reference: Option<Vec<[f64; 3]>>,
    /// The edges of the box when families were found.
    pub birth: Edges,
    /// The same in the last step that advanced.
    pub before: Edges,
    /// Where each particle is: a cell of a lattice or a record of the list, counted through all bodies;
    /// `u32::MAX` for particles without a family.
    pub place: Vec<u32>,
    /// Sum of the volumes of all partners at the start, per particle.
    pub family_volume: Vec<f64>,
    /// Number of partners at the start, per particle.
    pub family_size: Vec<u16>,
    /// The spacing around each particle over that of the lattice, where horizons count in it; empty elsewhere.
    #[serde(default)]
    pub spacing: Vec<f64>,
    /// Particles whose bonds never break; empty if there are none.
    pub lasting: Vec<bool>,
    /// Whether a particle may have lost a bond: damage need not be counted elsewhere.
    pub damaged: Vec<bool>,
    /// Pairs without a living bond that may come into short-range contact.
    pub near: NearPairs,
    /// Energy of bonds where they broke, as far as it was counted [energy].
    #[serde(default)]
    pub released: f64,
    /// What the last forces of broken bonds have taken from motion since, as far as it was counted [energy].
    #[serde(default)]
    pub trailing: f64,
    /// The part of both that is of bonds which broke after the forces of the last evaluation, in whose energies they still count
    /// [energy].
    #[serde(default)]
    pub late: f64,
    /// What relaxing and flowing bonds have turned into heat, as far as it was counted [energy].
    #[serde(default)]
    pub heat: f64,
    /// What flow and damage of materials took in the last step that advanced: heat, and fracture energy [energy].
    #[serde(skip)]
    pub lost: [f64; 2],
    /// What heat has added to the energy of bonds by thermal strain, as far as it was counted [energy].
    #[serde(default)]
    pub warmed: f64,
    /// The power at which bonds relaxed at the last step that was counted.
    #[serde(default)]
    pub relaxing: Option<f64>,
    /// Count both.
    #[serde(skip)]
    pub counts_losses: bool,
    /// What softening bonds and sites of materials lost in the last step that advanced, if losses are counted [energy].
    #[serde(skip)]
    pub taken: f64,
    /// Count [`Families::warmed`].
    #[serde(skip)]
    pub counts_warming: bool,
    /// Of the bonds beyond their limit the one that is stretched most, over its critical stretch, breaks, with those stretched
    /// as much and this share of the others; `None`: all.
    #[serde(skip)]
    pub breaking_share: Option<f64>,
    /// Evaluations that do not advance let bonds flow, soften and relax as a step would, and forget it.
    #[serde(skip)]
    pub implicit: bool,
    /// Of each living bond the ratio of what it bears to what it can bear, in the order of [`Families::living`], where a formula
    /// gives that.
    #[serde(skip)]
    pub ratios: Vec<f64>,
    /// Bonds are not judged in this step, where another criterion than their stretch decides.
    #[serde(skip)]
    pub unjudged: bool,
    /// Take kernels of four lanes even where the processor has eight: to compare them.
    #[serde(skip)]
    pub four_lanes: bool,
    /// Bodies that were meant to be on a lattice, when families were built.
    #[serde(skip)]
    pub almost: Vec<AlmostLattice>,
    /// What weighing bonds one at a time has come to, when they were found.
    #[serde(skip)]
    pub weighed: Option<Weighed>,
    /// How work is shared out to ranks, while it is.
    #[serde(skip)]
    pub shares: Option<shares::Shares>,
    /// Scratch that is not state.
    #[serde(skip)]
    pub scratch: Scratch,
}

/// A body of which some particles are a little off the sites of a lattice: its bonds are kept as a list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlmostLattice {
    /// Its first particle.
    pub first: u32,
    /// How many it has.
    pub count: usize,
    /// The largest distance of a particle from its site, in distances of nearest neighbours.
    pub off: f64,
}

/// Memory kept between steps that holds nothing a step depends on; a clone starts empty.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Cells of the search for near pairs.
    pub cells: Cells,
    /// Near pairs as they are evaluated.
    pub(crate) contact: Memory,
    /// Cells of each body at the last search within bodies, if they have been needed since.
    pub looked: Vec<Cells>,
    /// Energy and virial of rows.
    pub rows: Vec<[f64; 7]>,
    /// Bonds that may break.
    pub candidates: Vec<Candidate>,
    /// Bonds that break.
    pub(crate) broken: Vec<Broken>,
    /// Particles whose bonds have broken in this step.
    pub ends: Vec<[u32; 2]>,
}

impl Clone for Scratch {
    fn clone(&self) -> Self {
        Self::default()
    }
}
