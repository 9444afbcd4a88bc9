//! The tiles in which a body on a lattice is swept: blocks of rows and planes, each with forces of its own.

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
    /// Where in `Tiles::givers` the tiles stand whose bonds reach into this one, in their order.
    pub givers: Range<usize>,
    /// Where in `Tiles::takers` the tiles stand into which its own bonds reach, itself among them.
    pub takers: Range<usize>,
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

/// All tiles of a body, laid out once for all steps. A clone is empty and laid out anew where it is swept.
#[derive(Debug, Default)]
pub struct Tiles {
    /// In an order in which ranges of them are compact.
    pub all: Vec<Tile>,
    /// The planes of their windows.
    pub reached: Vec<Reached>,
    /// See [`Tile::givers`].
    pub givers: Vec<u32>,
    /// See [`Tile::takers`].
    pub takers: Vec<u32>,
    /// Their windows.
    pub windows: Vec<TileWindow>,
    /// Room for sums that no tile needs at present.
    pub free: Mutex<Vec<Vec<f64>>>,
    /// How many tiles that reach into each have not been swept yet.
    pub unswept: Vec<AtomicU32>,
    /// How many tiles into which each reaches have not settled yet.
    pub unsettled: Vec<AtomicU32>,
    /// The least time that each has taken to be swept for forces and to settle [ns], where that is measured; else empty.
    pub times: Vec<[AtomicU64; 2]>,
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

    /// The tiles whose bonds reach into one, without itself.
    pub fn givers(&self, tile: usize) -> &[u32] {
        &self.givers[self.all[tile].givers.clone()]
    }

    /// The tiles into which the bonds of one reach, itself among them.
    pub fn takers(&self, tile: usize) -> &[u32] {
        &self.takers[self.all[tile].takers.clone()]
    }

    /// Room for sums: what has been in use last, if there is some.
    pub fn take_room(&self) -> Vec<f64> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default()
    }

    /// Takes room back.
    pub fn give_room(&self, room: Vec<f64>) {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(room);
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        8 * free.iter().map(Vec::len).sum::<usize>()
            + self.all.len() * (size_of::<Tile>() + size_of::<TileWindow>() + 8)
            + self.reached.len() * size_of::<Reached>()
            + 4 * (self.givers.len() + self.takers.len())
    }
}
