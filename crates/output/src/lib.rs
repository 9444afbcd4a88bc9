//! What leaves the program: logs, tables, dumps, pictures.
//!
//! The types that matter most: [`log::Log`], [`thermo::Layout`], [`rows::Row`]. It formats and writes; it computes nothing about the
//! physics and takes plain slices and closures.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod binary;
pub mod dump;
pub mod file;
pub mod formats;
pub mod forms;
mod gzip;
pub mod image;
pub mod log;
pub mod movie;
pub mod restart;
pub mod rows;
pub mod sheet;
pub mod table;
pub mod table_row;
pub mod thermo;
pub mod vtu;

use std::sync::OnceLock;

pub use sheet::Sheet;

use perigrain_base::par;

/// Makes `n` things on all threads; they come back in order.
fn make<T: Send + Sync>(n: usize, one: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let slots: Vec<OnceLock<T>> = (0..n).map(|_| OnceLock::new()).collect();
    par::for_rows(n, |k| {
        slots[k].get_or_init(|| one(k));
    });
    slots.into_iter().filter_map(OnceLock::into_inner).collect()
}
