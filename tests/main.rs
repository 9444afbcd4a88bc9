//! Tests that need the program or the whole library, in one binary.
#![allow(clippy::unwrap_used)] // a test fails by panicking

#[path = "additions/main.rs"]
mod additions;
mod at_hand;
mod bench;
mod bonded;
mod bytes;
#[path = "checks.rs"]
mod checks;
mod cli;
#[path = "common/compare.rs"]
mod compare;
#[path = "computes/main.rs"]
mod computes;
#[path = "data/main.rs"]
mod data;
#[path = "common/decks.rs"]
mod decks;
mod disk;
#[path = "dumps/main.rs"]
mod dumps;
mod english;
mod examples;
mod fatigue;
mod found;
mod fuzz_loop;
#[path = "geometry/main.rs"]
mod geometry;
#[path = "grains/main.rs"]
mod grains;
mod heat;
mod impact;
mod inserting;
#[path = "installed_decks/main.rs"]
mod installed_decks;
mod interrupts;
#[path = "lammps.rs"]
mod lammps;
#[path = "liggghts/main.rs"]
mod liggghts;
mod liggghts_laws;
mod lsp;
mod meshes;
mod partitions;
#[path = "peri/main.rs"]
mod peri;
mod plans;
mod prompt;
#[cfg(unix)]
#[path = "common/pty.rs"]
mod pty;
#[path = "common/random.rs"]
mod random;
mod ranks;
mod release;
mod report;
#[path = "restart/main.rs"]
mod restart;
mod rooms;
mod runaway;
mod safe;
#[path = "scripts.rs"]
mod scripts;
mod staggered;
mod statics;
#[path = "strangers/main.rs"]
mod strangers;
#[path = "stress/main.rs"]
mod stress;
#[path = "surfaces/main.rs"]
mod surfaces;
mod sweep;
mod swinging;
mod terminal;
#[path = "common/threads.rs"]
mod threads;
mod verify;
mod workers;
