//! The tiles in which a body is swept: blocks of rows and planes of a lattice or slabs of a list, each with forces of its own.

use std::ops::Range;
use std::sync::atomic::{AtomicU32, AtomicU64};
use std::sync::{Mutex, PoisonError};

/// A block of rows and planes. Its bonds reach into others: what they add to these is kept in the tile's window until those settle.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Its planes.
    pub planes: Range<usize>,
    /// Its rows in each of them, by their places among a plane's row slots.
    pub rows: Range<usize>,
    /// Where in `Tiles::reached` the planes of its window stand: its own and those beyond that its bonds reach.
    pub reached: Range<usize>,
}

/// What a tile's bonds reach of one plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reached {
    /// First and past the last row, by their places among a plane's row slots.
    pub rows: [usize; 2],
    /// First and past the last cell of these rows.
    pub cells: [usize; 2],
    /// The cell with the first place of the window, were all planes like this one. Those of a tile differ by whole pages.
    pub first: usize,
}

/// Forces (or other sums) that the bonds of one tile give, by the cells that they reach.
#[derive(Debug, Default)]
pub struct TileWindow {
    /// The numbers; unused ones around. None but from the sweep of the tile until all have settled into which it reaches: the room
    /// serves other tiles then, and is in fast memory still.
    pub sums: Vec<f64>,
    /// Where the first component begins.
    pub base: usize,
    /// How far components are apart.
    pub stride: usize,
    /// Whether a bond of the tile was not at rest in the last sweep; else nothing here is of this sweep.
    pub touched: bool,
}

/// Which tiles of a body reach into which, and how far a pass over them has come. A clone is empty.
#[derive(Debug, Default)]
pub struct TileGraph {
    /// Where in `given` the tiles stand whose bonds reach into each, and where in `taken` those into which its own bonds reach.
    ends: Vec<[Range<usize>; 2]>,
    given: Vec<u32>,
    taken: Vec<u32>,
    /// Room for sums that no tile needs at present.
    free: Mutex<Vec<Vec<f64>>>,
    /// How many tiles that reach into each have not been swept yet.
    pub unswept: Vec<AtomicU32>,
    /// How many tiles into which each reaches have not settled yet.
    pub unsettled: Vec<AtomicU32>,
    /// The least time that each has taken to be swept for forces and to settle [ns], where that is measured; else empty.
    pub times: Vec<[AtomicU64; 2]>,
}

impl Clone for TileGraph {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl TileGraph {
    /// That of tiles of which each has these givers, without itself and ascending.
    pub fn of(givers: &[Vec<u32>]) -> Self {
        let mut takers: Vec<Vec<u32>> = (0..givers.len() as u32).map(|k| vec![k]).collect();
        for (taker, givers) in givers.iter().enumerate() {
            givers.iter().for_each(|giver| takers[*giver as usize].push(taker as u32));
        }
        let mut graph = Self::default();
        for (givers, takers) in givers.iter().zip(&takers) {
            let [given, taken] = [graph.given.len(), graph.taken.len()];
            graph.given.extend(givers);
            graph.taken.extend(takers);
            graph.ends.push([given..graph.given.len(), taken..graph.taken.len()]);
        }
        graph.unswept.resize_with(givers.len(), Default::default);
        graph.unsettled.resize_with(givers.len(), Default::default);
        graph
    }

    /// How many tiles there are.
    pub fn tiles(&self) -> usize {
        self.ends.len()
    }

    /// The tiles whose bonds reach into one, without itself, in their order.
    pub fn givers(&self, tile: usize) -> &[u32] {
        &self.given[self.ends[tile][0].clone()]
    }

    /// The tiles into which the bonds of one reach, itself first.
    pub fn takers(&self, tile: usize) -> &[u32] {
        &self.taken[self.ends[tile][1].clone()]
    }

    /// Room for sums: what has been in use last, if there is some.
    pub fn take_room(&self) -> Vec<f64> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default()
    }

    /// Takes room back.
    pub fn give_room(&self, room: Vec<f64>) {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(room);
    }

    /// From now on times are kept.
    pub fn keep_times(&mut self) {
        self.times.resize_with(self.tiles(), || [u64::MAX.into(), u64::MAX.into()]);
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        8 * free.iter().map(Vec::len).sum::<usize>()
            + self.tiles() * (size_of::<[Range<usize>; 2]>() + size_of::<TileWindow>() + 8)
            + 4 * (self.given.len() + self.taken.len())
    }
}

/// All tiles of a body on a lattice, laid out once for all steps. A clone is empty and laid out anew where it is swept.
#[derive(Debug, Default)]
pub struct Tiles {
    /// In an order in which ranges of them are compact.
    pub all: Vec<Tile>,
    /// The planes of their windows.
    pub reached: Vec<Reached>,
    /// Which reach into which.
    pub graph: TileGraph,
    /// Their windows.
    pub windows: Vec<TileWindow>,
}

impl Clone for Tiles {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Tiles {
    /// The planes of a tile's window.
    pub fn reached(&self, tile: usize) -> &[Reached] {
        &self.reached[self.all[tile].reached.clone()]
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        self.graph.bytes() + self.all.len() * size_of::<Tile>() + self.reached.len() * size_of::<Reached>()
    }
}

/// The slabs of a list as tiles. A clone is empty and laid out anew where it is swept.
#[derive(Debug, Default)]
pub struct ListTiles {
    /// The records that the window of each slab covers: from its first one to the one before the first number, then those before the second
    /// one, where bonds lead on to the first slabs.
    pub reached: Vec<[usize; 2]>,
    /// Which reach into which.
    pub graph: TileGraph,
    /// Their windows: four numbers for each record, or one.
    pub windows: Vec<TileWindow>,
}

impl Clone for ListTiles {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl ListTiles {
    /// Memory held.
    pub fn bytes(&self) -> usize {
        self.graph.bytes() + self.reached.len() * size_of::<[usize; 2]>()
    }
}
