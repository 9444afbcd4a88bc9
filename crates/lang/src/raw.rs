//! Decks as they are written, for editors: words and comments with their places, no value put in and nothing acted upon.

use super::command::Word;
use super::lex::{self, Logical};
use super::text::Mapped;
use perigrain_base::diag::{FileId, Span};

/// A logical line that holds something.
#[derive(Clone, Debug, PartialEq)]
pub struct RawLine {
    /// All of it, with its line break.
    pub span: Span,
    /// Its words; `$(a + b)` is one. Of a line that cannot be read those before the fault.
    pub words: Vec<Word>,
    /// Its comment, from `#` on.
    pub comment: Option<Span>,
}

/// All lines of a text, readable or not.
pub fn raw_lines(text: &str, file: FileId) -> Vec<RawLine> {
    let (mut out, mut at) = (vec![], 0);
    while at < text.len() {
        let start = at;
        let line = match lex::logical(text, file, start) {
            Ok(Some(line)) => line,
            Ok(None) => break,
            Err(problems) => readable(text, file, start, problems.0.first().and_then(|d| d.span)),
        };
        at = line.next;
        let head = line.text.head(line.code);
        let words = whole_formulas(lex::words(&head).unwrap_or_default());
        let comment = (line.code < line.text.text.len()).then(|| {
            let from = line.text.span(line.code..line.code + 1).start as usize;
            Span::new(file, from, from + text[from..at].trim_end_matches(lex::blank).len())
        });
        if !words.is_empty() || comment.is_some() {
            out.push(RawLine { span: Span::new(file, start, at), words, comment });
        }
    }
    out
}

/// The words of a command that stands in quotes, as behind `then`.
pub fn raw_words(quoted: &Word) -> Vec<Word> {
    let text = Mapped::whole(&quoted.text, quoted.span, quoted.origin, quoted.unknown);
    let Ok(line) = lex::standalone(text) else { return vec![] };
    whole_formulas(lex::words(&line.text.head(line.code)).unwrap_or_default())
}

/// The physical line at `start` up to the quote that is never closed.
fn readable(text: &str, file: FileId, start: usize, fault: Option<Span>) -> Logical {
    let next = text[start..].find('\n').map_or(text.len(), |k| start + k + 1);
    let end = fault.map_or(start, |span| (span.start as usize).clamp(start, next));
    let mut line = Mapped::default();
    line.push_literal(&text[start..end], file, start);
    Logical { code: line.text.len(), text: line, next }
}

/// Words that blanks within `$(…)` have taken apart are one again.
fn whole_formulas(words: Vec<Word>) -> Vec<Word> {
    let mut out: Vec<Word> = vec![];
    let mut open = 0_usize;
    for word in words {
        let text = if open > 0 { word.text.as_str() } else { word.text.split_once("$(").map_or("", |w| w.1) };
        let before = open;
        if !word.quoted {
            open += usize::from(before == 0 && word.text.contains("$(")) + text.matches('(').count();
            open = open.saturating_sub(text.matches(')').count());
        }
        match out.last_mut().filter(|_| before > 0) {
            Some(last) => {
                last.text = format!("{} {}", last.text, word.text);
                last.span = last.span.to(word.span);
            }
            None => out.push(word),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<Vec<&str>> {
        let lines = raw_lines(text, FileId(0));
        let spans = |line: &RawLine| line.words.iter().map(|w| w.span).collect::<Vec<_>>();
        lines
            .iter()
            .map(|l| spans(l).iter().map(|s| &text[s.start as usize..s.end as usize]).collect())
            .collect()
    }

    #[test]
    fn words_have_their_places() {
        assert_eq!(
            words("fix 1 all &\n  nve # c\n\nrun 1"),
            [vec!["fix", "1", "all", "nve"], vec!["run", "1"]]
        );
        assert_eq!(words("r $(1 + (2) - 3) x"), [["r", "$(1 + (2) - 3)", "x"]]);
        assert_eq!(words("print \"a b\" 'c\nrun 1\n"), [vec!["print", "a b"], vec!["run", "1"]]);
        let lines = raw_lines("# ä\nrun 1 # b \r\n", FileId(0));
        let comments: Vec<_> = lines.iter().map(|l| l.comment.unwrap()).map(|s| (s.start, s.end)).collect();
        assert_eq!(comments, [(0, 4), (11, 14)]);
    }

    #[test]
    fn commands_in_quotes_have_places_too() {
        let text = "if 1 then \"fix a all nve\"";
        let inner = raw_words(&raw_lines(text, FileId(0))[0].words[3]);
        let span = inner[1].span;
        assert_eq!((inner.len(), &text[span.start as usize..span.end as usize]), (4, "a"));
    }
}
