//! Colours for a line that is being typed: command, style, numbers, values, texts, comments.

use crate::manual::knowing;
use perigrain_lang::number::parse;
use std::ops::Range;

/// What a stretch of a line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// A command that exists.
    Command,
    /// A first word that is no command.
    Unknown,
    /// The style of a fix, compute, dump or pair_style.
    Style,
    /// A number.
    Number,
    /// `$x`, `${…}`, `$(…)`, `v_…`, `c_…`, `f_…`.
    Value,
    /// Quoted text.
    Text,
    /// A comment.
    Comment,
}

impl Class {
    /// The escape sequence of its colour.
    fn colour(self) -> &'static str {
        match self {
            Class::Command => "\x1b[1;34m",
            Class::Unknown => "\x1b[31m",
            Class::Style => "\x1b[36m",
            Class::Number => "\x1b[33m",
            Class::Value => "\x1b[35m",
            Class::Text => "\x1b[32m",
            Class::Comment => "\x1b[2m",
        }
    }
}

/// The line with colours.
pub fn paint(line: &str) -> String {
    let mut out = String::new();
    let mut at = 0;
    for (range, class) in classes(line) {
        out += &line[at..range.start];
        out += class.colour();
        out += &line[range.clone()];
        out += "\x1b[0m";
        at = range.end;
    }
    out + &line[at..]
}

/// The stretches of a line that have a class, from left to right.
pub fn classes(line: &str) -> Vec<(Range<usize>, Class)> {
    let mut out = vec![];
    let (mut at, mut words) = (0, vec![]);
    while let Some(c) = line[at..].chars().next() {
        let rest = &line[at..];
        if c == '#' {
            out.push((at..line.len(), Class::Comment));
            break;
        }
        if c.is_whitespace() {
            if c == '\n' && !line[..at].trim_end().ends_with('&') {
                words.clear();
            }
            at += c.len_utf8();
        } else if c == '"' || c == '\'' {
            let end = at + quoted(rest, c);
            out.push((at..end, Class::Text));
            words.push(&line[at..end]);
            at = end;
        } else {
            let end = at + rest.find(|c: char| c.is_whitespace() || c == '#').unwrap_or(rest.len());
            let word = &line[at..end];
            if let Some(class) = class(word, &words) {
                out.push((at..end, class));
            }
            words.push(word);
            at = end;
        }
    }
    out
}

/// Bytes of a quoted stretch at the front; all of it if it is not closed.
fn quoted(text: &str, mark: char) -> usize {
    let mark = if text.starts_with("\"\"\"") { "\"\"\"" } else { &text[..mark.len_utf8()] };
    text[mark.len()..].find(mark).map_or(text.len(), |k| k + 2 * mark.len())
}

fn class(word: &str, before: &[&str]) -> Option<Class> {
    let Some(&command) = before.first() else {
        let known = word.starts_with(':') || word == "help" || knowing::commands().contains(&word);
        return Some(if known { Class::Command } else { Class::Unknown });
    };
    let style_at = match command {
        "pair_style" => 1,
        "fix" | "compute" | "dump" => 3,
        _ => 0,
    };
    if before.len() == style_at && knowing::styles(command).contains(&word) {
        return Some(Class::Style);
    }
    if parse(word).is_some() {
        return Some(Class::Number);
    }
    let value = word.contains('$') || ["v_", "c_", "f_", "C_", "F_"].iter().any(|p| word.starts_with(p));
    value.then_some(Class::Value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(line: &str) -> Vec<(&str, Class)> {
        classes(line).into_iter().map(|(r, c)| (&line[r], c)).collect()
    }

    #[test]
    fn words_have_their_classes() {
        use Class::*;
        let line = "fix 1 all viscous 1e-3 # drag";
        let wanted =
            [("fix", Command), ("1", Number), ("viscous", Style), ("1e-3", Number), ("# drag", Comment)];
        assert_eq!(seen(line), wanted);
        assert_eq!(seen("pair_sytle"), [("pair_sytle", Unknown)]);
        assert_eq!(seen("print \"v = $v\""), [("print", Command), ("\"v = $v\"", Text)]);
        assert_eq!(seen("run ${n} every v_k"), [("run", Command), ("${n}", Value), ("v_k", Value)]);
        assert_eq!(seen("print \"open"), [("print", Command), ("\"open", Text)]);
    }

    #[test]
    fn colours_change_no_character() {
        for line in ["fix 1 all nve", "größe 'a b", "a &\nb", "\"\"\"x\n\"y\"\"\"\" z"] {
            let bare: String = paint(line)
                .split('\x1b')
                .enumerate()
                .map(|(k, p)| if k == 0 { p } else { p.split_once('m').unwrap().1 })
                .collect();
            assert_eq!(bare, line);
        }
    }
}
