//! Rows of particles shared out to ranks during a run: which rank moves which, and where their values are up to date.
//!
//! Every rank has all rows, at the same places. Of a body that is shared out it moves its own ones and keeps those near them up to date; the
//! others stay as they were until all of them are gathered ([`World::whole`]). Particles of no such body are moved by all ranks alike.

use super::field::{F, Fields, OMEGA, QUAT, SITES, TORQUE, V, X};
use super::{Key, Named, World};
use perigrain_base::comm::numbers::{put, take};
use perigrain_base::comm::{self, Comm};
use perigrain_peri::families::shares::ranges;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// The fields of which a rank may have some rows only.
pub const SHARED: Fields = X.and(V).and(F).and(OMEGA).and(TORQUE).and(QUAT).and(SITES);

/// How rows are shared out.
#[derive(Clone)]
pub struct Share {
    comm: Arc<dyn Comm>,
    /// Rows that this rank moves: its own, and those that all move.
    pub own: Vec<Range<usize>>,
    /// Rows that each rank alone moves.
    alone: Vec<Vec<Range<usize>>>,
    /// Rows to hand out to, and to take from, each other rank: those near bodies' own ones, and those that lists name.
    links: [Vec<Link>; 2],
    /// Rows that lists of ops name, by where these keep contacts, with the generation of lists.
    listed: Named<Listed>,
    /// Fields that are up to date in this rank's own rows alone.
    stale: Fields,
    /// Those of them that are up to date in the rows of these links as well.
    near: [Fields; 2],
    /// What particles there were, in which places.
    roster: [u64; 2],
    /// Whether the op at work acts on this rank's rows alone.
    pub narrow: bool,
    /// Messages, used again.
    bytes: Vec<u8>,
    traffic: Traffic,
}

/// Rows that the lists of an op name.
#[derive(Clone, Debug, Default)]
pub struct Listed {
    generation: u64,
    rows: Vec<u32>,
}

/// What ranks have exchanged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// How often all rows of something were handed to all.
    pub gathers: u64,
    /// Bytes that this rank has sent.
    pub sent: u64,
}

impl Traffic {
    /// What has come since an earlier look.
    pub fn since(self, before: Self) -> Self {
        // Counts begin anew where shares are dealt anew.
        let [gathers, sent] = [(self.gathers, before.gathers), (self.sent, before.sent)]
            .map(|(now, before)| now.checked_sub(before).unwrap_or(now));
        Self { gathers, sent }
    }
}

impl std::ops::AddAssign for Traffic {
    fn add_assign(&mut self, more: Self) {
        self.gathers += more.gathers;
        self.sent += more.sent;
    }
}

/// Rows that two ranks hand to each other.
#[derive(Clone, Debug, Default)]
struct Link {
    with: usize,
    out: Vec<Range<usize>>,
    into: Vec<Range<usize>>,
    bytes: [Vec<u8>; 2],
}

impl fmt::Debug for Share {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { own, stale, near, .. } = self;
        f.debug_struct("Share").field("own", own).field("stale", stale).field("near", near).finish()
    }
}

impl Share {
    /// Puts the largest of all ranks in the place of each number; what is no number counts as larger than all.
    pub fn agree<'a>(&self, numbers: impl Iterator<Item = &'a mut f64>) {
        let numbers: Vec<&mut f64> = numbers.collect();
        let mut most: Vec<f64> =
            numbers.iter().map(|a| if a.is_nan() { f64::INFINITY } else { **a }).collect();
        self.comm.most(&mut most);
        numbers.into_iter().zip(most).for_each(|(a, most)| *a = most);
    }
}

/// Bytes of a number.
const NUMBER: usize = size_of::<f64>();

impl World {
    /// Shares rows out to ranks, where there are several and some body can be. All rows are up to date before.
    pub fn deal(&mut self) {
        self.abandon();
        let comm = comm::present();
        let (me, ranks) = (comm.rank(), comm.size());
        if ranks < 2 {
            return;
        }
        let (n, roster) = (self.n(), self.roster());
        let Some(families) = self.families.past_mut().as_mut().filter(|families| families.place.len() == n)
        else {
            return;
        };
        if !families.deal(me, ranks) {
            return;
        }
        let Some(shares) = &families.shares else { return };
        let of = |rank: usize| {
            let rows = shares.owner.iter().enumerate().filter(|(_, owner)| usize::from(**owner) == rank);
            ranges(rows.map(|(row, _)| row))
        };
        let alone = (0..ranks).map(of).collect();
        let own = shares.own.clone();
        let (stale, near, bytes) = (Fields::NONE, [Fields::NONE; 2], vec![]);
        let (links, listed) = ([vec![], vec![]], Named::default());
        self.share = Some(Share {
            comm,
            own,
            alone,
            links,
            listed,
            stale,
            near,
            roster,
            narrow: false,
            bytes,
            traffic: Traffic::default(),
        });
        self.link();
    }

    /// Finds anew which rows ranks need of each other.
    pub fn link(&mut self) {
        let (Some(share), Some(families)) = (&mut self.share, self.families.past()) else { return };
        let me = share.comm.rank();
        let listed = share.listed.values().flat_map(|listed| listed.rows.iter().copied());
        share.links = [families.needed(), families.needed_by_lists(listed)].map(|needed| {
            let rows = |rows: &[u32]| ranges(rows.iter().map(|row| *row as usize));
            let others = (0..needed.len()).filter(|with| *with != me);
            let links = others.map(|with| Link {
                with,
                out: rows(&needed[with][me]),
                into: rows(&needed[me][with]),
                bytes: Default::default(),
            });
            links.filter(|link| !link.out.is_empty() || !link.into.is_empty()).collect()
        });
        // Rows that are linked since now have not been handed over.
        share.near = [Fields::NONE; 2];
    }

    /// Hands the rows that an op's lists name to all ranks from now on, where shares are dealt and that is not done for the present lists.
    pub fn list_rows(&mut self, by: Key<Listed>, rows: impl FnOnce() -> Vec<u32>) {
        let generation = self.rebuild.past().generation;
        let Some(share) = &mut self.share else { return };
        let known = share.listed.get(by);
        if known.is_some_and(|listed| listed.generation == generation) {
            return;
        }
        let rows = rows();
        let same = known.map_or(rows.is_empty(), |known| known.rows == rows);
        share.listed.insert(by, Listed { generation, rows });
        if !same {
            self.link();
        }
    }

    /// Takes the shares back; all rows are up to date then.
    pub fn undeal(&mut self) {
        self.whole(Fields::ALL);
        self.abandon();
    }

    /// Forgets that rows are shared out, without a word to other ranks: where something has failed.
    pub fn abandon(&mut self) {
        self.share = None;
        if let Some(families) = self.families.past_mut() {
            families.undeal();
        }
    }

    /// Counters that change when particles come, go or change places.
    fn roster(&self) -> [u64; 2] {
        let rebuild = self.rebuild.past();
        [rebuild.roster, rebuild.places]
    }

    /// Whether particles have come, gone or changed places since they were shared out.
    pub fn is_misdealt(&self) -> bool {
        let Some(share) = &self.share else { return false };
        let known = |families: &super::Families| {
            families.shares.as_ref().is_some_and(|shares| shares.owner.len() == self.n())
        };
        share.roster != self.roster() || !self.families.past().as_ref().is_some_and(known)
    }

    /// Brings all rows of these fields up to date on all ranks, which all call this with the same fields at the same place.
    pub fn whole(&mut self, fields: Fields) {
        let Some(mut share) = self.share.take() else { return };
        let missing = share.stale.and_only(fields);
        if !missing.is_empty() {
            self.gather_rows(&mut share, missing);
            share.stale = share.stale.without(missing);
            share.near = share.near.map(|near| near.without(missing));
        }
        self.share = Some(share);
    }

    /// Has the rows of these fields that are near this rank's own, or (`listed`) that lists of ops name.
    pub fn halo(&mut self, fields: Fields, listed: bool) {
        let Some(mut share) = self.share.take() else { return };
        let which = usize::from(listed);
        let missing = share.stale.and_only(fields).without(share.near[which]).without(SITES);
        if !missing.is_empty() {
            self.swap_rows(&mut share, (missing, which));
            share.near[which] |= missing;
        }
        self.share = Some(share);
    }

    /// What this rank has exchanged with others since shares were dealt.
    pub fn traffic(&self) -> Traffic {
        let Some(share) = &self.share else { return Traffic::default() };
        let shares = self.families.past().as_ref().and_then(|families| families.shares.as_ref());
        let within = shares.map_or(0, |shares| shares.sent);
        Traffic { sent: share.traffic.sent + within, ..share.traffic }
    }

    /// The rows among these that the op at work acts on: all, or those of this rank.
    pub fn moved_in(&self, rows: Range<usize>) -> impl Iterator<Item = Range<usize>> + use<'_> {
        let own = self.share.as_ref().filter(|share| share.narrow).map(|share| &share.own[..]);
        let all = own.is_none().then(|| rows.clone());
        let own = own.unwrap_or_default();
        let own = &own[own.partition_point(|own| own.end <= rows.start)..];
        let end = rows.end;
        let some = own.iter().take_while(move |own| own.start < end);
        all.into_iter().chain(some.map(move |own| own.start.max(rows.start)..own.end.min(end)))
    }

    /// Puts the least of all ranks in the place of a number, where the op at work acts on the rows of one.
    pub fn agree_on_least(&self, number: &mut f64) {
        if let Some(share) = self.share.as_ref().filter(|share| share.narrow) {
            let mut most = -*number;
            share.agree(std::iter::once(&mut most));
            *number = -most;
        }
    }

    /// Whether something has come up `here`, or on any rank where the op at work acts on the rows of one.
    pub fn anywhere(&self, here: bool) -> bool {
        let mut nowhere = if here { 0.0 } else { 1.0 };
        self.agree_on_least(&mut nowhere);
        nowhere == 0.0
    }

    /// Whether all particles with one of these group bits are moved by all ranks alike.
    pub fn is_common(&self, bits: u32) -> bool {
        let Some(share) = &self.share else { return true };
        let mask = self.particles.mask.past();
        !share.alone.iter().flatten().any(|rows| mask[rows.clone()].iter().any(|mask| mask & bits != 0))
    }

    /// Whether the op at work acts on the rows of this rank alone.
    pub fn is_narrow(&self) -> bool {
        self.share.as_ref().is_some_and(|share| share.narrow)
    }

    /// An op has changed these fields in this rank's own rows alone.
    pub fn strays(&mut self, fields: Fields) {
        let Some(share) = &mut self.share else { return };
        let changed = SHARED.and_only(fields);
        share.stale |= changed;
        share.near = share.near.map(|near| near.without(changed));
        #[cfg(debug_assertions)]
        self.spoil(changed);
    }

    fn gather_rows(&mut self, share: &mut Share, fields: Fields) {
        let mut bytes = std::mem::take(&mut share.bytes);
        bytes.clear();
        let me = share.comm.rank();
        let mut counts = vec![];
        for rank in 0..share.alone.len() {
            let before = bytes.len();
            let mut length = 0;
            self.columns_of(fields, |numbers, width| {
                let rows: usize = share.alone[rank].iter().map(Range::len).sum();
                length += NUMBER * width * rows;
                if rank == me {
                    write(numbers, width, &share.alone[rank], &mut bytes);
                }
            });
            if let Some(families) = self.families.past_mut().as_mut().filter(|_| fields.has(SITES)) {
                length += families.piece_bytes(rank);
                if rank == me {
                    families.write_piece(rank, &mut bytes);
                }
            }
            bytes.resize(before + length, 0);
            counts.push(length);
        }
        share.comm.gather_all(&mut bytes, &counts);
        share.traffic += Traffic { gathers: 1, sent: counts[me] as u64 };
        let mut rest = &bytes[..];
        for (rank, count) in counts.iter().enumerate() {
            let (mut piece, after) = rest.split_at(*count);
            rest = after;
            if rank == me {
                continue;
            }
            self.columns_of(fields, |numbers, width| {
                piece = read(numbers, width, &share.alone[rank], piece);
            });
            if let Some(families) = self.families.past_mut().as_mut().filter(|_| fields.has(SITES)) {
                families.read_piece(rank, piece);
            }
        }
        share.bytes = bytes;
    }

    fn swap_rows(&mut self, share: &mut Share, (fields, which): (Fields, usize)) {
        let links = &mut share.links[which];
        for link in &mut *links {
            let [out, into] = &mut link.bytes;
            out.clear();
            let mut length = 0;
            self.columns_of(fields, |numbers, width| {
                write(numbers, width, &link.out, out);
                length += NUMBER * width * link.into.iter().map(Range::len).sum::<usize>();
            });
            into.resize(length, 0);
        }
        let mut out: Vec<(usize, &[u8])> = vec![];
        let mut into: Vec<(usize, &mut [u8])> = vec![];
        for Link { with, bytes: [own, others], .. } in &mut *links {
            if !own.is_empty() {
                out.push((*with, own));
            }
            if !others.is_empty() {
                into.push((*with, others));
            }
        }
        share.traffic.sent += out.iter().map(|(_, bytes)| bytes.len() as u64).sum::<u64>();
        share.comm.swap(&out, &mut into);
        for link in &*links {
            let mut piece = &link.bytes[1][..];
            self.columns_of(fields, |numbers, width| piece = read(numbers, width, &link.into, piece));
        }
    }

    /// Calls `f(numbers, numbers per row)` for the columns of these fields that have rows.
    fn columns_of(&mut self, fields: Fields, mut f: impl FnMut(&mut [f64], usize)) {
        let p = &mut self.particles;
        for (field, column) in
            [(X, &mut p.x), (V, &mut p.v), (F, &mut p.f), (OMEGA, &mut p.omega), (TORQUE, &mut p.torque)]
        {
            if fields.has(field) && !column.is_empty() {
                f(column.past_mut().as_flattened_mut(), 3);
            }
        }
        if fields.has(QUAT) && !p.quat.is_empty() {
            f(p.quat.past_mut().as_flattened_mut(), 4);
        }
    }

    /// Makes numbers that are not up to date such that whatever reads them is found out.
    #[cfg(debug_assertions)]
    fn spoil(&mut self, fields: Fields) {
        let Some(share) = self.share.take() else { return };
        let me = share.comm.rank();
        let others = share.alone.iter().enumerate().filter(|(rank, _)| *rank != me);
        let rows: Vec<Range<usize>> = others.flat_map(|(_, rows)| rows.clone()).collect();
        self.columns_of(fields, |numbers, width| {
            rows.iter().for_each(|rows| numbers[width * rows.start..width * rows.end].fill(f64::NAN));
        });
        self.share = Some(share);
    }
}

/// Appends some rows.
fn write(numbers: &[f64], width: usize, rows: &[Range<usize>], bytes: &mut Vec<u8>) {
    for rows in rows {
        put(bytes, &numbers[width * rows.start..width * rows.end]);
    }
}

/// Takes some rows in; what is left of the bytes.
fn read<'a>(numbers: &mut [f64], width: usize, rows: &[Range<usize>], mut bytes: &'a [u8]) -> &'a [u8] {
    for rows in rows {
        take(&mut bytes, &mut numbers[width * rows.start..width * rows.end]);
    }
    bytes
}
