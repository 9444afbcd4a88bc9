//! Ranks: several processes that run one deck together, and their communication.
//!
//! [`Comm`] has the operations of a rank: exchange with partners, sums, maxima, broadcasts from the first
//! rank. [`Alone`] is a single rank, [`Local`] connects ranks on one machine by sockets, [`Mpi`] uses any MPI
//! library, loaded at run time. A program selects the communicator of the current thread by [`run_as`]; other
//! code uses [`present`], [`several`] and [`is_first`], and takes values that must be equal on all ranks
//! (times, files, the environment) from [`broadcast`].
//!
//! All ranks call the same functions in the same order, except for letters ([`Comm::post`]), which a rank
//! takes when it polls for them. A rank that ends unexpectedly ends the others; if a letter cannot arrive any
//! more, the caller handles it.

#[cfg(all(target_os = "linux", target_env = "gnu"))]
mod mpi;

mod alone;
pub mod broadcast;
mod error;
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
pub use error::Error;
pub use host::{describe, file_of, host, nodes};
pub use launcher::{Launched, launched, open, set_apart};
#[cfg(unix)]
pub use local::{Local, Seat};
#[cfg(all(target_os = "linux", target_env = "gnu"))]
pub use mpi::Mpi;
pub use present::{is_first, present, run_as, several};

use std::time::Duration;

/// Operations of a rank. All ranks must call every method except the first three.
///
/// A lost partner is not an error to handle: the program ends with a message that names it.
pub trait Comm: Send + Sync {
    /// This rank, from 0.
    fn rank(&self) -> usize;

    /// The number of ranks.
    fn size(&self) -> usize;

    /// Name of the transport, for messages.
    fn library(&self) -> String;

    /// Sends to and receives from each partner simultaneously. Both sides know the lengths.
    fn swap(&self, out: &[(usize, &[u8])], into: &mut [(usize, &mut [u8])]);

    /// Distributes every rank's piece to all. `all` holds the pieces in rank order, `counts` their lengths;
    /// this rank's own piece is already in place.
    fn gather_all(&self, all: &mut [u8], counts: &[usize]);

    /// Sums numbers over all ranks.
    fn sum(&self, values: &mut [i64]);

    /// The maximum of each number over all ranks.
    fn most(&self, values: &mut [f64]);

    /// Hands the first rank's bytes to all.
    fn broadcast(&self, bytes: &mut Vec<u8>);

    /// Sends a letter to another rank, which receives it by [`Comm::letter`]. Letters between two ranks keep
    /// their order. They are for ranks that wait for each other in no fixed order, and that call no other
    /// operation until all letters are received.
    fn post(&self, to: usize, letter: &[u8]);

    /// The next letter from another rank, if it has arrived; never waits. Progresses this rank's own letters.
    ///
    /// # Errors
    /// The other rank has ended. An MPI launcher ends all ranks before this can be observed.
    fn letter(&self, from: usize) -> Result<Option<Vec<u8>>, Gone>;

    /// Progresses this rank's own letters; returns whether all have been sent.
    fn posted(&self) -> bool;

    /// Waits until all ranks have called this, at most for `patience`; returns whether they have. The last
    /// operation of all ranks.
    fn meet(&self, patience: Duration) -> bool;

    /// Closes this rank, after all have met.
    fn close(&self);

    /// Ends all ranks immediately.
    fn abort(&self, code: i32) -> !;

    /// Collects a piece of any length from every rank, in rank order; `own` is this one's.
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

    /// Sends pieces of any length to any partners; returns the pieces received, in rank order.
    fn exchange(&self, out: Vec<(usize, Vec<u8>)>) -> Vec<(usize, Vec<u8>)> {
        let (me, size) = (self.rank(), self.size());
        // Row `r` of this square table: the lengths that rank `r` sends to each.
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

/// A rank cannot be reached any more: prints this and ends the process.
fn lost(me: usize, other: usize) -> ! {
    eprintln!("error: rank {me} on {}: rank {other} has ended without a message", host());
    std::process::exit(1)
}
