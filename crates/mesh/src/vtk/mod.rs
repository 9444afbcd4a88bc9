//! VTK's XML files, whatever data set they hold: surfaces here, meshes and images where particles are made of them.

pub mod appended;
pub mod numbers;
mod tags;
pub mod xml;
