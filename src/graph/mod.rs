//! Commands as a graph of declarations, acts and runs.

pub mod keywords;
pub mod measure;
