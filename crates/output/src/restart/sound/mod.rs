//! Whether a scene read from a restart file is consistent: the conditions that every loop relies on, section by section.
//!
//! A checksum detects damage, not a forged file. So nothing in the file is trusted: each length, index and cross-reference is
//! checked here, once, before anything is computed from it.

mod numbers;
mod parts;

pub use parts::stand;

use perigrain_world::World;

/// The section of a scene that does not fit, and what is the matter with it.
#[derive(Debug, PartialEq)]
pub struct Fault {
    /// The section, as a field of the scene is called.
    pub section: &'static str,
    /// What does not fit.
    pub what: String,
}

/// The result for a section.
type Outcome = Result<(), String>;

/// A fault unless all is well.
fn must(well: bool, what: &str) -> Outcome {
    if well { Ok(()) } else { Err(what.to_string()) }
}

/// Checks all sections of a scene.
///
/// # Errors
/// The first one that is inconsistent.
pub fn check(w: &World) -> Result<(), Fault> {
    let n = w.n();
    let sections: [(&'static str, Outcome); 14] = [
        ("clock", numbers::clock(w)),
        ("settings", numbers::settings(w)),
        ("box", numbers::domain(w)),
        ("lattice", must(w.lattice.is_sound(), "a length or direction of it is none")),
        ("types", numbers::types(w)),
        ("particles", parts::particles(w)),
        ("columns", must(w.columns.have(n), "a column and the particles differ in length")),
        ("groups", must(w.groups.are_sound(), "a group is made of one that cannot be")),
        ("regions", parts::regions(w)),
        ("values", must(w.slots.are_sound(), "a row of values is cut off")),
        ("neighbours", parts::rebuild(w)),
        ("bonds", parts::bonds(w)),
        ("contacts", parts::contacts(w)),
        ("families", parts::families(w)),
    ];
    for (section, outcome) in sections {
        outcome.map_err(|what| Fault { section, what })?;
    }
    Ok(())
}
