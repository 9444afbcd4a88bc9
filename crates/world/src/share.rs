//! Rows of particles shared out to ranks during a run: which rank moves which, and where their values are up to date.
//!
//! Every rank has all rows, at the same places. Of a body that is shared out, and of grains that stand in tiles, it moves its own ones and keeps
//! those near them up to date; the others stay as they were until all of them are gathered ([`World::whole`]). Particles of no such body are
//! moved by all ranks alike where bodies are shared out.

mod deal;
mod leaves;
mod memory;
mod rigid;

use super::field::{F, Fields, OMEGA, QUAT, RIGID, SITES, TORQUE, V, WALL_CONTACTS, X};
use super::{Named, World};
pub use deal::{Dealings, Tiling};
pub use memory::joined_of_all;
use perigrain_base::comm::Comm;
use perigrain_base::comm::numbers::{put, take};
use rigid::Parted;
pub use rigid::RigidBodies;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// The fields of which a rank may have some rows only.
pub const SHARED: Fields =
    X.and(V).and(F).and(OMEGA).and(TORQUE).and(QUAT).and(SITES).and(RIGID).and(WALL_CONTACTS);
/// Those that are handed over as a whole, not row by row.
const ENTIRE: Fields = SITES.and(RIGID).and(WALL_CONTACTS);

/// How rows are shared out.
#[derive(Clone)]
pub struct Share {
    comm: Arc<dyn Comm>,
    /// What is shared out.
    what: What,
    /// Counts how often rows have been dealt since the program began: another number, other rows.
    pub deal: u64,
    /// Rows that this rank moves: its own, and those that all move.
    pub own: Vec<Range<usize>>,
    /// Rows that each rank alone moves.
    alone: Vec<Vec<Range<usize>>>,
    /// Rows to hand out to, and to take from, each other rank, for each [`Halo`].
    links: [Vec<Link>; HALOS],
    /// Rows that ops name for each of them, by where these keep contacts or bodies or by their names.
    listed: [Named<Listed>; HALOS],
    /// How rigid bodies are dealt out, by where their fixes keep them.
    bodies: Named<Parted>,
    /// Of which group bits it is known whether all ranks move all particles with them.
    common: Vec<(u32, bool)>,
    /// Fields that are up to date in this rank's own rows alone.
    stale: Fields,
    /// Those of them that are up to date in the rows of these links as well.
    near: [Fields; HALOS],
    /// What particles there were, in which places.
    roster: [u64; 2],
    /// Whether the op at work acts on this rank's rows alone.
    pub narrow: bool,
    /// Messages, used again.
    bytes: Vec<u8>,
    traffic: Traffic,
}

/// What is shared out to ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    /// Peridynamic bodies: all ranks list the same pairs of other particles.
    Bodies,
    /// Grains, tile by tile: each rank lists the pairs of its own.
    Grains,
}

/// Rows of other ranks that ops read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Halo {
    /// Those near bodies' own ones.
    Near,
    /// Those that lists of pairs name.
    Listed,
    /// Those of the other particles of rigid bodies of which this rank moves some.
    Members,
}

/// How many kinds of such rows there are.
const HALOS: usize = 3;

/// Rows that the lists of an op name.
#[derive(Clone, Debug, Default)]
pub struct Listed {
    version: u64,
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
    /// Brings all rows of these fields up to date on all ranks, which all call this with the same fields at the same place.
    pub fn whole(&mut self, fields: Fields) {
        let Some(mut share) = self.share.take() else { return };
        let missing = share.stale.and_only(fields);
        if !missing.is_empty() {
            if missing.has(WALL_CONTACTS) {
                self.gather_wall_contacts(&mut share);
            }
            if missing != WALL_CONTACTS {
                self.gather_rows(&mut share, missing);
            }
            share.stale = share.stale.without(missing);
            share.near = share.near.map(|near| near.without(missing));
        }
        self.share = Some(share);
    }

    /// Has these rows of these fields, of other ranks.
    pub fn halo(&mut self, fields: Fields, halo: Halo) {
        let Some(mut share) = self.share.take() else { return };
        let which = halo as usize;
        let missing = share.stale.and_only(fields).without(share.near[which]).without(ENTIRE);
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

    /// Whether all particles with one of these group bits were moved by all ranks alike at the first such query in the present
    /// deal.
    pub fn is_common(&mut self, bits: u32) -> bool {
        let Some(share) = &mut self.share else { return true };
        if let Some((_, common)) = share.common.iter().find(|(of, _)| *of == bits) {
            return *common;
        }
        let mask = self.particles.mask.past();
        let mut alone = share.alone.iter().flatten().flat_map(|rows| &mask[rows.clone()]);
        let common = !alone.any(|mask| mask & bits != 0);
        share.common.push((bits, common));
        common
    }

    /// Whether the op at work acts on the rows of this rank alone.
    pub fn is_narrow(&self) -> bool {
        self.share.as_ref().is_some_and(|share| share.narrow)
    }

    /// How rows are shared out, where the op at work acts on those of this rank alone.
    pub fn narrow_share(&self) -> Option<&Share> {
        self.share.as_ref().filter(|share| share.narrow)
    }

    /// The op at work has lists of this rank's rows alone, though it has seen all rows.
    pub fn act_narrowly(&mut self) {
        if let Some(share) = &mut self.share {
            share.narrow = true;
        }
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
            if fields.has(RIGID) {
                length += share.body_bytes(rank);
                if rank == me {
                    share.write_bodies(self.memo.past(), rank, &mut bytes);
                }
            }
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
            if fields.has(RIGID) {
                piece = share.read_bodies(self.memo.past_mut(), rank, piece);
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
        if fields.has(RIGID) {
            share.spoil_bodies(self.memo.past_mut());
        }
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
