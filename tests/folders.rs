//! Tests that change the working folder, which belongs to the whole process.
#![allow(clippy::unwrap_used)] // a test fails by panicking

mod book;
mod docs;
#[path = "fixes/main.rs"]
mod fixes;
mod manual;
#[path = "common/pages.rs"]
mod scene;
#[path = "common/threads.rs"]
mod threads;
#[path = "tilted/main.rs"]
mod tilted;
mod words;

use std::sync::{Mutex, MutexGuard, PoisonError};

static FOLDER: Mutex<()> = Mutex::new(());

/// Held while the working folder is another one: relative file names refer to it.
fn folder() -> MutexGuard<'static, ()> {
    FOLDER.lock().unwrap_or_else(PoisonError::into_inner)
}
