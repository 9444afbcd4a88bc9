//! Peridynamic families: what bonds exist, what they are made of, and which still live.

use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::SIX;

pub mod bond_weights;
mod cell;
pub(crate) mod cells;
mod excluded;
mod free;
mod kin;
pub mod lattice;
pub mod law;
pub mod list;
mod measures;
mod scatter;
pub mod shares;
mod sound;
mod table;
pub mod tiles;

use crate::contact::Memory;
pub use crate::damage::Neighbour;
use crate::shares::Broken;
pub use bond_weights::{BondWeights, Factors, Weighed};
pub use cell::Edges;
pub(crate) use cell::{BoxStrain, Cell};
pub use cells::Cells;
pub use excluded::Excluded;
pub(crate) use free::Moved;
pub use law::{Influence, Law, LawKind, Moduli};
pub use measures::Measures;

pub use scatter::Scatter;
pub use table::{PmbCoeff, PmbTable};

/// How the volume of a partner near the horizon counts (`peri_modify volume`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum VolumeRule {
    /// Weight (delta + dx/2 - |xi|)/dx within dx/2 of the horizon, where families end: LAMMPS.
    #[default]
    Lammps,
    /// Weight 1 for every bond up to the horizon.
    None,
    /// The same weight as LAMMPS, but families reach to delta + dx/2, where it vanishes.
    Full,
}

impl VolumeRule {
    /// How far families reach for horizon `delta` and lattice spacing `dx`.
    pub fn reach(self, delta: f64, dx: f64) -> f64 {
        if self == Self::Full { delta + 0.5 * dx } else { delta }
    }

    /// The weight of a bond of reference length `r0` (physics: Parks et al. 2008, eq. 14).
    pub fn weight(self, r0: f64, delta: f64, dx: f64) -> f64 {
        let half = 0.5 * dx;
        if self == Self::None || (r0 - delta).abs() > half {
            return 1.0;
        }
        (-1.0 / (2.0 * half)) * r0 + (1.0 + (delta - half) / (2.0 * half))
    }
}

/// What `f` holds (`peri_modify force`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum ForceUnit {
    /// Force per volume, as LAMMPS' peri styles.
    #[default]
    Density,
    /// Force: the density times the volume of the particle it acts on.
    Newton,
}

/// Which layout bonds are kept in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Layout {
    /// The lattice where a body is one, the list elsewhere.
    #[default]
    Auto,
    /// The list everywhere.
    List,
}

/// Everything about families that is not a coefficient.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FamilyOptions {
    /// Partial volumes.
    pub volume: VolumeRule,
    /// What `f` holds.
    pub unit: ForceUnit,
    /// Spacing of the latest `lattice` command: partial volumes and short-range contact use it.
    pub lattice_spacing: f64,
    /// One critical stretch per particle, and LAMMPS' absolute threshold for stretch.
    pub compat_lammps: bool,
    /// Under that what LAMMPS has mended in 2026: each bond has the critical stretch of its own pair, and plastic bodies return
    /// to the yield surface.
    #[serde(default)]
    pub mended: bool,
    /// Broken bonds still push when they are shorter than at the start (`peri_modify broken compress`).
    pub compress: bool,
    /// Lattice or list.
    pub layout: Layout,
    /// Leave out what is exactly at rest; same bits either way.
    #[serde(skip)]
    pub skip_rest: bool,
    /// Use the portable kernels even where better ones would run.
    #[serde(skip)]
    pub portable: bool,
    /// No short-range repulsion: other contact laws keep particles apart.
    #[serde(default)]
    pub no_repulsion: bool,
    /// Members of one family whose bond is broken meet again as others do (`peri_modify family broken`).
    #[serde(default)]
    pub reunite: bool,
    /// What bonds are weighed by one at a time.
    #[serde(default)]
    pub weights: BondWeights,
}

/// Bond length changes below this count as none under `compat lammps`: an absolute length.
const NEAR_ZERO: f64 = 2.2204e-16;
/// Stretches below this carry exactly no force.
const DEAD_BAND: f64 = 4e-13;

impl FamilyOptions {
    /// The |z| (twice the stretch) below which a bond of this reference length counts as unstretched.
    pub fn dead_band(&self, length: f64) -> f64 {
        if self.compat_lammps { 2.0 * NEAR_ZERO / length } else { 2.0 * DEAD_BAND }
    }

    /// Whether particles have one critical stretch each, the largest of their bonds, as in LAMMPS 22Jul2025.
    pub fn one_stretch(&self) -> bool {
        self.compat_lammps && !self.mended
    }

    /// The distance below which two particles repel each other, bonded or not:
    /// min(0.9 of their distance at creation, 1.35 lattice spacings) (LAMMPS' peri styles).
    #[inline]
    pub fn contact_range(&self, view: &PeriView, i: u32, j: u32) -> f64 {
        let (a, b) = (view.x0[i as usize], view.x0[j as usize]);
        let d = view.bounds.nearest([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
        (0.9 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()).min(1.35 * self.lattice_spacing)
    }

    /// The defaults for a lattice spacing.
    pub fn new(lattice_spacing: f64) -> Self {
        Self {
            volume: VolumeRule::Lammps,
            unit: ForceUnit::Density,
            lattice_spacing,
            compat_lammps: false,
            mended: false,
            compress: false,
            layout: Layout::Auto,
            skip_rest: true,
            portable: false,
            no_repulsion: false,
            reunite: false,
            weights: BondWeights::default(),
        }
    }
}

/// A box, whose edges may lean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Low corner.
    pub lo: [f64; 3],
    /// High corner.
    pub hi: [f64; 3],
    /// Which directions repeat.
    pub periodic: [bool; 3],
    /// How it leans: xy, xz, yz.
    pub tilt: [f64; 3],
}

impl Bounds {
    /// Whether some edge leans.
    #[inline]
    pub fn tilted(&self) -> bool {
        self.tilt != [0.0; 3]
    }

    /// The edges along which it repeats, zero elsewhere.
    pub fn periods(&self) -> Periods {
        let of = |k: usize, a: f64| if self.periodic[k] { a } else { 0.0 };
        let [xy, xz, yz] = self.tilt;
        Periods {
            length: std::array::from_fn(|k| of(k, self.hi[k] - self.lo[k])),
            tilt: [of(1, xy), of(2, xz), of(2, yz)],
        }
    }

    /// All edges.
    pub fn edges(&self) -> Periods {
        Periods { length: std::array::from_fn(|k| self.hi[k] - self.lo[k]), tilt: self.tilt }
    }

    /// Where a place would be were the box upright.
    pub fn upright(&self, x: [f64; 3]) -> [f64; 3] {
        self.edges().straightened(x, self.lo)
    }

    /// By how much upright places along an axis are farther apart at most than the places themselves.
    pub fn wider(&self) -> [f64; 3] {
        let edges = self.edges();
        let heights = edges.heights();
        std::array::from_fn(|k| if self.tilted() { edges.length[k] / heights[k] } else { 1.0 })
    }

    /// The shortest of `d` and its images.
    #[inline]
    pub fn nearest(&self, mut d: [f64; 3]) -> [f64; 3] {
        if self.tilted() {
            return self.periods().nearest(d);
        }
        for k in 0..3 {
            let length = self.hi[k] - self.lo[k];
            if self.periodic[k] && d[k].abs() > 0.5 * length {
                d[k] -= length * (d[k] / length).round();
            }
        }
        d
    }
}

/// Energy and virial of one force evaluation; the caller zeroes them.
#[derive(Debug, Default)]
pub struct PeriTally<'a> {
    /// Sum over particles: energy densities, or energies under [`ForceUnit::Newton`].
    pub energy: f64,
    /// Virial xx, yy, zz, xy, xz, yz: with one volume factor, as LAMMPS.
    pub virial: [f64; 6],
    /// Energy (density) of each particle, added to.
    pub per_atom_energy: Option<&'a mut [f64]>,
    /// Virial of each particle, half of a bond's for each end, added to.
    pub per_atom_virial: Option<&'a mut [[f64; 6]]>,
}

impl PeriTally<'_> {
    /// Whether something is wanted of each particle.
    pub fn per_atom(&self) -> bool {
        self.per_atom_energy.is_some() || self.per_atom_virial.is_some()
    }

    /// Adds the virial of the force `pull` times `d` on `i` from `j`.
    pub fn add_virial(&mut self, i: usize, j: usize, pull: f64, d: [f64; 3]) {
        self.add_virials([i, j], [pull; 2], d);
    }

    /// Adds the virial of a bond along `d` that pulls at each of its ends as that end feels it.
    pub fn add_virials(&mut self, ends: [usize; 2], pulls: [f64; 2], d: [f64; 3]) {
        let both = 0.5 * (pulls[0] + pulls[1]);
        let product = |pull: f64| SIX.map(|(a, b)| pull * d[a] * d[b]);
        self.virial.iter_mut().zip(product(both)).for_each(|(v, p)| *v += p);
        if let Some(atoms) = self.per_atom_virial.as_deref_mut() {
            for (end, pull) in ends.into_iter().zip(pulls) {
                atoms[end].iter_mut().zip(product(pull)).for_each(|(v, p)| *v += 0.5 * p);
            }
        }
    }
}

/// What families need to know about particles: columns of equal length, and the box.
#[derive(Clone, Copy, Debug)]
pub struct PeriView<'a> {
    /// Positions.
    pub x: &'a [[f64; 3]],
    /// Positions at creation.
    pub x0: &'a [[f64; 3]],
    /// Types, from 1.
    pub kind: &'a [u16],
    /// Volumes.
    pub volume: &'a [f64],
    /// The box.
    pub bounds: Bounds,
    /// Pairs that `neigh_modify exclude` takes away: no bonds when families are found, no short-range contact.
    pub excluded: Option<Excluded<'a>>,
}

impl PeriView<'_> {
    /// Whether a rule takes this pair away.
    #[inline]
    pub fn excludes(&self, i: u32, j: u32) -> bool {
        self.excluded.is_some_and(|rules| rules.pair(i as usize, j as usize))
    }
}

/// All families of a scene: state only; [`crate::build`] makes them, `lattice` and `list` sweep them.
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
    /// The power at which bonds relaxed at the last step that was counted.
    #[serde(default)]
    pub relaxing: Option<f64>,
    /// Count both.
    #[serde(skip)]
    pub counts_losses: bool,
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

/// Pairs without a living bond that may come into short-range contact before they are looked for again.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct NearPairs {
    /// Pairs within a body (the list counts as one), and pairs across bodies.
    pub pairs: [Vec<NearPair>; 2],
    /// How much closer than at the last search two particles of the same body, and of different ones, may be.
    pub spent: [f64; 2],
    /// How much closer they may come before pairs must be searched anew.
    pub allowed: [f64; 2],
    /// How much farther than contact pairs are kept.
    pub skin: f64,
    /// Particles without a family whose type has short-range contact, and where they were.
    pub loose: Vec<(u32, [f64; 3])>,
    /// Where all particles were when pairs within a body were last searched; empty where nobody asks.
    #[serde(default)]
    pub looked: Vec<[f64; 3]>,
}

/// Two particles, the first with the lower number, that may come into short-range contact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct NearPair {
    /// The particles.
    pub ends: [u32; 2],
    /// What [`NearPairs::spent`] must reach before they can touch.
    pub after: f32,
    /// The square of the distance at which they touch, or a little more: only restart files ask, whose layout stays.
    pub within: f32,
}

/// Memory kept between steps that holds nothing a step depends on; a clone starts empty.
#[derive(Debug, Default)]
pub struct Scratch {
    /// Cells of the search for near pairs.
    pub cells: Cells,
    /// Near pairs as they are evaluated.
    pub(crate) contact: Memory,
    /// Cells of each body at the last search within bodies, if somebody has asked since.
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
