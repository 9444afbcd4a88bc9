//! Memory requests that depend on input: they are forecast, compared with free memory, and refused by name.
//!
//! A count given by a deck, a file or a command line passes [`lacking`] (or `Args::count`, which calls it)
//! before anything of its size is allocated. Behind this check, the program's allocator, [`Fence`], handles
//! requests that no forecast covered: it ends the program with the line of the deck.

mod fence;
mod free;

use crate::comm;
use crate::diag::{Code, Diagnostic};
use crate::gate;
use crate::stop::Heeding;
pub use fence::{Fence, at, reads, speaks};
pub(crate) use fence::{limit, limited};
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result};

/// Smaller requests are not checked [byte].
const SMALL: f64 = 1e6;

/// The error for a request of more bytes than are free.
pub fn lacking(bytes: f64, what: &str) -> Option<Diagnostic> {
    if bytes <= SMALL {
        return None;
    }
    let free = room().filter(|free| bytes > *free)?;
    let text = format!("{what} would need {} of memory; {} are free", size(bytes), size(free));
    let error = Diagnostic::error(Code::TOO_LARGE, None, text);
    Some(if gate::limits().is_some() { error.help("`-limit memory MB` allows more") } else { error })
}

/// Like [`lacking`], for a request by each of several ranks: ranks on one machine share its free memory. All
/// ranks call it together and get the same answer.
/// the same answer.
pub fn lacking_on_ranks(bytes: f64, what: &str) -> Option<Diagnostic> {
    if !comm::several() || bytes <= SMALL {
        return lacking(bytes, what);
    }
    let ranks = comm::present();
    let (hosts, size_of) = (comm::nodes(&*ranks), ranks.size());
    let mut rooms = vec![f64::NEG_INFINITY; 2 * size_of];
    rooms[ranks.rank()] = free::shared().unwrap_or(f64::INFINITY);
    rooms[size_of + ranks.rank()] = room().unwrap_or(f64::INFINITY);
    ranks.most(&mut rooms);
    let (shared, own) = rooms.split_at(size_of);
    let (host, beside, free) = short(bytes, &hosts, shared, own)?;
    let all = size(bytes * beside as f64);
    let of = if beside == 1 { "a rank".into() } else { format!("{beside} ranks with {} each", size(bytes)) };
    let text =
        format!("{what} would need {all} of memory on {host}, for {of}; {} are free there", size(free));
    let error = Diagnostic::error(Code::TOO_LARGE, None, text);
    Some(
        error.help(
            "each rank has all particles: start one on each machine, with as many threads as it has cores",
        ),
    )
}

/// A machine whose ranks do not fit into its free memory, together or each, with their number and the free
/// memory.
fn short<'a>(bytes: f64, hosts: &'a [String], shared: &[f64], own: &[f64]) -> Option<(&'a str, usize, f64)> {
    if let Some(rank) = own.iter().position(|room| bytes > *room) {
        return Some((&hosts[rank], 1, own[rank]));
    }
    let of = |host: &String| {
        let free = hosts.iter().zip(shared).filter(|(h, _)| *h == host).map(|(_, room)| *room);
        (free.clone().count(), free.fold(f64::INFINITY, f64::min))
    };
    hosts.iter().find_map(|host| {
        let (beside, free) = of(host);
        (bytes * beside as f64 > free).then_some((host.as_str(), beside, free))
    })
}

/// Bytes that may still be allocated, if the system reports them: the minimum over the machine, the process
/// limits and `-limit memory`.
pub fn room() -> Option<f64> {
    free::bytes().into_iter().chain(gate::memory_left()).reduce(f64::min)
}

/// Bytes of memory used by the program, if the system reports them.
pub fn resident() -> Option<f64> {
    free::resident()
}

/// Appends the contents of a file to `bytes`.
///
/// # Errors
/// System errors, and too little memory.
pub fn read_file(file: File, bytes: &mut Vec<u8>) -> Result<()> {
    let length = file.metadata().map_or(0, |m| m.len());
    if let Some(d) = lacking(length as f64, "what is in it") {
        return Err(Error::new(ErrorKind::OutOfMemory, d.message));
    }
    bytes.reserve_exact((length as usize).saturating_add(1));
    read_all(file, bytes)
}

/// Appends everything a reader returns to `bytes`: the size of compressed files is not known in advance.
///
/// # Errors
/// Errors of the reader, and too little memory.
pub fn read_all(reader: impl Read, bytes: &mut Vec<u8>) -> Result<()> {
    let ready = bytes.capacity() - bytes.len();
    // Half of the free memory: a growing vector may need its old and new buffer at the same time.
    let most = (room().map_or(f64::INFINITY, |room| room / 2.0) + ready as f64).min(u64::MAX as f64) as u64;
    let read = Heeding(reader).take(most).read_to_end(bytes)? as u64;
    if read == most {
        let text =
            format!("what is in it does not fit into the {} of memory that are free", size(most as f64));
        return Err(Error::new(ErrorKind::OutOfMemory, text));
    }
    Ok(())
}

/// A number of bytes for messages.
fn size(bytes: f64) -> String {
    match bytes {
        b if b < 1e8 => format!("{:.1} MB", b / 1e6),
        b if b < 1e15 => format!("{:.1} GB", b / 1e9),
        b => format!("{:.1e} GB", b / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_and_what_does_is_not() {
        let lack = lacking(1e18, "a table").unwrap();
        assert!(lack.message.starts_with("a table would need 1.0e9 GB of memory; "), "{}", lack.message);
        assert_eq!(lack.code, Code::TOO_LARGE);
        assert!(lacking(1000.0, "a row").is_none() && lacking(f64::INFINITY, "all").is_some());
        let hosts = ["a", "a", "b"].map(String::from);
        let short = |shared, own| short(4.0, &hosts, shared, own);
        assert_eq!(short(&[9.0, 8.0, 4.0], &[4.0; 3]), None);
        assert_eq!(short(&[9.0, 7.0, 9.0], &[7.0; 3]), Some(("a", 2, 7.0)));
        assert_eq!(short(&[9.0, 9.0, 3.0], &[9.0; 3]), Some(("b", 1, 3.0)));
        assert_eq!(short(&[9.0; 3], &[9.0, 3.0, 9.0]), Some(("a", 1, 3.0)));
        let mut bytes = vec![];
        read_all(&b"text"[..], &mut bytes).unwrap();
        assert_eq!(bytes, b"text");
    }
}
