//! Dealing rows out to ranks: bodies and grains tile by tile, and which rows ranks need of each other then.

use super::{Halo, Link, Listed, Share, Traffic, What};
use crate::rebuild::Rebuild;
use crate::{Fields, Key, Named, World};
use perigrain_base::comm::numbers::{next, put};
use perigrain_base::comm::{self, Comm};
use perigrain_peri::families::Families;
use perigrain_peri::families::shares::ranges;
use std::ops::Range;

/// Some rows, ascending.
type Rows = Vec<Range<usize>>;

/// Whether rows are shared out, and how often they have been.
#[derive(Clone, Copy, Debug, Default)]
pub struct Dealings {
    /// A run is under way, and its rows are shared out as soon as they can be.
    wanted: bool,
    /// How often rows have been dealt since the program began.
    count: u64,
    /// How much work the last evaluation was for this rank where grains are shared out, in units that all ranks have in common.
    pub work: f64,
    /// A run has failed: ranks need not have come to the same place, and nothing waits for another rank any more.
    pub apart: bool,
}

/// The tiles that grains stand in while they stand in the order of space.
#[derive(Clone, Debug, Default)]
pub struct Tiling {
    /// Rows before which each tile ends, ascending.
    ends: Vec<u32>,
    /// What particles there were, in which places.
    roster: [u64; 2],
}

impl Tiling {
    /// Tiles that end before these rows, of particles as they stand now.
    pub fn new(ends: Vec<u32>, rebuild: &Rebuild) -> Self {
        Self { ends, roster: roster(rebuild) }
    }

    /// The rows of each rank: whole tiles, with as much work for each as for any other. None where there are fewer tiles than ranks.
    fn dealt(&self, ranks: usize, work: &Work) -> Option<Vec<Range<usize>>> {
        let all = *self.ends.last()? as usize;
        if self.ends.len() < ranks {
            return None;
        }
        let before: Vec<f64> =
            self.ends.iter().map(|end| work.before(f64::from(*end) / all as f64)).collect();
        let end = |rank: usize| match rank {
            0 => 0,
            rank if rank == ranks => all,
            rank => {
                let wanted = work.before(1.0) * rank as f64 / ranks as f64;
                let k = before.partition_point(|before| *before < wanted).max(1);
                let k = k.min(before.len() - 1);
                (if wanted - before[k - 1] < before[k] - wanted { self.ends[k - 1] } else { self.ends[k] })
                    as usize
            }
        };
        Some((0..ranks).map(|rank| end(rank)..end(rank + 1)).collect())
    }
}

/// How work lies along the rows: the parts of the rows at which the ranks' own ended, ascending, and how much work a row was to each.
#[derive(Clone, Debug, Default)]
struct Work(Vec<[f64; 2]>);

/// No rank's rows are taken for so many times more or less work than those of all.
const UNEVEN: f64 = 4.0;

impl Work {
    /// That of ranks which had these rows and did so much, as far as that is known.
    fn of(rows: &[Range<usize>], done: &[f64]) -> Self {
        let all = rows.last().map_or(0, |rows| rows.end) as f64;
        let mean = done.iter().sum::<f64>() / all;
        if !mean.is_normal() {
            return Self::default();
        }
        let row = |(rows, done): (&Range<usize>, &f64)| {
            let each = if rows.is_empty() { 1.0 } else { done / (rows.len() as f64 * mean) };
            [rows.end as f64 / all, each.clamp(1.0 / UNEVEN, UNEVEN)]
        };
        Self(rows.iter().zip(done).map(row).collect())
    }

    /// How much of it comes before this part of the rows.
    fn before(&self, part: f64) -> f64 {
        let (mut sum, mut from) = (0.0, 0.0);
        for [end, each] in self.0.iter().chain([&[1.0, 1.0]]) {
            sum += each * (end.min(part) - from).max(0.0);
            from = *end;
        }
        sum
    }
}

/// Counters that change when particles come, go or change places.
fn roster(rebuild: &Rebuild) -> [u64; 2] {
    [rebuild.roster, rebuild.places]
}

/// The rows of bodies that each rank alone moves, and those that this one moves. None where there is no body to deal.
fn deal_bodies(
    families: &mut Option<Families>,
    n: usize,
    (me, ranks): (usize, usize),
) -> Option<(Vec<Rows>, Rows)> {
    let families = families.as_mut().filter(|families| families.place.len() == n)?;
    if !families.deal(me, ranks) {
        return None;
    }
    let shares = families.shares.as_ref()?;
    let of = |rank: usize| {
        let rows = shares.owner.iter().enumerate().filter(|(_, owner)| usize::from(**owner) == rank);
        ranges(rows.map(|(row, _)| row))
    };
    Some(((0..ranks).map(of).collect(), shares.own.clone()))
}

impl World {
    /// Shares rows out to ranks from now on, where there are several, as soon as there is something to share out. All rows are up to date
    /// before.
    pub fn begin_shares(&mut self) {
        self.dealings.wanted = comm::several();
        self.deal();
    }

    /// Shares rows out to ranks anew; all rows are up to date before.
    pub fn deal(&mut self) {
        let work = self.work_of_ranks();
        self.abandon();
        if !self.dealings.wanted {
            return;
        }
        let comm = comm::present();
        let (me, ranks) = (comm.rank(), comm.size());
        let n = self.n();
        let (what, alone, own) = match deal_bodies(self.families.past_mut(), n, (me, ranks)) {
            Some((alone, own)) => (What::Bodies, alone, own),
            None => {
                let Some(rows) = self.tiling().and_then(|tiling| tiling.dealt(ranks, &work)) else { return };
                let alone: Vec<Rows> = rows.into_iter().map(|rows| vec![rows]).collect();
                let own = alone[me].clone();
                (What::Grains, alone, own)
            }
        };
        self.dealings.count += 1;
        self.share = Some(Share {
            comm,
            what,
            deal: self.dealings.count,
            own,
            alone,
            links: Default::default(),
            listed: Default::default(),
            bodies: Named::default(),
            common: vec![],
            stale: Fields::NONE,
            near: Default::default(),
            roster: roster(self.rebuild.past()),
            narrow: false,
            bytes: vec![],
            traffic: Traffic::default(),
        });
        self.link();
    }

    /// How much work the rows have been that grains are shared out in now.
    fn work_of_ranks(&self) -> Work {
        let Some(share) = self.share.as_ref().filter(|share| share.what == What::Grains) else {
            return Work::default();
        };
        let mut done = vec![f64::NEG_INFINITY; share.comm.size()];
        done[share.comm.rank()] = self.dealings.work;
        share.comm.most(&mut done);
        Work::of(&share.rows_of_ranks(), &done)
    }

    /// Shares rows out where that was not possible before, and is now.
    pub fn deal_if_possible(&mut self) {
        if self.dealings.wanted && self.share.is_none() && self.tiling().is_some() {
            self.deal();
        }
    }

    /// The tiles of grains, where all particles are grains and stand in them now.
    fn tiling(&self) -> Option<&Tiling> {
        let rebuild = self.rebuild.past();
        let tiling = &rebuild.tiling;
        let all = tiling.ends.last().map(|end| *end as usize) == Some(self.n());
        (all && tiling.roster == roster(rebuild) && self.families.past().is_none()).then_some(tiling)
    }

    /// Finds anew which rows ranks need of each other.
    pub fn link(&mut self) {
        let Some(share) = &mut self.share else { return };
        let named = |of: &Named<Listed>| -> Vec<u32> {
            of.values().flat_map(|listed| listed.rows.iter().copied()).collect()
        };
        let me = share.comm.rank();
        share.links = match (share.what, self.families.past()) {
            (What::Grains, _) => share.listed.each_ref().map(|of| {
                // All ranks know whether something lists rows at all.
                if of.is_empty() {
                    return vec![];
                }
                let wanted = wanted(&share.alone, me, named(of).into_iter());
                let requested = requested_rows(&*share.comm, &wanted);
                links(&requested, &wanted)
            }),
            (What::Bodies, Some(families)) => {
                let listed = named(&share.listed[Halo::Listed as usize]).into_iter();
                let [near, listed] = [families.needed(), families.needed_by_lists(listed)].map(|needed| {
                    let Some(into) = needed.get(me) else { return vec![] };
                    let out: Vec<Vec<u32>> = needed.iter().map(|with| with[me].clone()).collect();
                    links(&out, into)
                });
                [near, listed, vec![]]
            }
            (What::Bodies, None) => Default::default(),
        };
        // Rows that are linked since now have not been handed over.
        share.near = Default::default();
    }

    /// Hands over the rows that an op's lists of this version name from now on, where shares are dealt and that is not done yet. Lists are
    /// those of all ranks where bodies are shared out, and those of this one where grains are.
    pub fn list_rows(&mut self, list: (Key<Listed>, u64), rows: impl FnOnce() -> Vec<u32>) {
        self.name_rows(Halo::Listed, list, rows);
    }

    /// The same for rows of other kinds.
    pub(super) fn name_rows(
        &mut self,
        halo: Halo,
        (by, version): (Key<Listed>, u64),
        rows: impl FnOnce() -> Vec<u32>,
    ) {
        let Some(share) = &mut self.share else { return };
        let named = &mut share.listed[halo as usize];
        let known = named.get(by);
        if known.is_some_and(|listed| listed.version == version) {
            return;
        }
        let rows = rows();
        let mut other = known.map_or(!rows.is_empty(), |known| known.rows != rows);
        named.insert(by, Listed { version, rows });
        if share.what == What::Grains {
            let mut others = if other { 1.0 } else { 0.0 };
            share.agree(std::iter::once(&mut others));
            other = others > 0.0;
        }
        if other {
            self.link();
        }
    }

    /// The number of the present deal, where grains are shared out to ranks.
    pub fn grains_dealt(&self) -> Option<u64> {
        self.share.as_ref().filter(|share| share.what == What::Grains).map(|share| share.deal)
    }

    /// Takes the shares back for the rest of a run; all rows are up to date then.
    pub fn undeal(&mut self) {
        self.whole(Fields::ALL);
        self.abandon();
        self.dealings.wanted = false;
    }

    /// Ends the distribution of rows after a failure, without communication.
    pub fn part(&mut self) {
        self.abandon();
        (self.dealings.wanted, self.dealings.apart) = (false, true);
    }

    fn abandon(&mut self) {
        self.share = None;
        if let Some(families) = self.families.past_mut() {
            families.undeal();
        }
    }

    /// Whether particles have come, gone or changed places since they were shared out.
    pub fn is_misdealt(&self) -> bool {
        let Some(share) = &self.share else { return false };
        let known = |families: &Families| {
            families.shares.as_ref().is_some_and(|shares| shares.owner.len() == self.n())
        };
        let stands = match share.what {
            What::Bodies => self.families.past().as_ref().is_some_and(known),
            What::Grains => self.families.past().is_none(),
        };
        share.roster != roster(self.rebuild.past()) || !stands
    }
}

impl Share {
    /// The rows of each rank, one behind the other, where grains are shared out.
    pub fn rows_of_ranks(&self) -> Vec<Range<usize>> {
        self.alone.iter().flatten().cloned().collect()
    }
}

/// The links to other ranks, where each of them needs these rows of this one, and this one needs these of each; none to itself.
fn links(out: &[Vec<u32>], into: &[Vec<u32>]) -> Vec<Link> {
    let rows = |rows: &Vec<u32>| ranges(rows.iter().map(|row| *row as usize));
    let link = |(with, (out, into)): (usize, (&Vec<u32>, &Vec<u32>))| Link {
        with,
        out: rows(out),
        into: rows(into),
        bytes: Default::default(),
    };
    let links = out.iter().zip(into).enumerate().map(link);
    links.filter(|link| !link.out.is_empty() || !link.into.is_empty()).collect()
}

/// Of these rows those that each other rank has, ascending.
fn wanted(alone: &[Vec<Range<usize>>], me: usize, listed: impl Iterator<Item = u32>) -> Vec<Vec<u32>> {
    let mut rows: Vec<u32> = listed.collect();
    rows.sort_unstable();
    rows.dedup();
    let of = |(rank, owned): (usize, &Vec<Range<usize>>)| match &owned[..] {
        [owned] if rank != me => {
            let at = |end: usize| rows.partition_point(|row| (*row as usize) < end);
            rows[at(owned.start)..at(owned.end)].to_vec()
        }
        _ => vec![],
    };
    alone.iter().enumerate().map(of).collect()
}

/// The rows of this rank that each other rank needs, when this one needs these of theirs.
fn requested_rows(comm: &dyn Comm, wanted: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let letter = |rows: &Vec<u32>| {
        let mut bytes = vec![];
        put(&mut bytes, rows);
        bytes
    };
    let out = wanted.iter().map(letter).enumerate().filter(|(_, bytes)| !bytes.is_empty()).collect();
    let mut requested = vec![vec![]; wanted.len()];
    for (from, bytes) in comm.exchange(out) {
        let mut rest = &bytes[..];
        while let Some([row]) = next(&mut rest) {
            requested[from].push(row);
        }
    }
    requested
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_get_whole_tiles_and_as_many_rows_as_others() {
        let tiling = Tiling { ends: vec![10, 30, 30, 41, 60, 75, 100], roster: [0; 2] };
        let even = Work::default();
        assert_eq!(tiling.dealt(2, &even), Some(vec![0..41, 41..100]));
        assert_eq!(tiling.dealt(3, &even), Some(vec![0..30, 30..60, 60..100]));
        assert_eq!(tiling.dealt(8, &even), None);
        for ranks in 1..=7 {
            let rows = tiling.dealt(ranks, &even).unwrap();
            assert!(rows.windows(2).all(|two| two[0].end == two[1].start && two[0].start <= two[0].end));
            assert_eq!((rows[0].start, rows[ranks - 1].end), (0, 100));
        }
    }

    #[test]
    fn ranks_whose_rows_were_more_work_get_fewer() {
        let tiling = Tiling { ends: (1..=100).map(|k| 10 * k).collect(), roster: [0; 2] };
        let dealt =
            |rows: &[Range<usize>], done: &[f64]| tiling.dealt(rows.len(), &Work::of(rows, done)).unwrap();
        // Three quarters of the work lay in the first half: a third of a half more than it had.
        assert_eq!(dealt(&[0..500, 500..1000], &[30.0, 10.0]), [0..330, 330..1000]);
        // Dealt so, both did as much.
        assert_eq!(dealt(&[0..330, 330..1000], &[20.0, 20.0]), [0..330, 330..1000]);
        // What is not known is the same for all, and no rank is left with next to nothing.
        assert_eq!(dealt(&[0..500, 500..1000], &[0.0, 0.0]), [0..500, 500..1000]);
        assert!((420..=430).contains(&dealt(&[0..10, 10..1000], &[1e9, 1.0])[0].len()));
        assert_eq!(dealt(&[0..0, 0..1000], &[0.0, 1.0]), [0..500, 500..1000]);
    }

    #[test]
    fn rows_of_lists_are_wanted_of_their_ranks() {
        let alone = [0..4, 4..9, 9..12].map(|rows| Vec::from([rows]));
        let listed = [7, 3, 4, 10, 11, 4, 0].into_iter();
        assert_eq!(wanted(&alone, 1, listed), [vec![0, 3], vec![], vec![10, 11]]);
    }
}
