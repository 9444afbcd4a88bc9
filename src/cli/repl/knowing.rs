//! What completion, hints and highlighting know: the manual's syntax lines, and the names of the session.

use crate::cli::manual::{Page, pages};
use crate::cli::syntax::{Form, Place};
use crate::session::{Known, THERMO};
use std::sync::LazyLock;

/// A form of a command with the page it stands on.
struct Entry {
    page: Page,
    form: Form,
}

/// All forms, those of commands before those of their styles.
static FORMS: LazyLock<Vec<Entry>> = LazyLock::new(|| {
    let of = |page: Page| {
        let lines = page.doc.syntax.lines().filter(|l| !l.starts_with('#'));
        lines.map(move |line| Entry { page, form: Form::read(line, page.name) })
    };
    pages().into_iter().filter(|p| p.kind != "topic").flat_map(of).collect()
});

/// Commands that exist only at the prompt.
pub const COLON: [(&str, &str); 9] = [
    (":plan", "prints what each step of a run now would do"),
    (":graph", "[FILE.dot]  lists the lines so far and what uses what, or writes the graph for graphviz"),
    (":plot", "COLUMN …  draws thermo columns over the step"),
    (":slice", "FORMULA x|y|z AT [WIDTH]  draws a cut through the particles, coloured by a formula"),
    (":show", "FILE.png  shows a picture"),
    (":undo", "[N]  goes back to before the last line, or the last N"),
    (":save", "FILE  writes the lines that count as a deck"),
    (":help", "lists these commands"),
    (":quit", "leaves"),
];

/// All commands a deck knows, sorted.
pub fn commands() -> Vec<&'static str> {
    let mut all: Vec<&str> = pages().iter().filter(|p| p.kind == "command").map(|p| p.name).collect();
    all.sort_unstable();
    all
}

/// All styles that a command takes, sorted.
pub fn styles(command: &str) -> Vec<&'static str> {
    let mut all: Vec<&str> = pages().iter().filter(|p| p.kind == command).map(|p| p.name).collect();
    all.sort_unstable();
    all
}

/// What stands behind the words typed, from the form that fits them best, and that form's page.
pub fn place(typed: &[&str], known: &Known) -> Option<(Place, Page)> {
    let mut best: Option<(i32, &Entry)> = None;
    for entry in FORMS.iter().filter(|e| e.form.index_of(typed.first().unwrap_or(&"")) == Some(0)) {
        let name = entry.page.name;
        // A style's own page counts once the style is typed.
        if entry.page.kind == typed[0]
            && entry.form.index_of(name).is_some_and(|k| typed.get(k) != Some(&name))
        {
            continue;
        }
        let mut fit = entry.form.fit(typed);
        let pair = entry.page.kind == "pair_style" && typed[0] != "pair_style";
        if pair && typed.get(3).or(known.pair.as_deref().as_ref()).is_some_and(|s| *s == entry.page.name) {
            fit += 3;
        }
        if best.is_none_or(|(most, _)| fit > most) {
            best = Some((fit, entry));
        }
    }
    let (_, entry) = best?;
    Some((entry.form.place(typed), entry.page))
}

/// Keywords that a page's text names behind "Keywords:" and the like, each the first word of something in backticks.
pub fn keywords_in(text: &str) -> Vec<&str> {
    let listed = text.split("eywords: ").nth(1).unwrap_or("");
    let end = listed.find(". ").unwrap_or(listed.len());
    let quoted = listed[..end].split('`').skip(1).step_by(2);
    quoted.filter_map(|q| q.split_whitespace().next()).collect()
}

/// The columns a step table can show by keyword.
pub fn thermo() -> Vec<&'static str> {
    THERMO.iter().map(|k| k.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rest(line: &str, pair: Option<&str>) -> String {
        let known = Known { pair: pair.map(String::from), ..Known::default() };
        place(&line.split_whitespace().collect::<Vec<_>>(), &known).map_or(String::new(), |(p, _)| p.rest)
    }

    #[test]
    fn the_style_typed_chooses_the_page() {
        assert_eq!(rest("fix 1 all", None), "STYLE word…");
        assert_eq!(rest("fix 1 all viscous", None), "gamma [scale type ratio]");
        assert!(rest("region a sphere 0 0", None).starts_with("Z R"));
        assert!(rest("pair_coeff 1 1", Some("peri/pmb")).starts_with("c horizon"));
        assert!(rest("pair_coeff 1 1 material glass", Some("peri/pmb")).starts_with("horizon H"));
        assert!(rest("no_such", None).is_empty());
    }

    #[test]
    fn every_form_begins_with_its_command() {
        for e in FORMS.iter() {
            let command = if e.page.kind == "command" { e.page.name } else { e.page.kind };
            let own = e.form.index_of(command) == Some(0);
            assert!(
                own || ["pair_style", "bond_style", "command"].contains(&e.page.kind),
                "{}: {:?}",
                e.page.title(),
                e.form
            );
        }
    }
}
