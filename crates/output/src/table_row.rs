//! The latest row of the step table, for dumps and programs that repeat it.

use perigrain_world::Constant;
use std::sync::Arc;

/// The latest row in the facts of a scene.
pub static LATEST_ROW: Constant<Arc<TableRow>> = Constant::new("thermo/row");

/// A row of the step table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TableRow {
    /// Its step.
    pub step: i64,
    /// The columns' usual names and the numbers.
    pub values: Vec<(String, RowValue)>,
}

/// A number of the step table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RowValue {
    /// A whole number.
    Whole(i64),
    /// Any other.
    Real(f64),
}
