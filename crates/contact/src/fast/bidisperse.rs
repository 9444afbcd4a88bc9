//! Grains of very different sizes: pairs with large ones are found size by size and have lists of their own, slab by slab, in
//! slabs as thick as they reach. They come after the pairs of small grains, whose slabs are thin and many.

use super::lists::Slab;
use super::{Fast, NONE};
use crate::driver::Grains;
use perigrain_base::math::lanes::PLACE_BITS;
use perigrain_base::math::periods::Periods;
use perigrain_neigh::list::{Pair, Reach, View, Wanted, pairs_of_large};
use perigrain_neigh::slabs::{HERE, Slabs};

impl Fast {
    /// Pairs with large grains, from these positions and radii in a box of these periods, with surfaces nearer than `skin`.
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

    /// Adds long lists of these pairs. A pair belongs to the slab of one of its grains from where the other is in the same or the
    /// next one.
    pub(super) fn add_large(&mut self, found: &[Pair], slabs: &Slabs) {
        let far = slabs.far();
        let (count, n) = (far.count(), slabs.order.len());
        let (mut place, mut slab) = (vec![0; n], vec![0; n]);
        for k in 0..count {
            for at in far.members(k) {
                let i = slabs.order[at] as usize;
                (place[i], slab[i]) = (at as u32, k);
            }
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
        let mut members = vec![];
        for mut entries in entries {
            entries.sort_unstable();
            let grain = |place: u32| slabs.order[place as usize];
            let mut list = Slab::default();
            list.long.i.extend(entries.iter().map(|[i, ..]| grain(*i)));
            list.long.w.extend(entries.iter().map(|[_, j, image]| grain(*j) | image << PLACE_BITS));
            self.lists.push(list);
            let mut places: Vec<u32> = entries.iter().flat_map(|[i, j, _]| [*i, *j]).collect();
            places.sort_unstable();
            places.dedup();
            members.push(places.into_iter().map(grain).collect());
        }
        self.validity_of_large.take(&members);
    }
}
