//! Grains of very different sizes: pairs with large grains are found size by size and stored in their own
//! lists, one per slab as thick as they reach. They come after the pairs of small grains, whose tiles are
//! small and many.

use super::lists::List;
use super::{Fast, NONE};
use crate::driver::Grains;
use perigrain_base::math::lanes::PLACE_BITS;
use perigrain_base::math::periods::Periods;
use perigrain_neigh::list::{Pair, Reach, View, Wanted, pairs_of_large};
use perigrain_neigh::tiles::{HERE, Tiles};

impl Fast {
    /// Pairs with large grains at these positions, with gaps below `skin`.
    pub(super) fn find_large(
        &self,
        grains: &Grains,
        (period, skin): (Periods, f64),
        keep: &(impl Fn(usize, usize) -> bool + Sync),
    ) -> Vec<Pair> {
        let types = self.laws.types as u16;
        let mut wanted = Wanted::new(self.laws.types);
        for (a, b) in (1..=types).flat_map(|a| (a..=types).map(move |b| (a, b))) {
            if self.laws.which(a, b) != NONE {
                wanted.set(a, b, Reach::Touch);
            }
        }
        let Grains { x, tag, kind, radius, .. } = *grains;
        pairs_of_large(&View { x, tag, kind, radius, period }, &wanted, skin, keep)
    }

    /// Adds long lists of these pairs, one per slab. A pair belongs to the slab of one of its grains such
    /// that the other is in the same slab or the next.
    pub(super) fn add_large(&mut self, found: &[Pair], tiles: &Tiles) {
        let (slabs, slab_of_places) = (tiles.slabs(), tiles.slab_of_places());
        let (count, n) = (slabs.count(), tiles.order.len());
        let (mut place, mut slab) = (vec![0; n], vec![0; n]);
        for (at, i) in tiles.order.iter().enumerate() {
            (place[*i as usize], slab[*i as usize]) = (at as u32, slab_of_places[at]);
        }
        let mut entries: Vec<Vec<[u32; 3]>> = vec![vec![]; count];
        for p in found {
            let (a, b) = (p.i as usize, p.j as usize);
            let next = |k: usize| (k + 1) % count;
            debug_assert!(slab[a] == slab[b] || next(slab[a]) == slab[b] || next(slab[b]) == slab[a]);
            let first = if slab[a] == slab[b] { place[a] < place[b] } else { next(slab[a]) == slab[b] };
            let image = |sign: i32| {
                let [x, y, z] = p.shift.map(|s| sign * i32::from(s));
                (HERE as i32 + x + 3 * y + 9 * z) as u32
            };
            if first {
                entries[slab[a]].push([place[a], place[b], image(1)]);
            } else {
                entries[slab[b]].push([place[b], place[a], image(-1)]);
            }
        }
        self.lists.extend(entries.into_iter().map(|entries| list_of(entries, tiles)));
    }
}

/// A list of these entries: indices of both grains, and the image of the second one.
fn list_of(mut entries: Vec<[u32; 3]>, tiles: &Tiles) -> List {
    entries.sort_unstable();
    let grain = |place: u32| tiles.order[place as usize];
    let mut list = List::default();
    list.long.i.extend(entries.iter().map(|[i, ..]| grain(*i)));
    list.long.w.extend(entries.iter().map(|[_, j, image]| grain(*j) | image << PLACE_BITS));
    let mut seen: Vec<[u32; 2]> =
        entries.iter().flat_map(|[i, j, image]| [[HERE, *i], [*image, *j]]).collect();
    seen.sort_unstable();
    seen.dedup();
    // They extend over many layers, which are watched as one.
    seen.into_iter().for_each(|[image, place]| list.watched.push(0, image, &[grain(place)]));
    list
}
