//! Decks with a description at their head: lines that begin with `#|` together are a TOML document; for the deck they are
//! comments.

use serde::de::DeserializeOwned;

/// Reads a deck's first lines.
///
/// # Errors
/// What is wrong with them.
pub fn read<T: DeserializeOwned>(name: &str, deck: &str) -> Result<T, String> {
    let head: Vec<&str> = deck.lines().filter_map(|line| line.strip_prefix("#|")).collect();
    toml::from_str(&head.join("\n")).map_err(|e| format!("{name}: {e}"))
}

/// What stands at the head of such a deck.
pub trait Headed: Sized {
    /// Reads it from a deck of this name.
    ///
    /// # Errors
    /// What is wrong with the first lines.
    fn read(name: &str, deck: &str) -> Result<Self, String>;
    /// The deck's name.
    fn name(&self) -> &str;
    /// What it is for, a line.
    fn title(&self) -> &str;
}

/// The decks (name and text) whose name or title holds a text, whatever its case; all for an empty one.
///
/// # Errors
/// A deck whose first lines cannot be read.
pub fn chosen<T: Headed>(decks: &[(&str, &str)], text: &str) -> Result<Vec<T>, String> {
    let wanted = text.to_lowercase();
    let holds =
        |case: &T| [case.name(), case.title()].iter().any(|words| words.to_lowercase().contains(&wanted));
    let all: Result<Vec<T>, String> = decks.iter().map(|(name, deck)| T::read(name, deck)).collect();
    Ok(all?.into_iter().filter(holds).collect())
}

/// The deck without the lines that are read here.
pub fn without(deck: &str) -> String {
    let rest: Vec<&str> = deck.lines().filter(|line| !line.starts_with("#|")).collect();
    rest.join("\n").trim().to_string() + "\n"
}
