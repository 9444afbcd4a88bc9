//! Pairs without a living bond that may come into short-range contact, by each of their ends: searched now and then, kept in between.
//!
//! A pair stands in the rows of both of its particles and is evaluated from both sides. So threads share nothing, whichever particles they
//! take, and what a particle feels is added up at one place, in the order of its partners' numbers: sums depend neither on threads nor on when
//! pairs were searched.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use crate::contact::hits::{Hits, Push, Rules};
use crate::contact::meet::Meet;
use crate::families::list::GROUP;
use crate::families::shares::{Shares, ranges};
use crate::families::view::Sums;
use crate::families::{Bounds, FamilyOptions, NearPair, PeriTally, PeriView};
use crate::shares::sums_everywhere;
use perigrain_base::math::form::Form;
use perigrain_base::par::{self, Shared};

/// Particles in hand at once.
pub const BLOCK: usize = 32;
/// Pairs stand in rows that particles so much closer [lattice spacings] let touch: few, where a search finds pairs for far longer.
const ROOM: f64 = 0.2;
/// What the count of the partners of a member begins with.
const MEMBER: u32 = 1 << 31;
/// Particles of a part that threads share.
const PART: usize = 8 * BLOCK;

/// Where the partners of one particle stand.
#[derive(Clone, Copy, Debug, Default)]
pub struct Row {
    first: u32,
    count: u32,
    /// Places, a multiple of [`GROUP`]; those beyond `count` lead to the particle itself, with which it never touches.
    room: u32,
}

impl Row {
    /// Those in use.
    fn used(&self) -> Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }

    /// Its places, those that are not in use too.
    pub fn all(&self) -> Range<usize> {
        self.first as usize..(self.first + self.room) as usize
    }
}

/// The pairs of [`crate::families::NearPairs`] as rows. Members are particles with pairs: first those of the search in the order of their
/// numbers, then those that have come since.
#[derive(Debug, Default)]
pub struct Near {
    /// How many pairs are taken in, of which those stand in rows that may touch while particles are no more than so much closer.
    taken: usize,
    until: f64,
    /// Whether only pairs of this rank's particles stand in rows, each in the rows of those; other members have empty rows.
    pub narrow: bool,
    /// The member that a particle is; `u32::MAX` without pairs.
    member: Vec<u32>,
    /// Members, of which so many are in ascending order.
    pub particle: Vec<u32>,
    ascending: usize,
    /// Their rows.
    pub row: Vec<Row>,
    /// How much closer particles must be than at the search before the first partner of a member can touch it, and before any pair can.
    pub after: Vec<f32>,
    least: f32,
    /// Members by rows, in each in the order of their particles.
    pub partner: Vec<u32>,
    /// Places of present rows among these: rows that were full have left theirs.
    used: usize,
    /// The distances at which they touch; 0 for places that are not in use.
    pub contact: Vec<f64>,
    /// Positions of members, wrapped into the box, and their volumes.
    pub place: Vec<[f64; 4]>,
}

impl Near {
    /// Forgets all pairs.
    pub fn clear(&mut self) {
        (self.taken, self.narrow) = (0, false);
        self.particle.clear();
        self.row.clear();
        self.after.clear();
        self.partner.clear();
        self.contact.clear();
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        4 * (self.member.len() + self.particle.len() + self.after.len() + self.partner.len())
            + 12 * self.row.len()
            + 8 * self.contact.len()
            + 32 * self.place.len()
    }

    /// Takes in pairs that have come since, and those that may touch by now, where particles may be `closer` than at the search, which is made
    /// anew where they may be `allowed`. Of several ranks that share the work out each needs the rows of its own particles.
    pub fn follow(
        &mut self,
        pairs: &[NearPair],
        (closer, allowed): (f64, f64),
        (view, options): (&PeriView, &FamilyOptions),
        shares: Option<&Shares>,
    ) {
        if pairs.is_empty() {
            return self.clear();
        }
        // Rows of all particles serve one rank as well, until they are built anew.
        let lacks = self.narrow && shares.is_none();
        if pairs.len() == self.taken && closer <= self.until && !lacks {
            return;
        }
        let few = pairs.len() > self.taken && pairs.len() - self.taken < self.taken / 4;
        if lacks || closer > self.until || !few || !self.add(&pairs[self.taken..], (view, options), shares) {
            let room = ROOM * options.lattice_spacing;
            self.until = if allowed - closer < 2.0 * room { f64::INFINITY } else { closer + room };
            self.build(pairs, (view, options), shares);
        }
        self.taken = pairs.len();
    }

    fn build(
        &mut self,
        pairs: &[NearPair],
        (view, options): (&PeriView, &FamilyOptions),
        shares: Option<&Shares>,
    ) {
        self.clear();
        self.narrow = shares.is_some();
        let own = |p: u32| shares.is_none_or(|shares| shares.moves(p as usize));
        let until = self.until;
        let soon = || pairs.iter().filter(|pair| f64::from(pair.after) <= until);
        self.member.clear();
        self.member.resize(view.x.len(), 0);
        // Members are all that have pairs: the other ones may stand in rows soon.
        for p in pairs.iter().flat_map(|pair| pair.ends) {
            self.member[p as usize] = MEMBER;
        }
        for p in soon().flat_map(|pair| pair.ends).filter(|p| own(*p)) {
            self.member[p as usize] += 1;
        }
        let mut first = 0;
        for (p, member) in self.member.iter_mut().enumerate() {
            let count = std::mem::replace(member, u32::MAX);
            if count >= MEMBER {
                *member = self.particle.len() as u32;
                self.particle.push(p as u32);
                let room = (count - MEMBER).next_multiple_of(GROUP as u32);
                self.row.push(Row { first, count: 0, room });
                first += room;
            }
        }
        (self.ascending, self.used) = (self.particle.len(), first as usize);
        self.least = f32::INFINITY;
        self.after.resize(self.particle.len(), f32::INFINITY);
        self.partner.resize(first as usize, 0);
        self.contact.resize(first as usize, 0.0);
        for pair in soon() {
            let [a, b] = pair.ends.map(|p| self.member[p as usize]);
            for (own, other) in [(a, b), (b, a)] {
                let row = &mut self.row[own as usize];
                if row.room > 0 {
                    self.partner[(row.first + row.count) as usize] = other;
                    row.count += 1;
                }
                self.hasten(own, pair.after);
            }
        }
        self.put_in_order(view, options);
    }

    /// A member may touch a partner as soon as particles are so much closer.
    fn hasten(&mut self, member: u32, after: f32) {
        let own = &mut self.after[member as usize];
        *own = own.min(after);
        self.least = self.least.min(after);
    }

    /// Sorts rows, fills them up and finds the distances of contact.
    fn put_in_order(&mut self, view: &PeriView, options: &FamilyOptions) {
        let Self { row, particle, partner, contact, .. } = self;
        let (partner, contact) = (Shared::new(partner), Shared::new(contact));
        in_parts(0..row.len(), |members| {
            for own in members {
                let row = row[own];
                // SAFETY: rows share no places.
                let (partner, contact) = unsafe { (partner.get(row.all()), contact.get(row.used())) };
                let (partner, free) = partner.split_at_mut(row.count as usize);
                partner.sort_unstable();
                free.fill(own as u32);
                for (contact, other) in contact.iter_mut().zip(partner) {
                    *contact = options.contact_range(view, particle[own], particle[*other as usize]);
                }
            }
        });
    }

    /// Takes in a few more pairs; false if that is not worth it.
    fn add(
        &mut self,
        pairs: &[NearPair],
        (view, options): (&PeriView, &FamilyOptions),
        shares: Option<&Shares>,
    ) -> bool {
        let shares = shares.filter(|_| self.narrow);
        let until = self.until;
        let soon = || pairs.iter().filter(|pair| f64::from(pair.after) <= until);
        let late = self.particle.len() - self.ascending;
        if self.partner.len() > 2 * self.used || late > self.ascending / 4 {
            return false;
        }
        if !soon().all(|pair| (pair.ends[1] as usize) < self.member.len()) {
            return false;
        }
        for p in soon().flat_map(|pair| pair.ends) {
            self.admit(p);
        }
        for pair in soon() {
            let contact = options.contact_range(view, pair.ends[0], pair.ends[1]);
            let [a, b] = pair.ends.map(|p| self.member[p as usize]);
            for (own, other, p) in [(a, b, pair.ends[0]), (b, a, pair.ends[1])] {
                if shares.is_none_or(|shares| shares.moves(p as usize)) {
                    self.insert(own, other, contact);
                }
                self.hasten(own, pair.after);
            }
        }
        true
    }

    /// Makes a particle a member.
    fn admit(&mut self, p: u32) {
        let member = &mut self.member[p as usize];
        if *member == u32::MAX {
            *member = self.particle.len() as u32;
            self.particle.push(p);
            self.row.push(Row { first: self.partner.len() as u32, ..Row::default() });
            self.after.push(f32::INFINITY);
        }
    }

    fn insert(&mut self, own: u32, other: u32, contact: f64) {
        let row = &mut self.row[own as usize];
        if row.count == row.room {
            let all = row.all();
            row.first = self.partner.len() as u32;
            row.room += GROUP as u32;
            self.used += GROUP;
            self.partner.extend_from_within(all.clone());
            self.partner.resize(self.partner.len() + GROUP, own);
            self.contact.extend_from_within(all);
            self.contact.resize(self.contact.len() + GROUP, 0.0);
        }
        let used = row.used();
        let particle = |member: u32| self.particle[member as usize];
        let at = used.start + self.partner[used.clone()].partition_point(|p| particle(*p) < particle(other));
        self.partner.copy_within(at..used.end, at + 1);
        self.contact.copy_within(at..used.end, at + 1);
        (self.partner[at], self.contact[at]) = (other, contact);
        row.count += 1;
    }

    /// Positions of members, within the box along axes that repeat.
    fn gather(&mut self, view: &PeriView) {
        self.place.resize(self.particle.len(), [0.0; 4]);
        let Bounds { lo, hi, periodic, .. } = view.bounds;
        let repeats = periodic.map(|repeats| repeats && !view.bounds.tilted());
        par::each((&mut self.place[..], &self.particle[..]), |_, (place, particle)| {
            for (place, p) in place.iter_mut().zip(particle) {
                let mut x = view.x[*p as usize];
                for k in (0..3).filter(|k| repeats[*k]) {
                    if x[k] < lo[k] || x[k] >= hi[k] {
                        let length = hi[k] - lo[k];
                        x[k] -= length * ((x[k] - lo[k]) / length).floor();
                    }
                }
                *place = [x[0], x[1], x[2], view.volume[*p as usize]];
            }
        });
    }

    /// Adds the pushes of all pairs that touch to `f`, where particles may be `closer` by now than at the search; of several ranks that share
    /// the work out each looks after its own particles. `rows` is scratch.
    pub fn push(
        &mut self,
        form: Form,
        rules: &Rules,
        (closer, shares): (f64, Option<&Shares>),
        (f, tally): (&mut [[f64; 3]], Option<&mut PeriTally>),
        (hits, rows): (&[Mutex<Hits>], &mut Vec<Sums>),
    ) {
        let all = f.len().min(rules.view.x.len()) >= self.member.len();
        // All ranks come to the same end: rows of each have at least all pairs that may touch by now.
        if self.particle.is_empty() || !all || f64::from(self.least) > closer {
            return;
        }
        self.gather(rules.view);
        rows.clear();
        rows.resize(if tally.is_some() { self.particle.len() } else { 0 }, [0.0; 7]);
        let (f, sums) = (Shared::new(f), Shared::new(rows));
        // Those of other ranks find their forces there.
        self.members_of(shares).into_iter().for_each(|some| {
            in_parts(some, |members| {
                let mut hits = hits[par::slot() % hits.len()].lock().unwrap_or_else(PoisonError::into_inner);
                for first in members.clone().step_by(BLOCK) {
                    let members = first..members.end.min(first + BLOCK);
                    let mut ends = [0; BLOCK];
                    hits.count = 0;
                    // SAFETY: the caller has chosen kernels that the processor has; rows lead to members.
                    unsafe {
                        form.run(Meet {
                            near: self,
                            members: members.clone(),
                            closer,
                            rules,
                            hits: &mut hits,
                            ends: &mut ends,
                        });
                        form.run(Push(&mut hits));
                    }
                    self.hand_back(members, (&hits, &ends), (&f, &sums));
                }
            })
        });
        if let Some(t) = tally {
            if let Some(shares) = shares {
                sums_everywhere((&self.particle, &self.member), rows, shares);
            }
            self.tally(rows, t);
        }
    }

    /// The members that are this rank's, or all.
    fn members_of(&self, shares: Option<&Shares>) -> Vec<Range<usize>> {
        let Some(shares) = shares else { return std::iter::once(0..self.particle.len()).collect() };
        let (ordered, late) = self.particle.split_at(self.ascending);
        let place = |particle: usize| ordered.partition_point(|p| (*p as usize) < particle);
        let late = late.iter().enumerate().filter(|(_, p)| shares.moves(**p as usize));
        let late = ranges(late.map(|(k, _)| self.ascending + k));
        shares.own.iter().map(|own| place(own.start)..place(own.end)).chain(late).collect()
    }

    /// Adds what pushes members to the forces on them, and sums up energies and virials if these are wanted.
    fn hand_back(
        &self,
        members: Range<usize>,
        (hits, ends): (&Hits, &[usize; BLOCK]),
        (f, sums): (&Shared<[f64; 3]>, &Shared<Sums>),
    ) {
        let mut from = 0;
        for (own, &end) in members.zip(ends) {
            let all = std::mem::replace(&mut from, end)..end;
            if all.is_empty() {
                continue;
            }
            let p = self.particle[own] as usize;
            let mut sum = [0.0; 3];
            for at in all.clone() {
                let push = hits.pull[at] * hits.volume[0][at];
                (0..3).for_each(|k| sum[k] += hits.d[k][at] * push);
            }
            // SAFETY: each particle is one member, of one part.
            let f = unsafe { &mut f.get(p..p + 1)[0] };
            (0..3).for_each(|k| f[k] += sum[k]);
            if !sums.is_empty() {
                // SAFETY: as above.
                unsafe { sums.get(own..own + 1)[0] = hits.sums(self.place[own][3], all) };
            }
        }
    }

    fn tally(&self, rows: &[Sums], t: &mut PeriTally) {
        let mut members: Vec<(u32, &Sums)> = self.particle.iter().copied().zip(rows).collect();
        if self.ascending < members.len() {
            members.sort_unstable_by_key(|(p, _)| *p);
        }
        for (p, row) in members {
            let p = p as usize;
            t.energy += row[0];
            t.virial.iter_mut().zip(&row[1..]).for_each(|(v, own)| *v += own);
            if let Some(atoms) = t.per_atom_energy.as_deref_mut() {
                atoms[p] += row[0];
            }
            if let Some(atoms) = t.per_atom_virial.as_deref_mut() {
                atoms[p].iter_mut().zip(&row[1..]).for_each(|(v, own)| *v += own);
            }
        }
    }
}

/// Calls `f` for parts of so many members.
fn in_parts(members: Range<usize>, f: impl Fn(Range<usize>) + Sync) {
    let Range { start, end } = members;
    par::for_rows_if(members.len() > PART, members.len().div_ceil(PART), |part| {
        f(start + part * PART..end.min(start + (part + 1) * PART));
    });
}
