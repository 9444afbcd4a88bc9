//! Why this process cannot join others.

use thiserror::Error;

/// Why this process cannot join the other ranks.
#[derive(Debug, Error)]
pub enum Error {
    /// No MPI library can be loaded: what the loader says of each.
    #[error("{}", .0.join("; "))]
    NoLibrary(Vec<String>),
    /// A file without one of the functions of MPI.
    #[error("`{file}` has no {lacking}: it is no MPI library that perigrain knows")]
    NoMpi {
        /// Its name.
        file: String,
        /// The function.
        lacking: &'static str,
    },
    /// The library does not start.
    #[error("{0}: MPI_Init_thread fails with {1}")]
    Init(String, i32),
    /// The library does not allow calls of another thread than the first.
    #[error("{0} allows no calls by another thread than the first")]
    OneThread(String),
    /// Sums come out wrong: the constants are those of another library.
    #[error("{0} does not add up: its interface is unknown")]
    Unknown(String),
    /// A library of another kind than the launcher's, which sees a single rank in each process.
    #[error(
        "{library} is loaded, which sees {seen} rank{} where {launcher} has started {started}: it is not the launcher's \
         library", if *.seen == 1 { "" } else { "s" }
    )]
    Other {
        /// The library.
        library: String,
        /// Ranks that it sees.
        seen: usize,
        /// The launcher.
        launcher: &'static str,
        /// Ranks that the launcher has started.
        started: usize,
    },
    /// A variable of the environment that this program has not set.
    #[error("{variable} is `{value}`, which no perigrain has set")]
    Seat {
        /// Its name.
        variable: &'static str,
        /// Its value.
        value: String,
    },
    /// A socket of another rank.
    #[error("a socket to another rank: {0}")]
    Socket(#[from] std::io::Error),
    /// MPI libraries are loaded at run time on Linux only.
    #[error("MPI libraries are loaded on Linux alone")]
    NotLinux,
}
