//! Diagnostics as text for people: file, line, column, the line itself with the word underlined.

use super::{Diagnostic, Diagnostics, Severity, Sources};
use codespan_reporting::diagnostic as cs;
use codespan_reporting::files::SimpleFiles;
use codespan_reporting::term;

/// All problems as plain text (no colours), one after the other.
pub fn plain(diagnostics: &Diagnostics, sources: &Sources) -> String {
    render(diagnostics, sources, false)
}

/// All problems with colours for a terminal.
pub fn colored(diagnostics: &Diagnostics, sources: &Sources) -> String {
    render(diagnostics, sources, true)
}

fn render(diagnostics: &Diagnostics, sources: &Sources, colors: bool) -> String {
    let mut files = SimpleFiles::new();
    let mut k = 0;
    while let Some(s) = sources.get(super::FileId(k)) {
        files.add(s.name.clone(), s.text.clone());
        k += 1;
    }
    let config = term::Config { before_label_lines: 0, after_label_lines: 0, ..Default::default() };
    let mut out = String::new();
    for d in &diagnostics.0 {
        let d = convert(d);
        let text = if colors {
            term::emit_into_string(&config, &files, &d)
        } else {
            term::emit_into_string(&config, &files, &d)
        };
        out.push_str(&text.unwrap_or_else(|_| format!("{}\n", d.message)));
    }
    out
}

fn convert(d: &Diagnostic) -> cs::Diagnostic<usize> {
    let severity = match d.severity {
        Severity::Error => cs::Severity::Error,
        Severity::Warning => cs::Severity::Warning,
        Severity::Note => cs::Severity::Note,
    };
    let mut labels = vec![];
    if let Some(s) = d.span {
        labels.push(cs::Label::primary(s.file.0 as usize, s.start as usize..s.end as usize));
    }
    for l in &d.labels {
        let s = l.span;
        labels.push(
            cs::Label::secondary(s.file.0 as usize, s.start as usize..s.end as usize)
                .with_message(l.text.clone()),
        );
    }
    cs::Diagnostic::new(severity)
        .with_code(d.code.to_string())
        .with_message(d.message.clone())
        .with_labels(labels)
        .with_notes(d.help.iter().map(|h| format!("help: {h}")).collect())
}
