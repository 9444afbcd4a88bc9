//! Passes over the tiles of a body: each is swept into a window of its own and settles when what is owed to it has come together.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};
use std::time::Instant;

use crate::families::tiles::{TileGraph, TileWindow};
use perigrain_base::par::{self, Shared};

/// What a pass goes over.
pub(crate) struct Over<'a, 's> {
    /// The tiles.
    pub(crate) graph: &'a TileGraph,
    /// Their windows.
    pub(crate) windows: &'a mut [TileWindow],
    /// Their times, where these are kept.
    pub(crate) times: &'a [[AtomicU64; 2]],
    /// This rank's share of them, where others have the rest; how to hand windows over.
    pub(crate) share: Option<HandOver<'s>>,
}

/// A rank's share of tiles, and the exchange of windows with other ranks.
pub(crate) struct HandOver<'a> {
    /// This rank's tiles.
    pub(crate) own: Range<usize>,
    /// Those of them that others' bonds reach.
    pub(crate) waits: &'a [usize],
    /// Hands windows over to other ranks and takes theirs.
    pub(crate) exchange: &'a mut dyn FnMut(&mut [TileWindow]),
}

/// Sweeps each tile into its window (`sweep(tile, window)` says whether any bond was not at rest), and settles a tile as soon as all whose
/// bonds reach into it have been swept: `settle(tile, windows)`. In which order tiles settle makes no difference: each adds up the
/// windows of its givers in their order, to cells that no other tile has. Tiles that wait for other ranks settle after these have sent
/// their windows.
pub(crate) fn pass(
    over: Over,
    sweep: impl Fn(usize, &mut TileWindow) -> bool + Sync,
    settle: impl Fn(usize, Windows) + Sync,
) {
    let Over { graph: tiles, windows, times, share } = over;
    let own = share.as_ref().map_or(0..tiles.tiles(), |share| share.own.clone());
    let here = |tile: u32| own.contains(&(tile as usize));
    // With one more for other ranks, where these give or take something.
    let count = |list: &[u32]| {
        let some = list.iter().filter(|tile| here(**tile)).count();
        (some + usize::from(some < list.len())) as u32
    };
    for k in own.clone() {
        tiles.unswept[k].store(1 + count(tiles.givers(k)), Ordering::Relaxed);
        tiles.unsettled[k].store(count(tiles.takers(k)), Ordering::Relaxed);
    }
    let last = |count: &[AtomicU32], tile: usize| count[tile].fetch_sub(1, Ordering::AcqRel) == 1;
    let release = |tile: usize, shared: &Shared<TileWindow>| {
        if last(&tiles.unsettled, tile) {
            // SAFETY: all tiles that read the window have settled.
            let window = unsafe { &mut shared.get(tile..tile + 1)[0] };
            if window.touched {
                tiles.give_room(std::mem::take(&mut window.sums));
            }
        }
    };
    let done = |taker: usize, shared: &Shared<TileWindow>| {
        timed(times, (taker, 1), || settle(taker, Windows(shared)));
        release(taker, shared);
        tiles.givers(taker).iter().filter(|giver| here(**giver)).for_each(|g| release(*g as usize, shared));
    };
    let shared = Shared::new(&mut *windows);
    par::for_rows(own.len(), |k| {
        let k = own.start + k;
        // SAFETY: each tile is swept once, and its window is read after that alone.
        let window = unsafe { &mut shared.get(k..k + 1)[0] };
        window.touched = timed(times, (k, 0), || sweep(k, window));
        for &taker in tiles.takers(k).iter().filter(|taker| here(**taker)) {
            // What was written before is seen by the thread that settles.
            let taker = taker as usize;
            if last(&tiles.unswept, taker) {
                done(taker, &shared);
            }
        }
    });
    let Some(HandOver { waits, exchange, .. }) = share else { return };
    exchange(windows);
    let shared = Shared::new(windows);
    let given = |tile: usize| tiles.takers(tile).iter().any(|taker| !here(*taker));
    own.clone().filter(|tile| given(*tile)).for_each(|tile| release(tile, &shared));
    par::for_rows(waits.len(), |k| {
        if last(&tiles.unswept, waits[k]) {
            done(waits[k], &shared);
        }
    });
}

/// Does a tile's work, and notes how long that took if it is the least time so far and times are kept.
fn timed<R>(times: &[[AtomicU64; 2]], (tile, which): (usize, usize), work: impl FnOnce() -> R) -> R {
    let Some(times) = times.get(tile) else { return work() };
    let start = Instant::now();
    let done = work();
    times[which].fetch_min(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    done
}

/// Windows of tiles, of which those that reach into a tile that settles have been swept.
#[derive(Clone, Copy)]
pub(crate) struct Windows<'a>(&'a Shared<'a, TileWindow>);

impl Windows<'_> {
    /// The window of a tile.
    ///
    /// # Safety
    /// The tile must have been swept in this pass.
    pub(crate) unsafe fn get(&self, tile: usize) -> &TileWindow {
        assert!(tile < self.0.len());
        // SAFETY: in bounds; nothing is written to the window of a tile that has been swept.
        unsafe { &*self.0.as_ptr().add(tile) }
    }
}
