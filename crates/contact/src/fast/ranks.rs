//! Lists on several ranks: each rank has the whole lists of its own tiles, and of those beside them the pairs that touch its grains.
//!
//! A pair that crosses the border of two ranks is evaluated by both, from the same numbers. What a rank lists of a tile of another one is
//! a part of its list in the same order, so that forces on its own grains are added in the order of one process, and have its bits. No
//! forces are handed over.

use super::Fast;
use super::lists::{CONTACT, List};
use perigrain_base::math::lanes::place;
use perigrain_neigh::tiles::Tiles;
use perigrain_world::contacts::{Contacts, mirror};
use std::ops::Range;

/// What of its list a rank has of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// All.
    Whole,
    /// The pairs that touch its grains.
    Touching,
    /// Nothing.
    Nothing,
}

/// Which pairs a rank lists.
#[derive(Clone, Debug)]
pub struct Own {
    /// Whether each grain is its own.
    grains: Vec<bool>,
    /// What it has of each tile.
    parts: Vec<Part>,
    /// The rank of each grain, and the one that has the whole list of its tile.
    ranks: Vec<[u16; 2]>,
}

/// How grains are shared out to ranks.
#[derive(Clone, Copy, Debug)]
pub struct Dealt<'a> {
    /// The rows of each rank, one behind the other.
    pub rows: &'a [Range<usize>],
    /// This rank.
    pub me: usize,
}

impl Own {
    /// What this rank lists. A tile is that of the rank that has its first grain: tiles may be others than those that were dealt, where
    /// contacts reach beyond touch.
    pub(super) fn new(dealt: Dealt, tiles: &Tiles) -> Self {
        let owner = |row: u32| dealt.rows.partition_point(|rows| rows.end <= row as usize) as u16;
        let mut ranks = vec![[0; 2]; tiles.order.len()];
        let (mut of_tiles, mut has_some) = (vec![], vec![]);
        for tile in 0..tiles.count() {
            let members = &tiles.order[tiles.members(tile)];
            let first = members.first().map(|row| owner(*row));
            for row in members {
                ranks[*row as usize] = [owner(*row), first.unwrap_or_default()];
            }
            has_some.push(members.iter().any(|row| usize::from(ranks[*row as usize][0]) == dealt.me));
            of_tiles.push(first.map(usize::from));
        }
        let part = |tile: usize| match of_tiles[tile] == Some(dealt.me) {
            true => Part::Whole,
            false if has_some[tile] || tiles.beside(tile).iter().any(|k| has_some[*k as usize]) => {
                Part::Touching
            }
            false => Part::Nothing,
        };
        let parts = (0..tiles.count()).map(part).collect();
        let mut grains = vec![false; tiles.order.len()];
        grains[dealt.rows[dealt.me].clone()].fill(true);
        Self { grains, parts, ranks }
    }

    /// Whether it lists anything of a tile.
    pub(super) fn lists(&self, tile: usize) -> bool {
        self.parts[tile] != Part::Nothing
    }

    /// Whether it lists this pair of a tile of which it lists something.
    pub(super) fn has(&self, tile: usize, i: usize, j: usize) -> bool {
        self.parts[tile] == Part::Whole || self.grains[i] || self.grains[j]
    }
}

impl Fast {
    /// Whether lists are those of one of several ranks.
    pub fn is_part(&self) -> bool {
        self.own.is_some()
    }

    /// Grains that no list names are not watched on several ranks: where they are is not known.
    pub(super) fn watch_listed(&mut self) {
        if self.is_part() {
            let is_listed = self.are_listed();
            self.lists.iter_mut().for_each(|list| list.watched.retain(|grain| is_listed[grain as usize]));
        }
    }

    /// The lists that this rank has as a whole, with their numbers.
    pub(super) fn whole_lists(&self) -> impl Iterator<Item = (usize, &List)> {
        let is_whole = |k: usize| self.own.as_ref().is_none_or(|own| own.parts.get(k) == Some(&Part::Whole));
        self.lists.iter().enumerate().filter(move |(k, _)| is_whole(*k))
    }

    /// What each other rank is to remember of the contacts of this one, where grains of these ids stand in this order now, are dealt so, and
    /// are listed so: each contact goes to the ranks of both its grains, and to those that have the whole lists of their tiles.
    pub fn handed_over(&self, tag: &[u32], dealt: Dealt, own: &Own) -> Vec<Contacts> {
        let (places, width) = (super::memory::Places::new(tag), self.width);
        let mut out = vec![Contacts { width: self.laws.memory(), ..Contacts::default() }; dealt.rows.len()];
        for (_, list) in self.whole_lists() {
            let rows = list.short.history.chunks_exact(width);
            for ((i, w), row) in list.short.i.iter().zip(&list.short.w).zip(rows) {
                if row[width - 1] != self.now {
                    continue;
                }
                let [a, b] = [self.tag[*i as usize], self.tag[place(*w)]];
                let Some((p, q)) = places.of(a).zip(places.of(b)) else { continue };
                let [[a0, a1], [b0, b1]] = [p, q].map(|row| own.ranks[row as usize]);
                let mut takers = [a0, a1, b0, b1].map(usize::from);
                takers.sort_unstable();
                for (k, &rank) in takers.iter().enumerate() {
                    if rank == dealt.me || (k > 0 && takers[k - 1] == rank) {
                        continue;
                    }
                    let to = &mut out[rank];
                    to.keys.push([a.min(b), a.max(b)]);
                    let from = to.history.len();
                    to.history.extend_from_slice(&row[..to.width]);
                    if a > b {
                        mirror(&mut to.history[from..]);
                    }
                }
            }
        }
        out
    }

    /// How much work the last evaluation was, of the lists that this rank has as a whole, and its grains are: in units of the test of a pair.
    pub fn work(&self, grains: usize) -> f64 {
        let lists: usize =
            self.whole_lists().map(|(_, list)| list.short.i.len() + CONTACT * list.touching).sum();
        (lists + CONTACT * grains) as f64
    }

    /// Σ d ⊗ F of the last evaluation: of each list that this rank has as a whole, with its number [energy].
    pub fn virials(&self) -> impl Iterator<Item = (u32, [f64; 6])> {
        self.whole_lists().map(|(k, list)| (k as u32, list.virial))
    }
}
