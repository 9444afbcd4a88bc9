//! Peridynamic families on raw arrays: golden numbers, layouts against each other, patch tests, determinism.
#![allow(clippy::unwrap_used)] // a test fails by panicking

mod endurance;
mod golden;
mod layouts;
mod limits;
mod patch;
mod released;
mod scene;
mod states;
mod textbook;
mod waves;
