//! Characters that look like a blank, a quote or a sign but are different ones, as in texts from web pages
//! and word processors.

use crate::diag::{Code, Diagnostic, Span};
use std::fmt::Write;

/// A character, its name, and its replacement.
type Letter = (char, &'static str, &'static str);

/// All characters that are replaced. LAMMPS replaces most of them in decks, and therefore in data files.
const LETTERS: &[Letter] = &[
    ('\u{a0}', "no-break space", " "),
    ('\u{ad}', "soft hyphen", " "),
    ('\u{61c}', "Arabic letter mark", " "),
    ('\u{1680}', "ogham space mark", " "),
    ('\u{180e}', "Mongolian vowel separator", " "),
    ('\u{2000}', "en quad", " "),
    ('\u{2001}', "em quad", " "),
    ('\u{2002}', "en space", " "),
    ('\u{2003}', "em space", " "),
    ('\u{2004}', "three-per-em space", " "),
    ('\u{2005}', "four-per-em space", " "),
    ('\u{2006}', "six-per-em space", " "),
    ('\u{2007}', "figure space", " "),
    ('\u{2008}', "punctuation space", " "),
    ('\u{2009}', "thin space", " "),
    ('\u{200a}', "hair space", " "),
    ('\u{200b}', "zero width space", " "),
    ('\u{200c}', "zero width non-joiner", " "),
    ('\u{200d}', "zero width joiner", " "),
    ('\u{200e}', "left-to-right mark", " "),
    ('\u{200f}', "right-to-left mark", " "),
    ('\u{2028}', "line separator", " "),
    ('\u{2029}', "paragraph separator", " "),
    ('\u{202a}', "left-to-right embedding", " "),
    ('\u{202b}', "right-to-left embedding", " "),
    ('\u{202c}', "pop directional formatting", " "),
    ('\u{202d}', "left-to-right override", " "),
    ('\u{202e}', "right-to-left override", " "),
    ('\u{202f}', "narrow no-break space", " "),
    ('\u{205f}', "medium mathematical space", " "),
    ('\u{2060}', "word joiner", " "),
    ('\u{2061}', "function application", " "),
    ('\u{2062}', "invisible times", " "),
    ('\u{2063}', "invisible separator", " "),
    ('\u{2066}', "left-to-right isolate", " "),
    ('\u{2067}', "right-to-left isolate", " "),
    ('\u{2068}', "first strong isolate", " "),
    ('\u{2069}', "pop directional isolate", " "),
    ('\u{3000}', "ideographic space", " "),
    ('\u{feff}', "byte order mark", " "),
    ('\u{2d6}', "modifier letter plus sign", "+"),
    ('\u{2064}', "invisible plus", "+"),
    ('\u{2d7}', "modifier letter minus sign", "-"),
    ('\u{2212}', "minus sign", "-"),
    ('\u{2018}', "left single quotation mark", "'"),
    ('\u{2019}', "right single quotation mark", "'"),
    ('\u{201c}', "left double quotation mark", "\""),
    ('\u{201d}', "right double quotation mark", "\""),
];

/// The replacement of a character: a blank, a sign or a quote; `None` for all others.
pub fn plain(c: char) -> Option<&'static str> {
    if c.is_ascii() {
        return None;
    }
    LETTERS.iter().find(|l| l.0 == c).map(|l| l.2)
}

/// A data text with look-alike blanks and signs replaced, and the replaced characters with their first bytes.
/// Every other byte keeps its position. Comments, which begin with `#`, and quotes are unchanged.
pub fn plain_data(text: String) -> (String, Vec<(char, usize)>) {
    if text.is_ascii() {
        return (text, vec![]);
    }
    let (mut out, mut found, mut comment) = (String::with_capacity(text.len()), vec![], false);
    for (at, c) in text.char_indices() {
        comment = c != '\n' && (comment || c == '#');
        match plain(c).filter(|new| !comment && !matches!(*new, "'" | "\"")) {
            Some(new) => {
                let _ = write!(out, "{new:>0$}", c.len_utf8());
                found.push((c, at));
            }
            None => out.push(c),
        }
    }
    (out, found)
}

/// One note about all replaced characters of a text: the position of the first one, and the count of each.
pub fn note(found: &[(char, Span)]) -> Option<Diagnostic> {
    let first = found.first()?.1;
    Some(Diagnostic::note(Code::LETTERS, first, named(found.iter().map(|f| f.0))))
}

/// The same for a data file, by the first bytes of the characters.
pub fn note_of_file(name: &str, text: &str, found: &[(char, usize)]) -> Option<Diagnostic> {
    let before = text.as_bytes().get(..found.first()?.1)?;
    let line = 1 + before.iter().filter(|b| **b == b'\n').count();
    let text = format!("`{name}`, line {line}: {}", named(found.iter().map(|f| f.0)));
    Some(Diagnostic::note(Code::LETTERS, None, text))
}

/// The same for a value given outside of a deck.
pub fn note_of_value(what: &str, found: &[char]) -> Option<Diagnostic> {
    found.first()?;
    Some(Diagnostic::note(Code::LETTERS, None, format!("{what}: {}", named(found.iter().copied()))))
}

fn named(found: impl Iterator<Item = char>) -> String {
    let mut kinds: Vec<(&Letter, usize)> = vec![];
    for letter in found.filter_map(|c| LETTERS.iter().find(|l| l.0 == c)) {
        match kinds.iter_mut().find(|k| k.0 == letter) {
            Some(kind) => kind.1 += 1,
            None => kinds.push((letter, 1)),
        }
    }
    let one = |((c, name, new), times): &(&Letter, usize)| {
        let times = if *times > 1 { format!(", {times} times") } else { String::new() };
        let new = if *new == " " { "a blank".to_string() } else { format!("`{new}`") };
        format!("U+{:04X} ({name}{times}) is read as {new}", *c as u32)
    };
    kinds.iter().map(one).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn data_keep_their_places_and_comments() {
        let (text, found) = plain_data("\u{feff}1\u{a0}2 \u{2212}3 # a\u{a0}b\n\u{200b}4".into());
        assert_eq!(text, "   1  2   -3 # a\u{a0}b\n   4");
        assert_eq!(found.iter().map(|f| f.1).collect::<Vec<_>>(), [0, 4, 8, 20]);
        let words = |text: &str| text.split_whitespace().count();
        assert_eq!(words(&plain_data("é\u{a0}1".into()).0), 2);
    }

    #[test]
    fn one_note_names_all() {
        let at = |k| Span { start: k, end: k + 2, ..Span::default() };
        let noted = note(&[('\u{a0}', at(3)), ('\u{201c}', at(5)), ('\u{a0}', at(9))]).unwrap();
        assert_eq!(
            noted.message,
            "U+00A0 (no-break space, 2 times) is read as a blank, U+201C (left double quotation mark) is read as `\"`"
        );
        assert_eq!(noted.span, Some(at(3)));
        assert_eq!(note(&[]), None);
    }
}
