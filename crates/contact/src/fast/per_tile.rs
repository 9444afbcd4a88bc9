//! Contacts tile by tile on one thread: grains whose contacts are complete can be moved while they are in
//! cache.
//!
//! Columns of 32,000 grains exceed the second-level cache. If all grains are moved after all contacts, they
//! are loaded from the third level twice in a step, where a pass over the columns takes twice as long.

use super::{Fast, Sums};
use crate::Advance;
use crate::driver::Grains;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;
use std::ops::Range;

/// Tiles with about this many grains are evaluated together: the overhead per evaluation and its incomplete
/// last groups are then small, and everything fits the second-level cache.
const TOGETHER: usize = 512;

/// An evaluation of all contacts in progress.
pub struct PerTile {
    /// Number of tiles done.
    done: usize,
    step: Advance,
    store: bool,
    deep: Option<([u32; 2], f64)>,
}

/// Buffers for the next evaluation tile by tile.
#[derive(Clone, Debug, Default)]
pub(super) struct Waiting {
    /// Per tile, the number of pending tiles that add to it, itself included.
    to_come: Vec<u32>,
    /// Tiles that became complete in the last part.
    ready: Vec<usize>,
}

impl Fast {
    /// Whether an evaluation can run tile by tile: not with several threads, nor if the grains of a tile are
    /// not contiguous. For few grains there is no gain, and contacts of several lists are faster together.
    pub fn is_per_tile(&self) -> bool {
        par::threads() == 1 && self.len() > par::CHUNK && self.in_order && self.large() == 0 && !self.timed
    }

    /// Begins an evaluation like [`Fast::run`] without virial, with the same bits, for [`Fast::advance`].
    pub fn begin_per_tile(&mut self, grains: &Grains, step: Advance, store: bool) -> PerTile {
        self.begin(grains);
        let to_come = &mut self.waiting.to_come;
        to_come.clear();
        to_come.extend(self.beside.iter().map(|beside| 1 + beside.len() as u32));
        PerTile { done: 0, step, store, deep: None }
    }

    /// Adds forces and torques of the contacts of some more tiles to `f` and `torque`; returns whether there
    /// were any. [`Fast::ready`] then gives the grains whose sums are complete.
    pub fn advance(&mut self, p: &mut PerTile, grains: &Grains, wrench: [&mut [Vec3]; 2]) -> bool {
        let some = self.some_from(p.done);
        if some.is_empty() {
            self.now += if p.store { 1.0 } else { 0.0 };
            self.deep = self.deep.or(p.deep);
            return false;
        }
        p.done = some.end;
        let [force, torque] = wrench;
        let sums = Sums { force, torque, heat: None, deeds: None };
        self.sweep(grains, sums, p.step, (p.store, false), Some(some.clone()));
        let tiles = &self.order[some];
        // Contacts of several lists are evaluated together: a list may report overlaps of another one.
        if self.deep.is_none() && tiles.iter().any(|tile| self.lists[*tile].deep) {
            let found = tiles.iter().filter_map(|tile| self.find_deep(grains, &self.lists[*tile..tile + 1]));
            p.deep = p.deep.into_iter().chain(found).min_by_key(|(ids, _)| *ids);
        }
        let Waiting { to_come, ready } = &mut self.waiting;
        ready.clear();
        for tile in tiles {
            for taker in self.beside[*tile].iter().map(|taker| *taker as usize).chain([*tile]) {
                to_come[taker] -= 1;
                if to_come[taker] == 0 {
                    ready.push(taker);
                }
            }
        }
        true
    }

    /// The next tiles, as a range in the order of a single thread.
    fn some_from(&self, done: usize) -> Range<usize> {
        let (mut end, mut grains) = (done, 0);
        while let Some(tile) = self.order.get(end).filter(|_| grains < TOGETHER) {
            grains += self.members[*tile].len();
            end += 1;
        }
        done..end
    }

    /// The grains of this part whose sums have become complete since the last [`Fast::advance`].
    pub fn ready(&self, part: usize) -> Option<Range<usize>> {
        self.waiting.ready.get(part).map(|tile| self.members[*tile].clone())
    }
}
