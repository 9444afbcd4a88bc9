//! The two lists of each slab: pairs within the skin, and of those the pairs within the thin skin.

use super::near::{self, HERE_BITS};
use super::{Fast, NONE, NOWHERE};
use crate::laws::contact::ContactLaw;
use crate::laws::contact::driver::Grains;
use crate::neigh::slabs::{HERE, Run, Slabs};
use crate::par;
use std::sync::{Mutex, PoisonError};

/// Pairs of grains and images. Filled up to a multiple of four with pairs that are nowhere near.
#[derive(Clone, Debug, Default)]
pub struct Pairs {
    /// The grain that lies in the slab.
    pub i: Vec<u32>,
    /// The other and the image it is seen in.
    pub w: Vec<u32>,
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
    /// Per pair: what its contact remembers, and the number of the step it last touched.
    pub history: Vec<f64>,
}

impl Short {
    fn clear(&mut self) {
        self.i.clear();
        self.w.clear();
        self.t.clear();
        self.history.clear();
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
}

impl<L: ContactLaw> Fast<L> {
    /// Long lists from these positions and radii.
    pub(super) fn make_long(
        &mut self,
        grains: &Grains,
        slabs: &Slabs,
        skin: f64,
        keep: &(impl Fn(usize, usize) -> bool + Sync),
    ) {
        let record = |&i: &u32| {
            let (x, r) = (grains.x[i as usize], grains.radius[i as usize]);
            [x[0], x[1], x[2], r]
        };
        let at: Vec<[f64; 4]> = slabs.order.iter().map(record).collect();
        let mut lists = std::mem::take(&mut self.lists);
        lists.resize(slabs.count(), Slab::default());
        let shared = par::Shared::new(&mut lists);
        let this = &*self;
        par::for_rows(slabs.count(), |k| {
            // SAFETY: each part writes its own slab.
            let slab = unsafe { &mut shared.get(k..k + 1)[0] };
            let keep = |i: u32, j: u32| {
                let (i, j) = (i as usize, j as usize);
                this.laws.which(grains.kind[i], grains.kind[j]) != NONE && keep(i, j)
            };
            this.search((slabs, k), &at, skin, &keep, &mut slab.long);
        });
        self.lists = lists;
    }

    fn search(
        &self,
        (slabs, k): (&Slabs, usize),
        at: &[[f64; 4]],
        skin: f64,
        keep: &impl Fn(u32, u32) -> bool,
        out: &mut Pairs,
    ) {
        out.i.clear();
        out.w.clear();
        let order = &slabs.order;
        let mut runs = vec![];
        for cell in slabs.slab(k) {
            let own = slabs.places(cell);
            if own.is_empty() {
                continue;
            }
            slabs.runs(cell, &mut runs);
            for i in own.clone() {
                let rest = Run { from: i as u32 + 1, to: own.end as u32, image: HERE };
                let a = at[i];
                for run in std::iter::once(&rest).chain(&runs) {
                    let shift = self.shifts[run.image as usize];
                    let others = &at[run.from as usize..run.to as usize];
                    for (b, j) in others.iter().zip(run.from..) {
                        let d =
                            [a[0] - (b[0] + shift[0]), a[1] - (b[1] + shift[1]), a[2] - (b[2] + shift[2])];
                        let reach = a[3] + b[3] + skin;
                        let (i, j) = (order[i], order[j as usize]);
                        if d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach && keep(i, j) {
                            out.i.push(i);
                            out.w.push(j | run.image << HERE_BITS);
                        }
                    }
                }
            }
        }
        while !out.i.len().is_multiple_of(4) {
            out.i.push(0);
            out.w.push(NOWHERE << HERE_BITS);
        }
        let long = out.i.len();
        fit(&mut out.i, long);
        fit(&mut out.w, long);
    }

    /// Short lists from the present positions; contacts keep what they remember.
    pub(super) fn make_short(&mut self, grains: &Grains) {
        let book = self.book.take();
        let mut lists = std::mem::take(&mut self.lists);
        let spare = Mutex::new(std::mem::take(&mut self.spare));
        let open = || spare.lock().unwrap_or_else(PoisonError::into_inner);
        let slabs = par::Shared::new(&mut lists);
        let this = &*self;
        par::for_rows(slabs.len(), |k| {
            // SAFETY: each part writes its own slab.
            let slab = unsafe { &mut slabs.get(k..k + 1)[0] };
            let mut room = open().pop().unwrap_or_default();
            room.clear();
            // SAFETY: `near` asks the processor; list entries are grains.
            unsafe { near::near(grains, &this.shifts, slab, this.thin + this.span, |t| room.t.push(t)) };
            this.fill_short(slab, book.as_ref(), &mut room);
            std::mem::swap(&mut slab.short, &mut room);
            open().push(room);
        });
        self.spare = spare.into_inner().unwrap_or_else(PoisonError::into_inner);
        self.lists = lists;
    }

    /// Fills in pairs and memory of a new short list that knows its pairs of the long list.
    fn fill_short(&self, slab: &Slab, book: Option<&super::Book>, new: &mut Short) {
        let (old, width) = (&slab.short, self.width);
        let near = new.t.len().next_multiple_of(4);
        fit(&mut new.t, near);
        fit(&mut new.i, near);
        fit(&mut new.w, near);
        new.i.extend(new.t.iter().map(|t| slab.long.i[*t as usize]));
        new.w.extend(new.t.iter().map(|t| slab.long.w[*t as usize]));
        while !new.i.len().is_multiple_of(4) {
            new.i.push(0);
            new.w.push(NOWHERE << HERE_BITS);
        }
        fit(&mut new.history, new.i.len() * width);
        new.history.resize(new.i.len() * width, 0.0);
        let mut at = 0;
        for (k, t) in new.t.iter().enumerate() {
            let row = &mut new.history[k * width..][..width];
            if let Some(book) = book {
                self.look_up(book, new.i[k], new.w[k], row);
                continue;
            }
            while old.t.get(at).is_some_and(|o| o < t) {
                at += 1;
            }
            if old.t.get(at) == Some(t) {
                row.copy_from_slice(&old.history[at * width..][..width]);
            } else {
                row[width - 1] = -1.0;
            }
        }
        new.history[new.t.len() * width..].fill(-1.0);
    }
}

/// Room for `len` entries and some more; far too much is given back. What is in between stays: lists come and go in every
/// few steps, and memory that is cut to size each time falls to pieces.
fn fit<T>(list: &mut Vec<T>, len: usize) {
    let ample = len + len / 8;
    if list.capacity() < len {
        list.reserve_exact(ample - list.len());
    } else if list.capacity() > 2 * ample {
        list.shrink_to(ample);
    }
}
