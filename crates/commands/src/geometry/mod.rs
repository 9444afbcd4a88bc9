//! Bodies from files: what `read_mesh`, `read_points` and `read_voxels` share, and their readers.

pub mod enter;
pub mod file;
pub mod mesh;
pub mod numbers;
pub mod points;
pub mod rows;
pub mod voxels;
mod vtk_tags;
pub mod vtk_xml;
pub mod words;
