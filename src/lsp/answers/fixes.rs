//! Quick fixes: the replacements that the help of a message suggests.

use crate::lsp::server::{File, Server};
use serde_json::{Value, json};

/// Actions for the problems within some bytes.
pub fn actions(server: &Server, file: &File, range: &std::ops::Range<usize>) -> Value {
    let mut all: Vec<Value> = vec![];
    for problem in server.problems(&file.uri) {
        let place = file.text.bytes_at(&problem["range"]);
        if place.start > range.end || range.start > place.end {
            continue;
        }
        let old = file.text.as_str().get(place.clone()).unwrap_or_default();
        let help = problem.pointer("/data/help").and_then(Value::as_array).into_iter().flatten();
        for new in help.filter_map(Value::as_str).filter_map(meant).filter(|new| *new != old) {
            let Some(text) = replacement(old, new) else { continue };
            let title = format!("Write `{text}`");
            let edit = json!({"range": file.text.range(place.clone()), "newText": text});
            all.push(json!({
                "title": title,
                "kind": "quickfix",
                "diagnostics": [problem],
                "isPreferred": true,
                "edit": {"changes": {file.uri.clone(): [edit]}},
            }));
        }
    }
    Value::Array(all)
}

/// The word in a help of the form "did you mean `word`?".
fn meant(help: &str) -> Option<&str> {
    let (_, rest) = help.split_once("did you mean ")?;
    let (_, quoted) = rest.split_once('`')?;
    quoted.split_once('`').map(|(word, _)| word).filter(|word| !word.is_empty())
}

/// The new text of a word, with the surroundings of its name kept. In a formula or a line only one word is wrong; its place
/// determines which.
fn replacement(old: &str, new: &str) -> Option<String> {
    if old.is_empty() || old.contains(char::is_whitespace) {
        return None;
    }
    let prefixed =
        ["v_", "c_", "f_", "C_", "F_"].into_iter().find(|p| old.starts_with(p) && !new.starts_with(p));
    Some(match prefixed {
        Some(prefix) => format!("{prefix}{new}"),
        None if old.starts_with("${") && !new.starts_with('$') => format!("${{{new}}}"),
        None => new.to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_word_that_was_meant_stands_in_the_help() {
        assert_eq!(meant("did you mean `pair_style`?"), Some("pair_style"));
        assert_eq!(meant("write it otherwise"), None);
        assert_eq!(replacement("v_dept", "depth").as_deref(), Some("v_depth"));
        assert_eq!(replacement("${dept}", "depth").as_deref(), Some("${depth}"));
        assert_eq!(replacement("a b", "c"), None);
    }
}
