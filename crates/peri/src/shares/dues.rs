//! What tiles of one rank owe to those of another, as messages.

use std::ops::Range;

use crate::families::lattice::{LatticeBody, PAD, staggered};
use crate::families::shares::{BodyShare, Dues, RowLink};
use crate::families::tiles::{Reached, TileWindow, Tiles};
use crate::pass::HandOver;
use perigrain_base::comm;
use perigrain_base::comm::numbers::{put, take};

/// Bytes of a number.
const NUMBER: usize = size_of::<f64>();

/// What of the window of one tile belongs to another, in one plane: first and past the last cell, and where the plane is in the window.
pub(crate) fn overlap<'a>(
    body: &LatticeBody,
    (tiles, giver, taker): (&'a Tiles, usize, usize),
    plane: usize,
) -> Option<([usize; 2], &'a Reached)> {
    let up = plane.checked_sub(tiles.all[giver].planes.start)?;
    let at = tiles.reached(giver).get(up)?;
    let rows = &tiles.all[taker].rows;
    let (low, high) = (at.rows[0].max(rows.start), at.rows[1].min(rows.end));
    if low >= high {
        return None;
    }
    let cells = [low, high].map(|row| body.rows[body.slot(plane, row)].start as usize);
    (cells[0] < cells[1]).then_some((cells, at))
}

/// Windows of a body as messages have them.
pub(crate) trait Owing {
    /// Gives the window of another rank's tile its room.
    fn open(&self, tile: usize, window: &mut TileWindow);

    /// Calls `run` for all numbers that a tile's window, which is open, has for another tile, those beside each other at once.
    fn runs(&self, pair: [usize; 2], window: &TileWindow, run: impl FnMut(Range<usize>));
}

/// Those of a body on a lattice, with so many components.
pub(crate) struct OfLattice<'a> {
    /// The body, without its tiles.
    pub(crate) body: &'a LatticeBody,
    /// Its tiles.
    pub(crate) tiles: &'a Tiles,
    /// Numbers for each cell.
    pub(crate) components: usize,
}

impl Owing for OfLattice<'_> {
    /// The room stays: only what this rank's tiles take is written and read.
    fn open(&self, tile: usize, window: &mut TileWindow) {
        let Some(top) = self.tiles.reached(tile).last() else { return };
        let (base, stride) = (PAD, staggered(top.cells[1] - top.first));
        (window.base, window.stride) = (base, stride);
        if window.sums.len() < base + self.components * stride {
            window.sums.resize(base + self.components * stride, 0.0);
        }
    }

    fn runs(&self, [giver, taker]: [usize; 2], window: &TileWindow, mut run: impl FnMut(Range<usize>)) {
        for plane in self.tiles.all[taker].planes.clone() {
            let Some(([low, high], at)) = overlap(self.body, (self.tiles, giver, taker), plane) else {
                continue;
            };
            for k in 0..self.components {
                let from = window.base + k * window.stride + low - at.first;
                run(from..from + high - low);
            }
        }
    }
}

/// Sends something of each of some dues to its rank, and receives the same of others from theirs.
fn swap(gives: &mut [Dues], takes: &mut [Dues], what: impl for<'a> Fn(&'a mut Dues) -> &'a mut Vec<u8>) {
    let out: Vec<(usize, &[u8])> = gives.iter_mut().map(|d| (d.with, &what(d)[..])).collect();
    let out: Vec<(usize, &[u8])> = out.into_iter().filter(|(_, bytes)| !bytes.is_empty()).collect();
    let into = takes.iter_mut().map(|d| (d.with, &mut what(d)[..]));
    let mut into: Vec<(usize, &mut [u8])> = into.filter(|(_, bytes)| !bytes.is_empty()).collect();
    comm::present().swap(&out, &mut into);
}

/// Calls `pass` with a rank's share of a body's tiles, if there is one, and the way in which their windows are handed over.
pub(crate) fn with_share(
    owing: &impl Owing,
    share: Option<&mut BodyShare>,
    pass: impl FnOnce(Option<HandOver>),
) {
    let Some(BodyShare { mine, waits, gives, takes, .. }) = share else { return pass(None) };
    let mut exchange = |windows: &mut [TileWindow]| hand_over(owing, windows, gives, takes);
    pass(Some(HandOver { own: mine.clone(), waits, exchange: &mut exchange }));
}

/// Hands the windows of this rank's tiles over to the ranks whose tiles they reach, and puts those of others in their places. What is at rest
/// owes nothing: a first message says which tiles owe something.
fn hand_over(owing: &impl Owing, windows: &mut [TileWindow], gives: &mut [Dues], takes: &mut [Dues]) {
    for dues in &mut *gives {
        dues.owes.clear();
        dues.owes.extend(dues.pairs.iter().map(|pair| u8::from(windows[pair[0]].touched)));
    }
    takes.iter_mut().for_each(|dues| dues.owes.resize(dues.pairs.len(), 0));
    swap(gives, takes, |dues| &mut dues.owes);
    for Dues { pairs, owes, bytes, .. } in &mut *gives {
        bytes.clear();
        for (&pair, _) in pairs.iter().zip(owes).filter(|(_, owes)| **owes != 0) {
            let window = &windows[pair[0]];
            owing.runs(pair, window, |run| put(bytes, &window.sums[run]));
        }
    }
    for Dues { pairs, owes, bytes, .. } in &mut *takes {
        let mut length = 0;
        for (&pair, owes) in pairs.iter().zip(owes) {
            let window = &mut windows[pair[0]];
            window.touched = *owes != 0;
            if window.touched {
                owing.open(pair[0], window);
                owing.runs(pair, window, |run| length += NUMBER * run.len());
            }
        }
        bytes.resize(length, 0);
    }
    swap(gives, takes, |dues| &mut dues.bytes);
    for Dues { pairs, owes, bytes, .. } in takes {
        let (mut bytes, mut runs) = (&bytes[..], vec![]);
        for (&pair, _) in pairs.iter().zip(owes).filter(|(_, owes)| **owes != 0) {
            let window = &mut windows[pair[0]];
            owing.runs(pair, window, |run| runs.push(run));
            runs.drain(..).for_each(|run| take(&mut bytes, &mut window.sums[run]));
        }
    }
}

/// Hands the numbers of this rank's sites to the ranks whose bonds lead to them, and takes those of others: row slots by the `places` of their
/// numbers.
pub(crate) fn share_sums(places: impl Fn(usize) -> Range<usize>, links: &mut [RowLink], sums: &mut [f64]) {
    for RowLink { out, into, bytes, .. } in &mut *links {
        let [own, others] = bytes;
        own.clear();
        out.iter().for_each(|slot| put(own, &sums[places(*slot)]));
        others.resize(NUMBER * into.iter().map(|slot| places(*slot).len()).sum::<usize>(), 0);
    }
    let mut out: Vec<(usize, &[u8])> = vec![];
    let mut into: Vec<(usize, &mut [u8])> = vec![];
    for RowLink { with, bytes: [own, others], .. } in &mut *links {
        if !own.is_empty() {
            out.push((*with, own));
        }
        if !others.is_empty() {
            into.push((*with, others));
        }
    }
    comm::present().swap(&out, &mut into);
    for RowLink { into, bytes, .. } in links {
        let mut bytes = &bytes[1][..];
        into.iter().for_each(|slot| take(&mut bytes, &mut sums[places(*slot)]));
    }
}
