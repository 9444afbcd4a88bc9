//! Hover and signature help: the manual's text on the word at the cursor.

use super::{completion, page_markdown};
use crate::lsp::checks::explained;
use crate::lsp::names::{Kind, Mention, Role};
use crate::lsp::server::{File, Server};
use crate::manual::knowing;
use serde_json::{Value, json};
use std::ops::Range;
use std::sync::Arc;

/// Definitions of a name that are shown at most.
const MOST: usize = 5;

/// The text on the word at a byte, and on the problems there.
pub fn hover(server: &mut Server, file: &Arc<File>, byte: usize) -> Value {
    let mut parts = problems_at(server, file, byte);
    let mut range = None;
    if let Some((text, bytes)) = word_at(server, file, byte) {
        parts.push(text);
        range = Some(bytes);
    }
    if parts.is_empty() {
        return Value::Null;
    }
    let mut hover = json!({"contents": {"kind": "markdown", "value": parts.join("\n\n---\n\n")}});
    if let Some(range) = range {
        hover["range"] = file.text.range(range);
    }
    hover
}

/// The stories behind the problems at a byte.
fn problems_at(server: &Server, file: &File, byte: usize) -> Vec<String> {
    let mut codes: Vec<&str> = server
        .problems(&file.uri)
        .filter(|problem| {
            let range = file.text.bytes_at(&problem["range"]);
            (range.start..=range.end).contains(&byte)
        })
        .filter_map(|problem| problem["code"].as_str())
        .collect();
    codes.dedup();
    codes.into_iter().filter_map(explained).collect()
}

fn word_at(server: &mut Server, file: &Arc<File>, byte: usize) -> Option<(String, Range<usize>)> {
    if let Some(mention) = file.index.at(byte) {
        let text = of_name(server, file, &mention)?;
        return Some((text, mention.bytes));
    }
    let (words, k) = file.index.word_at(byte)?;
    let typed: Vec<&str> = words.iter().map(|w| w.text.as_str()).collect();
    let word = &words[k];
    let range = word.span.start as usize..word.span.end as usize;
    let page = match k {
        0 => knowing::page(typed[0]),
        _ => knowing::page(&format!("{} {}", typed[0], typed[k])),
    };
    if let Some(page) = page {
        return Some((page_markdown(&page), range));
    }
    let known = server.known(file, byte);
    let (place, page) = knowing::place(&typed[..k], &known)?;
    let declared = place.offers.iter().find_map(|offer| offer.about(typed[k]));
    let text = declared.or_else(|| knowing::sentence_on(page.doc.text, typed[k])).filter(|_| !word.quoted);
    let text = text.or_else(|| {
        let here = place.here.iter().find(|here| *here != "|")?;
        Some(format!("here stands `{here}`\n\n```perigrain\n{}\n```", page.syntax()))
    })?;
    Some((format!("**{}**: {text}", page.title()), range))
}

/// The lines that define a name, and the page of its style.
fn of_name(server: &mut Server, file: &Arc<File>, mention: &Mention) -> Option<String> {
    if mention.kind == Kind::File {
        let named = server.named(&mention.name, file)?;
        return Some(format!(
            "file `{}`",
            named.path.as_deref().unwrap_or(std::path::Path::new("")).display()
        ));
    }
    if mention.kind == Kind::Group && mention.name == "all" {
        return Some("group `all`: every particle".to_string());
    }
    let mut text = format!("{} `{}`", mention.kind.word(), mention.name);
    let (mut shown, mut page) = (0, None);
    for other in server.family(file) {
        let lines = other
            .index
            .mentions
            .iter()
            .filter(|m| m.kind == mention.kind && m.name == mention.name && m.role == Role::Defines);
        for m in lines {
            let Some((words, _)) = other.index.word_at(m.bytes.start) else { continue };
            let (first, last) = (words.first()?.span.start as usize, words.last()?.span.end as usize);
            let line = other.text.as_str().get(first..last)?;
            if shown < MOST {
                text += &format!("\n\n```perigrain\n{line}\n```");
            }
            shown += 1;
            let command = words[0].text.as_str();
            page = page.or_else(|| {
                words.iter().skip(1).find_map(|w| knowing::page(&format!("{command} {}", w.text)))
            });
        }
    }
    if shown > MOST {
        text += &format!("\n\nand {} more", shown - MOST);
    }
    if let Some(page) = page {
        text += &format!("\n\n{}: {}", page.title(), page.doc.summary);
    }
    Some(text)
}

/// The synopsis that the words before the cursor fit best, and which of its words is being typed.
pub fn signature(server: &mut Server, file: &Arc<File>, byte: usize) -> Value {
    let Some(line) = completion::before(&file.text.as_str()[..byte]) else { return Value::Null };
    let whole = line.rfind(char::is_whitespace).map_or(0, |k| k + 1);
    let typed: Vec<&str> = line[..whole].split_whitespace().filter(|w| *w != "&").collect();
    if typed.is_empty() {
        return Value::Null;
    }
    let known = server.known(file, byte);
    let Some((parts, active, page)) = knowing::synopsis(&typed, &known) else { return Value::Null };
    let mut label = String::new();
    let mut parameters = vec![];
    for part in &parts {
        let start = label.encode_utf16().count();
        label += part;
        parameters.push(json!({"label": [start, label.encode_utf16().count()]}));
        label.push(' ');
    }
    let documentation = json!({"kind": "markdown", "value": page.doc.summary});
    let signature =
        json!({"label": label.trim_end(), "parameters": parameters, "documentation": documentation});
    json!({"signatures": [signature], "activeSignature": 0, "activeParameter": active.unwrap_or(parts.len())})
}
