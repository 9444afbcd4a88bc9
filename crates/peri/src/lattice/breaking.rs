//! Breaking on the lattice: chunks with a bond near its limit, eight cells at a time.

use std::borrow::Cow;

use crate::breaking::{Bonds, banded, measure};
use crate::families::lattice::{CONSTANTS, LANES, LatticeBody, Lead, MAY_BREAK, PAD, Slack, Slackest};
use crate::families::{Candidate, FamilyOptions, Measures};
use crate::lattice::bond_stretch::{FindLeast, FindStrained, Side, Strained, Watched};
use crate::lattice::chunk::constant;
use crate::lattice::leads::ahead;
use crate::law::series::stretch;
use perigrain_base::math::form::Form;
use perigrain_base::par::{self, Shared};

/// Where bonds lead back to from a row's cells, along one stencil vector.
struct Behind {
    /// How many cells further than a cell the owner of its bond lies.
    to: i32,
    /// Alive bits of the owners' row begin and end here.
    alive: (usize, usize),
    /// Where in there those of the owners of a row's first eight cells are, counted from `alive.0`; others follow them.
    first: isize,
    /// How many bits the first owner's are to be shifted.
    shift: u32,
    /// The stencil vector.
    e: u16,
    /// The pair of local types.
    pair: u16,
    /// The place of constants.
    place: u32,
}

/// Memory for one thread's rows.
#[derive(Default)]
struct Scratch {
    behind: Vec<Behind>,
    sides: Vec<Side>,
    pairs: Vec<u16>,
}

/// Chunks measured in one go.
const CHUNKS_PER_PART: usize = 32;

impl LatticeBody {
    /// Micromodulus, s00 and alpha of the bond between two cells, of which s00 is its own.
    pub(crate) fn pair(&self, i: usize, j: usize) -> [f64; 3] {
        let kind = |cell: usize| {
            let row = &self.rows[self.slot_of(cell)];
            if self.cell_kind.is_empty() {
                usize::from(row.kind)
            } else {
                usize::from(self.cell_kind[PAD + cell])
            }
        };
        let [c, s00, alpha] = self.pairs[kind(i) * self.kinds.len() + kind(j)];
        [c, s00 * self.scatter.strength([i, j]), alpha]
    }

    /// Micromodulus, s00 and alpha of pairs of local types, with the least s00 that a bond has.
    pub(crate) fn weakest_pairs(&self) -> Cow<'_, [[f64; 3]]> {
        if !self.scatter.uneven() {
            return Cow::Borrowed(&self.pairs);
        }
        let lowest = |s00| self.scatter.lowest(s00);
        Cow::Owned(self.pairs.iter().map(|&[c, s00, alpha]| [c, lowest(s00), alpha]).collect())
    }

    /// Displacements of this step (1) or of the one before (0), at a cell.
    fn at_cell(&self, which: usize, cell: usize) -> [*const f64; 3] {
        let u = self.u[which].as_ptr();
        [0, 1, 2].map(|k| u.wrapping_add(k * self.stride + PAD + cell))
    }

    /// The bonds ahead of a chunk along all stencil vectors, of which some live. `to`: where they lead.
    fn sides_ahead(&self, chunk: usize, to: &[Lead], sides: &mut Vec<Side>) {
        let entries = self.stencil.len();
        let alive = &self.alive[chunk * entries..][..entries];
        // Tables of a pair of types stand together: few pairs, and to divide for every bond would take longer than the bond.
        let (mut first, mut pair) = (u32::MAX, 0);
        for &Lead { to, table, e, .. } in to {
            let bits = alive[e as usize];
            if bits == 0 {
                continue;
            }
            let of_pair = table - e * CONSTANTS as u32;
            if of_pair != first {
                (first, pair) = (of_pair, (of_pair as usize / (CONSTANTS * entries)) as u16);
            }
            sides.push(Side { to, place: table, e: e as u16, pair, bits, behind: false });
        }
    }

    /// The row slots with bonds that may break, and those that such bonds lead to, ascending.
    fn looked_at(&self) -> Vec<usize> {
        let mut looked = vec![false; self.rows.len()];
        for (slot, row) in self.rows.iter().enumerate() {
            if self.flagged[row.chunks()].iter().any(|flag| flag & MAY_BREAK != 0) {
                looked[slot] = true;
                self.steps.iter().for_each(|step| looked[ahead(self, slot, *step)] = true);
            }
        }
        (0..looked.len()).filter(|slot| looked[*slot]).collect()
    }

    /// Finds where bonds lead back to from a row's cells.
    fn owners(&self, slot: usize, behind: &mut Vec<Behind>) {
        let (row, entries) = (&self.rows[slot], self.stencil.len());
        behind.clear();
        for (e, &[along, across, up]) in self.stencil.iter().enumerate() {
            let back = slot.wrapping_add_signed(-(across as isize)).checked_sub(up as usize * self.width);
            let Some(back) = back.and_then(|back| self.rows.get(back)).filter(|back| back.len > 0) else {
                continue;
            };
            // The owner of the bond to the row's first cell, counted from its own row's start.
            let first = row.lo - along - back.lo;
            let (start, chunks) = (back.start as usize / LANES, back.len as usize / LANES);
            let pair = back.kind * self.kinds.len() as u16 + row.kind;
            behind.push(Behind {
                to: back.start as i32 - row.start as i32 + first,
                alive: (start * entries, (start + chunks) * entries),
                first: first.div_euclid(LANES as i32) as isize * entries as isize + e as isize,
                shift: first.rem_euclid(LANES as i32) as u32,
                e: e as u16,
                pair,
                place: ((usize::from(pair) * entries + e) * CONSTANTS) as u32,
            });
        }
    }

    /// The bonds that lead to the chunk that is number `k` in its row from cells behind it.
    fn sides_behind(&self, k: usize, behind: &[Behind], sides: &mut Vec<Side>) {
        let entries = self.stencil.len();
        for b in behind {
            let alive = &self.alive[b.alive.0..b.alive.1];
            // Beyond either end of the row: too large a place.
            let at = (k * entries).wrapping_add_signed(b.first);
            let byte = |at: usize| alive.get(at).copied().unwrap_or(0);
            let bits = (u16::from(byte(at)) | u16::from(byte(at.wrapping_add(entries))) << 8) >> b.shift;
            if bits as u8 != 0 {
                let (to, place, e, pair) = (b.to, b.place, b.e, b.pair);
                sides.push(Side { to, place, e, pair, bits: bits as u8, behind: true });
            }
        }
    }

    /// Per cell of a chunk the smallest previous stretch, or LAMMPS' critical stretch, and which bond has it where all bonds
    /// have the same limits. `scratch` knows the row, whose first chunk is `first`.
    fn extremes(
        &self,
        form: Form,
        (chunk, first): (usize, usize),
        compat: bool,
        scratch: &mut Scratch,
    ) -> [(f64, Slack); LANES] {
        let Scratch { behind, sides, pairs } = scratch;
        sides.clear();
        self.sides_ahead(chunk, self.leads_of(self.slot_of(chunk * LANES)), sides);
        self.sides_behind(chunk - first, behind, sides);
        pairs.clear();
        for side in &*sides {
            // Sides of one pair mostly follow each other.
            if pairs.last() != Some(&side.pair) && !pairs.contains(&side.pair) {
                pairs.push(side.pair);
            }
        }
        let none = if compat { f64::NEG_INFINITY } else { f64::INFINITY };
        let mut out = [(none, Slack::NONE); LANES];
        for &pair in &*pairs {
            let [_, s00, alpha] = self.pairs[usize::from(pair)];
            // SAFETY: living bonds lead to cells of the body; kernels read at most seven cells further.
            let u = self.at_cell(0, chunk * LANES);
            let least = unsafe { form.run(FindLeast { u, sides, pair, tables: &self.tables }) };
            for (k, (out, z)) in out.iter_mut().zip(least.z).enumerate().filter(|(_, (_, z))| z.is_finite()) {
                // A larger z is a larger stretch, and alpha is not negative.
                let value = if compat { out.0.max(s00 - alpha * stretch(z)) } else { out.0.min(stretch(z)) };
                let Side { to, place, e, behind, .. } = sides[least.side[k] as usize];
                *out = (value, Slack { to, place, e, behind });
            }
        }
        out
    }

    /// Bonds of a row's flagged chunks that may break: stretched beyond what is sure to allow it.
    fn strained_in_row(
        &self,
        form: Form,
        (slot, pairs): (usize, &[[f64; 3]]),
        strained: &mut Vec<Strained>,
        found: &mut Vec<Candidate>,
    ) {
        let (row, entries) = (&self.rows[slot], self.stencil.len());
        let chunks = row.start as usize / LANES..(row.start + row.len) as usize / LANES;
        for chunk in chunks.filter(|&chunk| self.flagged[chunk] & MAY_BREAK != 0) {
            if !self.cell_kind.is_empty() {
                self.examine(chunk, slot, found);
                continue;
            }
            let cell = chunk * LANES;
            let watched = Watched {
                now: self.at_cell(1, cell),
                before: self.at_cell(0, cell),
                least: self.slackest.bound.as_ptr().wrapping_add(PAD + cell),
                to: self.leads_of(slot),
                alive: &self.alive[chunk * entries..][..entries],
                tables: &self.tables,
                table: entries * CONSTANTS,
                pairs,
                floor: f64::from(self.floor[chunk]),
            };
            strained.clear();
            // SAFETY: living bonds lead to cells of the body; kernels read at most seven cells further.
            unsafe { form.run(FindStrained(&watched, strained)) };
            for s in &*strained {
                let [_, s00, alpha] = self.pairs[usize::from(s.pair)];
                let mut bits = s.bits;
                while bits != 0 {
                    let lane = bits.trailing_zeros() as usize;
                    bits &= bits - 1;
                    let ends =
                        [(cell + lane) as u32, (cell + lane).wrapping_add_signed(s.lead.to as isize) as u32];
                    let one = Candidate { ends, bond: s.lead.e, stretch: s.stretch[lane], s00, alpha };
                    found.extend(self.scattered(one));
                }
            }
        }
    }

    /// A bond that may break for all that is known of the weakest one, with its own critical stretch; nothing where it bears that.
    fn scattered(&self, c: Candidate) -> Option<Candidate> {
        if !self.scatter.uneven() {
            return Some(c);
        }
        let [i, j] = c.ends.map(|cell| cell as usize);
        let s00 = c.s00 * self.scatter.strength([i, j]);
        let before = if c.alpha == 0.0 { 0.0 } else { stretch(self.z(0, i, j, c.bond as usize)).max(0.0) };
        // Rounding takes far less.
        let (limit, stretch) = (s00 - c.alpha * before, c.stretch - self.scatter.strain_between([i, j]));
        (stretch > limit - 1e-12 * limit.abs()).then_some(Candidate { s00, stretch, ..c })
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
                let now = stretch(self.z(1, i, j, e)) - self.scatter.strain_between([i, j]);
                if now > s00 - alpha * stretch(self.z(0, i, j, e)).max(0.0) {
                    let ends = [i as u32, j as u32];
                    found.push(Candidate { ends, bond: e as u32, stretch: now, s00, alpha });
                }
            }
        }
    }
}

/// No less than the least stretch of a cell's family in the step before, if its slackest bond still lives.
fn bound(body: &LatticeBody, cell: usize, bond: Slack) -> Option<f64> {
    let other = cell.wrapping_add_signed(bond.to as isize);
    let owner = if bond.behind { other } else { cell };
    if bond.place == u32::MAX || !body.lives(owner, usize::from(bond.e)) {
        return None;
    }
    let c: &[f64; CONSTANTS] = body.tables[bond.place as usize..].first_chunk()?;
    let u = |k: usize, cell: usize| body.u[0][k * body.stride + PAD + cell];
    let mut q = 0.0;
    for k in 0..3 {
        let eta = if bond.behind { u(k, cell) - u(k, other) } else { u(k, other) - u(k, cell) };
        q += eta * (eta + 2.0 * c[constant::XI + k]);
    }
    // s ≤ z/2.
    Some(if q.abs() < c[constant::DEAD] { 0.0 } else { 0.5 * q * c[constant::INVERSE] })
}

impl Bonds for LatticeBody {
    const GROUP: usize = LANES;

    fn prepare(&mut self) {
        if !self.flagged.iter().any(|flag| flag & MAY_BREAK != 0) {
            return;
        }
        let cells = self.particle.len();
        let Slackest { bond, bound: mut bounds } = std::mem::take(&mut self.slackest);
        bounds.resize(cells + 2 * PAD, f64::INFINITY);
        if bond.len() == cells {
            let (body, looked) = (&*self, self.looked_at());
            let shared = Shared::new(&mut bounds);
            par::for_rows(looked.len(), |k| {
                let cells = body.rows[looked[k]].cells();
                // SAFETY: rows share no cells, and each is looked at once.
                let bounds = unsafe { shared.get(PAD + cells.start..PAD + cells.end) };
                for (cell, (bounds, bond)) in cells.clone().zip(bounds.iter_mut().zip(&bond[cells])) {
                    *bounds = bound(body, cell, *bond).unwrap_or(f64::INFINITY);
                }
            });
        }
        self.slackest = Slackest { bond, bound: bounds };
    }

    fn candidates(&self, form: Form, found: &mut Vec<Candidate>) {
        if !self.flagged.iter().any(|flag| flag & MAY_BREAK != 0) {
            return;
        }
        let mut lists = vec![vec![]; self.planes];
        let (shared, pairs) = (Shared::new(&mut lists), self.weakest_pairs());
        par::for_rows(self.planes, |plane| {
            // SAFETY: each plane has its own list.
            let list = unsafe { &mut shared.get(plane..plane + 1)[0] };
            let mut strained = vec![];
            for slot in self.slot(plane, 0)..self.slot(plane + 1, 0) {
                self.strained_in_row(form, (slot, &pairs), &mut strained, list);
            }
        });
        found.reserve(lists.iter().map(Vec::len).sum());
        lists.into_iter().for_each(|mut list| found.append(&mut list));
    }

    fn measure(&mut self, form: Form, groups: &[u32], options: &FamilyOptions, values: &mut [f64]) {
        let mut slack = std::mem::take(&mut self.slackest.bond);
        // Bonds of several pairs have several limits: which is the least stretched says nothing of the others.
        let alike = self.pairs.len() == 1;
        if alike {
            slack.resize(self.particle.len(), Slack::NONE);
        }
        let (values, slacks, body) = (Shared::new(values), Shared::new(&mut slack), &*self);
        par::for_rows(groups.len().div_ceil(CHUNKS_PER_PART), |part| {
            let mut scratch = Scratch::default();
            let mut row = 0..0;
            let first = part * CHUNKS_PER_PART;
            for (k, &chunk) in groups[first..].iter().take(CHUNKS_PER_PART).enumerate() {
                let (chunk, at) = (chunk as usize, (first + k) * LANES);
                // SAFETY: each chunk has its own values.
                let values = unsafe { values.get(at..at + LANES) };
                if !body.cell_kind.is_empty() {
                    // Types differ within rows: constants by cell.
                    for (lane, value) in values.iter_mut().enumerate() {
                        *value = measure(body, (chunk * LANES + lane) as u32, options);
                    }
                    continue;
                }
                if !row.contains(&chunk) {
                    let slot = body.slot_of(chunk * LANES);
                    let (start, len) = (body.rows[slot].start as usize, body.rows[slot].len as usize);
                    row = start / LANES..(start + len) / LANES;
                    body.owners(slot, &mut scratch.behind);
                }
                let measured = body.extremes(form, (chunk, row.start), options.one_stretch(), &mut scratch);
                for (value, measured) in values.iter_mut().zip(&measured) {
                    *value = measured.0;
                }
                if alike {
                    // SAFETY: each chunk has its own cells.
                    let slacks = unsafe { slacks.get(chunk * LANES..(chunk + 1) * LANES) };
                    slacks.iter_mut().zip(&measured).for_each(|(slack, measured)| *slack = measured.1);
                }
            }
        });
        self.slackest.bond = slack;
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
