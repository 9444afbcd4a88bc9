//! Dumps: snapshots of particles in files; one file each, one line each in [`DUMPS`].

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

mod attribute;
mod base;
mod columns;
mod forms;
mod image;
mod legacy;
mod local;
mod mesh;
mod movie;
mod packed;
mod picture;
mod text;
mod vtk;

pub use image::auto_diameter;
pub use perigrain_styles::dump::{Dump, DumpStyle};
use perigrain_styles::words::{Form, Words};

/// What stands before the keywords of `dump_modify`.
const MODIFY: &str = "dump_modify ID";

/// The keywords of `dump_modify` that all dumps have, and those that dumps of particles have.
pub const MODIFIED: [Form; 2] =
    [Form::headed(MODIFY, base::Common::GRAMMAR), Form::headed(MODIFY, base::OfParticles::GRAMMAR)];

/// Every dump style.
#[rustfmt::skip]
pub const DUMPS: &[&dyn DumpStyle] = &[
    &text::Atom,
    &packed::ATOM,
    &forms::Cfg,
    &packed::CFG,
    &text::Custom,
    &packed::CUSTOM,
    &image::Image,
    &local::Local,
    &packed::LOCAL,
    &mesh::MeshStl,
    &mesh::MeshVtk,
    &movie::Movie,
    &vtk::Vtk,
    &forms::Xyz,
    &packed::XYZ,
    &forms::Yaml,
];
