//! Dealing tiles out to ranks.

use std::ops::Range;

use crate::families::lattice::LatticeBody;
use crate::families::shares::{ALL, BodyShare, Dues, RowLink, Shares, ranges};
use crate::families::tiles::TileGraph;
use crate::families::{Criterion, Families};
use crate::lattice::tiles::lay_tiles;
use crate::list::tiles::lay_slabs;
use crate::shares::list::{followed_slabs, share_of_list};

impl Families {
    /// Deals tiles out to ranks, the same way on each: neighbours in the order of tiles to one rank, as many particles to each as to any
    /// other. `false` where all of them do all work: no body, bonds that remember, correspondence, bonds that break by other things than their stretch.
    pub fn deal(&mut self, me: usize, ranks: usize) -> bool {
        self.shares = None;
        self.scratch.contact.forget_own();
        let together = self.law.kind.memory() == 0 && !self.law.kind.correspondence;
        let plain = together
            && self.options.criterion == Criterion::Stretch
            && !self.options.compress
            && !self.options.reunite;
        self.lattices.iter_mut().for_each(lay_tiles);
        lay_slabs(&mut self.list);
        let tiles = self.lattices.iter().map(|body| body.tiles.all.len()).sum::<usize>() + self.list.slabs();
        if !plain || tiles < ranks || !self.list.parts_are_of_slabs() {
            return false;
        }
        let mut weights: Vec<Vec<usize>> = self.lattices.iter().map(weights).collect();
        weights.push(self.list.slab.windows(2).map(|ends| (ends[1] - ends[0]) as usize).collect());
        let all: usize = weights.iter().flatten().sum();
        let mut before = 0;
        let mut deal = |weights: &Vec<usize>| -> Vec<Range<usize>> {
            let mut rank_of = vec![];
            for weight in weights {
                rank_of.push(((2 * before + weight) * ranks / (2 * all).max(1)).min(ranks - 1));
                before += weight;
            }
            let end = |rank: usize| rank_of.partition_point(|r| *r < rank);
            (0..ranks).map(|rank| end(rank)..end(rank + 1)).collect()
        };
        let mut owner = vec![ALL; self.place.len()];
        let mut own = |particles: &[u32], rank: usize| {
            particles.iter().for_each(|p| {
                if let Some(owner) = owner.get_mut(*p as usize) {
                    *owner = rank as u16;
                }
            });
        };
        let mut bodies = vec![];
        for (body, weights) in self.lattices.iter().zip(&weights) {
            let tiles = deal(weights);
            for (rank, tiles) in tiles.iter().enumerate() {
                let cells = tiles.clone().flat_map(|tile| cells_of(body, tile));
                cells.for_each(|cells| own(&body.particle[cells], rank));
            }
            bodies.push(share_of(body, me, tiles));
        }
        let slabs = deal(&weights[self.lattices.len()]);
        for (rank, slabs) in slabs.iter().enumerate() {
            slabs.clone().for_each(|slab| own(&self.list.particle[self.list.records(slab)], rank));
        }
        let list = (self.list.slabs() > 0).then(|| share_of_list(&self.list, me, slabs));
        let mut shares = Shares { me, ranks, bodies, list, owner, own: vec![], sent: 0 };
        shares.own = ranges((0..shares.owner.len()).filter(|p| shares.moves(*p)));
        self.shares = Some(shares);
        true
    }

    /// Takes the deal back.
    pub fn undeal(&mut self) {
        self.shares = None;
    }

    /// Which particles all ranks need that lists name: by the rank that needs them and the one that has them, ascending.
    pub fn needed_by_lists(&self, listed: impl Iterator<Item = u32>) -> Vec<Vec<Vec<u32>>> {
        let Some(shares) = &self.shares else { return vec![] };
        let mut needs = vec![vec![vec![]; shares.ranks]; shares.ranks];
        for p in listed {
            let owner = shares.owner[p as usize];
            if owner != ALL {
                needs.iter_mut().for_each(|needs| needs[usize::from(owner)].push(p));
            }
        }
        in_order(needs)
    }

    /// Which particles' places each rank needs of each other one for bodies and pairs near each other, in the same form.
    pub fn needed(&self) -> Vec<Vec<Vec<u32>>> {
        let Some(shares) = &self.shares else { return vec![] };
        let ranks = shares.ranks;
        let mut needs = vec![vec![vec![]; ranks]; ranks];
        for (rank, needs) in needs.iter_mut().enumerate() {
            let mut follow = |particles: &[u32]| {
                for &p in particles {
                    if let Some(&owner) = shares.owner.get(p as usize) {
                        needs[usize::from(owner)].push(p);
                    }
                }
            };
            for (body, share) in self.lattices.iter().zip(&shares.bodies) {
                let slots = followed(body, &share.tiles[rank]).into_iter().enumerate();
                let slots = slots.filter(|(_, follows)| *follows);
                slots.for_each(|(slot, _)| follow(&body.particle[body.rows[slot].cells()]));
            }
            if let Some(share) = &shares.list {
                let slabs = followed_slabs(&self.list, &share.tiles[rank]).into_iter();
                slabs.for_each(|slab| follow(&self.list.particle[self.list.records(slab)]));
            }
        }
        for pair in self.near.pairs.iter().flatten() {
            let [a, b] = pair.ends.map(|p| shares.owner[p as usize]);
            for (of, needed, p) in [(a, b, pair.ends[1]), (b, a, pair.ends[0])] {
                if needed == ALL || of == needed {
                    continue;
                }
                let by = if of == ALL { 0..ranks } else { usize::from(of)..usize::from(of) + 1 };
                by.for_each(|rank| needs[rank][usize::from(needed)].push(p));
            }
        }
        in_order(needs)
    }
}

/// Without what ranks need of themselves, each particle once, ascending.
fn in_order(mut needs: Vec<Vec<Vec<u32>>>) -> Vec<Vec<Vec<u32>>> {
    for (rank, needs) in needs.iter_mut().enumerate() {
        needs[rank].clear();
        for list in needs {
            list.sort_unstable();
            list.dedup();
        }
    }
    needs
}

/// Particles of each tile.
fn weights(body: &LatticeBody) -> Vec<usize> {
    let taken = |cells: Range<usize>| body.particle[cells].iter().filter(|p| **p != u32::MAX).count();
    (0..body.tiles.all.len()).map(|tile| cells_of(body, tile).map(taken).sum()).collect()
}

/// The cells of a tile, plane by plane.
fn cells_of(body: &LatticeBody, tile: usize) -> impl Iterator<Item = Range<usize>> {
    let tile = &body.tiles.all[tile];
    tile.planes.clone().map(|plane| {
        let start = |row: usize| body.rows[body.slot(plane, row)].start as usize;
        start(tile.rows.start)..start(tile.rows.end)
    })
}

/// The row slots that sweeps of some tiles look at: theirs, those that their bonds reach, and those that bonds of these reach: whether a bond
/// breaks depends on the families of both its ends.
fn followed(body: &LatticeBody, tiles: &Range<usize>) -> Vec<bool> {
    let mut follows = vec![false; body.rows.len()];
    let (across, up) = (2 * body.reach[1] as usize, 2 * body.reach[2] as usize);
    for tile in &body.tiles.all[tiles.clone()] {
        let planes = tile.planes.start.saturating_sub(up)..(tile.planes.end + up).min(body.planes);
        let rows = tile.rows.start.saturating_sub(across)..(tile.rows.end + across).min(body.width);
        for plane in planes {
            follows[body.slot(plane, rows.start)..body.slot(plane, rows.end)].fill(true);
        }
    }
    follows
}

/// The row slots of some tiles.
fn rows_of(body: &LatticeBody, tiles: &Range<usize>) -> Vec<bool> {
    let mut own = vec![false; body.rows.len()];
    for tile in &body.tiles.all[tiles.clone()] {
        for plane in tile.planes.clone() {
            own[body.slot(plane, tile.rows.start)..body.slot(plane, tile.rows.end)].fill(true);
        }
    }
    own
}

/// The row slots that bonds of some tiles lead to.
fn reached(body: &LatticeBody, tiles: &Range<usize>) -> Vec<bool> {
    let mut reached = vec![false; body.rows.len()];
    for tile in tiles.clone() {
        for (plane, at) in (body.tiles.all[tile].planes.start..).zip(body.tiles.reached(tile)) {
            reached[body.slot(plane, at.rows[0])..body.slot(plane, at.rows[1])].fill(true);
        }
    }
    reached
}

/// Rows whose sums one rank exchanges with each other one.
fn row_links(body: &LatticeBody, me: usize, tiles: &[Range<usize>]) -> Vec<RowLink> {
    let both = |a: &[bool], b: &[bool]| -> Vec<usize> {
        a.iter().zip(b).enumerate().filter(|(_, (a, b))| **a && **b).map(|(slot, _)| slot).collect()
    };
    let (own, needs) = (rows_of(body, &tiles[me]), reached(body, &tiles[me]));
    let others = (0..tiles.len()).filter(|with| *with != me);
    let links = others.map(|with| RowLink {
        with,
        out: both(&reached(body, &tiles[with]), &own),
        into: both(&needs, &rows_of(body, &tiles[with])),
        bytes: Default::default(),
    });
    links.filter(|link| !link.out.is_empty() || !link.into.is_empty()).collect()
}

fn share_of(body: &LatticeBody, me: usize, tiles: Vec<Range<usize>>) -> BodyShare {
    let own = rows_of(body, &tiles[me]);
    let (gives, takes, waits) = dues_of(&body.tiles.graph, me, &tiles);
    let (mine, follows) = (tiles[me].clone(), followed(body, &tiles[me]));
    let rows = row_links(body, me, &tiles);
    BodyShare { mine, follows, own, gives, takes, waits, rows, tiles }
}

/// What tiles of a rank give to those of others and take from them, and those that take.
pub(super) fn dues_of(
    graph: &TileGraph,
    me: usize,
    tiles: &[Range<usize>],
) -> (Vec<Dues>, Vec<Dues>, Vec<usize>) {
    let pairs = |from: &Range<usize>, to: &Range<usize>| {
        let takers = |giver: usize| graph.takers(giver).iter().map(move |taker| [giver, *taker as usize]);
        from.clone().flat_map(takers).filter(|[_, taker]| to.contains(taker)).collect::<Vec<_>>()
    };
    let others = || (0..tiles.len()).filter(|with| *with != me);
    let dues = |with: usize, pairs: Vec<[usize; 2]>| Dues { with, pairs, ..Dues::default() };
    let gives = others().map(|r| dues(r, pairs(&tiles[me], &tiles[r]))).filter(|d| !d.pairs.is_empty());
    let takes = others().map(|r| dues(r, pairs(&tiles[r], &tiles[me]))).filter(|d| !d.pairs.is_empty());
    let (gives, takes): (Vec<_>, Vec<_>) = (gives.collect(), takes.collect());
    let mut waits: Vec<usize> = takes.iter().flat_map(|d| &d.pairs).map(|pair| pair[1]).collect();
    waits.sort_unstable();
    waits.dedup();
    (gives, takes, waits)
}
