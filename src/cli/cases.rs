//! Cases that the program carries, chosen by a pattern.

use super::args::Usage;
use crate::heads::{self, Headed};
use perigrain_base::diag::nearest;

/// The cases of a table whose name or title holds the pattern; `list` is the command that lists all.
///
/// # Errors
/// A pattern that no case has, with the nearest name.
pub fn named<T: Headed>(decks: &[(&str, &str)], pattern: &str, list: &str) -> Result<Vec<T>, Usage> {
    let cases = heads::chosen(decks, pattern).map_err(Usage::new)?;
    if !cases.is_empty() {
        return Ok(cases);
    }
    let last = |name: &'_ str| name.rsplit_once('/').map_or(0, |(folder, _)| folder.len() + 1);
    let near = nearest(pattern, decks.iter().flat_map(|(name, _)| [*name, &name[last(name)..]]));
    let near = near.map(|name| format!("did you mean `{name}`? ")).unwrap_or_default();
    let usage = Usage::new(format!("no case has `{pattern}` in its name or title"));
    Err(usage.help(format!("{near}`{list}` lists all")))
}
