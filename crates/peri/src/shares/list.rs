//! The list on ranks: which slabs each sweeps, what it follows of others, and what all agree upon.

use std::ops::Range;

use crate::families::list::{ListBody, PART};
use crate::families::shares::{BodyShare, RowLink};
use crate::families::tiles::TileWindow;
use crate::families::view::Sums;
use crate::list::tiles::{make_room, overlap};
use crate::shares::agreed::{pieces_of_all, to_all};
use crate::shares::deal::dues_of;
use crate::shares::dues::Owing;
use crate::shares::whole::{Way, piece_of_sites};
use perigrain_base::comm::numbers::{next, put, take};

/// A list's windows, with `N` numbers for each record.
pub(crate) struct OfList<'a, const N: usize>(pub(crate) &'a ListBody);

impl<const N: usize> Owing for OfList<'_, N> {
    fn open(&self, slab: usize, window: &mut TileWindow) {
        make_room::<N>(self.0, slab, window);
    }

    fn runs(&self, [giver, taker]: [usize; 2], _: &TileWindow, mut run: impl FnMut(Range<usize>)) {
        if let Some((records, place)) = overlap(self.0, giver, &self.0.records(taker)) {
            run(N * place..N * (place + records.len()));
        }
    }
}

/// The slabs whose places sweeps of some slabs look at: theirs, those that their bonds reach, and those whose bonds reach them, which may be
/// squeezed.
pub(super) fn followed_slabs(list: &ListBody, slabs: &Range<usize>) -> Vec<usize> {
    let graph = &list.tiles.graph;
    let near = |slab: usize| graph.takers(slab).iter().chain(graph.givers(slab)).map(|other| *other as usize);
    let mut all: Vec<usize> = slabs.clone().flat_map(near).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// A rank's share of the list, whose slabs are dealt out like this.
pub(super) fn share_of_list(list: &ListBody, me: usize, tiles: Vec<Range<usize>>) -> BodyShare {
    let graph = &list.tiles.graph;
    let (gives, takes, waits) = dues_of(graph, me, &tiles);
    let mut follows = vec![false; list.slabs()];
    followed_slabs(list, &tiles[me]).into_iter().for_each(|slab| follows[slab] = true);
    let own = (0..list.slabs()).map(|slab| tiles[me].contains(&slab)).collect();
    let reached = |from: usize, of: usize| {
        let mut slabs: Vec<usize> =
            tiles[from].clone().flat_map(|slab| graph.takers(slab)).map(|t| *t as usize).collect();
        slabs.sort_unstable();
        slabs.dedup();
        slabs.retain(|slab| tiles[of].contains(slab));
        slabs
    };
    let links = (0..tiles.len()).filter(|with| *with != me).map(|with| RowLink {
        with,
        out: reached(with, me),
        into: reached(me, with),
        bytes: Default::default(),
    });
    let rows = links.filter(|link| !link.out.is_empty() || !link.into.is_empty()).collect();
    BodyShare { mine: tiles[me].clone(), follows, own, gives, takes, waits, rows, tiles }
}

impl ListBody {
    /// Whether each part of records whose energies are added up together is one slab's.
    pub(super) fn parts_are_of_slabs(&self) -> bool {
        let within = self.slab.get(1..self.slab.len().saturating_sub(1)).unwrap_or(&[]);
        within.iter().all(|first| (*first as usize).is_multiple_of(PART))
    }

    /// The records of some slabs.
    pub(crate) fn records_of(&self, slabs: &Range<usize>) -> Range<usize> {
        self.slab[slabs.start] as usize..self.slab[slabs.end] as usize
    }

    /// The parts of records whose energies are added up together, of some slabs.
    pub(crate) fn parts_of(&self, slabs: &Range<usize>) -> Range<usize> {
        let records = self.records_of(slabs);
        records.start.div_ceil(PART)..records.end.div_ceil(PART)
    }

    /// What sweeps and motion leave of the records of some slabs.
    pub(super) fn piece(&mut self, slabs: &Range<usize>, way: &mut Way) {
        let (n, records) = (self.record.len(), self.records_of(slabs));
        let mut moving: Vec<u8> = self.moving[slabs.clone()].iter().map(|moves| u8::from(*moves)).collect();
        way.numbers(&mut moving);
        self.moving[slabs.clone()].iter_mut().zip(moving).for_each(|(moves, flag)| *moves = flag != 0);
        self.record[records.clone()].iter_mut().for_each(|record| way.numbers(&mut record.u));
        self.last[records.clone()].iter_mut().for_each(|last| way.numbers(last));
        way.numbers(&mut self.lowest[records.clone()]);
        if self.limits.least.len() == n {
            way.numbers(&mut self.limits.least[records.clone()]);
        }
        piece_of_sites(&mut self.state, records, way);
    }
}

/// Forgets what an evaluation that was not shared out has left of other ranks' slabs.
pub(crate) fn forget_others(list: &mut ListBody, share: &BodyShare) {
    list.limits.strained.resize_with(list.slabs(), Default::default);
    for slab in (0..list.slabs()).filter(|slab| !share.own[*slab]) {
        let records = list.records(slab);
        list.lowest[records].fill(0.0);
        let (strained, top) = &mut list.limits.strained[slab];
        strained.clear();
        *top = 0.0;
    }
}

/// Has the smallest z of other ranks' records too, where bonds may be squeezed that reach this rank's particles, or `all` of them.
pub(crate) fn lowest_everywhere(list: &mut ListBody, share: &BodyShare, all: bool) {
    let mut own = vec![];
    for i in list.records_of(&share.mine).filter(|i| list.may_touch(list.lowest[*i])) {
        put(&mut own, &[i as u32, list.lowest[i].to_bits()]);
    }
    for (_, bytes) in to_all(&own) {
        let mut bytes = &bytes[..];
        while let Some([i, low]) = next(&mut bytes) {
            let i = i as usize;
            let slab = list.slab.partition_point(|first| *first as usize <= i) - 1;
            if all || share.follows[slab] {
                list.lowest[i] = f32::from_bits(low);
            }
        }
    }
}

/// Has the energies of parts of the list on all ranks, each of which has found those of its own.
pub(crate) fn parts_everywhere(list: &ListBody, (share, me): (&BodyShare, usize), parts: &mut [Sums]) {
    let length = |slabs: &Range<usize>| list.parts_of(slabs).len() * size_of::<Sums>();
    let counts: Vec<usize> = share.tiles.iter().map(length).collect();
    let own = parts[list.parts_of(&share.mine)].as_flattened();
    let bytes = pieces_of_all(&counts, me, |bytes| put(bytes, own));
    take(&mut &bytes[..], parts.as_flattened_mut());
}
