//! Which tiles of bodies each of several ranks sweeps, and what ranks owe to each other for that.

use std::ops::Range;

/// The owner of particles that all ranks move alike: those of no body.
pub const ALL: u16 = u16::MAX;

/// How the work on bodies is dealt out to ranks. Nothing a step depends on: the same bits with any deal, and without one.
#[derive(Clone, Debug, Default)]
pub struct Shares {
    /// This rank.
    pub me: usize,
    /// How many there are.
    pub ranks: usize,
    /// Of each body on a lattice.
    pub bodies: Vec<BodyShare>,
    /// Of the list, where it has records: slabs are its tiles, and its row slots.
    pub list: Option<BodyShare>,
    /// The rank that each particle belongs to, or [`ALL`].
    pub owner: Vec<u16>,
    /// This rank's particles, and those of all.
    pub own: Vec<Range<usize>>,
    /// Bytes that this rank has sent to others within evaluations.
    pub sent: u64,
}

/// One body's tiles on ranks.
#[derive(Clone, Debug, Default)]
pub struct BodyShare {
    /// This rank's tiles.
    pub mine: Range<usize>,
    /// Those of each rank, in the order of ranks.
    pub tiles: Vec<Range<usize>>,
    /// Whether this rank follows the displacements of each row slot: it does where its bonds, or bonds of their families, lead.
    pub follows: Vec<bool>,
    /// Whether a row slot is this rank's.
    pub own: Vec<bool>,
    /// What this rank's tiles give to those of others.
    pub gives: Vec<Dues>,
    /// What others' tiles give to those of this rank.
    pub takes: Vec<Dues>,
    /// Tiles of this rank that others' bonds reach.
    pub waits: Vec<usize>,
    /// Rows whose sums other ranks need, and whose sums this one needs of them.
    pub rows: Vec<RowLink>,
}

/// Row slots whose sums two ranks exchange.
#[derive(Clone, Debug, Default)]
pub struct RowLink {
    /// The other rank.
    pub with: usize,
    /// Rows of this rank that bonds of the other one lead to.
    pub out: Vec<usize>,
    /// Rows of the other one that bonds of this one lead to.
    pub into: Vec<usize>,
    /// The messages.
    pub bytes: [Vec<u8>; 2],
}

/// Windows that one rank hands over to another.
#[derive(Clone, Debug, Default)]
pub struct Dues {
    /// The other rank.
    pub with: usize,
    /// The tile that gives, and the one that takes.
    pub pairs: Vec<[usize; 2]>,
    /// Whether the first tile of each pair owes anything in the present sweep.
    pub owes: Vec<u8>,
    /// The message.
    pub bytes: Vec<u8>,
}

impl Shares {
    /// Bytes that this rank's tiles hand over to others in one sweep.
    pub fn dues(&self) -> usize {
        let all = self.bodies.iter().chain(&self.list).map(|body| {
            let dues = body.gives.iter().map(|dues| dues.bytes.len());
            dues.chain(body.rows.iter().map(|rows| rows.bytes[0].len())).sum::<usize>()
        });
        all.sum()
    }

    /// Whether a particle's forces are this rank's to find.
    pub fn moves(&self, particle: usize) -> bool {
        let owner = self.owner[particle];
        owner == ALL || usize::from(owner) == self.me
    }
}

/// Ascending numbers as ranges.
pub fn ranges(numbers: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = vec![];
    for n in numbers {
        match all.last_mut() {
            Some(last) if last.end == n => last.end += 1,
            _ => all.push(n..n + 1),
        }
    }
    all
}
