//! Neighbour search: cell grids and neighbour lists.
//!
//! Main types: [`list::Wanted`], the reach of pairs of types; [`list::Pair`], two particles and a periodic
//! image; [`tiles::Tiles`], points in the order of blocks of cells that threads share. The crate works on
//! columns of numbers and depends on neither the world nor contact laws.

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod grid;
pub mod list;
pub mod tiles;
