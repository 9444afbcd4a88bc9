//! Frames to and from several ranks at once, on one thread: as much at a time as each socket accepts or has.

use super::local::{HEAD, Kind};
use rustix::event::{PollFd, PollFlags, poll};
use rustix::io::Errno;
use rustix::net::{RecvAncillaryBuffer, RecvFlags, SendAncillaryBuffer, SendFlags, recvmsg, sendmsg};
use std::io::{IoSlice, IoSliceMut};
use std::os::unix::net::UnixStream;

/// This rank is lost.
#[derive(Debug)]
pub struct GoneRank(pub usize);

/// The header of a frame with this many bytes.
pub fn head(kind: Kind, length: usize) -> [u8; HEAD] {
    let mut head = [kind as u8; HEAD];
    head[1..].copy_from_slice(&(length as u64).to_le_bytes());
    head
}

/// An outgoing frame.
pub struct Going<'a> {
    with: usize,
    socket: &'a UnixStream,
    head: [u8; HEAD],
    bytes: &'a [u8],
    /// Number of bytes sent, including the header.
    done: usize,
}

impl<'a> Going<'a> {
    /// A frame with these bytes, for a rank at the other end of this socket.
    pub fn new(with: usize, socket: &'a UnixStream, kind: Kind, bytes: &'a [u8]) -> Self {
        Self { with, socket, head: head(kind, bytes.len()), bytes, done: 0 }
    }

    fn left(&self) -> usize {
        HEAD + self.bytes.len() - self.done
    }

    /// Sends what the socket accepts, and with `wait` everything; returns whether all has been sent.
    ///
    /// # Errors
    /// The other rank is lost.
    pub fn send(&mut self, wait: bool) -> Result<bool, GoneRank> {
        let flags = if wait { SendFlags::empty() } else { SendFlags::DONTWAIT };
        while self.left() > 0 {
            let pieces = [
                IoSlice::new(&self.head[self.done.min(HEAD)..]),
                IoSlice::new(&self.bytes[self.done.saturating_sub(HEAD)..]),
            ];
            match sendmsg(self.socket, &pieces, &mut SendAncillaryBuffer::default(), flags) {
                Ok(n) => self.done += n,
                Err(Errno::AGAIN) if !wait => return Ok(false),
                Err(Errno::INTR) => {}
                Err(_) => return Err(GoneRank(self.with)),
            }
        }
        Ok(true)
    }
}

/// An incoming frame.
pub struct Coming<'a> {
    with: usize,
    socket: &'a UnixStream,
    wanted: [u8; HEAD],
    head: [u8; HEAD],
    bytes: &'a mut [u8],
    /// Number of bytes received, including the header.
    done: usize,
}

impl<'a> Coming<'a> {
    /// A frame of this kind that fills the buffer, from a rank at the other end of this socket.
    pub fn new(with: usize, socket: &'a UnixStream, kind: Kind, bytes: &'a mut [u8]) -> Self {
        Self { with, socket, wanted: head(kind, bytes.len()), head: [0; HEAD], bytes, done: 0 }
    }

    fn left(&self) -> usize {
        HEAD + self.bytes.len() - self.done
    }

    /// Receives what the socket has, and with `wait` everything; returns whether all has been received. A
    /// frame of another kind or length is a bug in this program, and ends it.
    ///
    /// # Errors
    /// The other rank is lost.
    pub fn receive(&mut self, wait: bool) -> Result<bool, GoneRank> {
        let flags = if wait { RecvFlags::WAITALL } else { RecvFlags::DONTWAIT };
        while self.left() > 0 {
            let mut pieces = [
                IoSliceMut::new(&mut self.head[self.done.min(HEAD)..]),
                IoSliceMut::new(&mut self.bytes[self.done.saturating_sub(HEAD)..]),
            ];
            match recvmsg(self.socket, &mut pieces, &mut RecvAncillaryBuffer::default(), flags) {
                Ok(came) if came.bytes == 0 => return Err(GoneRank(self.with)),
                Ok(came) => self.done += came.bytes,
                Err(Errno::AGAIN) if !wait => return Ok(false),
                Err(Errno::INTR) => {}
                Err(_) => return Err(GoneRank(self.with)),
            }
            let (with, head) = (self.with, self.head);
            assert!(
                self.done < HEAD || head == self.wanted,
                "rank {with} sends frame {head:?} where {:?} is agreed",
                self.wanted
            );
        }
        Ok(true)
    }
}

/// Sends and receives all of these frames; of two frames with one rank the first comes first.
///
/// # Errors
/// A rank is lost.
pub fn swap(out: &mut [Going], into: &mut [Coming]) -> Result<(), GoneRank> {
    loop {
        let before = left(out, into);
        let mut waiting: Vec<usize> = vec![];
        for frame in &mut *out {
            if waiting.contains(&frame.with) || !frame.send(false)? {
                waiting.push(frame.with);
            }
        }
        if waiting.is_empty() {
            // No rank waits for this one any more: it may wait for one after the other.
            return into.iter_mut().try_for_each(|frame| frame.receive(true).map(drop));
        }
        waiting.clear();
        for frame in &mut *into {
            if waiting.contains(&frame.with) || !frame.receive(false)? {
                waiting.push(frame.with);
            }
        }
        if left(out, into) == before {
            wait(out, into);
        }
    }
}

/// The number of bytes not yet sent or received.
fn left(out: &[Going], into: &[Coming]) -> usize {
    out.iter().map(Going::left).chain(into.iter().map(Coming::left)).sum()
}

/// Waits until a socket accepts or has data.
fn wait(out: &[Going], into: &[Coming]) {
    let sending = out.iter().filter(|frame| frame.left() > 0).map(|f| PollFd::new(f.socket, PollFlags::OUT));
    let taking = into.iter().filter(|frame| frame.left() > 0).map(|f| PollFd::new(f.socket, PollFlags::IN));
    let mut sockets: Vec<PollFd> = sending.chain(taking).collect();
    // Whatever ends the wait, including a signal: all sockets are tried again.
    let _ = poll(&mut sockets, None);
}
