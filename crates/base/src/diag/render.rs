//! Diagnostics as text: file, line, column, and the line itself with the word underlined.

use super::{Diagnostic, Diagnostics, FileId, Severity, Sources, Span};
use codespan_reporting::diagnostic as cs;
use codespan_reporting::files::{Error, SimpleFiles};
use codespan_reporting::term::{self, termcolor::Ansi};

/// All problems as plain text (without colours), in order.
pub fn plain(diagnostics: &Diagnostics, sources: &Sources) -> String {
    all(diagnostics, sources, |config, files, d| term::emit_into_string(config, files, d))
}

/// All problems with ANSI colours.
pub fn colored(diagnostics: &Diagnostics, sources: &Sources) -> String {
    all(diagnostics, sources, |config, files, d| {
        let mut out = Ansi::new(Vec::new());
        term::emit_to_write_style(&mut out, config, files, d)?;
        Ok(String::from_utf8_lossy(&out.into_inner()).into_owned())
    })
}

type Files = SimpleFiles<String, String>;

fn all(
    diagnostics: &Diagnostics,
    sources: &Sources,
    emit: impl Fn(&term::Config, &Files, &cs::Diagnostic<usize>) -> Result<String, Error>,
) -> String {
    let mut files = SimpleFiles::new();
    for source in (0..).map_while(|k| sources.get(FileId(k))) {
        files.add(source.name.clone(), source.text.clone());
    }
    // ASCII, so that log files and any terminal show the same text.
    let config = term::Config { chars: term::Chars::ascii(), ..Default::default() };
    let mut out = String::new();
    for d in &diagnostics.0 {
        let text = emit(&config, &files, &convert(d, sources));
        out.push_str(&text.unwrap_or_else(|_| format!("{}\n", d.message)));
    }
    out
}

fn convert(d: &Diagnostic, sources: &Sources) -> cs::Diagnostic<usize> {
    let severity = match d.severity {
        Severity::Error => cs::Severity::Error,
        Severity::Warning => cs::Severity::Warning,
        Severity::Note => cs::Severity::Note,
    };
    let primary = d.span.and_then(|s| bytes(s, sources)).map(|(file, range)| cs::Label::primary(file, range));
    let others = d.labels.iter().filter_map(|l| {
        bytes(l.span, sources).map(|(file, range)| cs::Label::secondary(file, range).with_message(&l.text))
    });
    cs::Diagnostic::new(severity)
        .with_code(d.code.to_string())
        .with_message(&d.message)
        .with_labels(primary.into_iter().chain(others).collect())
        .with_notes(d.help.iter().map(|h| remark(h)).collect())
}

/// A remedy, or a remark that begins with `note: `.
fn remark(text: &str) -> String {
    if text.starts_with("note: ") { text.to_string() } else { format!("help: {text}") }
}

/// The byte range of a span, clamped to its text and to whole characters; `None` if there is no such text.
fn bytes(span: Span, sources: &Sources) -> Option<(usize, std::ops::Range<usize>)> {
    let text = &sources.get(span.file)?.text;
    let whole = |k: u32| {
        let mut k = (k as usize).min(text.len());
        while !text.is_char_boundary(k) {
            k -= 1;
        }
        k
    };
    let start = whole(span.start);
    Some((span.file.0 as usize, start..whole(span.end).max(start)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::Code;

    const DECK: &str = "variable v equal 3\npair_sytle peri/pmb ${v}\n";

    fn sources() -> Sources {
        let mut sources = Sources::default();
        sources.add("in.plate", DECK);
        sources
    }

    fn typo() -> Diagnostics {
        Diagnostic::error(Code::UNKNOWN_COMMAND, Span::new(FileId(0), 19, 29), "unknown command `pair_sytle`")
            .help("did you mean `pair_style`?")
            .into()
    }

    #[test]
    fn a_message_names_place_word_and_cure() {
        assert_eq!(
            plain(&typo(), &sources()),
            "error[PG0102]: unknown command `pair_sytle`
  --> in.plate:2:1
  |
2 | pair_sytle peri/pmb ${v}
  | ^^^^^^^^^^
  |
  = help: did you mean `pair_style`?

"
        );
    }

    #[test]
    fn a_substituted_value_shows_where_it_was_defined() {
        let d = Diagnostic::error(Code::BAD_VALUE, Span::new(FileId(0), 39, 43), "`3` is no horizon")
            .label(Span::new(FileId(0), 17, 18), "the value comes from here");
        assert_eq!(
            plain(&d.into(), &sources()),
            "error[PG0108]: `3` is no horizon
  --> in.plate:2:21
  |
1 | variable v equal 3
  |                  - the value comes from here
2 | pair_sytle peri/pmb ${v}
  |                     ^^^^

"
        );
    }

    #[test]
    fn colours_add_nothing_but_escapes() {
        let colored = colored(&typo(), &sources());
        assert!(colored.contains("\u{1b}["), "no escape sequence in {colored:?}");
        let mut bare = String::new();
        let mut inside = false;
        for c in colored.chars() {
            match c {
                '\u{1b}' => inside = true,
                'm' if inside => inside = false,
                c if !inside => bare.push(c),
                _ => {}
            }
        }
        assert_eq!(bare, plain(&typo(), &sources()));
    }

    #[test]
    fn wrong_spans_do_no_harm() {
        let mut sources = Sources::default();
        sources.add("in.umlaut", "größe 1");
        for (start, end) in [(3, 4), (0, 900), (900, 901), (5, 2)] {
            let d = Diagnostic::error(Code::SYNTAX, Span::new(FileId(0), start, end), "odd");
            assert!(plain(&d.into(), &sources).contains("odd"));
        }
        let d = Diagnostic::error(Code::SYNTAX, Span::new(FileId(7), 0, 1), "elsewhere");
        assert_eq!(plain(&d.into(), &sources), "error[PG0101]: elsewhere\n\n");
    }
}
