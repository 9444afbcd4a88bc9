//! Bodies on lattices shared out to ranks: which rank sweeps which tiles, what is handed over, what all agree upon.

mod agreed;
pub(crate) mod deal;
pub(crate) mod dues;
pub(crate) mod list;
mod near;
mod whole;

pub(crate) use agreed::{
    Agreed, LIST, agree, agreed, agreed_motion, broken_everywhere, forget_flags, rows_everywhere, square,
    squeezed_everywhere,
};
pub(crate) use near::{pairs_everywhere, sums_everywhere};
