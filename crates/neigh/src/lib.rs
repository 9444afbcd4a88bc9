//! Which particles are near each other: cell grids and neighbour lists.
//!
//! The types that matter most: [`list::Wanted`], how far pairs of types reach; [`list::Pair`], two particles and the image that meets;
//! [`tiles::Tiles`], points in the order of blocks of cells that threads share. It knows columns of numbers, no world and no law.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod grid;
pub mod list;
pub mod tiles;
