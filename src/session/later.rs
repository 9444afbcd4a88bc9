//! Variables that a deck defines after the line that names them: fixes may use them, since they read them in runs only.

use perigrain_base::diag::Sources;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The names that some `variable NAME …` of the texts read so far defines; `known` holds what was found before.
pub(super) fn defined(
    sources: &Sources,
    known: &mut (usize, Arc<BTreeSet<String>>),
) -> Arc<BTreeSet<String>> {
    for text in sources.texts().skip(known.0) {
        // Also inside of quotes: `if … then "variable x equal 1"`.
        let words = text.split(|c: char| c.is_whitespace() || matches!(c, '"' | '\''));
        let words: Vec<&str> = words.filter(|w| !w.is_empty()).collect();
        let names = words.windows(2).filter(|w| w[0] == "variable").map(|w| w[1].to_string());
        Arc::make_mut(&mut known.1).extend(names);
        known.0 += 1;
    }
    known.1.clone()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definitions_are_found_in_lines_and_in_quotes() {
        let mut sources = Sources::default();
        sources.add("a", "variable one equal 1\nif 1 then \"variable two equal 2\"\n");
        let mut known = Default::default();
        assert_eq!(defined(&sources, &mut known).iter().collect::<Vec<_>>(), ["one", "two"]);
        sources.add("b", "variable three index x");
        assert!(defined(&sources, &mut known).contains("three"));
    }
}
