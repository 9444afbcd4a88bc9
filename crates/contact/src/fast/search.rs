//! Finds the pairs of each tile by cells, and the grains to watch for it.

use super::lists::{List, Pairs};
use super::near::InOrder;
use super::{Fast, NONE};
use crate::driver::Grains;
use perigrain_base::math::form::InLanes;
use perigrain_base::math::lanes::{Lanes, PLACE_BITS, place};
use perigrain_base::par;
use perigrain_neigh::tiles::{Around, Neighbourhood, Tiles};

/// Below this number of grains, a loop ends before other threads could start.
pub(super) const FEW: usize = 64;

/// The grains of a list, ordered so that the largest possible approach can be bounded.
#[derive(Clone, Debug, Default)]
pub struct Watched {
    pub grains: Vec<u32>,
    /// Ranges of equal layer and image, layer by layer.
    pub parts: Vec<Part>,
}

/// Grains of one layer and one image.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    pub layer: usize,
    pub image: u32,
    /// End of the range.
    pub end: u32,
}

impl Watched {
    /// Removes all grains.
    pub(super) fn clear(&mut self) {
        self.grains.clear();
        self.parts.clear();
    }

    /// Removes all grains except those for which `stays`.
    pub(super) fn retain(&mut self, stays: impl Fn(u32) -> bool) {
        let (grains, parts) = (std::mem::take(&mut self.grains), std::mem::take(&mut self.parts));
        let mut from = 0;
        for Part { layer, image, end } in parts {
            let own = grains[from..end as usize].iter().copied().filter(|grain| stays(*grain));
            let own: Vec<u32> = own.collect();
            if !own.is_empty() {
                self.push(layer, image, &own);
            }
            from = end as usize;
        }
    }

    /// Adds grains of the last layer or a later one.
    pub(super) fn push(&mut self, layer: usize, image: u32, grains: &[u32]) {
        self.grains.extend_from_slice(grains);
        let end = self.grains.len() as u32;
        match self.parts.last_mut() {
            Some(part) if (part.layer, part.image) == (layer, image) => part.end = end,
            _ => self.parts.push(Part { layer, image, end }),
        }
    }

    /// The grains grouped by image, with the images.
    pub(super) fn by_image(&self) -> impl Iterator<Item = (u32, &[u32])> {
        let mut from = 0;
        self.parts.iter().map(move |part| {
            let of = from..part.end as usize;
            from = of.end;
            (part.image, &self.grains[of])
        })
    }

    /// The grains with their images.
    fn entries(&self) -> Vec<u32> {
        let mut entries = Vec::with_capacity(self.grains.len());
        for (image, which) in self.by_image() {
            entries.extend(which.iter().map(|grain| grain | image << PLACE_BITS));
        }
        entries
    }
}

impl Fast {
    /// Makes long lists from these positions and radii, for the tiles that `lists` selects and the pairs for
    /// which `keep(tile, i, j)`.
    pub(super) fn make_long(
        &mut self,
        grains: &Grains,
        tiles: &Tiles,
        skin: f64,
        lists: impl Fn(usize) -> bool + Sync,
        keep: &(impl Fn(usize, usize, usize) -> bool + Sync),
    ) {
        let mut all = std::mem::take(&mut self.lists);
        all.resize(tiles.count(), List::default());
        let shared = par::Shared::new(&mut all);
        let this = &*self;
        par::for_rows_if(grains.x.len() > FEW, tiles.count(), |k| {
            // SAFETY: each part writes its own list.
            let list = unsafe { &mut shared.get(k..k + 1)[0] };
            if lists(k) {
                let out = (&mut list.long, &mut list.watched);
                this.search(grains, tiles, k, skin, &|i, j| keep(k, i, j), out);
            } else {
                list.long.clear();
                list.watched.clear();
            }
        });
        self.lists = all;
    }

    /// The long list of tile `k`, and the grains to watch for it.
    fn search(
        &self,
        grains: &Grains,
        tiles: &Tiles,
        k: usize,
        skin: f64,
        keep: &(impl Fn(usize, usize) -> bool + Sync),
        (out, watched): (&mut Pairs, &mut Watched),
    ) {
        let everywhere = !self.laws.which.contains(&NONE);
        let keep = |i: u32, j: u32| {
            let (i, j) = (i as usize, j as usize);
            (everywhere || self.laws.which(grains.kind[i], grains.kind[j]) != NONE) && keep(i, j)
        };
        watched.clear();
        let around = tiles.around(k, |layer, image, places| watched.push(layer, image, &tiles.order[places]));
        let (copy, entries) = (InOrder::new(grains, watched, &self.shifts), watched.entries());
        let search = Search { around: &around, grains: &copy, entries: &entries, skin, keep, out };
        // SAFETY: the processor supports its form.
        unsafe { self.form.run(search) }
        if out.i.is_empty() {
            watched.clear();
        }
        self.laws.sort(grains.kind, out);
    }

    /// Remakes the long lists of the selected tiles that contain these grains, from all positions and with
    /// the pairs for which `keep(tile, i, j)`; histories are kept. Returns the numbers of these lists.
    pub(super) fn extend_long(
        &mut self,
        grains: &Grains,
        tiles: &Tiles,
        skin: f64,
        (ends, lists): (&[usize], impl Fn(usize) -> bool),
        keep: &(impl Fn(usize, usize, usize) -> bool + Sync),
    ) -> Vec<usize> {
        let mut mine = vec![false; grains.x.len()];
        ends.iter().for_each(|&i| mine[i] = true);
        let concerned = |k: &usize| tiles.order[tiles.members(*k)].iter().any(|i| mine[*i as usize]);
        let which: Vec<usize> = (0..tiles.count()).filter(|k| lists(*k) && concerned(k)).collect();
        for &k in &which {
            let (mut new, mut watched) = (Pairs::default(), Watched::default());
            let out = (&mut new, &mut watched);
            self.search(grains, tiles, k, skin, &|i, j| keep(k, i, j), out);
            new.fill_up();
            let list = &mut self.lists[k];
            let places = moved(&list.long, &new);
            list.short.t.iter_mut().for_each(|t| *t = places[*t as usize]);
            (list.long, list.watched) = (new, watched);
        }
        which
    }
}

/// The new indices of the pairs of a list in a longer one that contains them in the same order.
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

/// The search of the pairs of a tile.
struct Search<'a, K> {
    around: &'a Around,
    /// The grains around it, in their images.
    grains: &'a InOrder,
    /// Their entries.
    entries: &'a [u32],
    skin: f64,
    keep: K,
    out: &'a mut Pairs,
}

impl<K: Fn(u32, u32) -> bool> InLanes for Search<'_, K> {
    type Out = ();

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self { around, grains, entries, skin, keep, out } = self;
        out.i.clear();
        out.w.clear();
        for Neighbourhood { own, mut rows } in around.neighbourhoods() {
            for i in own {
                let first = place(entries[i]) as u32;
                rows[0].start = i + 1;
                for others in &rows {
                    let hit = |k: usize| {
                        if keep(first, place(entries[k]) as u32) {
                            out.i.push(first);
                            out.w.push(entries[k]);
                        }
                    };
                    // SAFETY: the caller's guarantee.
                    unsafe { grains.near::<N, V>(i, others.clone(), skin, hit) };
                }
            }
        }
    }
}
