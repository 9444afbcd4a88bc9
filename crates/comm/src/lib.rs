//! Ranks: several processes that run one deck together, and what they say to each other.
//!
//! [`Comm`] is what a rank can do: send to partners, add up, find a largest value, hand out what the first rank has. [`Alone`] is
//! the only rank there is, [`Local`] are ranks on this machine connected by sockets, [`Mpi`] is any MPI library, found at run time.
//! A program says which one holds for the present thread by [`run_as`]; everything else asks [`present`], [`several`], [`is_first`],
//! or takes values that must not differ between ranks (times, files, the environment) from [`told`].
//!
//! All ranks call the same functions in the same order, but for letters ([`Comm::post`]), which a rank takes when it looks for them. A rank that ends
//! without a word ends the others; where it is a letter that does not come the program says what follows.

#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod mpi;

mod alone;
pub mod broadcast;
mod host;
mod launcher;
#[cfg(unix)]
mod local;
#[cfg(unix)]
mod mail;
pub mod numbers;
mod present;
pub mod rows;
#[cfg(unix)]
mod swap;

pub use alone::Alone;
pub use host::{describe, file_of, host, nodes};
pub use launcher::{Launched, launched, open, set_apart};
#[cfg(unix)]
pub use local::{Local, Seat};
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub use mpi::Mpi;
pub use present::{is_first, present, run_as, several};

use std::time::Duration;

/// What a rank can do together with the others. Every method but the first three is called by all ranks.
///
/// A partner that is gone is no error to handle: the program ends with a message that names it.
pub trait Comm: Send + Sync {
    /// This rank, from 0.
    fn rank(&self) -> usize;

    /// How many there are.
    fn size(&self) -> usize;

    /// What carries messages, for people.
    fn library(&self) -> String;

    /// Sends to and receives from each partner at once. Lengths are known on both sides.
    fn swap(&self, out: &[(usize, &[u8])], into: &mut [(usize, &mut [u8])]);

    /// Hands every rank's piece to all. `all` holds the pieces in the order of ranks, `counts` their lengths; this rank's own is
    /// in its place.
    fn gather_all(&self, all: &mut [u8], counts: &[usize]);

    /// Adds up numbers over all ranks.
    fn sum(&self, values: &mut [i64]);

    /// The largest of each number over all ranks.
    fn most(&self, values: &mut [f64]);

    /// Hands the first rank's bytes to all.
    fn broadcast(&self, bytes: &mut Vec<u8>);

    /// Sends a letter to another rank, which takes it by [`Comm::letter`]. Letters between two ranks keep their order. They are for ranks
    /// that wait for each other in no fixed order, and that do nothing else together until all letters are taken.
    fn post(&self, to: usize, letter: &[u8]);

    /// The next letter of another rank, if it has come; never waits. Sends on what this rank has posted.
    ///
    /// # Errors
    /// The other rank has ended. A launcher of MPI ends all ranks before one could see it.
    fn letter(&self, from: usize) -> Result<Option<Vec<u8>>, Gone>;

    /// Sends on what this rank has posted; whether all of it has left.
    fn posted(&self) -> bool;

    /// Waits until all ranks have come here, for so long at most; whether they have. The last thing that ranks do together.
    fn meet(&self, patience: Duration) -> bool;

    /// Ends this rank's part, once all have met.
    fn close(&self);

    /// Ends all ranks at once.
    fn abort(&self, code: i32) -> !;

    /// A piece of every rank, of any length, in the order of ranks; `own` is this one's.
    fn pieces(&self, own: Vec<u8>) -> Vec<Vec<u8>> {
        let (me, size) = (self.rank(), self.size());
        let mut lengths = vec![0u8; size * 8];
        lengths[me * 8..][..8].copy_from_slice(&(own.len() as u64).to_le_bytes());
        self.gather_all(&mut lengths, &vec![8; size]);
        let counts: Vec<usize> =
            lengths.as_chunks().0.iter().map(|n| u64::from_le_bytes(*n) as usize).collect();
        let mut all = vec![0; counts.iter().sum()];
        let before: usize = counts[..me].iter().sum();
        all[before..][..own.len()].copy_from_slice(&own);
        self.gather_all(&mut all, &counts);
        let mut rest = &all[..];
        counts.iter().filter_map(|count| rest.split_off(..*count).map(<[u8]>::to_vec)).collect()
    }

    /// Sends pieces of any length to any partners; what others have sent here, in the order of ranks.
    fn exchange(&self, out: Vec<(usize, Vec<u8>)>) -> Vec<(usize, Vec<u8>)> {
        let (me, size) = (self.rank(), self.size());
        // Row `r` of this square table: what rank `r` sends to each.
        let mut lengths = vec![0u8; size * size * 8];
        for (to, piece) in &out {
            let at = (me * size + to) * 8;
            lengths[at..at + 8].copy_from_slice(&(piece.len() as u64).to_le_bytes());
        }
        self.gather_all(&mut lengths, &vec![size * 8; size]);
        let length = |from: usize| {
            let at = (from * size + me) * 8;
            lengths[at..at + 8].iter().rev().fold(0usize, |n, byte| n << 8 | usize::from(*byte))
        };
        let mut came: Vec<(usize, Vec<u8>)> =
            (0..size).filter(|r| length(*r) > 0).map(|r| (r, vec![0; length(r)])).collect();
        let out: Vec<(usize, &[u8])> =
            out.iter().filter(|(_, piece)| !piece.is_empty()).map(|(to, piece)| (*to, &piece[..])).collect();
        let mut into: Vec<(usize, &mut [u8])> =
            came.iter_mut().map(|(from, b)| (*from, &mut b[..])).collect();
        self.swap(&out, &mut into);
        came
    }
}

/// Another rank has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gone;

/// A rank cannot be reached any more: says so and ends this one.
fn lost(me: usize, other: usize) -> ! {
    eprintln!("error: rank {me} on {}: rank {other} has ended without a message", host());
    std::process::exit(1)
}
