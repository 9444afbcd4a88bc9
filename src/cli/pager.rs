//! Long texts for people: wrapped at words and page by page on a terminal, as they are into a pipe.

use super::show;
use console::Term;
use std::io::{IsTerminal, Write, stdout};
use std::process::{Command, Stdio};

/// Lines of text are no longer than this, however wide the terminal is: longer ones are hard to read.
const WIDEST: usize = 110;

/// Shows a page of the manual.
pub fn page(text: &str) {
    let Some((rows, columns)) = Term::stdout().size_checked().filter(|_| stdout().is_terminal()) else {
        return show(text);
    };
    let text = wrapped(text, WIDEST.min(columns.into()));
    let fits = text.lines().count() < rows.into();
    if fits || !through_pager(&text) {
        show(&text);
    }
}

/// The text as it fits a terminal's screen, and as it is into a pipe.
pub fn fitted(text: &str) -> String {
    wrapped(text, width(usize::MAX))
}

/// How many characters a line on standard output may have: so many, and fewer where a terminal has fewer.
pub fn width(most: usize) -> usize {
    let columns =
        Term::stdout().size_checked().filter(|_| stdout().is_terminal()).map(|(_, columns)| columns.into());
    columns.map_or(most, |columns: usize| most.min(columns))
}

/// Passes the text to `$PAGER`, or to `less`; whether one could be started. With an empty `PAGER` none is.
fn through_pager(text: &str) -> bool {
    let wanted = std::env::var("PAGER").unwrap_or_else(|_| "less".into());
    let mut words = wanted.split_whitespace();
    let Some(program) = words.next() else { return false };
    let mut pager = Command::new(program);
    // Defaults for `less` where the user has set none: keep colours, leave the text on the screen.
    if std::env::var_os("LESS").is_none() {
        pager.env("LESS", "FRX");
    }
    let Ok(mut child) = pager.args(words).stdin(Stdio::piped()).spawn() else { return false };
    if let Some(mut input) = child.stdin.take() {
        // A pager that is closed before the end is no failure.
        let _ = input.write_all(text.as_bytes());
    }
    let _ = child.wait();
    true
}

/// The text with lines of at most `width` columns, broken between words; code and tables stay as they are.
pub fn wrapped(text: &str, width: usize) -> String {
    let mut code = false;
    let mut out = String::with_capacity(text.len() + text.len() / 32);
    for line in text.lines() {
        code ^= line.trim_start().starts_with("```");
        if code || line.starts_with('|') {
            out += line;
        } else if line.starts_with("  ") {
            out += &entry(line, width);
        } else {
            let options = textwrap::Options::new(width)
                .subsequent_indent(if line.starts_with("- ") { "  " } else { "" })
                .word_splitter(textwrap::WordSplitter::NoHyphenation)
                .break_words(false);
            out += &textwrap::fill(line, options);
        }
        out.push('\n');
    }
    out
}

/// A line of a list, whose text continues below itself: `  fix nve   what it does`.
fn entry(line: &str, width: usize) -> String {
    let name = line.trim_start();
    let behind = name.find("  ").map(|k| &name[k..]).unwrap_or_default();
    let text = behind.trim_start();
    let at = line.chars().count() - text.chars().count();
    if text.is_empty() || width < at + NARROWEST {
        return line.into();
    }
    let options = textwrap::Options::new(width - at)
        .word_splitter(textwrap::WordSplitter::NoHyphenation)
        .break_words(false);
    let below = format!("\n{}", " ".repeat(at));
    line[..line.len() - text.len()].to_string() + &textwrap::wrap(text, options).join(&below)
}

/// Characters beside a name from which a text is put there line by line.
const NARROWEST: usize = 20;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::manual::pages;

    #[test]
    fn lines_break_between_words_and_code_stays() {
        let text =
            "- one two three four\n```text\nfix ID group STYLE word\n```\n| a | table | of | columns |\n";
        let wanted = "- one two\n  three\n  four\n```text\nfix ID group STYLE word\n```\n| a | table | of | columns |\n";
        assert_eq!(wrapped(text, 10), wanted);
        let list = "  fix nve        Moves all particles of a group along\n";
        let wanted = "  fix nve        Moves all particles\n                 of a group along\n";
        assert_eq!(wrapped(list, 38), wanted);
        for page in pages() {
            let (text, words) =
                (page.markdown(), |t: &str| t.split_whitespace().map(String::from).collect::<Vec<_>>());
            assert_eq!(words(&wrapped(&text, 80)), words(&text), "{}", page.title());
        }
    }
}
