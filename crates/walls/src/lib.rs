//! Fixes that are walls for grains, and surfaces with what moves them and counts through them; the table of fixes has a line
//! for each.

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod elapsed;
pub mod massflow_mesh;
pub mod move_mesh;
pub mod shared;
pub mod surface;
pub mod wall;

pub(crate) use perigrain_styles::fix::{Counted, Fix, FixStyle, options};
pub(crate) use shared::{RegionId, needs_spheres};
