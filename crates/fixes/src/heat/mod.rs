//! Heat in solids: conduction over bonds, and what happens at the edges of bodies.

mod boundary;
mod conducting;
mod convect;
mod flux;
mod held;
mod peri;
mod scene;

pub use convect::Convect;
pub use flux::Flux;
pub use held::HeldAt;
pub use peri::HeatPeri;

use perigrain_world::{Constant, Key, Named, World};

/// A fix that changes temperatures of its group.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mover {
    /// The bit of the group.
    pub bit: u32,
    /// Over bonds of solids; else from the heat flow of contacts.
    pub bonds: bool,
}

/// The fixes that change temperatures, by ID.
pub static MOVERS: Constant<Named<Mover>> = Constant::new("heat/movers");

/// Registers a fix that changes temperatures.
pub fn enter(w: &mut World, id: &str, mover: Mover) {
    let key = Key::new(id);
    w.facts.get_or_default(*MOVERS).insert(key, mover);
}

/// Strikes it off.
pub fn leave(w: &mut World, id: &str) {
    let key = Key::new(id);
    w.facts.get_or_default(*MOVERS).remove(key);
}
