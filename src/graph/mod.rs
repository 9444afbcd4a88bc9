//! Commands as a graph of declarations, acts and runs.

pub mod answers;
mod bond_formulas;
pub mod bonds;
pub mod build;
pub mod catalogue;
pub mod declaration;
pub mod dumps;
pub mod dynamic;
pub mod env;
pub mod guard;
pub mod heads;
pub mod joined;
pub mod keywords;
pub mod ledger;
pub mod measure;
pub mod node;
mod offered;
pub mod ops;
pub mod pair_modify;
pub mod pairs;
pub mod pressed;
pub mod record;
pub mod regions;
pub mod restarts;
mod row;
pub mod runaway;
pub mod seal;
pub mod show;
pub mod spatial;
mod step_env;
mod texts;
pub mod thermo;
mod values;
pub mod virials;

pub use node::{ComputeNode, DumpNode, FixNode, Graph, PairNode};
pub use record::{Node, NodeId, Role};
