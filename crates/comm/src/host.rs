//! Host names.

use super::Comm;
use std::collections::BTreeSet;

/// Longest host name that is exchanged [bytes].
const NAME: usize = 64;

/// The name of this host.
#[cfg(unix)]
pub fn host() -> String {
    let mut name = [0u8; 256];
    // SAFETY: the call writes at most this many bytes, and the last one stays zero.
    let failed = unsafe { libc::gethostname(name.as_mut_ptr().cast(), name.len() - 1) } != 0;
    let end = name.iter().position(|b| *b == 0).unwrap_or(0);
    if failed || end == 0 {
        "this machine".into()
    } else {
        String::from_utf8_lossy(&name[..end]).into_owned()
    }
}

/// The name of this host.
#[cfg(not(unix))]
pub fn host() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_else(|_| "this machine".into())
}

/// An unnamed file with these bytes.
///
/// # Errors
/// The system refuses to create it.
#[cfg(target_os = "linux")]
pub fn file_of(bytes: &[u8]) -> std::io::Result<std::fs::File> {
    use std::io::{Seek, Write};
    use std::os::fd::FromRawFd;
    // SAFETY: creates a new file in memory.
    let fd = unsafe { libc::memfd_create(c"perigrain".as_ptr(), libc::MFD_CLOEXEC) };
    if fd < 0 {
        return Err(std::io::Error::last_os_error());
    }
    // SAFETY: the file is new, and nothing else owns it.
    let mut file = unsafe { std::fs::File::from_raw_fd(fd) };
    file.write_all(bytes)?;
    file.rewind()?;
    Ok(file)
}

/// An unnamed file with these bytes.
///
/// # Errors
/// Always: reading files on several ranks is supported on Linux only.
#[cfg(not(target_os = "linux"))]
pub fn file_of(_bytes: &[u8]) -> std::io::Result<std::fs::File> {
    Err(std::io::ErrorKind::Unsupported.into())
}

/// The host name of each rank.
pub fn nodes(comm: &dyn Comm) -> Vec<String> {
    let mut all = vec![0u8; NAME * comm.size()];
    let own = host();
    let length = own.len().min(NAME);
    let at = NAME * comm.rank();
    all[at..at + length].copy_from_slice(&own.as_bytes()[..length]);
    comm.gather_all(&mut all, &vec![NAME; comm.size()]);
    let name = |piece: &[u8]| String::from_utf8_lossy(piece).trim_end_matches('\0').to_string();
    all.chunks(NAME).map(name).collect()
}

/// How many ranks there are on how many machines, in words.
pub fn describe(nodes: &[String]) -> String {
    let hosts = nodes.iter().collect::<BTreeSet<_>>().len();
    let (ranks, s) = (nodes.len(), |n: usize| if n == 1 { "" } else { "s" });
    format!("{ranks} rank{} on {hosts} host{}", s(ranks), s(hosts))
}
