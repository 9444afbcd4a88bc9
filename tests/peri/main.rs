//! Peridynamic families on raw arrays: golden numbers, layouts against each other, patch tests, determinism.

mod bond_weights;
mod endurance;
mod golden;
mod lattices;
mod layouts;
mod limits;
mod patch;
mod released;
mod scatter;
mod scene;
mod softening;
mod states;
mod textbook;
mod waves;
