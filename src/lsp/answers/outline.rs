//! The outline of a deck: its sections, and within them what it names and its runs.

use crate::lsp::names::{Kind, Role};
use crate::lsp::server::File;
use serde_json::{Value, json};

/// Kinds of the protocol.
const NAMESPACE: u8 = 3;
const EVENT: u8 = 24;
const STRING: u8 = 15;

struct Symbol {
    name: String,
    detail: String,
    kind: u8,
    bytes: std::ops::Range<usize>,
    chosen: std::ops::Range<usize>,
}

/// All symbols, those below a section's comment within it.
pub fn symbols(file: &File) -> Value {
    let text = file.text.as_str();
    let mut roots: Vec<Value> = vec![];
    let mut section: Option<(Symbol, Vec<Value>)> = None;
    for line in &file.index.lines {
        let start = line.span.start as usize;
        let alone = line.comment.filter(|_| line.words.is_empty());
        if let Some(title) = alone.and_then(|c| heading(text, c.start as usize..c.end as usize)) {
            close(&mut section, start, &mut roots, file);
            let comment = line.comment.unwrap_or_default();
            let bytes = comment.start as usize..comment.end as usize;
            let symbol = Symbol {
                name: title,
                detail: String::new(),
                kind: NAMESPACE,
                bytes: bytes.clone(),
                chosen: bytes,
            };
            section = Some((symbol, vec![]));
            continue;
        }
        for symbol in of_line(file, line) {
            let value = shown(&symbol, file, vec![]);
            match &mut section {
                Some((_, within)) => within.push(value),
                None => roots.push(value),
            }
        }
    }
    close(&mut section, text.len(), &mut roots, file);
    Value::Array(roots)
}

/// A heading is longer only by mistake.
const LONGEST_HEADING: usize = 60;

/// The title of a section that a comment of one line begins: one with rules, or one that stands behind an empty line.
fn heading(text: &str, comment: std::ops::Range<usize>) -> Option<String> {
    let line = &text[comment.clone()];
    if let Some(title) = title(line) {
        return Some(title);
    }
    let before = text[..comment.start].rsplit('\n').nth(1).unwrap_or("").trim();
    let after = text[comment.end..].split('\n').nth(1).unwrap_or("").trim();
    let bare = line.trim_start_matches('#').trim();
    let heads = before.is_empty() && !after.starts_with('#') && !bare.is_empty();
    (heads && bare.chars().count() <= LONGEST_HEADING).then(|| bare.to_string())
}

/// The title within the rules of a comment, as `# --- walls`, `# ===== run =====`.
fn title(comment: &str) -> Option<String> {
    let body = comment.trim_start_matches('#').trim();
    let ruled = |c: char| "-=*#~_".contains(c);
    let bare = body.trim_matches(ruled).trim();
    let marked = body.len() >= bare.len() + 2 && body.starts_with(ruled);
    (marked && !bare.is_empty()).then(|| bare.to_string())
}

fn close(section: &mut Option<(Symbol, Vec<Value>)>, end: usize, roots: &mut Vec<Value>, file: &File) {
    let Some((mut symbol, within)) = section.take() else { return };
    let body = file.text.as_str()[symbol.bytes.start..end.max(symbol.bytes.end)].trim_end();
    symbol.bytes.end = symbol.bytes.start + body.len();
    roots.push(shown(&symbol, file, within));
}

fn shown(symbol: &Symbol, file: &File, children: Vec<Value>) -> Value {
    json!({
        "name": symbol.name,
        "detail": symbol.detail,
        "kind": symbol.kind,
        "range": file.text.range(symbol.bytes.clone()),
        "selectionRange": file.text.range(symbol.chosen.clone()),
        "children": children,
    })
}

/// What a line brings into being, or that it runs.
fn of_line(file: &File, line: &perigrain_lang::RawLine) -> Vec<Symbol> {
    let (Some(first), Some(last)) = (line.words.first(), line.words.last()) else { return vec![] };
    let bytes = first.span.start as usize..last.span.end as usize;
    let rest = |k: usize| line.words.iter().skip(k).map(|w| w.text.as_str()).collect::<Vec<_>>().join(" ");
    let acts = [
        "run",
        "minimize",
        "statics",
        "fatigue",
        "rerun",
        "read_data",
        "read_restart",
        "create_box",
        "create_atoms",
        "pair_style",
        "include",
    ];
    if acts.contains(&first.text.as_str()) {
        let kind = if ["run", "minimize", "statics", "fatigue", "rerun"].contains(&first.text.as_str()) {
            EVENT
        } else {
            STRING
        };
        let chosen = first.span.start as usize..first.span.end as usize;
        return vec![Symbol {
            name: format!("{} {}", first.text, short(&rest(1))),
            detail: String::new(),
            kind,
            bytes,
            chosen,
        }];
    }
    let from = file.index.mentions.partition_point(|m| m.bytes.start < line.span.start as usize);
    let here = file.index.mentions[from..].iter().take_while(|m| m.bytes.start < line.span.end as usize);
    let defined = here.filter(|m| m.role == Role::Defines);
    defined
        .map(|m| Symbol {
            name: m.name.clone(),
            detail: format!("{} {}", m.kind.word(), short(&rest(2))).trim_end().to_string(),
            kind: kind(m.kind),
            bytes: bytes.clone(),
            chosen: m.bytes.clone(),
        })
        .filter(|s| s.bytes.start <= s.chosen.start && s.chosen.end <= s.bytes.end)
        .collect()
}

fn short(text: &str) -> String {
    let cut: String = text.chars().take(60).collect();
    if cut.len() < text.len() { cut + "…" } else { cut }
}

fn kind(kind: Kind) -> u8 {
    match kind {
        Kind::Variable => 13,
        Kind::Fix => 6,
        Kind::Compute => 12,
        Kind::Group => 10,
        Kind::Region => 19,
        Kind::Dump | Kind::File => 17,
        Kind::Material | Kind::Molecule => 23,
        Kind::Label => 20,
    }
}

#[cfg(test)]
mod tests {
    use super::{heading, title};

    #[test]
    fn comments_with_rules_are_sections() {
        assert_eq!(title("# --- walls").as_deref(), Some("walls"));
        assert_eq!(title("## == run it ==").as_deref(), Some("run it"));
        assert_eq!((title("# a remark"), title("# -----"), title("#")), (None, None, None));
        let text = "run 1\n# a remark\nrun 2\n\n# more of it\nrun 3\n\n# one\n# two\n";
        let of = |line: &str| heading(text, text.find(line).map(|k| k..k + line.len()).unwrap());
        assert_eq!(of("# more of it").as_deref(), Some("more of it"));
        assert_eq!((of("# a remark"), of("# one"), of("# two")), (None, None, None));
    }
}
