//! LAMMPS' thermo text: columns, rows and the text around a run, so that existing log readers work.

mod finish;
mod keywords;
mod layout;

pub use finish::{Finish, Section, memory_line, ops_table, wall_time};
pub use keywords::{KEYWORDS, Keyword, keyword};
pub use layout::{Column, Layout, Line};

pub use super::formats::Kind;
