//! Threads with the same bits for any number of them.
//!
//! Work is cut into parts by a rule that knows only the size of the problem, never the number of threads:
//! [`for_rows`], [`for_rows_if`], [`for_chunks`] and [`each`] where parts do not touch each other's data, [`two_colours`] where a part
//! also writes into the next one, [`ordered`] where parts write into several others, [`sum`], [`reduce`] and [`best`] where parts are added up along a fixed tree. Which thread does
//! which part may vary, the order of additions never does. All run inline on one thread or when there is only one
//! part; [`both`] does two things beside each other. [`Trial`] finds out whether threads pay.

pub mod ordered;
mod pays;
mod pool;
mod split;
mod sum;

pub use pays::Trial;
pub use pool::{
    STACK, both, for_rows, for_rows_if, in_turn, inside, most_threads, set_threads, slot, threads,
    two_colours,
};
pub use split::{Rows, Shared, Split, each, for_chunks};
pub use sum::{add, along_tree, best, max, reduce, reduce_each, sum};

/// Particles per chunk, everywhere: fixed, so that the order of additions is too.
pub const CHUNK: usize = 2048;
