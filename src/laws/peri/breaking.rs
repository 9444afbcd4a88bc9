//! Which bonds break: after the forces of a step, from stretches of this step and families of the one before.
//!
//! A bond breaks when its stretch exceeds s00 − alpha max(s_min,i, s_min,j), s_min being the smallest stretch
//! among the bonds a particle had in the previous step, those that broke in it included. Under `compat lammps`
//! it breaks above min(s0_i, s0_j) with one s0 = max(s00 − alpha s) per particle, whatever the pair.
//!
//! Both measures are needed for few particles only. They are computed when a bond's stretch exceeds
//! s00 − alpha times its own previous stretch: never less than the true limit, for a bond belongs to both families.

use super::lattice::{MAY_BREAK, partners};
use super::pmb::stretch;
use super::stretching::{Side, StretchKernels};
use crate::par::{self, Shared};
use crate::world::families::lattice::{CONSTANTS, LANES, LatticeBody, PAD};
use crate::world::families::list::ListBody;
use crate::world::families::{Candidate, FamilyOptions};

/// A layout, as breaking sees it. Sites are cells or records.
pub trait Bonds: Sync + Sized {
    /// Finds bonds stretched beyond what their own previous stretch allows, in order.
    fn candidates<K: StretchKernels>(&self, found: &mut Vec<Candidate>);
    /// Calls `f(previous stretch, s00, alpha)` for each living bond of a site.
    fn family(&self, site: u32, options: &FamilyOptions, f: impl FnMut(f64, f64, f64));
    /// The smallest previous stretch of the families of `asked` sites (in order, each once), or LAMMPS'
    /// critical stretch.
    fn measure<K: StretchKernels>(&self, asked: &[u32], options: &FamilyOptions, measured: &Shared<f64>) {
        par::for_chunks(asked.len(), |range| {
            for &site in &asked[range] {
                let value = measure(self, site, options);
                // SAFETY: sites are asked for once.
                unsafe { measured.get(site as usize..site as usize + 1)[0] = value };
            }
        });
    }
    /// Sets whether the bonds that broke in the previous step live.
    fn revive(&mut self, lives: bool);
    /// Breaks bonds and remembers them as those of this step.
    fn break_all(&mut self, bonds: &[Candidate]);
    /// Memory for measures of sites.
    fn measured(&mut self) -> &mut Vec<f64>;
    /// Number of sites.
    fn sites(&self) -> usize;
}

/// Breaks what has to break; `found` is scratch.
pub fn break_bonds<K: StretchKernels, B: Bonds>(
    body: &mut B,
    options: &FamilyOptions,
    found: &mut Vec<Candidate>,
) {
    found.clear();
    body.candidates::<K>(found);
    if !found.is_empty() && (options.compat_lammps || found.iter().any(|c| c.alpha != 0.0)) {
        judge::<K, B>(body, options, found);
    }
    body.break_all(found);
}

/// Keeps the candidates that exceed their limit.
fn judge<K: StretchKernels, B: Bonds>(body: &mut B, options: &FamilyOptions, found: &mut Vec<Candidate>) {
    let mut measured = std::mem::take(body.measured());
    measured.resize(body.sites(), 0.0);
    let mut asked: Vec<u32> = found.iter().flat_map(|c| c.ends).collect();
    asked.sort_unstable();
    asked.dedup();
    body.revive(true);
    body.measure::<K>(&asked, options, &Shared::new(&mut measured));
    body.revive(false);
    found.retain(|c| {
        let [a, b] = c.ends.map(|site| measured[site as usize]);
        let limit = if options.compat_lammps { a.min(b) } else { c.s00 - c.alpha * a.max(b) };
        c.stretch > limit
    });
    *body.measured() = measured;
}

/// The smallest previous stretch of a site's family, or LAMMPS' critical stretch.
fn measure<B: Bonds>(body: &B, site: u32, options: &FamilyOptions) -> f64 {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    body.family(site, options, |stretch, s00, alpha| {
        least = least.min(stretch);
        most = most.max(s00 - alpha * stretch);
    });
    if options.compat_lammps { most } else { least }
}

/// A stretch, or 0 inside the dead band.
fn banded(z: f64, length: f64, options: &FamilyOptions) -> f64 {
    if z.abs() < options.dead_band(length) { 0.0 } else { stretch(z) }
}

impl LatticeBody {
    /// Micromodulus, s00 and alpha of the bond between two cells.
    fn pair(&self, i: usize, j: usize) -> [f64; 3] {
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
}

/// Memory for one thread's rows.
#[derive(Default)]
struct Scratch {
    meets: Vec<(i32, u32)>,
    to: Vec<(i32, u32)>,
    sides: Vec<Side>,
    stretches: Vec<[f64; LANES]>,
}

/// Chunks measured in one go.
const CHUNKS_PER_PART: usize = 32;

impl LatticeBody {
    /// Displacements of this step (1) or of the one before (0), at a cell.
    fn at_cell(&self, which: usize, cell: usize) -> [*const f64; 3] {
        let u = self.u[which].as_ptr();
        // SAFETY: the column has a place for each cell and PAD more around.
        [0, 1, 2].map(|k| unsafe { u.add(k * self.stride + PAD + cell) })
    }

    /// The bonds ahead of a row's chunk.
    fn sides_ahead(&self, chunk: usize, scratch: &mut Scratch) {
        let entries = self.stencil.len();
        for (e, &(to, place)) in scratch.to.iter().enumerate() {
            let [_, s00, alpha] = self.pairs[place as usize / CONSTANTS / entries];
            let bits = self.alive[chunk * entries + e];
            if bits != 0 {
                scratch.sides.push(Side { to, place, bits, sign: 1.0, s00, alpha });
            }
        }
    }

    /// The bonds that lead to a chunk (of row slot `slot`) from cells behind it.
    fn sides_behind(&self, slot: usize, chunk: usize, sides: &mut Vec<Side>) {
        let (row, entries) = (&self.rows[slot], self.stencil.len());
        for (e, &[along, across, up]) in self.stencil.iter().enumerate() {
            let back = slot.wrapping_add_signed(-(across as isize)).checked_sub(up as usize * self.width);
            let Some(back) = back.and_then(|back| self.rows.get(back)).filter(|back| back.len > 0) else {
                continue;
            };
            // The owner of the bond to the chunk's first cell, counted from its row's start.
            let first = (chunk * LANES) as i32 - row.start as i32 + row.lo - along - back.lo;
            let (owner, shift) = (first.div_euclid(LANES as i32), first.rem_euclid(LANES as i32));
            let byte = |owner: i32| match owner >= 0 && owner < (back.len as usize / LANES) as i32 {
                true => self.alive[(back.start as usize / LANES + owner as usize) * entries + e],
                false => 0,
            };
            let bits = (u16::from(byte(owner)) | u16::from(byte(owner + 1)) << 8) >> shift;
            if bits as u8 != 0 {
                let pair = usize::from(back.kind) * self.kinds.len() + usize::from(row.kind);
                let [_, s00, alpha] = self.pairs[pair];
                let to = back.start as i32 + first - (chunk * LANES) as i32;
                let place = ((pair * entries + e) * CONSTANTS) as u32;
                sides.push(Side { to, place, bits: bits as u8, sign: -1.0, s00, alpha });
            }
        }
    }

    /// Per cell of a chunk the smallest previous stretch, and LAMMPS' critical stretch.
    fn extremes<K: StretchKernels>(&self, chunk: usize, scratch: &mut Scratch) -> [[f64; LANES]; 2] {
        let slot = self.slot_of(chunk * LANES);
        partners(self, slot, &mut scratch.meets, &mut scratch.to);
        scratch.sides.clear();
        self.sides_ahead(chunk, scratch);
        self.sides_behind(slot, chunk, &mut scratch.sides);
        // SAFETY: living bonds lead to cells of the body; kernels read at most seven cells further.
        unsafe { K::extremes(self.at_cell(0, chunk * LANES), &scratch.sides, &self.tables) }
    }

    /// Bonds of a row's flagged chunks that are stretched beyond what their own previous stretch allows.
    fn strained_in_row<K: StretchKernels>(
        &self,
        slot: usize,
        scratch: &mut Scratch,
        found: &mut Vec<Candidate>,
    ) {
        let row = &self.rows[slot];
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
            scratch.sides.clear();
            scratch.stretches.clear();
            self.sides_ahead(chunk, scratch);
            let (now, before) = (self.at_cell(1, chunk * LANES), self.at_cell(0, chunk * LANES));
            let Scratch { sides, stretches, .. } = scratch;
            // SAFETY: living bonds lead to cells of the body; kernels read at most seven cells further.
            unsafe { K::strained(now, before, sides, &self.tables, stretches) };
            for (side, stretches) in sides.iter().zip(stretches.iter()).filter(|(side, _)| side.bits != 0) {
                let bond = (side.place as usize / CONSTANTS % self.stencil.len()) as u32;
                for lane in (0..LANES).filter(|lane| side.bits >> lane & 1 == 1) {
                    let i = chunk * LANES + lane;
                    let ends = [i as u32, i.wrapping_add_signed(side.to as isize) as u32];
                    let (stretch, s00, alpha) = (stretches[lane], side.s00, side.alpha);
                    found.push(Candidate { ends, bond, stretch, s00, alpha });
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
        lists.into_iter().for_each(|mut list| found.append(&mut list));
    }

    fn measure<K: StretchKernels>(&self, asked: &[u32], options: &FamilyOptions, measured: &Shared<f64>) {
        let mixed = !self.cell_kind.is_empty();
        let mut chunks: Vec<u32> = asked.iter().map(|&cell| cell / LANES as u32).collect();
        chunks.dedup();
        let parts = chunks.chunks(CHUNKS_PER_PART).collect::<Vec<_>>();
        par::for_rows(parts.len(), |part| {
            let mut scratch = Scratch::default();
            for &chunk in parts[part] {
                let cells = chunk as usize * LANES..(chunk as usize + 1) * LANES;
                let values = match mixed {
                    // Types differ within rows: constants by cell.
                    true => std::array::from_fn(|lane| measure(self, (cells.start + lane) as u32, options)),
                    false => {
                        self.extremes::<K>(chunk as usize, &mut scratch)[usize::from(options.compat_lammps)]
                    }
                };
                // SAFETY: chunks are listed once.
                unsafe { measured.get(cells).copy_from_slice(&values) };
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

    fn measured(&mut self) -> &mut Vec<f64> {
        &mut self.measured
    }

    fn sites(&self) -> usize {
        self.particle.len()
    }
}

impl ListBody {
    /// z of the bond between two records, from displacements of this step or of the last one, and |xi|.
    pub(super) fn z(&self, last: bool, i: usize, j: usize, period: [f64; 3]) -> (f64, f64) {
        let (a, b) = (&self.record[i], &self.record[j]);
        let (mut q, mut square) = (0.0, 0.0);
        for k in 0..3 {
            let mut xi = b.reference[k] - a.reference[k];
            if xi.abs() > 0.5 * period[k] {
                xi -= period[k] * (xi / period[k]).round();
            }
            let eta = if last { self.last[j][k] - self.last[i][k] } else { b.u[k] - a.u[k] };
            q += eta * (2.0 * xi + eta);
            square += xi * xi;
        }
        (q / square, square.sqrt())
    }
}

/// The list with the box it is in.
pub struct Periodic<'a>(pub &'a mut ListBody, pub [f64; 3]);

impl Bonds for Periodic<'_> {
    fn candidates<K: StretchKernels>(&self, found: &mut Vec<Candidate>) {
        let body = &*self.0;
        for i in (0..body.record.len()).filter(|&i| body.flagged[i] & MAY_BREAK != 0) {
            for b in body.own(i).filter(|&b| body.lives(b)) {
                let j = body.partner[b] as usize;
                let pair =
                    &body.pairs[usize::from(body.kind[i]) * body.kinds.len() + usize::from(body.kind[j])];
                let now = stretch(body.z(false, i, j, self.1).0);
                if now > pair.s00 - pair.alpha * stretch(body.z(true, i, j, self.1).0).max(0.0) {
                    let ends = [i as u32, j as u32];
                    let (s00, alpha) = (pair.s00, pair.alpha);
                    found.push(Candidate { ends, bond: b as u32, stretch: now, s00, alpha });
                }
            }
        }
    }

    fn family(&self, site: u32, options: &FamilyOptions, mut f: impl FnMut(f64, f64, f64)) {
        let body = &*self.0;
        body.around(site as usize, |other, b| {
            if body.lives(b) {
                let kinds = [other, site as usize].map(|r| usize::from(body.kind[r]));
                let pair = &body.pairs[kinds[0] * body.kinds.len() + kinds[1]];
                let (z, length) = body.z(true, site as usize, other, self.1);
                f(banded(z, length, options), pair.s00, pair.alpha);
            }
        });
    }

    fn revive(&mut self, lives: bool) {
        for b in self.0.broken.clone() {
            self.0.set(b as usize, lives);
        }
    }

    fn break_all(&mut self, bonds: &[Candidate]) {
        self.0.broken.clear();
        for c in bonds {
            self.0.broken.push(c.bond);
            self.0.set(c.bond as usize, false);
        }
    }

    fn measured(&mut self) -> &mut Vec<f64> {
        &mut self.0.measured
    }

    fn sites(&self) -> usize {
        self.0.record.len()
    }
}
