//! Pages of the manual on request: the list, one by its name, those that contain a word.

use super::args::Usage;
use crate::manual::howtos::{HOWTOS, HowTo};
pub use crate::manual::{Page, heading, pages};
use perigrain_base::diag::nearest;
use std::fmt::Write;

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
    let _ = writeln!(text, "\nhow-tos");
    for howto in HOWTOS {
        let _ = writeln!(text, "  {:<24} {}", howto.name, howto.question());
    }
    text
}

/// The page of a name, as `fix nve`, `nve` or `run`; after that of a command that takes styles, the list of them. `howto` lists the
/// how-tos. For a word that has no page, the pages that contain it.
///
/// # Errors
/// No page has the name or contains it; the nearest is offered.
pub fn page(name: &str) -> Result<String, Usage> {
    let all = pages();
    let found: Vec<&Page> = all.iter().filter(|p| p.title() == name || p.name == name).collect();
    if !found.is_empty() {
        let text = found.iter().map(|p| p.markdown()).collect::<Vec<_>>().join("\n");
        let styles: Vec<&Page> = all.iter().filter(|p| p.kind == name).collect();
        let text = if styles.is_empty() { text } else { text + "\n## Styles\n\n" + &lines(&styles) };
        // A how-to of the same name answers more than the page.
        let named: Vec<&HowTo> = HOWTOS.iter().filter(|h| h.name == name).collect();
        return Ok(if named.is_empty() { text } else { text + "\n## How-tos\n\n" + &questions(&named) });
    }
    if ["howto", "howtos", "how-tos"].contains(&name) {
        return Ok(format!("# How-tos\n\n{}", questions(&HOWTOS.iter().collect::<Vec<_>>())));
    }
    if let Some(howto) = HOWTOS.iter().find(|h| h.name == name || h.title() == name) {
        return Ok(howto.text());
    }
    if let Some(text) = search(name, &all) {
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

/// Pages with the words in their names, then those with them in their texts: beside each other, else each of them.
fn search(words: &str, all: &[Page]) -> Option<String> {
    let words = words.to_lowercase();
    found(&words, &[&words], all)
        .or_else(|| found(&words, &words.split_whitespace().collect::<Vec<_>>(), all))
}

/// The pages that contain each of the parts, as the answer to a search for these words.
fn found(words: &str, each: &[&str], all: &[Page]) -> Option<String> {
    let holds = |text: &str| {
        let text = text.to_lowercase();
        each.iter().all(|part| text.contains(part))
    };
    let (named, others): (Vec<&Page>, Vec<&Page>) = all.iter().partition(|p| holds(&p.title()));
    let mentioned: Vec<&Page> = others.into_iter().filter(|p| holds(&p.markdown())).collect();
    let howtos: Vec<&HowTo> = HOWTOS.iter().filter(|h| h.contains_all(each)).collect();
    let parts = [
        ("Pages named so", lines(&named)),
        ("How-tos", questions(&howtos)),
        ("Pages that contain it", lines(&mentioned)),
    ];
    let text: Vec<String> = parts
        .iter()
        .filter(|(_, lines)| !lines.is_empty())
        .map(|(head, lines)| format!("# {head}: `{words}`\n\n{lines}"))
        .collect();
    (!text.is_empty()).then(|| text.join("\n"))
}

/// Titles of how-tos and the questions that they answer.
fn questions(howtos: &[&HowTo]) -> String {
    howtos
        .iter()
        .fold(String::new(), |text, howto| text + &format!("  {:<28} {}\n", howto.title(), howto.question()))
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
    fn words_without_a_page_find_the_pages_that_contain_them() {
        let walls = page("wall").unwrap();
        assert!(
            walls.starts_with("# Pages named so: `wall`") && walls.contains("\n  fix wall/gran "),
            "{walls}"
        );
        assert!(page("fix").unwrap().contains("\n  fix wall/gran "));
        assert!(page("Wiggle").unwrap().starts_with("# Pages that contain it: `wiggle`"));
        assert!(page("fix nvee").unwrap_err().help.unwrap().contains("`fix nve`"));
    }

    #[test]
    fn how_tos_are_pages_too() {
        for name in ["notch", "howto notch"] {
            let text = page(name).unwrap();
            assert!(text.starts_with("# A crack from a notch\n") && text.contains("peri_crack"), "{text}");
        }
        assert!(page("movie").unwrap().contains("movie of a"));
        assert!(page("lattice spacing").unwrap().contains("\n  howto "));
        let all = page("howto").unwrap();
        for howto in HOWTOS {
            assert!(list().contains(&format!("\n  {} ", howto.name)), "{}", howto.name);
            assert!(all.contains(&format!("\n  {} ", howto.title())), "{all}");
        }
    }
}
