//! Letters over MPI: a message of a letter's length, then one of its bytes, neither waited for.

use super::{Message, Mpi, PIECE, count};
use std::ffi::{c_int, c_void};

/// Lengths of letters have this tag, their bytes the next one.
const TAG: c_int = 8;

/// Letters of this rank that are under way.
#[derive(Debug, Default)]
pub(super) struct Mail {
    /// Sent, but not surely taken from their buffers.
    out: Vec<Piece>,
    /// Awaited from each rank.
    into: Vec<Awaited>,
}

/// A message that goes or comes, and its buffer, which stays where it is until the message is through.
#[derive(Debug)]
struct Piece {
    request: u64,
    bytes: Vec<u8>,
}

/// What is awaited from a rank.
#[derive(Debug, Default)]
enum Awaited {
    #[default]
    Nothing,
    Length(Piece),
    Bytes(Piece),
}

impl Mail {
    /// That of a rank among so many.
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

    /// Forgets what has left; whether that is all.
    pub fn send(&mut self, mpi: &Mpi) -> bool {
        self.out.retain_mut(|piece| !piece.is_through(mpi));
        self.out.is_empty()
    }

    /// The next letter, if it has come as a whole.
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
        // SAFETY: the buffer lies on the heap and is kept, unchanged, until the request is through.
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
        // SAFETY: the request that `begin` has made; one that is through becomes the null request, which is through too.
        unsafe {
            (mpi.f.MPI_Test)((&raw mut self.request).cast(), &mut done, mpi.c.no_statuses as *mut c_void)
        };
        done != 0
    }
}
