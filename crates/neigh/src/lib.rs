//! Who is near whom: cell grids, neighbour lists, peridynamic families.

pub mod grid;
pub mod list;
pub mod slabs;
