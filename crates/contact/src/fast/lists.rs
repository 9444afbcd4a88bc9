//! The two lists of each slab: pairs within the skin, and of those the pairs within the thin skin.

use super::near::{self, InOrder, Places};
use super::{Fast, NONE, NOWHERE};
use crate::driver::Grains;
use perigrain_base::math::form::InLanes;
use perigrain_base::math::lanes::{Lanes, PLACE_BITS};
use perigrain_base::par;
use perigrain_neigh::slabs::{HERE, Run, Slabs};
use std::sync::{Mutex, PoisonError};

/// Lists are filled up to multiples of the most pairs that are looked at at a time.
pub const FILL: usize = 8;

/// Pairs of grains and images. Filled up to a multiple of [`FILL`] with pairs that are nowhere near.
#[derive(Clone, Debug, Default)]
pub struct Pairs {
    /// The grain that lies in the slab.
    pub i: Vec<u32>,
    /// The other and the image it is seen in.
    pub w: Vec<u32>,
}

impl Pairs {
    /// Fills up; far too much room is given back.
    pub(super) fn fill_up(&mut self) {
        while !self.i.len().is_multiple_of(FILL) {
            self.i.push(0);
            self.w.push(NOWHERE << PLACE_BITS);
        }
        let long = self.i.len();
        fit(&mut self.i, long);
        fit(&mut self.w, long);
    }
}

/// Pairs within the thin skin, in the order of the long list.
#[derive(Clone, Debug, Default)]
pub struct Short {
    /// See [`Pairs`].
    pub i: Vec<u32>,
    /// See [`Pairs`].
    pub w: Vec<u32>,
    /// Which pair of the long list.
    pub t: Vec<u32>,
    /// Per pair: the square of the distance within which they touch, or can hold together; empty where all radii are the same
    /// [length²].
    pub reach: Vec<f64>,
    /// Per pair: what its contact remembers, and the number of the step it last touched.
    pub history: Vec<f64>,
}

impl Short {
    /// Forgets the pairs. What stands in `history` stays there until it is written over.
    pub(super) fn clear(&mut self) {
        self.i.clear();
        self.w.clear();
        self.t.clear();
        self.reach.clear();
    }
}

/// What belongs to one slab.
#[derive(Clone, Debug, Default)]
pub struct Slab {
    /// Pairs within the skin.
    pub long: Pairs,
    /// Pairs within the thin skin.
    pub short: Short,
    /// Σ d ⊗ F of the last evaluation, where it was asked for.
    pub virial: [f64; 6],
    /// Whether some grains overlapped too far in the last evaluation.
    pub deep: bool,
    /// How many contacts there were in the last evaluation.
    pub touching: usize,
    /// What overlaps of laws that flow hold, where the ledger of energy asks [energy].
    pub held: f64,
}

impl Slab {
    /// What an evaluation has found so far.
    pub(super) fn found(&mut self, virial: [f64; 6], deep: bool, touching: usize) {
        (self.virial, self.deep, self.touching) = (virial, deep, touching);
        self.held = 0.0;
    }
}

/// How long it takes to evaluate a contact, in units of what it takes to find out that a listed pair does not touch.
const CONTACT: usize = 8;

/// The lists of so few grains are made before another thread has seen that there is work.
const FEW: usize = 64;

/// And contacts of so little work are evaluated before: some microseconds, in these units.
const LITTLE: usize = 1024;

/// How much work each short list is; nothing where all of them are little.
pub fn weights(lists: &[Slab]) -> Option<Vec<usize>> {
    let weight = |list: &Slab| list.short.i.len() + CONTACT * list.touching;
    let all: usize = lists.iter().map(weight).sum();
    (all > LITTLE).then(|| lists.iter().map(weight).collect())
}

impl Fast {
    /// Long lists from these positions and radii.
    pub(super) fn make_long(
        &mut self,
        grains: &Grains,
        slabs: &Slabs,
        skin: f64,
        keep: &(impl Fn(usize, usize) -> bool + Sync),
    ) {
        let at = InOrder::new(grains, &slabs.order);
        let mut lists = std::mem::take(&mut self.lists);
        lists.resize(slabs.near().count(), Slab::default());
        let shared = par::Shared::new(&mut lists);
        let this = &*self;
        par::for_rows_if(grains.x.len() > FEW, slabs.near().count(), |k| {
            // SAFETY: each part writes its own slab.
            let slab = unsafe { &mut shared.get(k..k + 1)[0] };
            this.search(grains, (slabs, &at), k, skin, keep, &mut slab.long);
        });
        self.lists = lists;
    }

    /// The long list of slab `k`.
    fn search(
        &self,
        grains: &Grains,
        (slabs, at): (&Slabs, &InOrder),
        k: usize,
        skin: f64,
        keep: &(impl Fn(usize, usize) -> bool + Sync),
        out: &mut Pairs,
    ) {
        let everywhere = !self.laws.which.contains(&NONE);
        let keep = |i: u32, j: u32| {
            let (i, j) = (i as usize, j as usize);
            (everywhere || self.laws.which(grains.kind[i], grains.kind[j]) != NONE) && keep(i, j)
        };
        let search = Search { slabs, k, at, shifts: &self.shifts, skin, keep, out };
        // SAFETY: the processor has what its form needs.
        unsafe { self.form.run(search) }
    }

    /// Long lists of the slabs in which these grains lie, made anew from the positions of all of them; what their contacts
    /// remember stays. Which slabs.
    pub(super) fn extend_long(
        &mut self,
        grains: &Grains,
        slabs: &Slabs,
        skin: f64,
        ends: &[usize],
        keep: &(impl Fn(usize, usize) -> bool + Sync),
    ) -> Vec<usize> {
        let mut mine = vec![false; grains.x.len()];
        ends.iter().for_each(|&i| mine[i] = true);
        let concerned = |k: &usize| slabs.order[slabs.near().members(*k)].iter().any(|i| mine[*i as usize]);
        let which: Vec<usize> = (0..slabs.near().count()).filter(concerned).collect();
        let at = InOrder::new(grains, &slabs.order);
        for &k in &which {
            let mut new = Pairs::default();
            self.search(grains, (slabs, &at), k, skin, keep, &mut new);
            new.fill_up();
            let slab = &mut self.lists[k];
            let places = moved(&slab.long, &new);
            slab.short.t.iter_mut().for_each(|t| *t = places[*t as usize]);
            slab.long = new;
        }
        which
    }

    /// Short lists of these slabs from the present positions; contacts keep what they remember.
    pub(super) fn make_short(&mut self, grains: &Grains, which: &[usize]) {
        if which.is_empty() {
            return;
        }
        self.idle = false;
        let book = self.book.take();
        let mut lists = std::mem::take(&mut self.lists);
        let spare = Mutex::new(std::mem::take(&mut self.spare));
        let open = || spare.lock().unwrap_or_else(PoisonError::into_inner);
        let slabs = par::Shared::new(&mut lists);
        let this = &*self;
        par::for_rows_if(grains.x.len() > FEW, which.len(), |k| {
            // SAFETY: each part writes its own slab.
            let slab = unsafe { &mut slabs.get(which[k]..which[k] + 1)[0] };
            let mut room = open().pop().unwrap_or_default();
            room.clear();
            // SAFETY: the processor has what its form needs; list entries are grains.
            let long = [&slab.long.i[..], &slab.long.w];
            unsafe { near::near(this.form, grains, &this.shifts, long, this.thin + this.span, &mut room.t) };
            this.fill_short(slab, book.as_ref(), &mut room);
            this.measure(grains, &mut room);
            std::mem::swap(&mut slab.short, &mut room);
            open().push(room);
        });
        self.spare = spare.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.lists = lists;
    }

    /// Fills in how far each pair of a short list reaches.
    pub(super) fn measure(&self, grains: &Grains, short: &mut Short) {
        short.reach.clear();
        if self.alike.radius.is_none() {
            fit(&mut short.reach, short.i.len());
            let at = Places::new(grains, &self.shifts);
            let pairs = short.i.iter().zip(&short.w);
            short.reach.extend(pairs.map(|(i, w)| at.reach(*i, *w, self.span)));
        }
    }

    /// Fills in pairs and memory of a new short list that knows its pairs of the long list.
    fn fill_short(&self, slab: &Slab, book: Option<&super::Book>, new: &mut Short) {
        let (old, width) = (&slab.short, self.width);
        let near = new.t.len().next_multiple_of(FILL);
        fit(&mut new.t, near);
        fit(&mut new.i, near);
        fit(&mut new.w, near);
        new.i.extend(new.t.iter().map(|t| slab.long.i[*t as usize]));
        new.w.extend(new.t.iter().map(|t| slab.long.w[*t as usize]));
        while !new.i.len().is_multiple_of(FILL) {
            new.i.push(0);
            new.w.push(NOWHERE << PLACE_BITS);
        }
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

/// Where the pairs of a list stand in a longer one that has them all in the same order.
fn moved(old: &Pairs, new: &Pairs) -> Vec<u32> {
    let mut at = 0;
    let mut places = vec![];
    for pair in old.i.iter().zip(&old.w) {
        while at + 1 < new.i.len() && (&new.i[at], &new.w[at]) != pair {
            at += 1;
        }
        places.push(at as u32);
        at = (at + 1).min(new.i.len().saturating_sub(1));
    }
    places
}

/// Carries what contacts remember from one short list to the next one; both are in the order of the long list. (No branch asks
/// whether a pair has been a contact: about half of them have.)
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
        // Looked up: as a choice it becomes a branch, which is guessed wrong for every other pair.
        row[W - 1] = [-1.0, now][lasts];
    }
}

/// Room for `len` entries and some more; far too much is given back. What is in between stays: lists come and go in every
/// few steps, and memory that is cut to size each time falls to pieces.
fn fit<T>(list: &mut Vec<T>, len: usize) {
    let ample = len + len / 8;
    if list.capacity() < len {
        list.reserve_exact(ample - list.len());
    } else if list.capacity() > 2 * ample {
        list.truncate(len);
        list.shrink_to(ample);
    }
}

/// The search of the pairs of slab `k`.
struct Search<'a, K> {
    slabs: &'a Slabs,
    k: usize,
    at: &'a InOrder,
    shifts: &'a [[f64; 4]; 32],
    skin: f64,
    keep: K,
    out: &'a mut Pairs,
}

impl<K: Fn(u32, u32) -> bool> InLanes for Search<'_, K> {
    type Out = ();

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self { slabs, k, at, shifts, skin, keep, out } = self;
        out.i.clear();
        out.w.clear();
        let order = &slabs.order;
        let mut runs = vec![];
        for cell in slabs.near().slab(k) {
            let own = slabs.places(cell);
            if own.is_empty() {
                continue;
            }
            slabs.runs(cell, &mut runs);
            for i in own.clone() {
                let rest = Run { from: i as u32 + 1, to: own.end as u32, image: HERE };
                for run in std::iter::once(&rest).chain(&runs) {
                    let hit = |j: usize| {
                        let (i, j) = (order[i], order[j]);
                        if keep(i, j) {
                            out.i.push(i);
                            out.w.push(j | run.image << PLACE_BITS);
                        }
                    };
                    // SAFETY: passed on.
                    unsafe { at.near::<N, V>(i, run, &shifts[run.image as usize], skin, hit) };
                }
            }
        }
    }
}
