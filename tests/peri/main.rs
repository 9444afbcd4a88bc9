//! Peridynamic families on raw arrays: golden numbers, layouts against each other, patch tests, determinism.

mod golden;
mod layouts;
mod patch;
mod scene;
mod textbook;
