//! Grains against closed forms and published test cases, as decks: impacts, restitution, rolling, cooling.
#![allow(clippy::unwrap_used)] // a test fails by panicking

mod cooling;
mod impacts;
mod oblique;
mod restitution;
mod rolling;
mod scene;
