//! `perigrain check`: the problems of one or more decks, for people or as JSON for editors.

use super::args::{Deck, Options};
use super::{FAILED, OK, deck, show};
use crate::json::quoted;
use crate::session::{Mode, whole};
use perigrain_base::diag::{Diagnostic, Diagnostics, Severity, Sources, Span};
use perigrain_output::log::Log;

/// Checks each deck by itself; the exit code is that of the worst.
pub fn check(decks: &[Options], json: bool) -> u8 {
    let mut code = OK;
    let mut objects = vec![];
    for o in decks {
        let mut sources = Sources::default();
        let (name, problems) = problems(o, &mut sources);
        if problems.has_errors() {
            code = FAILED;
        }
        if json {
            objects.extend(problems.0.iter().map(|d| object(d, &name, &sources)));
        } else {
            deck::print(&problems, &sources);
            show(&summary(&name, &problems));
        }
    }
    if json {
        show(&format!("[{}]\n", objects.join(",\n ")));
    }
    code
}

/// The deck's name and all its problems, in the order of its lines.
fn problems(o: &Options, sources: &mut Sources) -> (String, Diagnostics) {
    let (name, text) = match deck::read(&o.deck) {
        Ok(read) => read,
        Err(problems) => return (deck::name(&o.deck), problems),
    };
    match deck::settled(o, Mode::Check, &Log::silent()) {
        Ok(options) => {
            let checked = whole::check(&options, &name, &text, &Default::default());
            *sources = checked.sources;
            (name, checked.problems)
        }
        Err(problems) => (name, problems),
    }
}

/// The last line about a deck: how many problems of which kind.
fn summary(name: &str, problems: &Diagnostics) -> String {
    let count = |severity, word: &str| {
        let n = problems.0.iter().filter(|d| d.severity == severity).count();
        (n > 0).then(|| format!("{n} {word}{}", if n == 1 { "" } else { "s" }))
    };
    let parts: Vec<String> =
        [count(Severity::Error, "error"), count(Severity::Warning, "warning"), count(Severity::Note, "note")]
            .into_iter()
            .flatten()
            .collect();
    let found = if parts.is_empty() { "no problems found".into() } else { parts.join(", ") };
    format!("{name}: {found}\n")
}

/// A problem as a JSON object on one line.
fn object(d: &Diagnostic, deck: &str, sources: &Sources) -> String {
    let severity = match d.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
        Severity::Note => "note",
    };
    let labels: Vec<String> = d
        .labels
        .iter()
        .map(|l| format!("{{{}, \"message\": {}}}", place(Some(l.span), deck, sources), quoted(&l.text)))
        .collect();
    let help: Vec<String> = d.help.iter().map(|h| quoted(h)).collect();
    format!(
        "{{{}, \"severity\": \"{severity}\", \"code\": \"{}\", \"message\": {}, \"help\": [{}], \"labels\": [{}]}}",
        place(d.span, deck, sources),
        d.code,
        quoted(&d.message),
        help.join(", "),
        labels.join(", ")
    )
}

/// File, line and columns of a span: from 1, in characters, `end_column` one past the last; `null` without a place.
fn place(span: Option<Span>, deck: &str, sources: &Sources) -> String {
    let Some((span, source)) = span.and_then(|s| Some((s, sources.get(s.file)?))) else {
        return format!("\"file\": {}, \"line\": null, \"column\": null, \"end_column\": null", quoted(deck));
    };
    let (line, column) = sources.place(span);
    // A span of several lines ends, for an editor, with the first one.
    let covered = source.text.get(span.start as usize..span.end as usize).unwrap_or("");
    let end = column + covered.lines().next().unwrap_or("").chars().count().max(1);
    format!(
        "\"file\": {}, \"line\": {line}, \"column\": {column}, \"end_column\": {end}",
        quoted(&source.name)
    )
}

/// One set of options per deck; standard input if none is named.
pub fn each(options: &Options, decks: Vec<Deck>) -> Vec<Options> {
    let decks = if decks.is_empty() { vec![Deck::Stdin] } else { decks };
    decks.into_iter().map(|deck| Options { deck, ..options.clone() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::diag::{Code, FileId};

    #[test]
    fn a_problem_is_an_object_with_its_place() {
        let mut sources = Sources::default();
        sources.add("in.größe", "units si\nset größe \"x\"\n");
        let d = Diagnostic::error(Code::UNKNOWN_KEYWORD, Span::new(FileId(0), 13, 20), "a \"b\"\tc\u{1}")
            .help("d\\")
            .label(Span::new(FileId(0), 0, 22), "here");
        let wanted = "{\"file\": \"in.größe\", \"line\": 2, \"column\": 5, \"end_column\": 10, \"severity\": \"error\", \
                      \"code\": \"PG0104\", \"message\": \"a \\\"b\\\"\\tc\\u0001\", \"help\": [\"d\\\\\"], \"labels\": \
                      [{\"file\": \"in.größe\", \"line\": 1, \"column\": 1, \"end_column\": 9, \"message\": \"here\"}]}";
        assert_eq!(object(&d, "in.größe", &sources), wanted);
        let d = Diagnostic::error(Code::NO_FILE, None, "no");
        assert!(object(&d, "in.x", &sources).starts_with("{\"file\": \"in.x\", \"line\": null"));
    }
}
