//! Ranks on one machine, connected pairwise by sockets: processes started by the first rank, or threads of a
//! test.
//!
//! Data on a socket is sent in frames: a kind, a length, the bytes. The kind reveals ranks that call
//! different operations.

use super::mail::Mail;
use super::swap::{self, Coming, Going, GoneRank};
use super::{Comm, Error, Gone, lost};
use std::io::{ErrorKind, Read, Write};
use std::os::fd::{AsRawFd, FromRawFd, RawFd};
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command};
use std::sync::Mutex;
use std::sync::PoisonError;
use std::time::{Duration, Instant};

/// Variable that defines the place of a started process: its rank, the number of ranks, and a socket for
/// each.
pub(super) const SEAT: &str = "PERIGRAIN_SEAT";

/// Size of a frame header: kind and length.
pub(super) const HEAD: usize = 9;

/// The operation a frame belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Kind {
    Swap = 1,
    Gather,
    Sum,
    Most,
    Broadcast,
    Meet,
    Letter,
}

/// A rank's sockets by rank; `None` for itself.
type Sockets = Vec<Option<UnixStream>>;

/// A rank on the same machine as the others.
pub struct Local {
    rank: usize,
    sockets: Sockets,
    /// Letters to and from each rank.
    mail: Mutex<Vec<Mail>>,
    /// Whether the ranks are processes; otherwise they are threads.
    apart: bool,
    /// The processes started by the first rank.
    children: Mutex<Vec<Child>>,
}

/// The place of a process started by [`Local::start`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seat(String);

impl Seat {
    /// The place of this process, if it was started with one.
    pub fn given() -> Option<Self> {
        std::env::var(SEAT).ok().map(Self)
    }

    /// Opens the communicator.
    ///
    /// # Errors
    /// A variable that was not set by this program.
    pub fn take(self) -> Result<Local, Error> {
        let wrong = || Error::Seat { variable: SEAT, value: self.0.clone() };
        let numbers: Option<Vec<RawFd>> = self.0.split(' ').map(|n| n.parse().ok()).collect();
        let numbers = numbers.filter(|n| n.len() > 2).ok_or_else(wrong)?;
        let (rank, sockets) = (numbers[0] as usize, &numbers[1..]);
        if rank >= sockets.len() {
            return Err(wrong());
        }
        let own = |(k, fd): (usize, &RawFd)| {
            // SAFETY: the parent process has opened the socket for this process alone; its number is used
            // once.
            (k != rank).then(|| unsafe { UnixStream::from_raw_fd(*fd) })
        };
        let sockets: Vec<_> = sockets.iter().enumerate().map(own).collect();
        for socket in sockets.iter().flatten() {
            // Programs started by a deck must not inherit it.
            inherited(socket.as_raw_fd(), false)?;
        }
        Ok(Local::new(rank, sockets, true, vec![]))
    }
}

/// Sets whether a file stays open across exec.
fn inherited(fd: RawFd, yes: bool) -> std::io::Result<()> {
    // SAFETY: changes a flag of an open file.
    let done = unsafe { libc::fcntl(fd, libc::F_SETFD, if yes { 0 } else { libc::FD_CLOEXEC }) };
    if done < 0 { Err(std::io::Error::last_os_error()) } else { Ok(()) }
}

impl Local {
    fn new(rank: usize, sockets: Sockets, apart: bool, children: Vec<Child>) -> Self {
        let mail = sockets.iter().map(|_| Mail::default()).collect();
        Self { rank, sockets, mail: Mutex::new(mail), apart, children: Mutex::new(children) }
    }

    /// Ranks for threads of this process.
    ///
    /// # Errors
    /// The system refuses to create more sockets.
    pub fn threads(size: usize) -> std::io::Result<Vec<Self>> {
        let rows = mesh(size)?;
        let seat = |(rank, sockets)| Self::new(rank, sockets, false, vec![]);
        Ok(rows.into_iter().enumerate().map(seat).collect())
    }

    /// Starts the other ranks by this command, which runs a program that takes its [`Seat`]; this process is
    /// the first rank.
    ///
    /// # Errors
    /// Processes cannot be started.
    pub fn start(size: usize, mut command: impl FnMut() -> Command) -> std::io::Result<Self> {
        let mut rows = mesh(size)?.into_iter();
        let own = rows.next().unwrap_or_default();
        let mut children = vec![];
        for (k, row) in rows.enumerate() {
            let fds: Vec<RawFd> = row.iter().flatten().map(AsRawFd::as_raw_fd).collect();
            let all = row.iter().map(|socket| socket.as_ref().map_or(-1, AsRawFd::as_raw_fd).to_string());
            let place = format!("{} {}", k + 1, all.collect::<Vec<_>>().join(" "));
            let mut command = command();
            command.env(SEAT, place).stdin(std::process::Stdio::null());
            let keep =
                move || fds.iter().try_for_each(|fd| inherited(*fd, true)).and_then(|()| die_with_parent());
            // SAFETY: only system calls between fork and exec.
            unsafe { command.pre_exec(keep) };
            children.push(command.spawn()?);
        }
        Ok(Self::new(0, own, true, children))
    }

    fn socket(&self, with: usize) -> &UnixStream {
        match self.sockets.get(with) {
            Some(Some(socket)) => socket,
            _ => panic!("rank {with} is this one, or none"),
        }
    }

    /// The other rank is lost.
    fn gone(&self, other: usize) -> ! {
        if self.apart {
            lost(self.rank, other);
        }
        panic!("rank {other} has ended")
    }

    fn send(&self, to: usize, kind: Kind, bytes: &[u8]) {
        if Going::new(to, self.socket(to), kind, bytes).send(true).is_err() {
            self.gone(to);
        }
    }

    /// Receives the header of a frame; returns its length.
    fn head(&self, from: usize, kind: Kind) -> usize {
        let (mut socket, mut head) = (self.socket(from), [0; HEAD]);
        if socket.read_exact(&mut head).is_err() {
            self.gone(from);
        }
        assert!(
            head[0] == kind as u8,
            "rank {from} sends frame {} where rank {} waits for {kind:?}",
            head[0],
            self.rank
        );
        head[1..].iter().rev().fold(0, |n, byte| n << 8 | usize::from(*byte))
    }

    fn receive(&self, from: usize, kind: Kind, bytes: &mut [u8]) {
        if Coming::new(from, self.socket(from), kind, bytes).receive(true).is_err() {
            self.gone(from);
        }
    }

    /// The first rank combines the bytes of all ranks and distributes the result.
    fn combine(&self, kind: Kind, bytes: &mut [u8], add: impl Fn(&mut [u8], &[u8])) {
        if self.rank > 0 {
            self.send(0, kind, bytes);
            return self.receive(0, kind, bytes);
        }
        let mut other = vec![0; bytes.len()];
        for from in 1..self.size() {
            self.receive(from, kind, &mut other);
            add(bytes, &other);
        }
        (1..self.size()).for_each(|to| self.send(to, kind, bytes));
    }

    /// Like [`Local::combine`], for numbers of eight bytes.
    fn numbers<T: Copy>(
        &self,
        kind: Kind,
        values: &mut [T],
        into: fn(T) -> [u8; 8],
        from: fn([u8; 8]) -> T,
        add: impl Fn(T, T) -> T,
    ) {
        let eight = |bytes: &[u8]| {
            let mut number = [0; 8];
            number.copy_from_slice(bytes);
            from(number)
        };
        let mut bytes: Vec<u8> = values.iter().flat_map(|v| into(*v)).collect();
        self.combine(kind, &mut bytes, |sum, other| {
            for (s, o) in sum.chunks_exact_mut(8).zip(other.chunks_exact(8)) {
                let both = into(add(eight(s), eight(o)));
                s.copy_from_slice(&both);
            }
        });
        values.iter_mut().zip(bytes.chunks_exact(8)).for_each(|(v, b)| *v = eight(b));
    }
}

/// A socket between each pair of ranks.
fn mesh(size: usize) -> std::io::Result<Vec<Sockets>> {
    let mut rows: Vec<Sockets> = (0..size).map(|_| (0..size).map(|_| None).collect()).collect();
    for a in 0..size {
        for b in a + 1..size {
            let (one, other) = UnixStream::pair()?;
            (rows[a][b], rows[b][a]) = (Some(one), Some(other));
        }
    }
    Ok(rows)
}

/// Makes a started process end with its parent.
#[cfg(target_os = "linux")]
fn die_with_parent() -> std::io::Result<()> {
    // SAFETY: sets the signal that this process receives when its parent ends.
    let done = unsafe { libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL) };
    if done < 0 { Err(std::io::Error::last_os_error()) } else { Ok(()) }
}

#[cfg(not(target_os = "linux"))]
fn die_with_parent() -> std::io::Result<()> {
    Ok(())
}

impl Comm for Local {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.sockets.len()
    }

    fn library(&self) -> String {
        "sockets of this machine".into()
    }

    fn swap(&self, out: &[(usize, &[u8])], into: &mut [(usize, &mut [u8])]) {
        let mut own = out.iter().filter(|(to, _)| *to == self.rank).map(|(_, bytes)| *bytes);
        let others = out.iter().filter(|(to, _)| *to != self.rank);
        let mut sent: Vec<Going> =
            others.map(|(to, bytes)| Going::new(*to, self.socket(*to), Kind::Swap, bytes)).collect();
        let mut taken = vec![];
        for (from, bytes) in into {
            match *from == self.rank {
                true => bytes.copy_from_slice(own.next().unwrap_or_default()),
                false => taken.push(Coming::new(*from, self.socket(*from), Kind::Swap, bytes)),
            }
        }
        if let Err(GoneRank(rank)) = swap::swap(&mut sent, &mut taken) {
            self.gone(rank);
        }
    }

    fn gather_all(&self, all: &mut [u8], counts: &[usize]) {
        let start = |rank: usize| counts[..rank].iter().sum::<usize>();
        if self.rank > 0 {
            // The first rank need not send back what this rank already has.
            let own = start(self.rank)..start(self.rank) + counts[self.rank];
            self.send(0, Kind::Gather, &all[own.clone()]);
            self.receive(0, Kind::Gather, &mut all[..own.start]);
            return self.receive(0, Kind::Gather, &mut all[own.end..]);
        }
        for from in 1..self.size() {
            let at = start(from);
            self.receive(from, Kind::Gather, &mut all[at..at + counts[from]]);
        }
        for to in 1..self.size() {
            self.send(to, Kind::Gather, &all[..start(to)]);
            self.send(to, Kind::Gather, &all[start(to) + counts[to]..]);
        }
    }

    fn sum(&self, values: &mut [i64]) {
        self.numbers(Kind::Sum, values, i64::to_le_bytes, i64::from_le_bytes, i64::wrapping_add);
    }

    fn most(&self, values: &mut [f64]) {
        self.numbers(Kind::Most, values, f64::to_le_bytes, f64::from_le_bytes, f64::max);
    }

    fn broadcast(&self, bytes: &mut Vec<u8>) {
        if self.rank == 0 {
            return (1..self.size()).for_each(|to| self.send(to, Kind::Broadcast, bytes));
        }
        *bytes = vec![0; self.head(0, Kind::Broadcast)];
        if self.socket(0).read_exact(bytes).is_err() {
            self.gone(0);
        }
    }

    fn meet(&self, patience: Duration) -> bool {
        let end = Instant::now() + patience;
        let greet = |to: usize| self.socket(to).write_all(&[Kind::Meet as u8; HEAD]).is_ok();
        let mut met = true;
        if self.rank > 0 {
            return greet(0) && self.greeted(0, end);
        }
        for from in 1..self.size() {
            met &= self.greeted(from, end);
        }
        for to in 1..self.size() {
            met &= !met || greet(to);
        }
        met
    }

    fn post(&self, to: usize, letter: &[u8]) {
        let mut mail = self.mail.lock().unwrap_or_else(PoisonError::into_inner);
        mail[to].post(self.socket(to), letter);
    }

    fn letter(&self, from: usize) -> Result<Option<Vec<u8>>, Gone> {
        // A rank that waits for a letter also progresses its own: the other rank may be waiting for one of
        // them.
        self.posted();
        let mut mail = self.mail.lock().unwrap_or_else(PoisonError::into_inner);
        mail[from].next(self.socket(from))
    }

    fn posted(&self) -> bool {
        let mut mail = self.mail.lock().unwrap_or_else(PoisonError::into_inner);
        let others = mail.iter_mut().zip(&self.sockets);
        others.filter_map(|(mail, socket)| Some(mail.send(socket.as_ref()?))).fold(true, |all, one| all & one)
    }

    fn close(&self) {
        for child in self.children.lock().unwrap_or_else(PoisonError::into_inner).iter_mut() {
            // All ranks have met: it ends by itself.
            let _ = child.wait();
        }
    }

    fn abort(&self, code: i32) -> ! {
        for child in self.children.lock().unwrap_or_else(PoisonError::into_inner).iter_mut() {
            // A process that has ended needs no signal.
            let _ = child.kill();
            let _ = child.wait();
        }
        if !self.apart {
            panic!("rank {} ends all with {code}", self.rank);
        }
        std::process::exit(code)
    }
}

impl Local {
    /// Whether the other rank calls [`Comm::meet`] before this time; `false` if it sends anything else.
    fn greeted(&self, from: usize, end: Instant) -> bool {
        let mut socket = self.socket(from);
        loop {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() || socket.set_read_timeout(Some(left)).is_err() {
                return false;
            }
            let mut head = [0; HEAD];
            match socket.read_exact(&mut head) {
                Ok(()) if head == [Kind::Meet as u8; HEAD] => return true,
                Ok(()) => return false,
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                Err(_) => return false,
            }
        }
    }
}

#[cfg(test)]
#[path = "local_tests.rs"]
mod tests;
