//! Hints behind the cursor: the rest of a word that can only be one, else the syntax of what comes next.

use crate::manual::completing::complete;
use crate::manual::knowing::{self, COLON};
use crate::session::Known;
use std::path::Path;

/// Characters of a hint that are shown at most.
const LONGEST: usize = 90;

/// What stands dim behind the cursor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hint {
    /// As shown.
    pub text: String,
    /// Whether the right arrow takes it.
    pub to_take: bool,
}

/// The hint for a line with the cursor at its end.
pub fn hint(line: &str, known: &Known, folder: &Path) -> Option<Hint> {
    let begun = !line.ends_with(char::is_whitespace);
    if line.trim().is_empty() || line.contains(['#', '"', '\n']) {
        return None;
    }
    let words: Vec<&str> = line.split_whitespace().collect();
    if begun {
        let (start, found) = complete(line, known, folder);
        if let ([only], false) = (found.as_slice(), is_whole(&words, known)) {
            return Some(Hint { text: only[line.len() - start..].into(), to_take: true });
        }
    }
    let rest = match COLON.iter().find(|c| c.0 == words[0]) {
        Some((_, about)) if words.len() == 1 => (*about).to_string(),
        Some(_) => return None,
        None => knowing::place(&words, known)?.0.rest,
    };
    let rest = rest.replace(" …", "…").replace('…', " …");
    let shown: String = rest.chars().take(LONGEST).collect();
    let cut = if shown.len() < rest.len() { "…" } else { "" };
    let blank = if begun { " " } else { "" };
    (!shown.is_empty()).then(|| Hint { text: format!("{blank}{shown}{cut}"), to_take: false })
}

/// Whether the last word is a command or style as it stands, though longer ones begin with it (`fix`, `nve`).
fn is_whole(words: &[&str], known: &Known) -> bool {
    let Some((last, before)) = words.split_last() else { return false };
    match before {
        [] => knowing::commands().contains(last),
        _ => {
            let at = knowing::place(before, known).map(|(p, _)| p.here).unwrap_or_default();
            at.iter().any(|w| w == last || w == "STYLE" && knowing::styles(before[0]).contains(last))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(line: &str) -> Option<String> {
        let known = Known { groups: vec!["all".into(), "ball".into()], ..Known::default() };
        hint(line, &known, Path::new("")).map(|h| h.text)
    }

    #[test]
    fn a_word_that_can_only_be_one_is_finished() {
        assert_eq!(text("pair_st").as_deref(), Some("yle"));
        assert_eq!(text("fix 1 b").as_deref(), Some("all"));
        assert_eq!(text("compute d all dam").as_deref(), Some("age/atom"));
    }

    #[test]
    fn behind_a_whole_word_the_syntax_continues() {
        assert_eq!(text("fix").as_deref(), Some(" ID group STYLE word …"));
        assert_eq!(text("fix 1 all viscous ").as_deref(), Some("gamma [scale type ratio]"));
        assert_eq!(text("fix 1 all nve"), None);
        assert_eq!(text("run ").unwrap().split(' ').next(), Some("N"));
        assert!(text(":plot").unwrap().starts_with(" COLUMN"));
    }

    #[test]
    fn comments_and_texts_need_no_hint() {
        assert_eq!(text("run 100 # "), None);
        assert_eq!(text("print \"a "), None);
        assert_eq!(text(""), None);
    }
}
