//! Decks that say at their head what they are for: lines that begin with `#|` are together a TOML document, for the deck they are
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

/// The deck without the lines that are read here.
pub fn without(deck: &str) -> String {
    let rest: Vec<&str> = deck.lines().filter(|line| !line.starts_with("#|")).collect();
    rest.join("\n").trim().to_string() + "\n"
}
