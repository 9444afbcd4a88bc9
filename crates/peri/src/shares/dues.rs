//! What tiles of one rank owe to those of another, as messages.

use std::ops::Range;

use crate::families::lattice::{LatticeBody, PAD, staggered};
use crate::families::shares::{Dues, RowLink};
use crate::families::tiles::{Reached, TileWindow, Tiles};
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

/// All that one tile's window has for another tile: cells, and where they begin in the window, counted from its base.
fn parts<'a>(
    body: &'a LatticeBody,
    tiles: &'a Tiles,
    [giver, taker]: [usize; 2],
) -> impl Iterator<Item = (Range<usize>, usize)> + use<'a> {
    let planes = tiles.all[taker].planes.clone();
    let found = planes.filter_map(move |plane| overlap(body, (tiles, giver, taker), plane));
    found.map(|([low, high], at)| (low..high, low - at.first))
}

/// How long a message is: the numbers of pairs of tiles of which the first one owes something.
fn length(body: &LatticeBody, tiles: &Tiles, dues: &Dues, components: usize) -> usize {
    let cells = |pair: &[usize; 2]| parts(body, tiles, *pair).map(|(cells, _)| cells.len()).sum::<usize>();
    let owing = dues.pairs.iter().zip(&dues.owes).filter(|(_, owes)| **owes != 0);
    owing.map(|(pair, _)| NUMBER * components * cells(pair)).sum()
}

/// Sends something of each of some dues to its rank, and receives the same of others from theirs.
fn swap(gives: &mut [Dues], takes: &mut [Dues], what: impl for<'a> Fn(&'a mut Dues) -> &'a mut Vec<u8>) {
    let out: Vec<(usize, &[u8])> = gives.iter_mut().map(|d| (d.with, &what(d)[..])).collect();
    let out: Vec<(usize, &[u8])> = out.into_iter().filter(|(_, bytes)| !bytes.is_empty()).collect();
    let into = takes.iter_mut().map(|d| (d.with, &mut what(d)[..]));
    let mut into: Vec<(usize, &mut [u8])> = into.filter(|(_, bytes)| !bytes.is_empty()).collect();
    comm::present().swap(&out, &mut into);
}

/// Hands the windows of this rank's tiles over to the ranks whose tiles they reach, and puts those of others in their places. What is at rest
/// owes nothing: a first message says which tiles owe something.
pub(crate) fn hand_over(
    body: &LatticeBody,
    tiles: &Tiles,
    windows: &mut [TileWindow],
    (gives, takes): (&mut [Dues], &mut [Dues]),
    components: usize,
) {
    for dues in &mut *gives {
        dues.owes.clear();
        dues.owes.extend(dues.pairs.iter().map(|pair| u8::from(windows[pair[0]].touched)));
    }
    takes.iter_mut().for_each(|dues| dues.owes.resize(dues.pairs.len(), 0));
    swap(gives, takes, |dues| &mut dues.owes);
    for dues in &mut *takes {
        let length = length(body, tiles, dues, components);
        dues.bytes.resize(length, 0);
    }
    for Dues { pairs, owes, bytes, .. } in &mut *gives {
        bytes.clear();
        for (&pair, _) in pairs.iter().zip(owes).filter(|(_, owes)| **owes != 0) {
            let window = &windows[pair[0]];
            for (cells, from) in parts(body, tiles, pair) {
                for k in 0..components {
                    let from = window.base + k * window.stride + from;
                    put(bytes, &window.sums[from..from + cells.len()]);
                }
            }
        }
    }
    swap(gives, takes, |dues| &mut dues.bytes);
    for Dues { pairs, owes, bytes, .. } in takes {
        let mut bytes = &bytes[..];
        for (&pair, owes) in pairs.iter().zip(owes) {
            let window = &mut windows[pair[0]];
            window.touched = *owes != 0;
            if !window.touched {
                continue;
            }
            open(window, tiles.reached(pair[0]), components);
            for (cells, from) in parts(body, tiles, pair) {
                for k in 0..components {
                    let from = window.base + k * window.stride + from;
                    take(&mut bytes, &mut window.sums[from..from + cells.len()]);
                }
            }
        }
    }
}

/// Gives the window of another rank's tile its room, which stays: only what this rank's tiles take is written and read.
fn open(window: &mut TileWindow, reached: &[Reached], components: usize) {
    let Some(top) = reached.last() else { return };
    let (base, stride) = (PAD, staggered(top.cells[1] - top.first));
    (window.base, window.stride) = (base, stride);
    if window.sums.len() < base + components * stride {
        window.sums.resize(base + components * stride, 0.0);
    }
}

/// Hands the sums of this rank's sites to the ranks whose bonds lead to them, and takes those of others; columns of sites have [`PAD`]
/// entries before the first.
pub(crate) fn share_sums(body: &LatticeBody, links: &mut [RowLink], sums: &mut [f64]) {
    let cells = |slots: &[usize]| slots.iter().map(|slot| body.rows[*slot].len as usize).sum::<usize>();
    for RowLink { out, into, bytes, .. } in &mut *links {
        let [own, others] = bytes;
        own.clear();
        for slot in &*out {
            let cells = body.rows[*slot].cells();
            put(own, &sums[PAD + cells.start..PAD + cells.end]);
        }
        others.resize(NUMBER * cells(into), 0);
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
        for cells in into.iter().map(|slot| body.rows[*slot].cells()) {
            take(&mut bytes, &mut sums[PAD + cells.start..PAD + cells.end]);
        }
    }
}
