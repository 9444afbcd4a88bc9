//! Peridynamic families on raw arrays: golden numbers, layouts against each other, patch tests, determinism.
#![allow(clippy::unwrap_used)] // a test fails by panicking

mod endurance;
mod golden;
mod lattices;
mod layouts;
mod limits;
mod patch;
mod released;
mod scene;
mod softening;
mod states;
mod textbook;
#[path = "../../../../tests/common/threads.rs"]
mod threads;
mod waves;
