//! The manual: one page per command and style, made from the tables they are registered in.

use super::args::Usage;
use super::pages;
use perigrain_base::diag::nearest;
use perigrain_commands::COMMANDS;
use perigrain_computes::COMPUTES;
use perigrain_dumps::DUMPS;
use perigrain_fixes::FIXES;
use perigrain_pairs::PAIRS;
use perigrain_pairs::bond::BONDS;
use perigrain_styles::{Doc, Style};
use std::fmt::Write;

/// One page: what it is about and where it belongs.
#[derive(Clone, Copy)]
pub struct Page {
    /// `topic`, `command`, or the command that takes the style: `pair_style`, `fix`, `compute`, `dump`.
    pub kind: &'static str,
    /// The word in the deck.
    pub name: &'static str,
    /// What is said about it.
    pub doc: Doc,
}

impl Page {
    /// As it is asked for and headed: `fix nve`, `run`.
    pub fn title(&self) -> String {
        match self.kind {
            "topic" | "command" => self.name.to_string(),
            kind => format!("{kind} {}", self.name),
        }
    }

    /// The page's file below `docs/styles`.
    pub fn file(&self) -> String {
        format!("{}.md", self.title().replace([' ', '/'], "_"))
    }

    /// The page as Markdown.
    pub fn markdown(&self) -> String {
        let Doc { syntax, summary, text, example } = self.doc;
        let mut page = format!("# {}\n\n{summary}\n\n```text\n{syntax}\n```\n", self.title());
        if !text.is_empty() {
            let _ = write!(page, "\n{}\n", text.trim());
        }
        if !example.is_empty() {
            let _ = write!(page, "\n## Example\n\n```text\n{}\n```\n", example.trim());
        }
        page
    }
}

/// Every page, by kind and then in the order of the tables.
pub fn pages() -> Vec<Page> {
    fn of<S: Style + ?Sized>(kind: &'static str, table: &[&S]) -> Vec<Page> {
        table.iter().map(|s| Page { kind, name: s.name(), doc: s.doc() }).collect()
    }
    fn own(kind: &'static str, table: &[pages::Entry]) -> Vec<Page> {
        table.iter().map(|&(name, doc)| Page { kind, name, doc }).collect()
    }
    [
        own("topic", pages::TOPICS),
        of("command", COMMANDS),
        own("command", pages::COMMANDS),
        of("pair_style", PAIRS),
        of("bond_style", BONDS),
        of("fix", FIXES),
        of("compute", COMPUTES),
        of("dump", DUMPS),
    ]
    .concat()
}

/// All pages with their summaries, as `perigrain doc` prints them.
pub fn list() -> String {
    let mut text = String::new();
    let mut kind = "";
    for page in pages() {
        if page.kind != kind {
            kind = page.kind;
            let _ = writeln!(text, "{}{}", if text.is_empty() { "" } else { "\n" }, heading(kind));
        }
        let _ = writeln!(text, "  {:<24} {}", page.name, page.doc.summary);
    }
    text
}

/// What a kind of page is called in a list.
pub fn heading(kind: &str) -> &str {
    match kind {
        "topic" => "topics",
        "command" => "commands",
        _ => kind,
    }
}

/// The page of a name, as `fix nve`, `nve` or `run`; behind that of a command that takes styles, the list of them. Of a word
/// that has no page, those that speak of it.
///
/// # Errors
/// No page has the name or speaks of it; the nearest is offered.
pub fn page(name: &str) -> Result<String, Usage> {
    let all = pages();
    let found: Vec<&Page> = all.iter().filter(|p| p.title() == name || p.name == name).collect();
    if !found.is_empty() {
        let text = found.iter().map(|p| p.markdown()).collect::<Vec<_>>().join("\n");
        let styles: Vec<&Page> = all.iter().filter(|p| p.kind == name).collect();
        return Ok(if styles.is_empty() { text } else { text + "\n## Styles\n\n" + &lines(&styles) });
    }
    if let Some(text) = speaking_of(name, &all) {
        return Ok(text);
    }
    let titles: Vec<String> = all.iter().map(Page::title).collect();
    let known = titles.iter().map(String::as_str).chain(all.iter().map(|p| p.name));
    let help = match nearest(name, known) {
        Some(near) => format!("did you mean `{near}`? `perigrain doc` lists all"),
        None => "`perigrain doc` lists all".into(),
    };
    Err(Usage { message: format!("the manual has no page `{name}`"), help: Some(help) })
}

/// Pages with the words in their names, then those with them in their texts.
fn speaking_of(words: &str, all: &[Page]) -> Option<String> {
    let words = words.to_lowercase();
    let holds = |text: &str| text.to_lowercase().contains(&words);
    let (named, others): (Vec<&Page>, Vec<&Page>) = all.iter().partition(|p| holds(&p.title()));
    let telling: Vec<&Page> = others.into_iter().filter(|p| holds(&p.markdown())).collect();
    let parts = [("Pages named so", named), ("Pages that speak of it", telling)];
    let text: Vec<String> = parts
        .iter()
        .filter(|(_, pages)| !pages.is_empty())
        .map(|(head, pages)| format!("# {head}: `{words}`\n\n{}", lines(pages)))
        .collect();
    (!text.is_empty()).then(|| text.join("\n"))
}

/// Titles and summaries.
fn lines(pages: &[&Page]) -> String {
    pages
        .iter()
        .fold(String::new(), |text, page| text + &format!("  {:<28} {}\n", page.title(), page.doc.summary))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_without_a_page_find_those_that_speak_of_them() {
        let walls = page("wall").unwrap();
        assert!(
            walls.starts_with("# Pages named so: `wall`") && walls.contains("\n  fix wall/gran "),
            "{walls}"
        );
        assert!(page("fix").unwrap().contains("\n  fix wall/gran "));
        assert!(page("Wiggle").unwrap().starts_with("# Pages that speak of it: `wiggle`"));
        assert!(page("fix nvee").unwrap_err().help.unwrap().contains("`fix nve`"));
    }
}
