//! Who belongs to whose peridynamic family, and who comes close without belonging.

mod cells;

pub use cells::Cells;
