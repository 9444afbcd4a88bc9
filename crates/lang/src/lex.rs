//! The lexer: physical lines into logical lines, logical lines into words, with nom.

use super::command::{Command, Word};
use super::scan::place;
use super::text::Mapped;
use nom::bytes::complete::{tag, take_till, take_until, take_while1};
use nom::character::complete::{char, none_of};
use nom::combinator::opt;
use nom::sequence::{delimited, terminated};
use nom::{IResult, Parser, branch::alt};
use perigrain_base::diag::{Code, Diagnostic, FileId, Result, Span, fail};
use perigrain_base::letters;

/// What the end of a physical line finds open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mode {
    /// Nothing.
    Plain,
    /// Inside '…', "…" or """…""", opened at this byte of the logical line.
    Quote(Quote, usize),
    /// After `#`.
    Comment(usize),
}

/// The three kinds of quotes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Quote {
    /// `'…'`
    Single,
    /// `"…"`
    Double,
    /// `"""…"""`
    Triple,
}

impl Quote {
    pub(super) fn mark(self) -> &'static str {
        match self {
            Quote::Single => "'",
            Quote::Double => "\"",
            Quote::Triple => "\"\"\"",
        }
    }
    fn name(self) -> &'static str {
        match self {
            Quote::Single => "single",
            Quote::Double => "double",
            Quote::Triple => "triple",
        }
    }
}

/// A logical line of a source text.
pub(super) struct Logical {
    /// The line with `&` joins done, comment included.
    pub text: Mapped,
    /// Where its comment starts; its length if there is none.
    pub code: usize,
    /// The first byte after it in the source.
    pub next: usize,
}

/// The physical line at the front of `input` and what follows its line break.
fn physical(input: &str) -> IResult<&str, &str> {
    terminated(take_till(|c| c == '\n'), opt(char('\n'))).parse(input)
}

/// An opening quote mark.
pub(super) fn opening(input: &str) -> IResult<&str, Quote> {
    alt((
        tag("\"\"\"").map(|_| Quote::Triple),
        tag("\"").map(|_| Quote::Double),
        tag("'").map(|_| Quote::Single),
    ))
    .parse(input)
}

/// One step of the scan for quotes and comments: what it consumed, and the state after it.
pub(super) fn advance(input: &str, at: usize, mode: Mode) -> IResult<&str, Mode> {
    match mode {
        Mode::Comment(_) => take_while1(|_| true).map(|_| mode).parse(input),
        Mode::Quote(q, _) => {
            alt((tag(q.mark()).map(|_| Mode::Plain), none_of("").map(move |_| mode))).parse(input)
        }
        Mode::Plain => alt((
            opening.map(|q| Mode::Quote(q, at)),
            char('#').map(|_| Mode::Comment(at)),
            none_of("").map(|_| Mode::Plain),
        ))
        .parse(input),
    }
}

/// Scans `text`, which starts at byte `base` of its line.
fn scan(text: &str, base: usize, mut mode: Mode) -> Mode {
    let mut rest = text;
    loop {
        if mode == Mode::Plain {
            // the bytes that can change the state
            let Some(k) = rest.find(['"', '\'', '#']) else { return mode };
            rest = &rest[k..];
        }
        let Ok((after, next)) = advance(rest, base + place(text, rest), mode) else { return mode };
        (rest, mode) = (after, next);
    }
}

/// The bytes of a physical line at which stands what is read as something else, with that.
///
/// In quotes only blanks count, and the quote that closes one of its kind.
fn odd(line: &str, mut mode: Mode) -> Vec<(usize, &'static str)> {
    let (mut found, mut rest, mut curly) = (vec![], line, false);
    while let Some(c) = rest.chars().next().filter(|_| !matches!(mode, Mode::Comment(_))) {
        let at = place(line, rest);
        let new = letters::plain(c).filter(|new| match mode {
            Mode::Quote(q, _) => *new == " " || curly && *new == q.mark(),
            _ => true,
        });
        let Some(new) = new else {
            let Ok((after, next)) = advance(rest, at, mode) else { break };
            if next != mode {
                curly = false;
            }
            (rest, mode) = (after, next);
            continue;
        };
        found.push((at, new));
        if let Ok((_, next)) = advance(new, at, mode) {
            curly = matches!(next, Mode::Quote(..)) && (curly || next != mode);
            mode = next;
        }
        rest = &rest[c.len_utf8()..];
    }
    found
}

/// Reads the logical line that starts at byte `start` of `source`; `None` at its end.
pub(super) fn logical(source: &str, file: FileId, start: usize) -> Result<Option<Logical>> {
    let Some(mut rest) = source.get(start..).filter(|r| !r.is_empty()) else { return Ok(None) };
    let mut text = Mapped::default();
    let mut mode = Mode::Plain;
    while let Ok((after, line)) = physical(rest) {
        let at = place(source, rest);
        let body = line.strip_suffix('\r').unwrap_or(line);
        let before = text.text.len();
        let odd = if body.is_ascii() { vec![] } else { odd(body, mode) };
        text.push_line(body, file, at, &odd);
        mode = scan(&text.text[before..], before, mode);
        rest = after;
        let joined = text.text[before..].trim_end().strip_suffix('&').map(str::len);
        if joined.is_none() && matches!(mode, Mode::Quote(Quote::Triple, _)) && !rest.is_empty() {
            text.push_literal(&source[at + body.len()..place(source, rest)], file, at + body.len());
            continue;
        }
        if let Some(length) = joined {
            text.truncate(before + length);
        }
        if joined.is_none() || rest.is_empty() {
            break;
        }
    }
    if let Mode::Quote(q, at) = mode {
        return Err(unclosed(q, text.span(at..at + q.mark().len())).into());
    }
    let code = if let Mode::Comment(at) = mode { at.min(text.text.len()) } else { text.text.len() };
    Ok(Some(Logical { text, code, next: place(source, rest) }))
}

/// The characters of a deck that are read as others, with their places.
pub fn odd_letters(source: &str, file: FileId) -> Vec<(char, Span)> {
    let (mut at, mut found) = (0, vec![]);
    while !source.is_ascii() && at < source.len() {
        match logical(source, file, at) {
            Ok(Some(line)) => {
                let letter = |s: Span| Some((source.get(s.start as usize..)?.chars().next()?, s));
                found.extend(line.text.replaced(line.code).filter_map(letter));
                at = line.next;
            }
            Ok(None) => break,
            // A line that cannot be read is refused; what stands behind it is looked at nonetheless.
            Err(_) => at += source[at..].find('\n').map_or(source.len() - at, |k| k + 1),
        }
    }
    found
}

/// A value that is given outside of a deck, with what its odd characters are read as, and those.
pub fn plain_value(text: &str) -> (String, Vec<char>) {
    let odd = odd(text, Mode::Plain);
    let mut value = Mapped::default();
    value.push_line(text, FileId::default(), 0, &odd);
    (value.text, odd.iter().filter_map(|(at, _)| text[*at..].chars().next()).collect())
}

/// Whether a text typed so far ends inside a logical line: `&` at its end, or `"""` still open.
pub fn is_unfinished(text: &str) -> bool {
    let (mut mode, mut open) = (Mode::Plain, false);
    for line in text.split('\n') {
        mode = scan(line, 0, if open { mode } else { Mode::Plain });
        open = matches!(mode, Mode::Quote(Quote::Triple, _)) || line.trim_end().ends_with('&');
    }
    open
}

/// A line that does not come from a file: the comment is found, quotes are checked.
pub(super) fn standalone(text: Mapped) -> Result<Logical> {
    let mode = scan(&text.text, 0, Mode::Plain);
    if let Mode::Quote(q, at) = mode {
        return Err(unclosed(q, text.span(at..at + q.mark().len())).into());
    }
    let code = if let Mode::Comment(at) = mode { at } else { text.text.len() };
    Ok(Logical { text, code, next: 0 })
}

/// The complaint about a quote without its partner.
pub(super) fn unclosed(q: Quote, span: Span) -> Diagnostic {
    Diagnostic::error(Code::OPEN_QUOTE, span, format!("unmatched {} quote", q.name()))
        .help(format!("close it with {}, or continue the line with & at its end", q.mark()))
}

/// A word: the bytes inside the quotes, and the length of the quote mark (0 for a bare word).
fn word(input: &str) -> IResult<&str, (&str, usize)> {
    if !matches!(input.as_bytes().first(), None | Some(b'"' | b'\'')) {
        let end = until_blank(input);
        if end > 0 {
            return Ok((&input[end..], (&input[..end], 0)));
        }
    }
    let triple = delimited(tag("\"\"\""), take_until("\"\"\""), tag("\"\"\""));
    let double = delimited(char('"'), take_till(|c| c == '"'), char('"'));
    let single = delimited(char('\''), take_till(|c| c == '\''), char('\''));
    alt((triple.map(|w| (w, 3)), double.map(|w| (w, 1)), single.map(|w| (w, 1)))).parse(input)
}

/// What stands between words.
pub(super) fn blank(c: char) -> bool {
    c.is_ascii_whitespace() || c == '\x0b'
}

/// How many bytes stand before the first blank. Blanks are single bytes: the other characters need not be decoded.
fn until_blank(text: &str) -> usize {
    text.bytes().position(|b| blank(b.into())).unwrap_or(text.len())
}

/// What stands behind the blanks at the front.
fn past_blanks(text: &str) -> &str {
    &text[text.bytes().position(|b| !blank(b.into())).unwrap_or(text.len())..]
}

/// Splits a line (comment cut off, values put in) into its words.
pub(super) fn words(line: &Mapped) -> Result<Vec<Word>> {
    let text = line.text.as_str();
    let mut out = Vec::new();
    let mut rest = past_blanks(text);
    while !rest.is_empty() {
        let Ok((after, (body, mark))) = word(rest) else {
            let at = place(text, rest);
            let span = line.span(at..at + 1);
            let q = if rest.starts_with('\'') { Quote::Single } else { Quote::Double };
            return Err(unclosed(q, span).into());
        };
        let next = past_blanks(after);
        let glued = next.len() == after.len() && !after.is_empty();
        if mark > 0 && glued {
            let at = place(text, after);
            let end = at + until_blank(after);
            return fail(Code::SYNTAX, line.span(at..end), "a closing quote must be followed by a space");
        }
        let at = place(text, rest) + mark;
        let range = at..at + body.len();
        let (span, origin, unknown) = line.place(range);
        out.push(Word { text: body.to_owned(), span, quoted: mark > 0, origin, unknown });
        rest = next;
    }
    Ok(out)
}

/// The command a line holds, `None` if it holds no word.
pub(super) fn command(line: &Mapped) -> Result<Option<Command>> {
    let mut words = words(line)?;
    if words.is_empty() {
        return Ok(None);
    }
    let args = words.split_off(1);
    let Some(name) = words.pop() else { return Ok(None) };
    let last = args.last().map_or(name.span, |w| w.span);
    Ok(Some(Command { span: name.span.to(last), name, args, text: line.text.clone() }))
}
