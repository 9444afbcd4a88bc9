//! Bonds of all bodies that sit on no lattice: records in slab order, each with its bonds to later ones.

use crate::families::Scatter;
use crate::families::tiles::ListTiles;
use crate::law::state::SiteState;

/// What a bond needs of one end; one cache line.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Record {
    /// Reference position.
    pub reference: [f64; 3],
    /// Volume.
    pub volume: f64,
    /// Displacement.
    pub u: [f64; 3],
    /// What turns the force on the particle into what `f` holds: 1, or 1 over the volume.
    pub share: f64,
}

/// Records whose energies are added up together.
pub(crate) const PART: usize = 16;

/// Bonds that share one row of constants, as many as there are lanes at most.
pub const GROUP: usize = 8;

/// Constants of a pair of local types.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PairConstants {
    /// Micromodulus.
    pub c: f64,
    /// c times what turns the influence of a length into the shape of microelastic bonds.
    pub shape: f64,
    /// Critical stretch.
    pub s00: f64,
    /// Its rise under compression.
    pub alpha: f64,
    /// Horizon.
    pub horizon: f64,
    /// Stretch at which bonds begin to flow.
    pub yields: f64,
    /// Weight of partial volumes: min(1, `weight[0] - weight[1] |xi|`).
    pub weight: [f64; 2],
}

/// Records of particles in slab order, and for each the bonds to later ones in groups of eight.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct ListBody {
    /// Particle of each record; `u32::MAX` once it is gone.
    pub particle: Vec<u32>,
    /// The records.
    pub record: Vec<Record>,
    /// Displacements at the last step that advanced.
    pub last: Vec<[f64; 3]>,
    /// First record of each slab, and the end. Bonds lead to later records of the same slab, to later slabs, or if `ring` on to earlier ones.
    pub slab: Vec<u32>,
    /// See `slab`.
    pub ring: bool,
    /// Slabs as tiles.
    #[serde(skip)]
    pub tiles: ListTiles,
    /// Whether a slab has displacements that are not zero.
    pub moving: Vec<bool>,
    /// Local type of each record.
    pub kind: Vec<u8>,
    /// Type of each local type.
    pub kinds: Vec<u16>,
    /// Constants by pairs of local types; where bonds have types of their own there is one local type, and they go by those.
    pub pairs: Vec<PairConstants>,
    /// First group of each record, and the end.
    pub start: Vec<u32>,
    /// Partners' records, [`GROUP`] per group; the last group of a row is filled up with its owner.
    pub partner: Vec<u32>,
    /// Which bonds of a group live: bit k for the k-th; never for fillers.
    pub alive: Vec<u8>,
    /// Local type of a group's partners, or the bonds' own type.
    pub group_kind: Vec<u8>,
    /// The record whose group it is.
    pub owner: Vec<u32>,
    /// First entry of each record in `back`, and the end.
    pub back_start: Vec<u32>,
    /// Places in `partner` that lead to a record.
    pub back: Vec<u32>,
    /// Smallest z of each record's own bonds in the last force evaluation, or less; not above 0.
    pub lowest: Vec<f32>,
    /// Largest z at which a bonded pair can be in short-range contact.
    pub contact: f64,
    /// First entry of each record in `close`, and the end.
    pub close_start: Vec<u32>,
    /// The z below which bonds can be in short-range contact and their places in `partner`: those of at least [`CLOSE`], the
    /// largest of each record first.
    pub close: Vec<(f32, u32)>,
    /// 1/|xi| of each bond.
    #[serde(skip)]
    pub inverse: Vec<f64>,
    /// The influence of each bond where it takes an exponential; empty elsewhere.
    #[serde(skip)]
    pub influence: Vec<f64>,
    /// The weight of each bond in the place of that of partial volumes, where bonds are weighed one at a time; empty elsewhere.
    #[serde(default)]
    pub own_weight: Vec<f64>,
    /// Place of the first record among all cells and records of all bodies.
    pub first_place: u32,
    /// Bonds (places in `partner`) that broke in the last step that advanced.
    pub broken: Vec<u32>,
    /// What is known of bonds near their limits.
    #[serde(skip)]
    pub limits: Limits,
    /// The work done on each bond, over both volumes, and its tension in the last step that advanced, where bonds break by that.
    #[serde(default)]
    pub work: Vec<[f64; 2]>,
    /// What is left of the life of each bond, once bonds have tired; empty before.
    #[serde(default)]
    pub life: Vec<f64>,
    /// Factors of records.
    #[serde(default)]
    pub scatter: Scatter,
    /// Under a state-based law: columns by records. Memory of bonds: number `k` of the bond at place `b` is
    /// `(b / GROUP * numbers + k) * GROUP + b % GROUP`; only records that are `touched` have any but zeros.
    pub state: SiteState,
}

/// Bonds whose z for contact is less are not in [`ListBody::close`]: they are looked at one by one when they are as short.
pub const CLOSE: f32 = -0.5;

/// What is known of the last step that advanced: saves work when bonds are judged, and nothing depends on it.
#[derive(Clone, Debug, Default)]
pub struct Limits {
    /// The least measure of each record's family, see `crate::list::breaking`; empty where not known.
    pub least: Vec<f64>,
    /// The largest of these in each slab, infinite ones left out.
    pub highest: Vec<f64>,
    /// The same of the present step, and by slabs.
    pub next: Vec<f64>,
    /// Largest z of all bonds, if known.
    pub top: Option<f64>,
    /// Whether bonds are so near their limits that measures are to be kept.
    pub near: bool,
    /// By slabs: bonds that may break in the present step, with their z, and the largest z.
    pub strained: Vec<(Vec<(u32, f64)>, f64)>,
}

impl Limits {
    /// Finds [`Limits::highest`] of slabs, which begin and end at these records.
    pub fn find_highest(&mut self, slab: &[u32]) {
        let Self { least, highest, .. } = self;
        let most = |least: &[f64]| {
            least
                .iter()
                .filter(|least| least.is_finite())
                .fold(f64::NEG_INFINITY, |most, least| least.max(most))
        };
        highest.clear();
        if !least.is_empty() {
            highest.extend(slab.windows(2).map(|ends| most(&least[ends[0] as usize..ends[1] as usize])));
        }
    }
}

impl ListBody {
    /// The number of slabs.
    pub fn slabs(&self) -> usize {
        self.slab.len().saturating_sub(1)
    }

    /// Places in `partner` of a record's own bonds, fillers included.
    pub fn own(&self, i: usize) -> std::ops::Range<usize> {
        GROUP * self.start[i] as usize..GROUP * self.start[i + 1] as usize
    }

    /// Whether the bond at a place in `partner` lives.
    pub fn lives(&self, b: usize) -> bool {
        self.alive[b / GROUP] >> (b % GROUP) & 1 == 1
    }

    /// Sets whether the bond at a place in `partner` lives.
    pub fn set(&mut self, b: usize, lives: bool) {
        if lives {
            self.alive[b / GROUP] |= 1 << (b % GROUP);
        } else {
            self.alive[b / GROUP] &= !(1 << (b % GROUP));
        }
    }

    /// Ends a bond by hand: what is known of families is no longer so.
    pub fn end(&mut self, b: usize) {
        self.set(b, false);
        self.limits.least.clear();
    }

    /// Where the memory of the bond at a place in `partner` begins, for so many numbers; they are [`GROUP`] apart.
    pub fn memory(b: usize, numbers: usize) -> usize {
        b / GROUP * numbers * GROUP + b % GROUP
    }

    /// The constants of the bond at a place in `partner`.
    #[inline]
    pub fn constants(&self, b: usize) -> &PairConstants {
        let group = b / GROUP;
        let own = usize::from(self.kind[self.owner[group] as usize]);
        &self.pairs[own * self.kinds.len() + usize::from(self.group_kind[group])]
    }

    /// The weight of the bond at a place in `partner`, of this length at the start.
    #[inline]
    pub fn weight(&self, b: usize, length: f64) -> f64 {
        let [most, slope] = self.constants(b).weight;
        self.own_weight.get(b).copied().unwrap_or_else(|| (most - slope * length).min(1.0))
    }

    /// Calls `f(other record, place in partner)` for every bond of a record, living or not.
    pub fn around(&self, i: usize, mut f: impl FnMut(usize, usize)) {
        for &b in &self.back[self.back_start[i] as usize..self.back_start[i + 1] as usize] {
            f(self.owner[b as usize / GROUP] as usize, b as usize);
        }
        for b in self.own(i) {
            let j = self.partner[b] as usize;
            if j != i {
                f(j, b);
            }
        }
    }

    /// Whether the ends of bonds with this smallest z may be in short-range contact.
    pub fn may_touch(&self, lowest: f32) -> bool {
        // No bond is as short as that of the pair that touches first; both are rounded.
        f64::from(lowest) <= self.contact + 1e-5
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        self.record.len() * (size_of::<Record>() + 24 + 4 + 1 + 4 + 4 + 4 + 4)
            + 4 * (self.partner.len() + self.back.len() + self.owner.len())
            + self.group_kind.len()
            + 8 * (self.close.len() + self.inverse.len() + self.influence.len() + self.own_weight.len())
            + 16 * self.work.len()
            + 8 * self.life.len()
            + 8 * (self.limits.least.len() + self.limits.next.len() + self.limits.highest.len())
            + self.state.bytes()
            + self.tiles.bytes()
    }
}
