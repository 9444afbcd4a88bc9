//! The conditions of `if`: comparisons of numbers or of texts, joined by `&& || |^ !`.

use super::number;
use super::scan::{place, taken};
use super::text::Mapped;
use nom::branch::alt;
use nom::bytes::complete::{take_while, take_while1};
use nom::character::complete::{char, satisfy};
use nom::combinator::opt;
use nom::{IResult, Parser};
use perigrain_base::diag::{Code, Diagnostics, Result, fail};

/// How deep parentheses may nest.
const DEPTH: usize = 100;

#[derive(Clone, Debug, PartialEq)]
enum Item<'a> {
    Number(f64),
    Text(&'a str),
    /// Only a run determines it.
    Unknown,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Op {
    Or,
    Xor,
    And,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
}

/// Whether a condition (with values inserted) holds; `None` if it depends on a value that only a run determines.
pub(super) fn holds(text: &Mapped) -> Result<Option<bool>> {
    let reader = Reader { line: text, text: &text.text };
    let (rest, item) = reader.binary(&text.text, 1, 0)?;
    if !rest.trim().is_empty() {
        return Err(reader.unexpected(rest.trim_start()));
    }
    match item {
        Item::Number(v) => Ok(Some(v != 0.0)),
        Item::Unknown => Ok(None),
        Item::Text(t) => {
            let span = reader.line.span(0..reader.text.len());
            fail(
                Code::WRONG_KIND,
                span,
                format!("`{t}` is neither true nor false; compare it with something"),
            )
        }
    }
}

/// An operator with its level, and what follows it.
fn operator(input: &str) -> Option<(&str, (Op, u8))> {
    let rest = input.trim_ascii_start();
    let (length, operator) = match rest.as_bytes() {
        [b'|', b'|', ..] => (2, (Op::Or, 1)),
        [b'|', b'^', ..] => (2, (Op::Xor, 1)),
        [b'&', b'&', ..] => (2, (Op::And, 2)),
        [b'=', b'=', ..] => (2, (Op::Equal, 3)),
        [b'!', b'=', ..] => (2, (Op::NotEqual, 3)),
        [b'<', b'=', ..] => (2, (Op::LessEqual, 4)),
        [b'>', b'=', ..] => (2, (Op::GreaterEqual, 4)),
        [b'<', ..] => (1, (Op::Less, 4)),
        [b'>', ..] => (1, (Op::Greater, 4)),
        _ => return None,
    };
    Some((&rest[length..], operator))
}

/// What an operator makes of a value that is not known; `None` if both are. `0 && x` is false whatever x is.
fn unsure<'a>(op: Op, a: &Item<'_>, b: &Item<'_>) -> Option<Item<'a>> {
    let settled =
        |truth: bool| matches!((a, b), (Item::Number(v), _) | (_, Item::Number(v)) if (*v != 0.0) == truth);
    if *a != Item::Unknown && *b != Item::Unknown {
        return None;
    }
    Some(match op {
        Op::And if settled(false) => Item::Number(0.0),
        Op::Or if settled(true) => Item::Number(1.0),
        _ => Item::Unknown,
    })
}

/// A number or a word that starts with a letter, which may hold slashes as the names of styles do.
fn item(input: &str) -> IResult<&str, &str> {
    let name = take_while(|c: char| c.is_ascii_alphanumeric() || c == '_' || c == '/');
    let word = taken((satisfy(|c| c.is_ascii_alphabetic() || c == '_'), name));
    let number = taken((opt(char('-')), number::literal));
    alt((number, word)).parse(input)
}

struct Reader<'a> {
    line: &'a Mapped,
    text: &'a str,
}

impl<'a> Reader<'a> {
    fn binary(&self, input: &'a str, level: u8, depth: usize) -> Result<(&'a str, Item<'a>)> {
        let (mut rest, mut left) = self.operand(input, depth)?;
        while let Some((after, (op, l))) = operator(rest) {
            if l < level {
                break;
            }
            let (next, right) = self.binary(after, l + 1, depth)?;
            left = match unsure(op, &left, &right) {
                Some(item) => item,
                None => Item::Number(self.apply(op, &left, &right, input, next)?),
            };
            rest = next;
        }
        Ok((rest, left))
    }

    fn operand(&self, input: &'a str, depth: usize) -> Result<(&'a str, Item<'a>)> {
        let mut rest = input.trim_start();
        let mut nots = 0;
        while let Some(r) = rest.strip_prefix('!') {
            nots += 1;
            rest = r.trim_start();
        }
        let start = rest;
        let (rest, item) = self.primary(rest, depth)?;
        if nots == 0 {
            return Ok((rest, item));
        }
        let v = match item {
            Item::Number(v) => v,
            Item::Unknown => return Ok((rest, Item::Unknown)),
            Item::Text(_) => return Err(self.not_a_number(start, rest)),
        };
        let truth = (v != 0.0) ^ (nots % 2 == 1);
        Ok((rest, Item::Number(f64::from(u8::from(truth)))))
    }

    fn primary(&self, input: &'a str, depth: usize) -> Result<(&'a str, Item<'a>)> {
        if let Some(inside) = input.strip_prefix('(') {
            let open = self.line.span(place(self.text, input)..place(self.text, inside));
            if depth >= DEPTH {
                return fail(Code::FORMULA, open, format!("parentheses nest deeper than {DEPTH}"));
            }
            let (rest, item) = self.binary(inside, 1, depth + 1)?;
            let Some(after) = rest.trim_start().strip_prefix(')') else {
                return fail(Code::FORMULA, open, "this parenthesis is never closed");
            };
            return Ok((after, item));
        }
        let Ok((rest, word)) = item(input) else { return Err(self.unexpected(input)) };
        if rest.starts_with(|c: char| !(c.is_ascii_whitespace() || "()=!<>&|".contains(c))) {
            return Err(self.unexpected(rest));
        }
        let at = place(self.text, input);
        if self.line.unknown(at..at + word.len()) {
            return Ok((rest, Item::Unknown));
        }
        match number::parse(word) {
            Some(v) => Ok((rest, Item::Number(v))),
            None => Ok((rest, Item::Text(word))),
        }
    }

    fn apply(&self, op: Op, a: &Item<'_>, b: &Item<'_>, from: &str, to: &str) -> Result<f64> {
        let truth = match (a, b) {
            (Item::Number(a), Item::Number(b)) => match op {
                Op::Or => *a != 0.0 || *b != 0.0,
                Op::Xor => (*a != 0.0) != (*b != 0.0),
                Op::And => *a != 0.0 && *b != 0.0,
                Op::Equal => a == b,
                Op::NotEqual => a != b,
                Op::Less => a < b,
                Op::LessEqual => a <= b,
                Op::Greater => a > b,
                Op::GreaterEqual => a >= b,
            },
            (Item::Text(a), Item::Text(b)) if op == Op::Equal => a == b,
            (Item::Text(a), Item::Text(b)) if op == Op::NotEqual => a != b,
            (Item::Text(_), Item::Text(_)) => return Err(self.not_a_number(from, to)),
            _ => {
                let span = self.extent(from, to);
                return fail(Code::WRONG_KIND, span, "a number cannot be compared with a text");
            }
        };
        Ok(f64::from(u8::from(truth)))
    }

    fn extent(&self, from: &str, to: &str) -> perigrain_base::diag::Span {
        let start = place(self.text, from.trim_start());
        self.line.span(start..place(self.text, to).max(start + 1).min(self.text.len()))
    }

    fn not_a_number(&self, from: &str, to: &str) -> Diagnostics {
        let d = perigrain_base::diag::Diagnostic::error(
            Code::WRONG_KIND,
            self.extent(from, to),
            "texts can only be compared by == and !=",
        );
        d.into()
    }

    fn unexpected(&self, rest: &str) -> Diagnostics {
        let at = place(self.text, rest);
        let word: IResult<&str, &str> =
            take_while1(|c: char| c.is_alphanumeric() || c == '_' || c == '.').parse(rest);
        let len = word.map_or_else(|_| rest.chars().next().map_or(0, char::len_utf8), |(_, w)| w.len());
        let span = self.line.span(at.min(self.text.len().saturating_sub(1))..(at + len).max(1));
        let message =
            if rest.is_empty() { "the condition breaks off" } else { "this cannot stand in a condition" };
        perigrain_base::diag::Diagnostic::error(Code::FORMULA, span, message)
            .help("conditions compare numbers or names; for a formula write \"$(…) > 0\"")
            .into()
    }
}
