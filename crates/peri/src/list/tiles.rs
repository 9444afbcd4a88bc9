//! The slabs of a list as tiles: what their bonds reach, and what they owe to records.

use std::ops::Range;

use crate::families::list::{GROUP, ListBody};
use crate::families::shares::BodyShare;
use crate::families::tiles::{TileGraph, TileWindow};
use crate::pass::{Over, Windows, pass};
use crate::shares::dues::with_share;
use crate::shares::list::OfList;

/// Numbers of each record in windows of forces: the force, and the least measure.
pub const ROW: usize = 4;

/// Records that are added up together: they stay in the fastest memory.
const PIECE: usize = 64;

/// Finds what slabs reach, if that has not been done yet.
pub(crate) fn lay_slabs(body: &mut ListBody) {
    if body.tiles.graph.tiles() == body.slabs() {
        return;
    }
    body.tiles.reached = (0..body.slabs()).map(|slab| reach(body, slab)).collect();
    let list: &ListBody = body;
    let reaches = |giver: usize, records: &Range<usize>| overlap(list, giver, records).is_some();
    let giving = |taker: usize| {
        let (others, records) = ((0..list.slabs()).filter(|giver| *giver != taker), list.records(taker));
        others.filter(|giver| reaches(*giver, &records)).map(|giver| giver as u32).collect()
    };
    let givers: Vec<Vec<u32>> = (0..list.slabs()).map(giving).collect();
    body.tiles.graph = TileGraph::of(&givers);
    body.tiles.windows = givers.iter().map(|_| TileWindow::default()).collect();
}

/// See [`crate::families::tiles::ListTiles::reached`].
fn reach(body: &ListBody, slab: usize) -> [usize; 2] {
    let own = body.slab[slab] as usize..body.slab[slab + 1] as usize;
    let bonds = GROUP * body.start[own.start] as usize..GROUP * body.start[own.end] as usize;
    let ends = body.partner[bonds].iter().map(|partner| *partner as usize + 1);
    let (back, ahead): (Vec<usize>, Vec<usize>) = ends.partition(|end| *end <= own.start);
    match back.into_iter().max() {
        // Places in the window count on through the first records.
        Some(back) => [body.record.len(), back],
        None => [ahead.into_iter().max().unwrap_or(0).max(own.end), 0],
    }
}

/// What of some records the window of a slab covers, and the place of the first of them.
pub(crate) fn overlap(body: &ListBody, slab: usize, records: &Range<usize>) -> Option<(Range<usize>, usize)> {
    let (from, reached, n) = (body.slab[slab] as usize, body.tiles.reached[slab], body.record.len());
    let ahead = records.start.max(from)..records.end.min(reached[0]);
    if !ahead.is_empty() {
        let place = ahead.start - from;
        return Some((ahead, place));
    }
    let back = records.start..records.end.min(reached[1]).min(from);
    (!back.is_empty()).then(|| (back.clone(), n - from + back.start))
}

impl ListBody {
    /// The records of a slab.
    pub(crate) fn records(&self, slab: usize) -> Range<usize> {
        self.slab[slab] as usize..self.slab[slab + 1] as usize
    }

    /// The record before which all come after the others in the window of a slab.
    pub(crate) fn ring_start(&self, slab: usize) -> usize {
        if self.tiles.reached[slab][1] > 0 { self.slab[slab] as usize } else { 0 }
    }
}

/// Makes room in the window of a slab for `N` numbers of each record that it covers; how many these are in all.
pub(crate) fn make_room<const N: usize>(body: &ListBody, slab: usize, window: &mut TileWindow) -> usize {
    let [ahead, back] = body.tiles.reached[slab];
    let length = N * (ahead - body.slab[slab] as usize + back);
    if window.sums.len() < length {
        window.sums.resize(length, 0.0);
    }
    length
}

/// Opens the window of a slab: these `numbers` for each record that it covers. The place of the numbers of record 0, were it in the window.
pub(crate) fn open<const N: usize>(
    body: &ListBody,
    slab: usize,
    window: &mut TileWindow,
    numbers: [f64; N],
) -> *mut f64 {
    window.sums = body.tiles.graph.take_room();
    let length = make_room::<N>(body, slab, window);
    window.sums[..length].as_chunks_mut::<N>().0.fill(numbers);
    window.sums.as_mut_ptr().wrapping_sub(N * body.slab[slab] as usize)
}

/// Sweeps each slab into its window, as [`pass`] does, and settles it: `settle(records, rows)` with what some of its records are owed in all, each
/// number made of those of windows by `add`, in their order, from `none` on. Of several ranks each sweeps its share.
pub(crate) fn sweep<const N: usize>(
    body: &ListBody,
    (windows, timed, share): (&mut [TileWindow], bool, Option<&mut BodyShare>),
    sweep: impl Fn(usize, &mut TileWindow) -> bool + Sync,
    (none, add): ([f64; N], impl Fn(&mut [f64; N], &[f64; N]) + Sync),
    settle: impl Fn(Range<usize>, &[[f64; N]]) + Sync,
) {
    let graph = &body.tiles.graph;
    let times = if timed { &graph.times[..] } else { &[] };
    let settle = |slab: usize, windows: Windows| {
        // Its own window and those of its givers, in their order; what is at rest owes nothing.
        let givers = || std::iter::once(slab as u32).chain(graph.givers(slab).iter().copied());
        // SAFETY: a slab settles when it and those that reach into it have been swept.
        let owing = || givers().map(|giver| (giver as usize, unsafe { windows.get(giver as usize) }));
        let owing = || owing().filter(|(_, window)| window.touched);
        if owing().next().is_none() {
            return;
        }
        let (mut sums, records) = ([none; PIECE], body.records(slab));
        for first in records.clone().step_by(PIECE) {
            let piece = first..records.end.min(first + PIECE);
            sums.fill(none);
            for (giver, window) in owing() {
                let Some((some, place)) = overlap(body, giver, &piece) else { continue };
                let rows = window.sums[N * place..].as_chunks::<N>().0;
                let to = &mut sums[some.start - piece.start..][..some.len()];
                to.iter_mut().zip(rows).for_each(|(sum, row)| add(sum, row));
            }
            settle(piece.clone(), &sums[..piece.len()]);
        }
    };
    with_share(&OfList::<N>(body), share, |share| pass(Over { graph, windows, times, share }, sweep, settle));
}
