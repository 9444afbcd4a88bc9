//! A peridynamic body on a lattice: cells in rows, rows in planes, one bit per bond.

use crate::families::tiles::Tiles;
use crate::families::{Measures, Scatter};
use crate::law::state::SiteState;
use perigrain_base::math::cell::{Basis, point};
use std::ops::Range;

/// Cells per chunk: alive bits of a chunk's bonds along one stencil vector are one byte.
pub const LANES: usize = 8;

/// Numbers per stencil vector in a table of constants.
pub const CONSTANTS: usize = 16;

/// Bits of [`LatticeBody::flagged`]: bonds may break.
pub const MAY_BREAK: u8 = 1;
/// Bonded pairs close enough for short-range contact.
pub const SQUEEZED: u8 = 2;

/// A row of cells; vacant cells at its end fill the last chunk.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Row {
    /// First cell.
    pub start: u32,
    /// Number of cells, a multiple of [`LANES`]; 0 for a row without particles.
    pub len: u32,
    /// Lattice coordinate of the first cell.
    pub lo: i32,
    /// Local type (from 0) of all its particles; [`MIXED`] where they differ.
    pub kind: u16,
}

impl Row {
    /// Its cells.
    pub fn cells(&self) -> Range<usize> {
        self.start as usize..(self.start + self.len) as usize
    }

    /// Its chunks.
    pub fn chunks(&self) -> Range<usize> {
        self.start as usize / LANES..(self.start + self.len) as usize / LANES
    }
}

/// The kind of a row with particles of several types.
pub const MIXED: u16 = u16::MAX;

/// What moved in a row since the step before, and where it is not at rest.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RowMotion {
    /// First coordinate with a displacement that is not zero; above `hi` if there is none.
    pub lo: i32,
    /// Last such coordinate.
    pub hi: i32,
    /// Smallest change of displacement since the step before, per component.
    pub least: [f64; 3],
    /// Largest change.
    pub most: [f64; 3],
}

impl RowMotion {
    /// Nothing there.
    pub const NONE: Self =
        Self { lo: i32::MAX, hi: i32::MIN, least: [f64::INFINITY; 3], most: [f64::NEG_INFINITY; 3] };

    /// Both together.
    #[must_use]
    pub fn with(&self, o: &Self) -> Self {
        Self {
            lo: self.lo.min(o.lo),
            hi: self.hi.max(o.hi),
            least: [0, 1, 2].map(|k| lesser(self.least[k], o.least[k])),
            most: [0, 1, 2].map(|k| greater(self.most[k], o.most[k])),
        }
    }
}

/// The smaller of two numbers of which none is NaN: one instruction.
#[inline(always)]
pub fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger of two numbers of which none is NaN.
#[inline(always)]
pub fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// A body on a lattice: simple cubic, face- or body-centred, square, hexagonal or any other, in any direction. Rows follow one of
/// its vectors; where its sites are not all taken (hexagonal close packing, diamond), whole rows are left out. Bond `e` of
/// cell `c` goes to the cell one stencil vector further; half the stencil is kept, so each bond once.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct LatticeBody {
    /// Distance of nearest neighbours.
    pub spacing: f64,
    /// The lattice's vectors: along rows, to the next row, to the next plane.
    pub basis: Basis,
    /// The stencil's reach along rows, across rows, across planes.
    pub reach: [i32; 3],
    /// The horizon of all its bonds.
    pub horizon: f64,
    /// Stencil vectors (along, across, up): the half with (up, across, along) after (0, 0, 0), ordered by
    /// (along, up, across). Neighbours in this order meet different rows: a load that overlaps a store just
    /// made to the same row would have to wait for it (measured: a third of the time).
    pub stencil: Vec<[i32; 3]>,
    /// The row steps (across, up) that occur among them.
    pub steps: Vec<(i32, usize)>,
    /// Which of the steps each stencil vector takes.
    pub step_of: Vec<u16>,
    /// Planes, not counting as many empty ones above as bonds reach.
    pub planes: usize,
    /// Row slots per plane: those with particles, between as many empty ones on both sides as bonds reach.
    pub width: usize,
    /// Rows of all planes and of the empty ones.
    pub rows: Vec<Row>,
    /// Planes of the slabs in which versions before tiles swept bodies: restart files have it.
    pub thickness: usize,
    /// Particle in each cell; `u32::MAX` where vacant.
    pub particle: Vec<u32>,
    /// Alive bits: byte `chunk * stencil.len() + e`, bit = cell in the chunk.
    pub alive: Vec<u8>,
    /// Whether every cell of a chunk has a living bond along every stencil vector that leads to a row of the body.
    pub intact: Vec<bool>,
    /// Upper bounds of z = |xi + eta|^2/|xi|^2 - 1 over a chunk's bonds (tension), per chunk.
    pub tension: Vec<f32>,
    /// Upper bounds of -z (compression), per chunk.
    pub compression: Vec<f32>,
    /// Value of either bound at which a chunk is measured anew.
    pub measure: Vec<f32>,
    /// z below which no bond of a chunk can break in this step, where the chunk is flagged for that.
    pub floor: Vec<f32>,
    /// What a chunk's bonds may need besides forces this step: bits known to the sweep.
    pub flagged: Vec<u8>,
    /// Displacements, components `stride` apart, [`PAD`] unused cells before the first: now, and at the
    /// last step that advanced.
    pub u: [Vec<f64>; 2],
    /// Distance of components in `u`.
    pub stride: usize,
    /// Motion per row slot.
    pub motion: Vec<RowMotion>,
    /// Per row slot a bound on the change of z of any bond since the last step.
    #[serde(skip)]
    pub growth: Vec<f64>,
    /// Constants of the stencil vectors for each pair of local types, [`CONSTANTS`] each.
    pub tables: Vec<f64>,
    /// Type (1-based) of each local type.
    pub kinds: Vec<u16>,
    /// Local type of each cell; empty unless types are mixed in a row or volumes differ.
    pub cell_kind: Vec<u8>,
    /// Volume of each cell; empty unless types are mixed in a row or volumes differ.
    pub cell_volume: Vec<f64>,
    /// Micromodulus, s00 and alpha for each pair of local types.
    pub pairs: Vec<[f64; 3]>,
    /// Largest z at which a bonded pair can be in short-range contact.
    pub contact: f64,
    /// Place of the first cell among all cells and records of all bodies.
    pub first_place: u32,
    /// Bonds (cell, stencil vector) that broke in the last step that advanced.
    pub broken: Vec<(u32, u16)>,
    /// Critical measures of families in the step before, by chunks.
    #[serde(skip)]
    pub measures: Measures,
    /// The blocks in which it is swept.
    #[serde(skip)]
    pub tiles: Tiles,
    /// Where bonds lead.
    #[serde(skip)]
    pub leads: Leads,
    /// Bonds that were the least stretched ones of their cells' families.
    #[serde(skip)]
    pub slackest: Slackest,
    /// The work done on each bond, over both volumes, and its tension in the last step that advanced, where bonds break by that:
    /// bond `e` of a chunk's eight cells from `(chunk * stencil.len() + e) * LANES` on.
    #[serde(default)]
    pub work: Vec<[f64; 2]>,
    /// What is left of the life of each bond, in the same order, once bonds have tired; empty before.
    #[serde(default)]
    pub life: Vec<f64>,
    /// Factors of cells.
    #[serde(default)]
    pub scatter: Scatter,
    /// Under a state-based law: columns with [`PAD`] entries around those of the cells. Memory of bonds: number `k` of
    /// bond `e` of a chunk's eight cells from `((chunk * stencil.len() + e) * numbers + k) * LANES` on.
    pub state: SiteState,
}

/// Where the bonds of a row's cells along one stencil vector lead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lead {
    /// How many cells further.
    pub to: i32,
    /// The same in the window of the tile that the row belongs to.
    pub due: i32,
    /// The place of their table of constants.
    pub table: u32,
    /// The stencil vector.
    pub e: u32,
}

/// Where bonds lead, found once for all steps.
#[derive(Clone, Debug, Default)]
pub struct Leads {
    /// Lists for rows, one after the other: only stencil vectors that lead to a row of the body. Rows beside each other that meet
    /// theirs alike share one.
    pub to: Vec<Lead>,
    /// Where the list of a row slot begins and ends; empty where nothing has been found yet.
    pub of_row: Vec<(u32, u32)>,
    /// The row slot of each chunk.
    pub slot: Vec<u32>,
    /// Whether the second half of a chunk's cells is vacant.
    pub half: Vec<bool>,
}

/// The least stretched bond of a cell's family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slack {
    /// How many cells further the other end is.
    pub to: i32,
    /// The place of its constants; `u32::MAX` where none is known.
    pub place: u32,
    /// The stencil vector.
    pub e: u16,
    /// Whether the other end owns it.
    pub behind: bool,
}

impl Slack {
    /// None is known.
    pub const NONE: Self = Self { to: 0, place: u32::MAX, e: 0, behind: false };
}

/// For each cell the bond that was the least stretched one of its family when that was looked at last. While it lives, the
/// family's least stretch is no more than its own: mostly enough to know that no bond breaks, without a look at the others.
#[derive(Clone, Debug, Default)]
pub struct Slackest {
    /// By cells; empty until families are looked at.
    pub bond: Vec<Slack>,
    /// No less than the least stretch of each cell's family in the step before, with [`PAD`] entries around; infinite
    /// where nothing is known.
    pub bound: Vec<f64>,
}

/// Unused cells around the cells of a body: kernels read beyond the ends of rows.
pub const PAD: usize = 64;

/// Numbers per page of memory.
pub const PAGE: usize = 512;
/// Numbers between the page offsets of components.
pub const STAGGER: usize = 88;

/// The distance of components with `cells` cells each and [`PAD`] around, so that they do not share page
/// offsets: loads would wait for stores to other arrays (measured: 1.8 times as fast).
pub fn staggered(cells: usize) -> usize {
    (cells + 2 * PAD).next_multiple_of(PAGE) + STAGGER
}

impl LatticeBody {
    /// The row slot of a plane and a row in it.
    pub fn slot(&self, plane: usize, row: usize) -> usize {
        plane * self.width + row
    }

    /// Where the bonds of a row lead; see [`Leads`].
    pub fn leads_of(&self, slot: usize) -> &[Lead] {
        let (begin, end) = self.leads.of_row[slot];
        &self.leads.to[begin as usize..end as usize]
    }

    /// The row slot of a cell.
    pub fn slot_of(&self, cell: usize) -> usize {
        let known = self.leads.slot.get(cell / LANES).map(|slot| *slot as usize);
        known.unwrap_or_else(|| self.rows.partition_point(|r| r.start as usize <= cell) - 1)
    }

    /// The cell one stencil vector beyond `cell` (in row slot `slot`), vacant or not.
    pub fn ahead(&self, slot: usize, cell: usize, e: usize) -> Option<usize> {
        let [along, across, up] = self.stencil[e];
        self.at(slot, (slot + up as usize * self.width).wrapping_add_signed(across as isize), cell, along)
    }

    /// The cell one stencil vector before `cell`.
    pub fn behind(&self, slot: usize, cell: usize, e: usize) -> Option<usize> {
        let [along, across, up] = self.stencil[e];
        let back = slot.wrapping_add_signed(-(across as isize)).checked_sub(up as usize * self.width)?;
        self.at(slot, back, cell, -along)
    }

    fn at(&self, slot: usize, other: usize, cell: usize, along: i32) -> Option<usize> {
        let (row, other) = (self.rows[slot], self.rows.get(other)?);
        let to = (cell - row.start as usize) as i32 + row.lo + along - other.lo;
        (to >= 0 && to < other.len as i32).then(|| other.start as usize + to as usize)
    }

    /// The lattice vector (along, across, up) from one cell to another.
    pub fn step(&self, from: usize, to: usize) -> [i32; 3] {
        let (a, b) = (self.site(from), self.site(to));
        [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
    }

    /// The place of a cell along its row, of the row in its plane, and of the plane.
    pub fn site(&self, cell: usize) -> [i32; 3] {
        let slot = self.slot_of(cell);
        let row = &self.rows[slot];
        let along = (cell - row.start as usize) as i32 + row.lo;
        [along, (slot % self.width) as i32, (slot / self.width) as i32]
    }

    /// Whether bond `e` of a cell lives.
    pub fn lives(&self, cell: usize, e: usize) -> bool {
        self.alive[cell / LANES * self.stencil.len() + e] >> (cell % LANES) & 1 == 1
    }

    /// Sets whether bond `e` of a cell lives.
    pub fn set(&mut self, cell: usize, e: usize, lives: bool) {
        let byte = &mut self.alive[cell / LANES * self.stencil.len() + e];
        if lives {
            *byte |= 1 << (cell % LANES);
        } else {
            *byte &= !(1 << (cell % LANES));
        }
    }

    /// Ends all bonds of a cell and leaves it vacant and at rest.
    pub fn vacate(&mut self, cell: usize) {
        let slot = self.slot_of(cell);
        for e in 0..self.stencil.len() {
            self.set(cell, e, false);
            if let Some(back) = self.behind(slot, cell, e) {
                self.set(back, e, false);
                self.intact[back / LANES] = false;
            }
        }
        self.intact[cell / LANES] = false;
        self.particle[cell] = u32::MAX;
        for u in &mut self.u {
            for k in 0..3 {
                u[k * self.stride + PAD + cell] = 0.0;
            }
        }
    }

    /// Calls `f(partner's cell, owner's cell, stencil vector)` for every site that a cell's bonds lead to or
    /// come from, bonded or not.
    pub fn around(&self, cell: usize, mut f: impl FnMut(usize, usize, usize)) {
        let slot = self.slot_of(cell);
        for e in 0..self.stencil.len() {
            if let Some(back) = self.behind(slot, cell, e) {
                f(back, back, e);
            }
        }
        for e in 0..self.stencil.len() {
            if let Some(to) = self.ahead(slot, cell, e) {
                f(to, cell, e);
            }
        }
    }

    /// The reference bond of a stencil vector.
    pub fn xi(&self, e: usize) -> [f64; 3] {
        point(&self.basis, self.stencil[e])
    }

    /// z = |xi + eta|^2/|xi|^2 - 1 of the bond from cell `i` to cell `j`, from displacements `u[which]`.
    pub fn z(&self, which: usize, i: usize, j: usize, e: usize) -> f64 {
        let xi = self.xi(e);
        let u = |k: usize, c: usize| self.u[which][k * self.stride + PAD + c];
        let (mut q, mut square) = (0.0, 0.0);
        for (k, xi) in xi.into_iter().enumerate() {
            let eta = u(k, j) - u(k, i);
            q += eta * (2.0 * xi + eta);
            square += xi * xi;
        }
        q / square
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        let doubles = self.u[0].len() + self.u[1].len() + self.tables.len() + self.cell_volume.len();
        let chunk = 4 * 4 + 2;
        8 * (doubles + self.broken.capacity() + 2 * self.work.len() + self.life.len())
            + self.particle.len() * 4
            + self.alive.len()
            + self.intact.len() * chunk
            + self.cell_kind.len()
            + self.measures.bytes()
            + self.leads.to.len() * size_of::<Lead>()
            + self.tiles.bytes()
            + self.slackest.bond.len() * size_of::<Slack>()
            + self.slackest.bound.len() * 8
            + self.leads.of_row.len() * 8
            + self.leads.slot.len() * 4
            + self.state.bytes()
            + self.rows.len() * (size_of::<Row>() + size_of::<RowMotion>())
    }
}
