//! Rigid bodies on ranks: a rank updates the bodies of which it moves a particle; all ranks have all bodies where these are
//! needed.

use super::{Halo, NUMBER, Share, What};
use crate::{Named, Numbers, World};
use perigrain_base::comm::numbers::{put, take};
use std::ops::Range;

/// How the rigid bodies of a fix are dealt out, which the memo keeps in rows of numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct Parted {
    /// Numbers of a row.
    width: usize,
    /// The rank that hands each row out to all: that of the body's first particle.
    giver: Vec<u16>,
    /// The bodies of which this rank moves a particle, ascending.
    own: Vec<u32>,
}

/// The rigid bodies of a fix: where the memo keeps them, in rows of how many numbers, and their particles, ascending: those of body `k`
/// from place `first[k]` to `first[k + 1]`.
#[derive(Clone, Copy, Debug)]
pub struct RigidBodies<'a> {
    /// Where.
    pub key: Numbers,
    /// Numbers of a row.
    pub width: usize,
    /// Where the particles of each body begin.
    pub first: &'a [usize],
    /// Particles, body by body.
    pub members: &'a [usize],
}

impl RigidBodies<'_> {
    /// The particles of body `k`.
    fn members(&self, k: usize) -> &[usize] {
        &self.members[self.first[k]..self.first[k + 1]]
    }

    /// The bodies that have a particle of these rows, ascending.
    fn within(&self, own: &[Range<usize>]) -> Vec<u32> {
        let is_own = |i: &usize| own.iter().any(|rows| rows.contains(i));
        (0..self.count()).filter(|k| self.members(*k as usize).iter().any(is_own)).collect()
    }

    fn count(&self) -> u32 {
        self.first.len().saturating_sub(1) as u32
    }

    /// The rank of each body's first particle, where ranks have these rows, one behind the other.
    fn givers(&self, ranks: &[Range<usize>]) -> Vec<u16> {
        let first = |k: u32| self.members(k as usize).first().copied().unwrap_or(0);
        let rank = |row: usize| ranks.partition_point(|rows| rows.end <= row).min(ranks.len() - 1);
        (0..self.count()).map(|k| rank(first(k)) as u16).collect()
    }
}

impl World {
    /// Deals out the rigid bodies of a fix, where grains are dealt out: those of which this rank moves a particle, ascending. What
    /// [`Halo::Members`] names are their particles from now on; lists of particles of another version are others. Beside peridynamic bodies
    /// all ranks move all of them.
    pub fn deal_bodies(&mut self, bodies: &RigidBodies, version: u64) -> Vec<u32> {
        let Some(share) = &mut self.share else { return vec![] };
        if share.what == What::Bodies {
            return (0..bodies.count()).collect();
        }
        let own = bodies.within(&share.own);
        let giver = bodies.givers(&share.rows_of_ranks());
        let parted = Parted { width: bodies.width, giver, own: own.clone() };
        share.bodies.insert(bodies.key.of(), parted);
        self.name_rows(Halo::Members, (bodies.key.of(), version), || {
            own.iter().flat_map(|k| bodies.members(*k as usize)).map(|i| *i as u32).collect()
        });
        own
    }
}

impl Share {
    /// Bytes of the rows that a rank hands out to all.
    pub(super) fn body_bytes(&self, rank: usize) -> usize {
        let of = |parted: &Parted| NUMBER * parted.width * parted.given_by(rank).count();
        self.bodies.values().map(of).sum()
    }

    /// Appends them.
    pub(super) fn write_bodies(&self, memo: &Named<Vec<f64>>, rank: usize, bytes: &mut Vec<u8>) {
        for (key, parted) in self.bodies.iter() {
            let rows = memo.get(key.of()).map_or(&[][..], Vec::as_slice);
            parted.given_by(rank).for_each(|k| put(bytes, &rows[parted.width * k..][..parted.width]));
        }
    }

    /// Takes in those of another rank; what is left of the bytes.
    pub(super) fn read_bodies<'a>(
        &self,
        memo: &mut Named<Vec<f64>>,
        rank: usize,
        mut bytes: &'a [u8],
    ) -> &'a [u8] {
        for (key, parted) in self.bodies.iter() {
            let Some(rows) = memo.get_mut(key.of()) else { continue };
            parted
                .given_by(rank)
                .for_each(|k| take(&mut bytes, &mut rows[parted.width * k..][..parted.width]));
        }
        bytes
    }

    /// Makes the bodies of other ranks alone such that whatever reads them is found out.
    #[cfg(debug_assertions)]
    pub(super) fn spoil_bodies(&self, memo: &mut Named<Vec<f64>>) {
        for (key, parted) in self.bodies.iter() {
            let Some(rows) = memo.get_mut(key.of()) else { continue };
            for (k, row) in rows.chunks_exact_mut(parted.width).enumerate().take(parted.giver.len()) {
                if parted.own.binary_search(&(k as u32)).is_err() {
                    row.fill(f64::NAN);
                }
            }
        }
    }
}

impl Parted {
    /// The rows that a rank hands out.
    fn given_by(&self, rank: usize) -> impl Iterator<Item = usize> {
        let given = self.giver.iter().enumerate().filter(move |(_, giver)| usize::from(**giver) == rank);
        given.map(|(k, _)| k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Key;
    use crate::field::{F, RIGID};
    use crate::share::Tiling;
    use perigrain_base::comm::{self, Local};
    use std::sync::Arc;

    /// Three bodies of 2, 3 and 2 particles.
    const FIRST: [usize; 4] = [0, 2, 5, 7];
    const MEMBERS: [usize; 7] = [0, 9, 3, 4, 5, 7, 8];

    fn bodies<'a>() -> RigidBodies<'a> {
        RigidBodies { key: Key::new("rigid/small/1/bodies"), width: 2, first: &FIRST, members: &MEMBERS }
    }

    #[test]
    fn a_rank_has_the_bodies_of_its_particles() {
        let ranks = [0..4, 4..7, 7..7, 7..10];
        let own = |rank: usize| bodies().within(std::slice::from_ref(&ranks[rank]));
        assert_eq!([own(0), own(1), own(2), own(3)], [vec![0, 1], vec![1], vec![], vec![0, 2]]);
        assert_eq!(bodies().givers(&ranks), [0, 0, 3]);
    }

    /// Nine particles, three on each rank; three bodies, of which each rank has one or two.
    fn on_a_rank() {
        let me = comm::present().rank();
        let mut w = World::default();
        (1..=9).for_each(|tag| w.particles.push(tag, 1, [0.0; 3]));
        w.rebuild.tiling = Tiling::new(vec![3, 6, 9], &w.rebuild);
        w.begin_shares();
        let (first, members) = ([0, 2, 4, 6], [0, 1, 2, 3, 5, 8]);
        let dealt = RigidBodies { first: &first, members: &members, ..bodies() };
        w.memo.insert(dealt.key, vec![0.0; 6]);
        let own = w.deal_bodies(&dealt, 1);
        assert_eq!(own, [vec![0, 1], vec![1, 2], vec![2]][me]);
        let rows: Vec<f64> = (0..6).map(f64::from).collect();
        for k in own.iter().map(|k| 2 * *k as usize) {
            w.memo.get_or(dealt.key, Vec::new)[k..k + 2].copy_from_slice(&rows[k..k + 2]);
        }
        w.strays(RIGID);
        assert_eq!(w.memo.get(dealt.key).map(|now| *now == rows), Some(false));
        w.whole(RIGID);
        assert_eq!(w.memo.get(dealt.key), Some(&rows));
        for i in 3 * me..3 * me + 3 {
            w.particles.f[i] = [i as f64; 3];
        }
        w.strays(F);
        w.halo(F, Halo::Members);
        for i in own.iter().flat_map(|k| dealt.members(*k as usize)) {
            assert_eq!(w.particles.f[*i], [*i as f64; 3]);
        }
        assert_eq!(w.traffic().gathers, 1);
    }

    #[test]
    fn all_ranks_have_all_bodies_on_request() {
        let seats = Local::threads(3).unwrap();
        std::thread::scope(|s| {
            for seat in seats {
                s.spawn(move || comm::run_as(Arc::new(seat), on_a_rank));
            }
        });
    }
}
