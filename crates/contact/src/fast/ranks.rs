//! Lists on several ranks: each rank has the whole lists of its own tiles, and of neighbouring tiles the
//! pairs with its grains.
//!
//! A pair across the border of two ranks is evaluated by both, from the same numbers. A rank's part of
//! another rank's list is in the same order, so that forces on its own grains are summed as on one process,
//! with the same bits. No forces are exchanged.

use super::Fast;
use super::lists::{CONTACT, List};
use perigrain_base::math::lanes::place;
use perigrain_neigh::tiles::Tiles;
use perigrain_world::contacts::{Contacts, mirror};
use std::ops::Range;

/// The part of a tile's list that a rank has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    /// All pairs.
    Whole,
    /// The pairs with its grains.
    Touching,
    /// None.
    Nothing,
}

/// The pairs that a rank lists.
#[derive(Clone, Debug)]
pub struct Own {
    /// Whether each grain belongs to it.
    grains: Vec<bool>,
    /// The part it lists of each tile.
    parts: Vec<Part>,
    /// The rank of each grain, and the rank that has the whole list of its tile.
    ranks: Vec<[u16; 2]>,
}

/// The distribution of grains over ranks.
#[derive(Clone, Copy, Debug)]
pub struct Dealt<'a> {
    /// The rows of each rank, in order.
    pub rows: &'a [Range<usize>],
    /// This rank.
    pub me: usize,
}

impl Own {
    /// The pairs that this rank lists. A tile belongs to the rank of its first grain: tiles may differ from
    /// those that were distributed if contacts reach beyond touching.
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

    /// Whether it lists any pairs of a tile.
    pub(super) fn lists(&self, tile: usize) -> bool {
        self.parts[tile] != Part::Nothing
    }

    /// Whether it lists this pair of a tile that it lists in part.
    pub(super) fn has(&self, tile: usize, i: usize, j: usize) -> bool {
        self.parts[tile] == Part::Whole || self.grains[i] || self.grains[j]
    }
}

impl Fast {
    /// Whether the lists are those of one of several ranks.
    pub fn is_part(&self) -> bool {
        self.own.is_some()
    }

    /// On several ranks, grains in no list are not watched, because their positions are unknown.
    pub(super) fn watch_listed(&mut self) {
        if self.is_part() {
            let is_listed = self.are_listed();
            self.lists.iter_mut().for_each(|list| list.watched.retain(|grain| is_listed[grain as usize]));
        }
    }

    /// The whole lists of this rank, with their numbers.
    pub(super) fn whole_lists(&self) -> impl Iterator<Item = (usize, &List)> {
        let is_whole = |k: usize| self.own.as_ref().is_none_or(|own| own.parts.get(k) == Some(&Part::Whole));
        self.lists.iter().enumerate().filter(move |(k, _)| is_whole(*k))
    }

    /// The histories that each other rank needs of this rank's contacts, if grains with these tags are in
    /// this order now, with this distribution and these lists: each contact goes to the ranks of both its
    /// grains, and to those that have the whole lists of their tiles.
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

    /// Work of the last evaluation in the whole lists of this rank and for its grains, in units of a pair
    /// test.
    pub fn work(&self, grains: usize) -> f64 {
        let lists: usize =
            self.whole_lists().map(|(_, list)| list.short.i.len() + CONTACT * list.touching).sum();
        (lists + CONTACT * grains) as f64
    }

    /// Σ d ⊗ F of the last evaluation for each whole list of this rank, with its number [energy].
    pub fn virials(&self) -> impl Iterator<Item = (u32, [f64; 6])> {
        self.whole_lists().map(|(k, list)| (k as u32, list.virial))
    }
}
