//! The two lists of each tile: pairs within the skin, and among them the pairs within the thin skin.

use super::near::{self, Places};
use super::search::{FEW, Watched};
use super::{Fast, NOWHERE};
use crate::driver::Grains;
use perigrain_base::math::lanes::PLACE_BITS;
use perigrain_base::par;
use std::sync::{Mutex, PoisonError};

/// Lists are padded to a multiple of the largest number of pairs tested at a time.
pub const FILL: usize = 8;

/// Pairs of grains and images, padded to a multiple of [`FILL`] with pairs at infinite distance.
#[derive(Clone, Debug, Default)]
pub struct Pairs {
    /// The grain in the tile.
    pub i: Vec<u32>,
    /// The other grain, with the image in which it is seen.
    pub w: Vec<u32>,
}

impl Pairs {
    /// Removes all pairs.
    pub(super) fn clear(&mut self) {
        self.i.clear();
        self.w.clear();
    }

    /// Pads the list; releases excessive capacity.
    pub(super) fn fill_up(&mut self) {
        while !self.i.len().is_multiple_of(FILL) {
            self.i.push(0);
            self.w.push(NOWHERE << PLACE_BITS);
        }
        let long = self.i.len();
        [&mut self.i, &mut self.w].into_iter().for_each(|list| fit(list, long));
    }
}

/// Pairs within the thin skin, in the order of the long list.
#[derive(Clone, Debug, Default)]
pub struct Short {
    /// See [`Pairs`].
    pub i: Vec<u32>,
    /// See [`Pairs`].
    pub w: Vec<u32>,
    /// Index of the pair in the long list.
    pub t: Vec<u32>,
    /// Per pair: the square of the distance within which the grains touch or can stick together; empty if all
    /// radii are equal [length²].
    pub reach: Vec<f64>,
    /// Per pair: the contact's history, and the number of the step in which it last touched.
    pub history: Vec<f64>,
}

impl Short {
    /// Removes all pairs. The contents of `history` stay until they are overwritten.
    pub(super) fn clear(&mut self) {
        self.i.clear();
        self.w.clear();
        self.t.clear();
        self.reach.clear();
    }
}

/// A list of pairs of one tile.
#[derive(Clone, Debug, Default)]
pub struct List {
    /// The grains of its pairs, and some others.
    pub watched: Watched,
    /// Pairs within the skin.
    pub long: Pairs,
    /// Pairs within the thin skin.
    pub short: Short,
    /// Σ d ⊗ F of the last evaluation, if requested.
    pub virial: [f64; 6],
    /// Whether some grains overlapped too deeply in the last evaluation.
    pub deep: bool,
    /// Number of contacts in the last evaluation.
    pub touching: usize,
    /// Energy stored in contacts of dissipative laws, if the energy ledger needs it [energy].
    pub held: f64,
}

impl List {
    /// Adds the results of a part of an evaluation.
    pub(super) fn found(&mut self, virial: [f64; 6], deep: bool, touching: usize) {
        (self.virial, self.deep, self.touching) = (virial, deep, touching);
        self.held = 0.0;
    }
}

/// Cost of evaluating a contact, relative to testing a listed pair that does not touch.
pub(super) const CONTACT: usize = 8;

/// Below this amount of work (some microseconds), a loop ends before other threads could start.
const LITTLE: usize = 1024;

/// Whether the contacts of these lists are little work.
pub fn are_little(lists: &[List]) -> bool {
    lists.iter().map(|list| list.short.i.len() + CONTACT * list.touching).sum::<usize>() <= LITTLE
}

impl Fast {
    /// Makes these short lists from the current positions; histories are kept.
    pub(super) fn make_short(&mut self, grains: &Grains, which: &[usize]) {
        if which.is_empty() {
            return;
        }
        self.idle = false;
        let book = self.book.take();
        let mut lists = std::mem::take(&mut self.lists);
        let spare = Mutex::new(std::mem::take(&mut self.spare));
        let open = || spare.lock().unwrap_or_else(PoisonError::into_inner);
        let shared = par::Shared::new(&mut lists);
        let this = &*self;
        par::for_rows_if(grains.x.len() > FEW, which.len(), |k| {
            // SAFETY: each part writes its own list.
            let list = unsafe { &mut shared.get(which[k]..which[k] + 1)[0] };
            let mut room = open().pop().unwrap_or_default();
            room.clear();
            // SAFETY: the processor supports its form; list entries are grains.
            let long = [&list.long.i[..], &list.long.w];
            unsafe { near::near(this.form, grains, &this.shifts, long, this.thin + this.span, &mut room.t) };
            this.fill_short(list, book.as_ref(), &mut room);
            this.measure(grains, &mut room);
            std::mem::swap(&mut list.short, &mut room);
            open().push(room);
        });
        self.spare = spare.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.lists = lists;
    }

    /// Computes the reach of each pair in a short list.
    pub(super) fn measure(&self, grains: &Grains, short: &mut Short) {
        short.reach.clear();
        if self.alike.radius.is_none() {
            fit(&mut short.reach, short.i.len());
            let at = Places::new(grains, &self.shifts);
            let pairs = short.i.iter().zip(&short.w);
            short.reach.extend(pairs.map(|(i, w)| at.reach(*i, *w, self.span)));
        }
    }

    /// Fills in pairs and histories of a new short list whose indices into the long list are known.
    fn fill_short(&self, list: &List, book: Option<&super::Book>, new: &mut Short) {
        let (old, long, width) = (&list.short, &list.long, self.width);
        let near = new.t.len().next_multiple_of(FILL);
        [&mut new.t, &mut new.i, &mut new.w].into_iter().for_each(|list| fit(list, near));
        for (out, from) in [(&mut new.i, &long.i), (&mut new.w, &long.w)] {
            out.extend(new.t.iter().map(|t| from[*t as usize]));
        }
        new.i.resize(near, 0);
        new.w.resize(near, NOWHERE << PLACE_BITS);
        let all = new.i.len() * width;
        fit(&mut new.history, all);
        new.history.resize(all, -1.0);
        match (book, width) {
            (Some(book), _) => {
                for (k, row) in (0..new.t.len()).zip(new.history.chunks_exact_mut(width)) {
                    self.look_up(book, new.i[k], new.w[k], row);
                }
            }
            (None, 4) => carry::<4>(old, self.now, new),
            (None, 8) => carry::<8>(old, self.now, new),
            _ => carry::<12>(old, self.now, new),
        }
        new.history[new.t.len() * width..].fill(-1.0);
    }
}

/// Copies histories from one short list to the next; both are in the order of the long list. (There is no
/// branch on whether a pair was in contact: about half of them were.)
fn carry<const W: usize>(old: &Short, now: f64, new: &mut Short) {
    let (rows, row_of) = (old.history.as_chunks::<W>().0, new.history.as_chunks_mut::<W>().0);
    if rows.is_empty() {
        row_of.iter_mut().for_each(|row| row[W - 1] = -1.0);
        return;
    }
    let mut at = 0;
    for (t, row) in new.t.iter().zip(row_of) {
        while old.t.get(at).is_some_and(|o| o < t) {
            at += 1;
        }
        let before = &rows[at.min(rows.len() - 1)];
        let lasts = usize::from(old.t.get(at) == Some(t)) & usize::from(before[W - 1] == now);
        *row = *before;
        // A table lookup: a conditional would become a branch that is mispredicted for every other pair.
        row[W - 1] = [-1.0, now][lasts];
    }
}

/// Room for `len` entries and some more; releases excessive capacity. Intermediate capacities are kept: lists
/// are remade every few steps, and exact allocations would fragment memory.
fn fit<T>(list: &mut Vec<T>, len: usize) {
    let ample = len + len / 8;
    if list.capacity() < len {
        list.reserve_exact(ample - list.len());
    } else if list.capacity() > 2 * ample {
        list.truncate(len);
        list.shrink_to(ample);
    }
}
