//! Contacts tile by tile on one thread: grains that no later list touches can be moved while they are in fast memory.
//!
//! Columns of 32,000 grains do not fit the second cache. If all are moved after all contacts they are brought from the third one
//! twice in a step, and a pass over the columns takes twice as long from there.

use super::{Fast, Sums};
use crate::Advance;
use crate::driver::Grains;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;
use std::ops::Range;

/// Tiles of so many grains are evaluated together: what is set up for each evaluation, and contacts too few for a whole group at its end,
/// are then few beside it, and all of it stays in the second cache.
const TOGETHER: usize = 512;

/// An evaluation of all contacts that is under way.
pub struct PerTile {
    /// How many tiles have had their turn.
    done: usize,
    step: Advance,
    store: bool,
    deep: Option<([u32; 2], f64)>,
}

/// Room for the next evaluation tile by tile.
#[derive(Clone, Debug, Default)]
pub(super) struct Waiting {
    /// How many tiles that add something to each, itself among them, are still to come.
    to_come: Vec<u32>,
    /// The tiles that wait for none since the last step.
    ready: Vec<usize>,
}

impl Fast {
    /// Whether an evaluation can go tile by tile: not where several threads share the tiles, or grains of a tile do not stand beside
    /// each other. Those of a chunk are moved together anyway, and contacts of several lists go faster together.
    pub fn is_per_tile(&self) -> bool {
        par::threads() == 1 && self.len() > par::CHUNK && self.in_order && self.large() == 0 && !self.timed
    }

    /// Begins an evaluation as [`Fast::run`] does it without the virial, and with the same bits, for [`Fast::go_on`].
    pub fn begin_per_tile(&mut self, grains: &Grains, step: Advance, store: bool) -> PerTile {
        self.begin(grains);
        let to_come = &mut self.waiting.to_come;
        to_come.clear();
        to_come.extend(self.beside.iter().map(|beside| 1 + beside.len() as u32));
        PerTile { done: 0, step, store, deep: None }
    }

    /// Adds forces and torques of some tiles' contacts more to `f` and `torque`: whether there were any. [`Fast::ready`] then says which
    /// grains have all of theirs now.
    pub fn go_on(&mut self, p: &mut PerTile, grains: &Grains, wrench: [&mut [Vec3]; 2]) -> bool {
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
        // Contacts of several lists are evaluated together: a list may say of another's that they are too deep.
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

    /// The tiles that come next, by where they stand in the order of one thread.
    fn some_from(&self, done: usize) -> Range<usize> {
        let (mut end, mut grains) = (done, 0);
        while let Some(tile) = self.order.get(end).filter(|_| grains < TOGETHER) {
            grains += self.members[*tile].len();
            end += 1;
        }
        done..end
    }

    /// Which grains have all forces and torques since the last [`Fast::go_on`], in this part of its tiles.
    pub fn ready(&self, part: usize) -> Option<Range<usize>> {
        self.waiting.ready.get(part).map(|tile| self.members[*tile].clone())
    }
}
