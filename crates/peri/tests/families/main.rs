//! Peridynamic families on raw arrays: golden numbers, layouts against each other, patch tests, determinism.
#![allow(clippy::unwrap_used)] // a test fails by panicking

mod cauchy;
mod criteria;
mod cuts;
mod endurance;
mod flying;
mod freed;
mod golden;
mod kinematics;
mod lanes;
mod lattices;
mod layouts;
mod limits;
mod near;
mod patch;
#[cfg(unix)]
mod ranks;
mod released;
mod scene;
mod slackest;
mod softening;
mod squeezed;
mod states;
mod strengths;
mod textbook;
#[path = "../../../../tests/common/threads.rs"]
mod threads;
mod tiles;
mod warm;
mod waves;
