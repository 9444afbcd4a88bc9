//! The subcommand `translate`: a deck of LIGGGHTS as a native one.

use super::args::{Deck, Usage};
use super::{FAILED, OK, deck, show};
use clap::ValueEnum;
use perigrain_base::diag::{Result, Sources};
use perigrain_liggghts::{Rewritten, Target, rewrite};
use perigrain_output::file::trouble;
use std::path::{Path, PathBuf};

/// Whose words the new deck has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Words {
    /// perigrain's
    #[default]
    Perigrain,
    /// Those of LAMMPS, as far as it has any
    Lammps,
}

/// The deck, and where the new one goes.
#[derive(Clone, Debug, PartialEq, Eq, clap::Args)]
pub struct Wanted {
    /// The new deck's file; without it the text goes to standard output
    #[arg(long = "o", value_name = "OUT", value_hint = clap::ValueHint::FilePath)]
    out: Option<PathBuf>,
    /// Whose words it has
    #[arg(long, value_enum, default_value_t)]
    to: Words,
    /// The deck; `-` is standard input
    #[arg(value_name = "IN", value_hint = clap::ValueHint::FilePath)]
    deck: PathBuf,
}

/// Rewrites the deck; the exit code shows whether all of it has a counterpart.
///
/// # Errors
/// An output file that is the deck itself.
pub fn perform(wanted: &Wanted) -> std::result::Result<u8, Usage> {
    if wanted.out.as_ref().is_some_and(|out| *out == wanted.deck) {
        return Err(
            Usage::new("the new deck would replace the old one").help("name another file behind `-o`")
        );
    }
    let mut sources = Sources::default();
    Ok(match one(wanted, &mut sources) {
        Ok(new) => {
            deck::print(&new.problems, &sources);
            if new.problems.has_errors() || new.lost > 0 { FAILED } else { OK }
        }
        Err(problems) => {
            deck::print(&problems, &sources);
            FAILED
        }
    })
}

fn one(wanted: &Wanted, sources: &mut Sources) -> Result<Rewritten> {
    let from = match wanted.deck.as_os_str() == "-" {
        true => Deck::Stdin,
        false => Deck::File(wanted.deck.clone()),
    };
    let (name, text) = deck::read(&from)?;
    let file = sources.add(name, text.as_str());
    let target = match wanted.to {
        Words::Perigrain => Target::Perigrain,
        Words::Lammps => Target::Lammps,
    };
    let new = rewrite(&text, file, target);
    // A deck with mistakes makes no new one.
    if !new.problems.has_errors() {
        match &wanted.out {
            Some(path) => write(path, &new.text)?,
            None => show(&new.text),
        }
    }
    Ok(new)
}

fn write(path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text).map_err(|e| trouble("write", path, &e).into())
}
