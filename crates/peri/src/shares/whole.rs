//! What is up to date on one rank alone (bounds, displacements, dilatations, motion of its tiles' rows), handed to all.

use std::ops::Range;

use crate::families::Families;
use crate::families::lattice::{LatticeBody, PAD, RowMotion};
use crate::law::state::SiteState;
use crate::shares::agreed::slots_of;
use perigrain_base::comm::numbers::{Number, put, take};

/// Numbers on their way into a message or out of one.
pub(super) enum Way<'a> {
    Count(usize),
    Out(&'a mut Vec<u8>),
    In(&'a [u8]),
}

impl Way<'_> {
    /// Counts numbers, sends them on their way or takes them from it.
    pub(super) fn numbers<T: Number>(&mut self, numbers: &mut [T]) {
        match self {
            Way::Count(n) => *n += T::BYTES * numbers.len(),
            Way::Out(bytes) => put(bytes, numbers),
            Way::In(bytes) => take(bytes, numbers),
        }
    }
}

impl Families {
    /// How many bytes are up to date on one rank alone.
    pub fn piece_bytes(&mut self, rank: usize) -> usize {
        let mut way = Way::Count(0);
        self.piece(rank, &mut way);
        if let Way::Count(n) = way { n } else { 0 }
    }

    /// Appends what is up to date on this rank alone.
    pub fn write_piece(&mut self, rank: usize, bytes: &mut Vec<u8>) {
        self.piece(rank, &mut Way::Out(bytes));
    }

    /// Takes in what was up to date on another rank alone.
    pub fn read_piece(&mut self, rank: usize, bytes: &[u8]) {
        self.piece(rank, &mut Way::In(bytes));
    }

    fn piece(&mut self, rank: usize, way: &mut Way) {
        let Self { lattices, list, shares, .. } = self;
        let Some(shares) = shares else { return };
        for (body, share) in lattices.iter_mut().zip(&shares.bodies) {
            for slot in slots_of(body, &share.tiles[rank]) {
                piece_of_row(body, slot, way);
            }
        }
        if let Some(share) = &shares.list {
            list.piece(&share.tiles[rank], way);
        }
    }
}

/// What sweeps and motion leave of one row.
fn piece_of_row(body: &mut LatticeBody, slot: usize, way: &mut Way) {
    let (chunks, cells) = (body.rows[slot].chunks(), body.rows[slot].cells());
    for column in [&mut body.tension, &mut body.compression, &mut body.measure, &mut body.floor] {
        way.numbers(&mut column[chunks.clone()]);
    }
    way.numbers(&mut body.flagged[chunks]);
    for u in &mut body.u {
        for k in 0..3 {
            let first = k * body.stride + PAD;
            way.numbers(&mut u[first + cells.start..first + cells.end]);
        }
    }
    piece_of_sites(&mut body.state, PAD + cells.start..PAD + cells.end, way);
    let RowMotion { lo, hi, least, most } = &mut body.motion[slot];
    way.numbers(std::slice::from_mut(lo));
    way.numbers(std::slice::from_mut(hi));
    way.numbers(least);
    way.numbers(most);
}

/// What sweeps leave of some sites.
pub(super) fn piece_of_sites(state: &mut SiteState, sites: Range<usize>, way: &mut Way) {
    let freed = &mut state.freed;
    let columns = [&mut state.theta, &mut freed.gone, &mut freed.slip, &mut freed.spread, &mut freed.sum];
    let known = columns.into_iter().filter(|column| !column.is_empty());
    known.for_each(|column| way.numbers(&mut column[sites.clone()]));
}
