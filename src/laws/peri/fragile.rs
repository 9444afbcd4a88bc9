//! Breaking on the lattice: chunks with a bond near its limit, eight cells at a time.

use super::breaking::{Bonds, banded, measure};
use super::lattice::MAY_BREAK;
use super::leads::partners;
use super::pmb::stretch;
use super::stretching::{Side, StretchKernels};
use crate::par::{self, Shared};
use crate::world::families::lattice::{CONSTANTS, LANES, LatticeBody, Lead, PAD};
use crate::world::families::{Candidate, FamilyOptions, Measures};

/// Where bonds lead back to from a row's cells, along one stencil vector.
struct Behind {
    /// How many cells before a cell the owner of its bond lies.
    to: i32,
    /// First cell of the owner's row.
    start: i32,
    /// Chunks of the owner's row.
    chunks: usize,
    /// The stencil vector.
    e: usize,
    /// The pair of local types.
    pair: u16,
}

/// Memory for one thread's rows.
#[derive(Default)]
struct Scratch {
    meets: Vec<Option<(i32, u32)>>,
    to: Vec<Lead>,
    behind: Vec<Behind>,
    over: Vec<(Lead, u8)>,
    sides: Vec<Side>,
    pairs: Vec<u16>,
    stretches: Vec<[f64; LANES]>,
}

/// Chunks measured in one go.
const CHUNKS_PER_PART: usize = 32;

impl LatticeBody {
    /// Micromodulus, s00 and alpha of the bond between two cells.
    pub(super) fn pair(&self, i: usize, j: usize) -> [f64; 3] {
        let kind = |cell: usize| {
            let row = &self.rows[self.slot_of(cell)];
            if self.cell_kind.is_empty() {
                usize::from(row.kind)
            } else {
                usize::from(self.cell_kind[PAD + cell])
            }
        };
        self.pairs[kind(i) * self.kinds.len() + kind(j)]
    }

    /// Displacements of this step (1) or of the one before (0), at a cell.
    fn at_cell(&self, which: usize, cell: usize) -> [*const f64; 3] {
        let u = self.u[which].as_ptr();
        // SAFETY: the column has a place for each cell and PAD more around.
        [0, 1, 2].map(|k| unsafe { u.add(k * self.stride + PAD + cell) })
    }

    /// The bonds ahead of a chunk along a stencil vector.
    fn side_ahead(&self, Lead { to, table, .. }: Lead, bits: u8) -> Side {
        let pair = (table as usize / CONSTANTS / self.stencil.len()) as u16;
        Side { to, place: table, bits, behind: false, pair }
    }

    /// The bonds ahead of a chunk along all stencil vectors, of which some live. `to`: where they lead.
    fn sides_ahead(&self, chunk: usize, to: &[Lead], sides: &mut Vec<Side>) {
        let entries = self.stencil.len();
        let alive = &self.alive[chunk * entries..][..entries];
        // Tables of a pair of types stand together: few pairs, and to divide for every bond would take longer than the bond.
        let (mut first, mut pair) = (u32::MAX, 0);
        for &Lead { to, table, e } in to {
            let bits = alive[e as usize];
            if bits == 0 {
                continue;
            }
            let of_pair = table - e * CONSTANTS as u32;
            if of_pair != first {
                (first, pair) = (of_pair, (of_pair as usize / (CONSTANTS * entries)) as u16);
            }
            sides.push(Side { to, place: table, bits, behind: false, pair });
        }
    }

    /// Finds where bonds lead back to from a row's cells.
    fn owners(&self, slot: usize, behind: &mut Vec<Behind>) {
        let row = &self.rows[slot];
        behind.clear();
        for (e, &[along, across, up]) in self.stencil.iter().enumerate() {
            let back = slot.wrapping_add_signed(-(across as isize)).checked_sub(up as usize * self.width);
            let Some(back) = back.and_then(|back| self.rows.get(back)).filter(|back| back.len > 0) else {
                continue;
            };
            behind.push(Behind {
                to: back.start as i32 - row.start as i32 + row.lo - along - back.lo,
                start: back.start as i32,
                chunks: back.len as usize / LANES,
                e,
                pair: back.kind * self.kinds.len() as u16 + row.kind,
            });
        }
    }

    /// The bonds that lead to a chunk from cells behind it.
    fn sides_behind(&self, chunk: usize, behind: &[Behind], sides: &mut Vec<Side>) {
        let entries = self.stencil.len();
        for b in behind {
            // The owner of the bond to the chunk's first cell, counted from its row's start.
            let first = (chunk * LANES) as i32 + b.to - b.start;
            let (owner, shift) = (first.div_euclid(LANES as i32), first.rem_euclid(LANES as i32));
            let byte = |owner: i32| match (owner as usize) < b.chunks {
                true => self.alive[(b.start as usize / LANES + owner as usize) * entries + b.e],
                false => 0,
            };
            let bits = (u16::from(byte(owner)) | u16::from(byte(owner + 1)) << 8) >> shift;
            if bits as u8 != 0 {
                let place = ((usize::from(b.pair) * entries + b.e) * CONSTANTS) as u32;
                sides.push(Side { to: b.to, place, bits: bits as u8, behind: true, pair: b.pair });
            }
        }
    }

    /// Per cell of a chunk the smallest previous stretch, or LAMMPS' critical stretch. `scratch` knows the row.
    fn extremes<K: StretchKernels>(&self, chunk: usize, compat: bool, scratch: &mut Scratch) -> [f64; LANES] {
        let Scratch { to, behind, sides, pairs, .. } = scratch;
        sides.clear();
        self.sides_ahead(chunk, to, sides);
        self.sides_behind(chunk, behind, sides);
        pairs.clear();
        for side in &*sides {
            // Sides of one pair mostly follow each other.
            if pairs.last() != Some(&side.pair) && !pairs.contains(&side.pair) {
                pairs.push(side.pair);
            }
        }
        let mut out = [if compat { f64::NEG_INFINITY } else { f64::INFINITY }; LANES];
        for &pair in &*pairs {
            let [_, s00, alpha] = self.pairs[usize::from(pair)];
            // SAFETY: living bonds lead to cells of the body; kernels read at most seven cells further.
            let least = unsafe { K::least(self.at_cell(0, chunk * LANES), sides, pair, &self.tables) };
            for (out, z) in out.iter_mut().zip(least).filter(|(_, z)| z.is_finite()) {
                // A larger z is a larger stretch, and alpha is not negative.
                *out = if compat { out.max(s00 - alpha * stretch(z)) } else { out.min(stretch(z)) };
            }
        }
        out
    }

    /// Bonds of a row's flagged chunks that are stretched beyond what their own previous stretch allows.
    fn strained_in_row<K: StretchKernels>(
        &self,
        slot: usize,
        scratch: &mut Scratch,
        found: &mut Vec<Candidate>,
    ) {
        let (row, entries) = (&self.rows[slot], self.stencil.len());
        let chunks = row.start as usize / LANES..(row.start + row.len) as usize / LANES;
        let mut known = false;
        for chunk in chunks.filter(|&chunk| self.flagged[chunk] & MAY_BREAK != 0) {
            if !self.cell_kind.is_empty() {
                self.examine(chunk, slot, found);
                continue;
            }
            if !std::mem::replace(&mut known, true) {
                partners(self, slot, &mut scratch.meets, &mut scratch.to);
            }
            let Scratch { to, over, sides, stretches, .. } = scratch;
            let (now, before) = (self.at_cell(1, chunk * LANES), self.at_cell(0, chunk * LANES));
            let alive = &self.alive[chunk * entries..][..entries];
            over.clear();
            sides.clear();
            stretches.clear();
            // SAFETY: living bonds lead to cells of the body; kernels read at most seven cells further.
            unsafe { K::over(now, to, alive, &self.tables, f64::from(self.floor[chunk]), over) };
            sides.extend(over.iter().map(|&(lead, bits)| self.side_ahead(lead, bits)));
            // SAFETY: as above.
            unsafe { K::strained(now, before, sides, &self.tables, &self.pairs, stretches) };
            for (side, stretches) in sides.iter().zip(stretches.iter()).filter(|(side, _)| side.bits != 0) {
                let bond = (side.place as usize / CONSTANTS % entries) as u32;
                let [_, s00, alpha] = self.pairs[usize::from(side.pair)];
                for lane in (0..LANES).filter(|lane| side.bits >> lane & 1 == 1) {
                    let i = chunk * LANES + lane;
                    let ends = [i as u32, i.wrapping_add_signed(side.to as isize) as u32];
                    found.push(Candidate { ends, bond, stretch: stretches[lane], s00, alpha });
                }
            }
        }
    }

    /// The same for a chunk of a body with several types in a row, bond by bond.
    fn examine(&self, chunk: usize, slot: usize, found: &mut Vec<Candidate>) {
        let entries = self.stencil.len();
        for e in 0..entries {
            let bits = self.alive[chunk * entries + e];
            for lane in (0..LANES).filter(|lane| bits >> lane & 1 == 1) {
                let i = chunk * LANES + lane;
                let Some(j) = self.ahead(slot, i, e) else { continue };
                let [_, s00, alpha] = self.pair(i, j);
                let now = stretch(self.z(1, i, j, e));
                if now > s00 - alpha * stretch(self.z(0, i, j, e)).max(0.0) {
                    let ends = [i as u32, j as u32];
                    found.push(Candidate { ends, bond: e as u32, stretch: now, s00, alpha });
                }
            }
        }
    }
}

impl Bonds for LatticeBody {
    const GROUP: usize = LANES;

    fn candidates<K: StretchKernels>(&self, found: &mut Vec<Candidate>) {
        if !self.flagged.iter().any(|flag| flag & MAY_BREAK != 0) {
            return;
        }
        let mut lists = vec![vec![]; self.planes];
        let shared = Shared::new(&mut lists);
        par::for_rows(self.planes, |plane| {
            // SAFETY: each plane has its own list.
            let list = unsafe { &mut shared.get(plane..plane + 1)[0] };
            let mut scratch = Scratch::default();
            for slot in self.slot(plane, 0)..self.slot(plane + 1, 0) {
                self.strained_in_row::<K>(slot, &mut scratch, list);
            }
        });
        found.reserve(lists.iter().map(Vec::len).sum());
        lists.into_iter().for_each(|mut list| found.append(&mut list));
    }

    fn measure<K: StretchKernels>(&self, groups: &[u32], options: &FamilyOptions, values: &mut [f64]) {
        let mixed = !self.cell_kind.is_empty();
        let values = Shared::new(values);
        par::for_rows(groups.len().div_ceil(CHUNKS_PER_PART), |part| {
            let mut scratch = Scratch::default();
            let mut row = 0..0;
            let first = part * CHUNKS_PER_PART;
            for (k, &chunk) in groups[first..].iter().take(CHUNKS_PER_PART).enumerate() {
                let cells = chunk as usize * LANES..(chunk as usize + 1) * LANES;
                let measured = if mixed {
                    // Types differ within rows: constants by cell.
                    std::array::from_fn(|lane| measure(self, (cells.start + lane) as u32, options))
                } else {
                    if !row.contains(&cells.start) {
                        let slot = self.slot_of(cells.start);
                        row = self.rows[slot].start as usize
                            ..(self.rows[slot].start + self.rows[slot].len) as usize;
                        partners(self, slot, &mut scratch.meets, &mut scratch.to);
                        self.owners(slot, &mut scratch.behind);
                    }
                    self.extremes::<K>(chunk as usize, options.compat_lammps, &mut scratch)
                };
                let at = (first + k) * LANES;
                // SAFETY: each chunk has its own values.
                unsafe { values.get(at..at + LANES).copy_from_slice(&measured) };
            }
        });
    }

    fn family(&self, site: u32, options: &FamilyOptions, mut f: impl FnMut(f64, f64, f64)) {
        self.around(site as usize, |other, owner, e| {
            if self.lives(owner, e) {
                let to = if owner == other { site as usize } else { other };
                let length = self.xi(e).iter().map(|x| x * x).sum::<f64>().sqrt();
                let [_, s00, alpha] = self.pair(owner, to);
                f(banded(self.z(0, owner, to, e), length, options), s00, alpha);
            }
        });
    }

    fn revive(&mut self, lives: bool) {
        let broken = std::mem::take(&mut self.broken);
        for &(cell, e) in &broken {
            self.set(cell as usize, usize::from(e), lives);
        }
        self.broken = broken;
    }

    fn break_all(&mut self, bonds: &[Candidate]) {
        self.broken.clear();
        for c in bonds {
            self.broken.push((c.ends[0], c.bond as u16));
            self.set(c.ends[0] as usize, c.bond as usize, false);
            self.intact[c.ends[0] as usize / LANES] = false;
        }
    }

    fn measures(&mut self) -> &mut Measures {
        &mut self.measures
    }

    fn sites(&self) -> usize {
        self.particle.len()
    }
    fn particle(&self, site: u32) -> u32 {
        self.particle[site as usize]
    }
}
