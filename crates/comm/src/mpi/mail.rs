//! Letters over MPI: a message with a letter's length, then one with its bytes, both non-blocking.

use super::{Message, Mpi, PIECE, count};
use std::ffi::{c_int, c_void};

/// Tag of the lengths of letters; their bytes have the next one.
const TAG: c_int = 8;

/// Letters of this rank in transit.
#[derive(Debug, Default)]
pub(super) struct Mail {
    /// Sent, but the buffers may still be in use.
    out: Vec<Piece>,
    /// Receives in progress, by rank.
    into: Vec<Awaited>,
}

/// A message in transit, with its buffer, which must not move until the message is complete.
#[derive(Debug)]
struct Piece {
    request: u64,
    bytes: Vec<u8>,
}

/// State of receiving from a rank.
#[derive(Debug, Default)]
enum Awaited {
    #[default]
    Nothing,
    Length(Piece),
    Bytes(Piece),
}

impl Mail {
    /// For this many ranks.
    pub fn of(size: usize) -> Self {
        Self { out: vec![], into: (0..size).map(|_| Awaited::Nothing).collect() }
    }

    /// Sends a letter.
    pub fn post(&mut self, mpi: &Mpi, to: usize, letter: &[u8]) {
        assert!(letter.len() < PIECE, "letters are short");
        let length = (letter.len() as u64).to_le_bytes().to_vec();
        self.out.push(Piece::begin(mpi, mpi.f.MPI_Isend, length, to, TAG));
        self.out.push(Piece::begin(mpi, mpi.f.MPI_Isend, letter.to_vec(), to, TAG + 1));
        self.send(mpi);
    }

    /// Removes completed messages; returns whether none is left.
    pub fn send(&mut self, mpi: &Mpi) -> bool {
        self.out.retain_mut(|piece| !piece.is_through(mpi));
        self.out.is_empty()
    }

    /// The next letter, if it has arrived completely.
    pub fn next(&mut self, mpi: &Mpi, from: usize) -> Option<Vec<u8>> {
        self.send(mpi);
        let receive = |bytes, tag| Piece::begin(mpi, mpi.f.MPI_Irecv, bytes, from, tag);
        loop {
            let awaited = &mut self.into[from];
            if let Awaited::Length(piece) | Awaited::Bytes(piece) = awaited
                && !piece.is_through(mpi)
            {
                return None;
            }
            *awaited = match std::mem::take(awaited) {
                Awaited::Nothing => Awaited::Length(receive(vec![0; 8], TAG)),
                Awaited::Length(piece) => {
                    let length = piece.bytes.iter().rev().fold(0, |n, byte| n << 8 | usize::from(*byte));
                    Awaited::Bytes(receive(vec![0; length], TAG + 1))
                }
                Awaited::Bytes(piece) => return Some(piece.bytes),
            };
        }
    }
}

impl Piece {
    fn begin(mpi: &Mpi, act: Message, mut bytes: Vec<u8>, partner: usize, tag: c_int) -> Self {
        let mut request = 0u64;
        let piece: *mut c_void = bytes.as_mut_ptr().cast();
        // SAFETY: the buffer is on the heap and is kept, unchanged, until the request is complete.
        unsafe {
            act(
                piece,
                count(bytes.len()),
                mpi.c.byte,
                partner as c_int,
                tag,
                mpi.c.world,
                (&raw mut request).cast(),
            )
        };
        Self { request, bytes }
    }

    fn is_through(&mut self, mpi: &Mpi) -> bool {
        let mut done = 0;
        // SAFETY: the request made by `begin`; a completed one becomes the null request, which is complete
        // too.
        unsafe {
            (mpi.f.MPI_Test)((&raw mut self.request).cast(), &mut done, mpi.c.no_statuses as *mut c_void)
        };
        done != 0
    }
}
