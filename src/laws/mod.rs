//! Force laws as pure functions of local data, and the loops that apply them.

pub mod contact;
pub mod peri;
