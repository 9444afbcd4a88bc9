//! Any MPI library, loaded at run time: neither built nor linked against.
//!
//! MPI errors end the job, as with the default handler.

mod abi;
mod library;
mod mail;

use super::{Comm, Error, Gone};
use abi::Constants;
use library::{Functions, Library};
use mail::Mail;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// An MPI handle: a pointer, or an `int` in the low half where the calling convention expects it (x86-64 and
/// aarch64, at most eight arguments).
type Handle = usize;

/// Largest number of bytes per call; counts are C's `int`.
const PIECE: usize = 1 << 30;

/// `MPI_Isend` and `MPI_Irecv`.
type Message = unsafe extern "C" fn(*mut c_void, c_int, Handle, c_int, c_int, Handle, *mut c_void) -> c_int;

/// Tag of messages between partners.
const TAG: c_int = 7;

/// A rank of an MPI job.
pub struct Mpi {
    f: Functions,
    c: Constants,
    version: String,
    rank: usize,
    size: usize,
    /// A separate communicator for the meeting at the end: a rank that waits elsewhere must not count as
    /// arrived.
    last: Handle,
    mail: Mutex<Mail>,
}

impl Mpi {
    /// Loads a library and joins the ranks of the job.
    ///
    /// # Errors
    /// No library, or one that lacks a function or supports calls by a single thread only.
    pub fn open() -> Result<Self, Error> {
        let Library { f, constants: c, .. } = library::find()?;
        let version = version(&f);
        let mut granted = 0;
        // SAFETY: no arguments are passed, and the last one is written.
        let failed = unsafe {
            (f.MPI_Init_thread)(std::ptr::null_mut(), std::ptr::null_mut(), c.serialized, &mut granted)
        };
        if failed != 0 {
            return Err(Error::Init(version, failed));
        }
        if granted < c.serialized {
            return Err(Error::OneThread(version));
        }
        let (mut rank, mut size, mut last) = (0, 0, 0);
        // SAFETY: each call writes its last argument.
        unsafe {
            (f.MPI_Comm_rank)(c.world, &mut rank);
            (f.MPI_Comm_size)(c.world, &mut size);
            (f.MPI_Comm_dup)(c.world, &mut last);
        }
        let mail = Mutex::new(Mail::of(size as usize));
        keep_to_itself("PMI_FD");
        let mpi = Self { f, c, version, rank: rank as usize, size: size as usize, last, mail };
        mpi.proves_itself()?;
        Ok(mpi)
    }

    /// Checks that the constants fit the library; wrong ones would produce wrong numbers later.
    fn proves_itself(&self) -> Result<(), Error> {
        let (n, me) = (self.size, self.rank);
        let mut sum = [1i64, me as i64];
        self.sum(&mut sum);
        let mut most = [me as f64, -(me as f64)];
        self.most(&mut most);
        let (right, left) = ((me + 1) % n, (me + n - 1) % n);
        let mut came = [0u8; 8];
        self.swap(&[(right, &(me as u64).to_le_bytes())], &mut [(left, &mut came)]);
        let right = sum == [n as i64, (n * (n - 1) / 2) as i64]
            && most == [(n - 1) as f64, 0.0]
            && u64::from_le_bytes(came) == left as u64;
        if right { Ok(()) } else { Err(Error::Unknown(self.version.clone())) }
    }
}

/// Programs started by this rank must not inherit the launcher's socket, whose number is in a variable: one
/// that outlives a rank would hide the rank's end from the launcher.
fn keep_to_itself(variable: &str) {
    let Some(fd) = std::env::var(variable).ok().and_then(|fd| fd.parse::<c_int>().ok()) else { return };
    // SAFETY: changes a flag of a file; fails if there is none with this number.
    unsafe { libc::fcntl(fd, libc::F_SETFD, libc::FD_CLOEXEC) };
}

/// The library's own name for itself.
fn version(f: &Functions) -> String {
    // The standard's MPI_MAX_LIBRARY_VERSION_STRING is 8192.
    let (mut text, mut length) = (vec![0u8; 2 * 8192], 0);
    // SAFETY: the library writes at most that many bytes and a zero.
    unsafe { (f.MPI_Get_library_version)(text.as_mut_ptr().cast::<c_char>(), &mut length) };
    let text =
        CStr::from_bytes_until_nul(&text).map(|t| t.to_string_lossy().into_owned()).unwrap_or_default();
    // MPICH pads the line with tabs, Open MPI appends where it was built.
    let line = text.lines().next().unwrap_or_default();
    line.split(',').next().unwrap_or_default().split_whitespace().collect::<Vec<_>>().join(" ")
}

fn count(length: usize) -> c_int {
    debug_assert!(length <= PIECE, "pieces of messages are short");
    length as c_int
}

impl Comm for Mpi {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn library(&self) -> String {
        format!("{} ({})", self.version, self.c.abi.name())
    }

    fn swap(&self, out: &[(usize, &[u8])], into: &mut [(usize, &mut [u8])]) {
        let pieces = |length: usize| length.div_ceil(PIECE);
        let n: usize =
            out.iter().map(|o| pieces(o.1.len())).chain(into.iter().map(|i| pieces(i.1.len()))).sum();
        // Entries of eight bytes or of four, of which `used` are in use.
        let (mut requests, mut used) = (vec![0u64; n], 0);
        let table = requests.as_mut_ptr().cast::<u8>();
        let mut post = |act: Message, (piece, length): (*mut c_void, usize), partner: usize| {
            let (byte, world, partner) = (self.c.byte, self.c.world, partner as c_int);
            // SAFETY: the piece is borrowed until all requests are waited for below; there is an entry for
            // each.
            unsafe {
                act(piece, count(length), byte, partner, TAG, world, table.add(used * self.c.request).cast())
            };
            used += 1;
        };
        for (from, bytes) in into {
            for piece in bytes.chunks_mut(PIECE) {
                post(self.f.MPI_Irecv, (piece.as_mut_ptr().cast(), piece.len()), *from);
            }
        }
        for (to, bytes) in out {
            for piece in bytes.chunks(PIECE) {
                // Only read: its C argument is `const`.
                post(self.f.MPI_Isend, (piece.as_ptr().cast_mut().cast(), piece.len()), *to);
            }
        }
        // SAFETY: all requests were made above; statuses are not needed.
        unsafe { (self.f.MPI_Waitall)(count(n), table.cast(), self.c.no_statuses as *mut c_void) };
    }

    fn gather_all(&self, all: &mut [u8], counts: &[usize]) {
        let mut start = 0;
        if all.len() > PIECE {
            for (from, length) in counts.iter().enumerate() {
                self.broadcast(&mut all[start..start + length], from);
                start += length;
            }
            return;
        }
        // The address of an empty buffer equals Open MPI's "in place", which is refused here.
        if all.is_empty() {
            return;
        }
        let places: Vec<c_int> = counts
            .iter()
            .map(|length| {
                start += length;
                count(start - length)
            })
            .collect();
        let counts: Vec<c_int> = counts.iter().map(|length| count(*length)).collect();
        // SAFETY: pieces are consecutive in `all`, and this rank's is in place.
        unsafe {
            (self.f.MPI_Allgatherv)(
                self.c.in_place as *const c_void,
                0,
                self.c.byte,
                all.as_mut_ptr().cast(),
                counts.as_ptr(),
                places.as_ptr(),
                self.c.byte,
                self.c.world,
            )
        };
    }

    fn sum(&self, values: &mut [i64]) {
        for v in values.chunks_mut(PIECE / 8) {
            self.reduce(v.as_mut_ptr().cast(), v.len(), (self.c.int64, self.c.sum));
        }
    }

    fn most(&self, values: &mut [f64]) {
        for v in values.chunks_mut(PIECE / 8) {
            self.reduce(v.as_mut_ptr().cast(), v.len(), (self.c.double, self.c.max));
        }
    }

    fn broadcast(&self, bytes: &mut Vec<u8>) {
        let mut length = (bytes.len() as u64).to_le_bytes();
        self.broadcast(&mut length, 0);
        if self.rank > 0 {
            *bytes = vec![0; u64::from_le_bytes(length) as usize];
        }
        self.broadcast(bytes, 0);
    }

    fn post(&self, to: usize, letter: &[u8]) {
        self.mail.lock().unwrap_or_else(PoisonError::into_inner).post(self, to, letter);
    }

    fn letter(&self, from: usize) -> Result<Option<Vec<u8>>, Gone> {
        Ok(self.mail.lock().unwrap_or_else(PoisonError::into_inner).next(self, from))
    }

    fn posted(&self) -> bool {
        self.mail.lock().unwrap_or_else(PoisonError::into_inner).send(self)
    }

    fn meet(&self, patience: Duration) -> bool {
        let (mut request, end) = (0u64, Instant::now() + patience);
        let request: *mut c_void = (&raw mut request).cast();
        // SAFETY: the request lives until the test reports completion, or the job ends.
        unsafe { (self.f.MPI_Ibarrier)(self.last, request) };
        let mut pause = Duration::from_micros(20);
        loop {
            let mut done = 0;
            // SAFETY: the request was made above.
            unsafe { (self.f.MPI_Test)(request, &mut done, self.c.no_statuses as *mut c_void) };
            if done != 0 || Instant::now() >= end {
                return done != 0;
            }
            std::thread::sleep(pause);
            pause = (2 * pause).min(Duration::from_millis(5));
        }
    }

    fn close(&self) {
        // SAFETY: no message is in transit, because all ranks have met.
        unsafe { (self.f.MPI_Finalize)() };
    }

    fn abort(&self, code: i32) -> ! {
        // SAFETY: ends the job.
        unsafe { (self.f.MPI_Abort)(self.c.world, code) };
        std::process::exit(code)
    }
}

impl Mpi {
    /// Broadcasts one rank's bytes.
    fn broadcast(&self, bytes: &mut [u8], from: usize) {
        for piece in bytes.chunks_mut(PIECE) {
            // SAFETY: this many bytes are read on rank `from` and written elsewhere.
            unsafe {
                (self.f.MPI_Bcast)(
                    piece.as_mut_ptr().cast(),
                    count(piece.len()),
                    self.c.byte,
                    from as c_int,
                    self.c.world,
                )
            };
        }
    }

    /// Reduces the numbers of all ranks, in place.
    fn reduce(&self, values: *mut c_void, n: usize, (kind, how): (Handle, Handle)) {
        // SAFETY: there are `n` numbers of this kind at `values`.
        unsafe {
            (self.f.MPI_Allreduce)(
                self.c.in_place as *const c_void,
                values,
                count(n),
                kind,
                how,
                self.c.world,
            )
        };
    }
}
