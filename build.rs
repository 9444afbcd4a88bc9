//! Gives the program its target and, in release builds, the commit that it was built from: `perigrain -version` prints both.
//!
//! Debug builds carry no commit: it would have the program and all its tests compiled again after every commit.

use std::path::{Path, PathBuf};
use std::process::Command;

/// `git archive` writes commit and date into this file: a source archive has no `.git`.
const ARCHIVED: &str = "src/commit.txt";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=PERIGRAIN_TARGET={}", variable("TARGET"));
    let commit = if variable("PROFILE") == "release" { commit() } else { String::new() };
    println!("cargo::rustc-env=PERIGRAIN_COMMIT={commit}");
}

fn variable(name: &str) -> String {
    std::env::var(name).unwrap_or_default()
}

/// Short hash and date, from a source archive or from git; empty where neither has them.
fn commit() -> String {
    println!("cargo::rerun-if-changed={ARCHIVED}");
    let archived = std::fs::read_to_string(ARCHIVED).unwrap_or_default();
    if !archived.starts_with("$Format") {
        return archived.trim().into();
    }
    // A copy without a repository of its own may lie inside another one.
    if !Path::new(".git").exists() {
        return String::new();
    }
    moved_with_commits().iter().for_each(|file| println!("cargo::rerun-if-changed={}", file.display()));
    git(&["log", "-1", "--format=%h %cs", "--abbrev=9"]).unwrap_or_default()
}

/// Those files of git that change when another commit is checked out or made. A file that is missing would have cargo run this each time.
fn moved_with_commits() -> Vec<PathBuf> {
    let branch = git(&["symbolic-ref", "--quiet", "HEAD"]);
    let names = ["HEAD", "logs/HEAD", "packed-refs"].into_iter().chain(branch.as_deref());
    let paths = names.filter_map(|name| git(&["rev-parse", "--git-path", name]));
    paths.map(PathBuf::from).filter(|path| path.exists()).collect()
}

/// What git prints, if it succeeds.
fn git(words: &[&str]) -> Option<String> {
    let output = Command::new("git").args(words).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_string())
}
