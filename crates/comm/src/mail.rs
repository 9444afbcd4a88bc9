//! Letters over a socket: sent and received without blocking, as far as the socket allows.

use super::Gone;
use super::local::{HEAD, Kind};
use std::collections::VecDeque;
use std::io::{ErrorKind, Read, Write};
use std::os::unix::net::UnixStream;

/// Letters in transit to and from one other rank.
#[derive(Debug, Default)]
pub(super) struct Mail {
    /// Frames that are not sent yet.
    out: VecDeque<u8>,
    /// The received part of a frame.
    came: Vec<u8>,
    gone: bool,
}

impl Mail {
    /// Sends a letter, at once or when the socket accepts it.
    pub fn post(&mut self, socket: &UnixStream, letter: &[u8]) {
        self.out.push_back(Kind::Letter as u8);
        self.out.extend((letter.len() as u64).to_le_bytes());
        self.out.extend(letter);
        self.send(socket);
    }

    /// Sends pending data; returns whether all has been sent. Data for a rank that has ended counts as sent.
    pub fn send(&mut self, socket: &UnixStream) -> bool {
        while !self.out.is_empty() && !self.gone {
            let (piece, _) = self.out.as_slices();
            let sent = at_once(socket, |mut socket| socket.write(piece));
            match sent {
                Ok(n) => drop(self.out.drain(..n)),
                Err(ErrorKind::WouldBlock) => return false,
                Err(_) => self.gone = true,
            }
        }
        true
    }

    /// The next letter, if it has arrived completely.
    ///
    /// # Errors
    /// The other rank has ended.
    pub fn next(&mut self, socket: &UnixStream) -> Result<Option<Vec<u8>>, Gone> {
        loop {
            let wanted = match self.came.get(1..HEAD) {
                None => HEAD,
                Some(length) => {
                    assert!(self.came[0] == Kind::Letter as u8, "frame {} among letters", self.came[0]);
                    HEAD + length.iter().rev().fold(0, |n, byte| n << 8 | usize::from(*byte))
                }
            };
            let have = self.came.len();
            if have >= HEAD && have == wanted {
                return Ok(Some(std::mem::take(&mut self.came).split_off(HEAD)));
            }
            self.came.resize(wanted, 0);
            let into = &mut self.came[have..];
            let read = at_once(socket, |mut socket| socket.read(into));
            self.came.truncate(have + read.unwrap_or(0));
            match read {
                Ok(0) => return Err(Gone),
                Ok(_) => {}
                Err(ErrorKind::WouldBlock) => return Ok(None),
                Err(_) => return Err(Gone),
            }
        }
    }
}

/// Performs a non-blocking operation.
fn at_once(
    socket: &UnixStream,
    act: impl FnOnce(&UnixStream) -> std::io::Result<usize>,
) -> Result<usize, ErrorKind> {
    let outcome = socket.set_nonblocking(true).and_then(|()| act(socket));
    let back = socket.set_nonblocking(false);
    match outcome.and_then(|n| back.map(|()| n)) {
        Err(e) if e.kind() == ErrorKind::Interrupted => Err(ErrorKind::WouldBlock),
        other => other.map_err(|e| e.kind()),
    }
}
