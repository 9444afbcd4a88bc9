//! Dealing tiles out to ranks.

use std::ops::Range;

use crate::families::lattice::LatticeBody;
use crate::families::shares::{ALL, BodyShare, Dues, RowLink, Shares, ranges};
use crate::families::{Families, LawKind};
use crate::lattice::tiles::lay_tiles;

impl Families {
    /// Deals tiles out to ranks, the same way on each: neighbours in the order of tiles to one rank, as many particles to each as to any
    /// other. `false` where all of them do all work: no body on a lattice, bonds that remember.
    pub fn deal(&mut self, me: usize, ranks: usize) -> bool {
        self.shares = None;
        self.scratch.contact.forget_own();
        let kind = self.law.kind;
        let forgets = kind.memory() == 0 && (kind.bond_based() || kind == LawKind::Lps);
        let plain = forgets && !self.options.compress && !self.options.reunite;
        let tiles: usize = self
            .lattices
            .iter_mut()
            .map(|body| {
                lay_tiles(body);
                body.tiles.all.len()
            })
            .sum();
        if !plain || tiles < ranks {
            return false;
        }
        let weights: Vec<Vec<usize>> = self.lattices.iter().map(weights).collect();
        let all: usize = weights.iter().flatten().sum();
        let (mut before, mut owner) = (0, vec![ALL; self.place.len()]);
        let mut bodies = vec![];
        for (body, weights) in self.lattices.iter_mut().zip(&weights) {
            let mut rank_of = vec![];
            for weight in weights {
                rank_of.push(((2 * before + weight) * ranks / (2 * all).max(1)).min(ranks - 1));
                before += weight;
            }
            let of =
                |rank: usize| rank_of.partition_point(|r| *r < rank)..rank_of.partition_point(|r| *r <= rank);
            let share = share_of(body, me, (0..ranks).map(of).collect());
            for (tile, rank) in rank_of.iter().enumerate() {
                cells_of(body, tile).flatten().for_each(|cell| {
                    if let Some(owner) = owner.get_mut(body.particle[cell] as usize) {
                        *owner = *rank as u16;
                    }
                });
            }
            bodies.push(share);
        }
        let mut shares = Shares { me, ranks, bodies, owner, own: vec![], sent: 0 };
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
        for (body, share) in self.lattices.iter().zip(&shares.bodies) {
            for (rank, needs) in needs.iter_mut().enumerate() {
                let slots = followed(body, &share.tiles[rank]).into_iter().enumerate();
                for slot in slots.filter(|(_, follows)| *follows).map(|(slot, _)| slot) {
                    for &p in &body.particle[body.rows[slot].cells()] {
                        if let Some(&owner) = shares.owner.get(p as usize) {
                            needs[usize::from(owner)].push(p);
                        }
                    }
                }
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
    let pairs = |from: &Range<usize>, to: &Range<usize>| {
        let takers =
            |giver: usize| body.tiles.graph.takers(giver).iter().map(move |taker| [giver, *taker as usize]);
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
    let (mine, follows) = (tiles[me].clone(), followed(body, &tiles[me]));
    let rows = row_links(body, me, &tiles);
    BodyShare { mine, follows, own, gives, takes, waits, rows, tiles }
}
