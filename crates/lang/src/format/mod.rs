//! Decks laid out anew: blanks, columns, comments and empty lines, never words.

mod columns;
mod rows;

use super::lex::{self, Logical};
use columns::written;
use perigrain_base::diag::{Code, Diagnostics, FileId, Result, fail};
use rows::{Row, rows_of};

/// A layout that is laid out again so often and still changes is given up; two passes are usual.
const PASSES: usize = 12;

/// The text with one blank between words or columns where it had them, comments in columns, no blanks at the ends of lines
/// and no two empty lines in a row. Words, quoted texts, `$(…)` and line endings stay as they are, and so does a line whose words
/// would not.
///
/// # Errors
/// Each line that cannot be taken apart, with its place in `file`.
pub fn format(text: &str, file: FileId) -> Result<String> {
    let before = lines(text, file)?;
    let mut out = text.to_owned();
    let mut kept = vec![false; before.len()];
    for _ in 0..PASSES {
        let next = pass(&out, file, &kept)?;
        let after = lines(&next, file)?;
        if let Some(changed) = changed(text, &before, &next, &after, &mut kept) {
            if changed {
                out = text.to_owned();
                continue;
            }
        } else {
            return unlike();
        }
        if next == out {
            return Ok(out);
        }
        out = next;
    }
    unlike()
}

fn unlike<T>() -> Result<T> {
    fail(Code::SYNTAX, None, "this text cannot be laid out without changing its words")
}

/// A line that holds something: where it starts and ends, and where its comment does.
struct Held {
    start: usize,
    line: Logical,
}

/// All lines that are not empty.
fn lines(text: &str, file: FileId) -> Result<Vec<Held>> {
    let (mut at, mut out, mut problems) = (0, vec![], Diagnostics::default());
    loop {
        match lex::logical(text, file, at) {
            Ok(None) => break,
            Ok(Some(line)) => {
                let start = std::mem::replace(&mut at, line.next);
                if !is_empty(&text[start..at]) {
                    out.push(Held { start, line });
                }
            }
            Err(e) => {
                problems.append(e);
                at += text[at..].find('\n').map_or(text.len() - at, |k| k + 1);
            }
        }
    }
    if problems.is_empty() { Ok(out) } else { Err(problems) }
}

fn is_empty(line: &str) -> bool {
    line.chars().all(lex::blank)
}

/// Marks the lines whose words or comments have changed, and returns whether there are any; `None` if lines were added or
/// removed.
fn changed(old: &str, before: &[Held], new: &str, after: &[Held], kept: &mut [bool]) -> Option<bool> {
    let mut any = false;
    for (k, line) in before.iter().enumerate() {
        let same = after.get(k).is_some_and(|other| meaning(old, line) == meaning(new, other));
        if !same && std::mem::replace(&mut kept[k], true) {
            return None;
        }
        if !same {
            any = true;
            if before.len() != after.len() {
                break;
            }
        }
    }
    (any || before.len() == after.len()).then_some(any)
}

/// The words of a line, if they can be determined, and its comment.
fn meaning(text: &str, held: &Held) -> (Option<Vec<(String, bool)>>, String) {
    let line = &held.line;
    let words = lex::words(&line.text.head(line.code));
    let words = words.ok().map(|words| words.into_iter().map(|w| (w.text, w.quoted)).collect());
    let comment = &line.text.text[line.code..];
    let whole = if words.is_none() { &text[held.start..line.next] } else { "" };
    (words, format!("{}{}", comment.trim_end_matches(lex::blank), whole.trim_end_matches(lex::blank)))
}

/// Lays a text out once; lines that are `kept` stay byte by byte.
fn pass(text: &str, file: FileId, kept: &[bool]) -> Result<String> {
    let mut rows: Vec<Row<'_>> = vec![];
    let (mut at, mut k, mut gap) = (0, 0, false);
    while let Some(line) = lex::logical(text, file, at)? {
        let whole = &text[at..line.next];
        at = line.next;
        if is_empty(whole) {
            gap = true;
            continue;
        }
        if std::mem::take(&mut gap) && !rows.is_empty() {
            rows.push(Row::empty(whole));
        }
        match kept.get(k) {
            Some(true) => rows.push(Row::as_it_is(whole)),
            _ => rows.extend(rows_of(whole)),
        }
        k += 1;
    }
    let dos = text.find('\n').is_some_and(|k| text[..k].ends_with('\r'));
    Ok(written(&rows, if dos { "\r\n" } else { "\n" }))
}

#[cfg(test)]
mod tests;
