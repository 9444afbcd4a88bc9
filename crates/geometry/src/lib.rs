//! Bodies from files: what `read_mesh`, `read_points` and `read_voxels` share, and their readers.

pub mod body;
pub mod enter;
pub mod file;
pub mod mesh;
pub mod points;
pub mod rows;
pub mod text;
pub mod union;
pub mod voxels;
pub mod words;
