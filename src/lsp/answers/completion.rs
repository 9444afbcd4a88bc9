//! Completion and the help beside it: what may stand at the cursor, as at the prompt.

use super::page_markdown;
use crate::lsp::names::Kind;
use crate::lsp::server::{File, Server};
use crate::manual::completing::{Candidate, What, candidates};
use crate::manual::knowing;
use serde_json::{Value, json};
use std::sync::Arc;

/// What may stand at a byte of a file.
pub fn complete(server: &mut Server, file: &Arc<File>, byte: usize) -> Value {
    let line = before(&file.text.as_str()[..byte]);
    let Some(line) = line else { return json!([]) };
    let known = server.known(file, byte);
    let folder = file.folder();
    let (start, found) = candidates(line, &known, &folder);
    let range = file.text.range(byte - (line.len() - start)..byte);
    let typed: Vec<&str> = line[..start].split_whitespace().filter(|w| *w != "&").collect();
    let found = found.into_iter().filter(|c| c.what != What::Prompt);
    let items: Vec<Value> = found.map(|c| item(&c, &typed, &range)).collect();
    // The next letters may call for other names, as behind `v_`.
    json!({"isIncomplete": true, "items": items})
}

/// The line up to the cursor with what it continues, from the innermost command on; nothing within a comment.
pub fn before(text: &str) -> Option<&str> {
    let mut start = text.rfind('\n').map_or(0, |k| k + 1);
    while let Some(above) = text[..start].strip_suffix('\n').filter(|above| above.trim_end().ends_with('&')) {
        start = above.rfind('\n').map_or(0, |k| k + 1);
    }
    let line = &text[start..];
    let (mut quote, mut inner) = (None, 0);
    for (k, c) in line.char_indices() {
        match (quote, c) {
            (None, '#') => return None,
            (None, '"' | '\'') => (quote, inner) = (Some(c), k + 1),
            (Some(open), c) if c == open => quote = None,
            _ => {}
        }
    }
    let carries = line.split_whitespace().next().is_some_and(|w| w == "if" || w == "run");
    let behind_then = line[..inner].split_whitespace().any(|w| ["then", "else", "every"].contains(&w));
    Some(if quote.is_some() && carries && behind_then { &line[inner..] } else { line })
}

fn item(c: &Candidate, typed: &[&str], range: &Value) -> Value {
    let (kind, detail) = match c.what {
        What::Command => (14, summary(&c.text)),
        What::Style => {
            (7, typed.first().map(|command| summary(&format!("{command} {}", c.text))).unwrap_or_default())
        }
        What::Keyword => (10, String::new()),
        What::Named(Kind::File) | What::File => (17, String::new()),
        What::Named(kind) => (6, kind.word().to_string()),
        What::Column => (5, "column of a step table".to_string()),
        What::Attribute => (5, "attribute of particles".to_string()),
        What::Colour => (16, "colour".to_string()),
        What::Page | What::Prompt => (1, String::new()),
    };
    json!({
        "label": c.text,
        "kind": kind,
        "detail": detail,
        "textEdit": {"range": range, "newText": c.text},
        "data": {"command": typed.first(), "typed": typed, "word": c.text},
    })
}

fn summary(title: &str) -> String {
    knowing::page(title).map(|page| page.doc.summary.to_string()).unwrap_or_default()
}

/// An item with its documentation: the page of a command or style, or the page's sentence on a keyword.
pub fn resolve(mut item: Value) -> Value {
    let text = |key: &str| {
        item.pointer(&format!("/data/{key}")).and_then(Value::as_str).unwrap_or_default().to_string()
    };
    let (command, word, kind) = (text("command"), text("word"), item.get("kind").and_then(Value::as_u64));
    let typed: Vec<String> = item
        .pointer("/data/typed")
        .and_then(Value::as_array)
        .map(|all| all.iter().filter_map(Value::as_str).map(String::from).collect())
        .unwrap_or_default();
    let documentation = match kind {
        Some(14) => knowing::page(&word).map(|page| page_markdown(&page)),
        Some(7) => knowing::page(&format!("{command} {word}")).map(|page| page_markdown(&page)),
        Some(10) => {
            let typed: Vec<&str> = typed.iter().map(String::as_str).collect();
            knowing::place(&typed, &Default::default()).and_then(|(place, page)| {
                let declared = place.offers.iter().find_map(|offer| offer.about(&word));
                declared.or_else(|| knowing::sentence_on(page.doc.text, &word))
            })
        }
        _ => None,
    };
    if let (Some(text), Some(item)) = (documentation, item.as_object_mut()) {
        item.insert("documentation".into(), json!({"kind": "markdown", "value": text}));
    }
    item
}

#[cfg(test)]
mod tests {
    use super::before;

    #[test]
    fn the_innermost_command_counts() {
        assert_eq!(before("units lj\nfix 1 a"), Some("fix 1 a"));
        assert_eq!(before("fix 1 &\n all n"), Some("fix 1 &\n all n"));
        assert_eq!(before("if 1 then \"fix 1 a"), Some("fix 1 a"));
        assert_eq!(before("if \"$x"), Some("if \"$x"));
        assert_eq!(before("print \"a # ${x"), Some("print \"a # ${x"));
        assert_eq!(before("run 1 # a"), None);
        assert_eq!(before(""), Some(""));
    }
}
