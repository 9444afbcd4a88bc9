//! Commands that act on the world once, in order: one file each, one line each in [`COMMANDS`].
//!
//! They know no fix, no compute and no force.

// Units stand in brackets in doc comments, as [length]; they are no links.
#![allow(rustdoc::broken_intra_doc_links)]

mod angle_style;
mod atom_modify;
mod atom_style;
mod boundary;
mod change_box;
mod clump;
mod comm_modify;
pub mod create_atoms;
mod create_bonds;
mod create_box;
pub mod data;
mod delete_atoms;
mod delete_bonds;
mod dimension;
mod displace_atoms;
mod group;
mod lattice;
mod mass;
mod material;
mod min_modify;
mod min_style;
mod mixture;
mod molecule;
pub mod momentum;
mod neigh_modify;
mod neighbor;
mod newton;
pub mod peri_crack;
mod processors;
mod read_data;
pub mod read_dump;
mod read_mesh;
mod read_points;
mod read_voxels;
mod region;
mod replicate;
mod reset_atoms;
mod reset_timestep;
mod run_style;
mod set;
mod special_bonds;
#[cfg(test)]
mod surface_tests;
#[cfg(test)]
mod testing;
mod timestep;
mod units;
mod velocity;
mod write_data;

pub use angle_style::ANGLE_STYLES;
pub use atom_style::ATOM_STYLES;
pub use perigrain_styles::command::{Act, CommandStyle};
pub use region::SHAPES;
pub use run_style::RUN_STYLES;

/// Every command that acts.
pub const COMMANDS: &[&dyn CommandStyle] = &[
    &units::Units,
    &dimension::Dimension,
    &boundary::BoundaryCommand,
    &atom_style::AtomStyleCommand,
    &atom_modify::AtomModify,
    &newton::Newton,
    &processors::Processors,
    &comm_modify::CommModify,
    &lattice::LatticeCommand,
    &region::RegionCommand,
    &create_box::CreateBox,
    &read_data::ReadData,
    &read_dump::ReadDump,
    &read_mesh::ReadMesh,
    &read_points::ReadPoints,
    &read_voxels::ReadVoxels,
    &create_atoms::CreateAtoms,
    &group::Group,
    &set::Set,
    &delete_atoms::DeleteAtoms,
    &displace_atoms::DisplaceAtoms,
    &velocity::Velocity,
    &replicate::Replicate,
    &change_box::ChangeBox,
    &reset_atoms::ResetAtoms,
    &reset_atoms::ResetAtomIds,
    &reset_atoms::ResetMolIds,
    &mass::Mass,
    &material::MaterialStyle,
    &peri_crack::PeriCrack,
    &timestep::Timestep,
    &reset_timestep::ResetTimestep,
    &run_style::RunStyleCommand,
    &neighbor::Neighbor,
    &min_style::MinStyleCommand,
    &min_modify::MinModify,
    &neigh_modify::NeighModify,
    &write_data::WriteData,
    &create_bonds::CreateBonds,
    &delete_bonds::DeleteBonds,
    &special_bonds::SpecialBonds,
    &angle_style::AngleStyleCommand,
    &angle_style::AngleCoeff,
    &molecule::Molecule,
    &clump::ClumpCommand,
    &mixture::MixtureCommand,
];
