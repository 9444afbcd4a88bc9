//! VTK XML files of any data set type: surfaces here; meshes and images in `geometry`, where particles are
//! made of them.

pub mod appended;
pub mod numbers;
mod tags;
pub mod xml;
