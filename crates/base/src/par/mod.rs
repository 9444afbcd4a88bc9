//! Threads with results that are the same bits for any number of them.
//!
//! Work is divided by a rule that depends only on the size of the problem, never on the number of threads:
//! [`for_rows`], [`for_rows_if`], [`for_chunks`] and [`each`] for parts with separate data, [`two_colours`]
//! for parts that also write into the next one, [`ordered`] for parts that write into several others,
//! [`sum`], [`reduce`] and [`best`] for reductions along a fixed tree. The assignment of parts to threads may
//! vary, the order of additions does not. All of them run inline on one thread or for a single part; [`both`]
//! runs two tasks concurrently. [`Trial`] measures whether threads pay off.

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
