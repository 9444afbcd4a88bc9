//! The subcommand `new`: a small deck that runs as it is, with comments on what to change.

use super::args::Usage;
use super::show;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// What a new deck computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Kind {
    /// A peridynamic plate with a notch, pulled apart
    #[default]
    Crack,
    /// Grains that are poured into a cup
    Pour,
    /// An agglomerate of bonded spheres that breaks on a plate
    Bonded,
}

impl Kind {
    fn deck(self) -> &'static str {
        match self {
            Kind::Crack => include_str!("starters/crack.in"),
            Kind::Pour => include_str!("starters/pour.in"),
            Kind::Bonded => include_str!("starters/bonded.in"),
        }
    }
}

/// Writes the deck, never over a file that is there.
///
/// # Errors
/// A file that is there already or cannot be made.
pub fn write(file: &Path, kind: Kind) -> Result<(), Usage> {
    let made = std::fs::File::create_new(file).and_then(|mut f| f.write_all(kind.deck().as_bytes()));
    let name = file.display();
    match made {
        Ok(()) => show(&format!("run it: perigrain {name}\n")),
        Err(e) if e.kind() == ErrorKind::AlreadyExists => {
            return Err(Usage::new(format!("`{name}` is there already")).help("name another file"));
        }
        Err(e) => return Err(Usage::new(format!("cannot write `{name}`: {e}"))),
    }
    Ok(())
}
