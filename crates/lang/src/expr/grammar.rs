//! The grammar of formulas in nom: precedence climbing that emits steps in postfix order.
//!
//! Precedence from loose to tight, all from left to right, as LAMMPS has it: `|| |^`, `&&`, `== !=`,
//! `< <= > >=`, `+ -`, `* / %`, `^`, and tightest the signs `-x` and `!x` (so that `-2^2` is 4).

use super::super::number;
use super::super::scan::{place, taken};
use super::functions::{self, Group};
use super::{ATTRIBUTES, Binary, Index, Name, Op, RefKind, Step, attribute, special};
use nom::branch::alt;
use nom::bytes::complete::{tag, take_till, take_while};
use nom::character::complete::{char, digit1, multispace0, one_of, satisfy};
use nom::combinator::{map_opt, opt};
use nom::multi::many_m_n;
use nom::sequence::{delimited, preceded};
use nom::{IResult, Parser};
use perigrain_base::diag::{Code, nearest};
use std::ops::Range;

/// How deep parentheses may nest.
const DEPTH: usize = 100;
/// How many steps one formula may have.
const STEPS: usize = 100_000;

/// Why a formula cannot be read, and which bytes are to blame.
#[derive(Debug)]
pub(super) struct Fault {
    pub code: Code,
    pub range: Range<usize>,
    pub message: String,
    pub help: Vec<String>,
}

type Parsed<'a> = Result<&'a str, Fault>;

/// The whole formula.
pub(super) fn parse(text: &str) -> Result<Vec<Step>, Fault> {
    let mut p = Program { text, steps: Vec::new() };
    let rest = p.binary(text, 0, 0)?;
    let rest = rest.trim_start();
    if rest.is_empty() {
        return Ok(p.steps);
    }
    Err(p.fault(Code::SYNTAX, p.word_at(rest), "an operator or the end of the formula is expected here"))
}

/// The program as it grows.
struct Program<'a> {
    text: &'a str,
    steps: Vec<Step>,
}

fn spaced<'a, O>(
    p: impl Parser<&'a str, Output = O, Error = nom::error::Error<&'a str>>,
) -> impl Parser<&'a str, Output = O, Error = nom::error::Error<&'a str>> {
    preceded(multispace0, p)
}

/// An operator with its level, and what follows it.
fn operator(input: &str) -> Option<(&str, (Binary, u8))> {
    let rest = input.trim_ascii_start();
    let (length, operator) = match rest.as_bytes() {
        [b'|', b'|', ..] => (2, (Binary::Or, 1)),
        [b'|', b'^', ..] => (2, (Binary::Xor, 1)),
        [b'&', b'&', ..] => (2, (Binary::And, 2)),
        [b'=', b'=', ..] => (2, (Binary::Equal, 3)),
        [b'!', b'=', ..] => (2, (Binary::NotEqual, 3)),
        [b'<', b'=', ..] => (2, (Binary::LessEqual, 4)),
        [b'>', b'=', ..] => (2, (Binary::GreaterEqual, 4)),
        [b'<', ..] => (1, (Binary::Less, 4)),
        [b'>', ..] => (1, (Binary::Greater, 4)),
        [b'+', ..] => (1, (Binary::Add, 5)),
        [b'-', ..] => (1, (Binary::Subtract, 5)),
        [b'*', ..] => (1, (Binary::Multiply, 6)),
        [b'/', ..] => (1, (Binary::Divide, 6)),
        [b'%', ..] => (1, (Binary::Modulo, 6)),
        [b'^', ..] => (1, (Binary::Power, 7)),
        _ => return None,
    };
    Some((&rest[length..], operator))
}

/// A name: a letter or underscore, then letters, digits and underscores.
fn name(input: &str) -> IResult<&str, &str> {
    let first = satisfy(|c| c.is_ascii_alphabetic() || c == '_');
    taken((first, take_while(|c: char| c.is_ascii_alphanumeric() || c == '_'))).parse(input)
}

/// `[3]` or `[v_name]`.
fn index(input: &str) -> IResult<&str, Index> {
    let number = map_opt(digit1, |d: &str| d.parse().ok().filter(|&k| k > 0).map(Index::Number));
    let variable = preceded(tag("v_"), take_while(|c: char| c.is_ascii_alphanumeric() || c == '_'))
        .map(|n: &str| Index::Variable(n.to_owned()));
    delimited(char('['), alt((number, variable)), char(']')).parse(input)
}

/// Everything up to the parenthesis that closes one already open.
pub(in super::super) fn balanced(input: &str) -> IResult<&str, &str> {
    let mut depth = 0usize;
    for (k, c) in input.char_indices() {
        match c {
            '(' => depth += 1,
            ')' if depth == 0 => return Ok((&input[k..], &input[..k])),
            ')' => depth -= 1,
            _ => {}
        }
    }
    Err(nom::Err::Error(nom::error::Error::new(input, nom::error::ErrorKind::Char)))
}

impl<'a> Program<'a> {
    /// Operands joined by operators of at least `level`.
    fn binary(&mut self, input: &'a str, level: u8, depth: usize) -> Parsed<'a> {
        let mut rest = self.signed(input, depth)?;
        while let Some((after, (op, l))) = operator(rest) {
            if l < level.max(1) {
                break;
            }
            let at = place(self.text, rest.trim_start())..place(self.text, after);
            rest = self.binary(after, l + 1, depth)?;
            self.emit(Op::Binary(op), at)?;
        }
        Ok(rest)
    }

    /// Signs before an operand.
    fn signed(&mut self, input: &'a str, depth: usize) -> Parsed<'a> {
        let mut signs = Vec::new();
        let mut rest = input;
        while let Ok((after, sign)) = spaced(one_of("-!")).parse(rest) {
            let end = place(self.text, after);
            signs.push((if sign == '-' { Op::Negate } else { Op::Not }, end - 1..end));
            rest = after;
        }
        rest = self.operand(rest.trim_start(), depth)?;
        for (op, range) in signs.into_iter().rev() {
            self.emit(op, range)?;
        }
        Ok(rest)
    }

    fn operand(&mut self, input: &'a str, depth: usize) -> Parsed<'a> {
        let at = place(self.text, input);
        if let Ok((after, _)) = char::<_, nom::error::Error<&str>>('(').parse(input) {
            self.deeper(at..at + 1, depth)?;
            let rest = self.binary(after, 0, depth + 1)?;
            return self.close(rest, at);
        }
        if input.starts_with('[') {
            return self.vector(input, at);
        }
        if let Ok((after, digits)) = number::literal(input) {
            return self.number(after, digits, at);
        }
        if let Ok((after, word)) = name(input) {
            return self.named(after, word, at, depth);
        }
        Err(self.fault(Code::SYNTAX, self.word_at(input), "a number, a name or ( is expected here"))
    }

    fn number(&mut self, after: &'a str, digits: &'a str, at: usize) -> Parsed<'a> {
        let range = at..at + digits.len();
        if after.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '.' || c == '_') {
            let tail = after.find(|c: char| !(c.is_ascii_alphanumeric() || c == '.' || c == '_'));
            let range = at..range.end + tail.unwrap_or(after.len());
            let message = format!("`{}` is not a number", &self.text[range.clone()]);
            return Err(self.fault(Code::BAD_NUMBER, range, message));
        }
        match digits.parse::<f64>() {
            Ok(v) if v.is_finite() => self.emit(Op::Number(v), range).map(|()| after),
            _ => Err(self.fault(Code::BAD_NUMBER, range, format!("`{digits}` is too large for a number"))),
        }
    }

    /// What starts with a letter: constant, reference, function, attribute, keyword.
    fn named(&mut self, after: &'a str, word: &'a str, at: usize, depth: usize) -> Parsed<'a> {
        let range = at..at + word.len();
        if after.trim_start().starts_with('(') {
            return self.call(after, word, at, depth);
        }
        let kind = word.chars().next().and_then(RefKind::from_letter);
        if let (Some(kind), Some(id)) = (kind, word.get(1..).and_then(|w| w.strip_prefix('_'))) {
            return self.reference(after, kind, id, at);
        }
        if let Ok((rest, i)) = index(after) {
            let range = at..place(self.text, rest);
            if !attribute(word) {
                let mut f = self.fault(Code::UNKNOWN_NAME, range, format!("`{word}` cannot have an index"));
                f.help.push(format!("particles have {}", ATTRIBUTES.join(" ")));
                return Err(f);
            }
            self.emit(Op::Particle(word.to_owned(), i), range)?;
            return Ok(rest);
        }
        if after.starts_with('[') {
            return Err(self.bad_index(after));
        }
        let op = match functions::constant(word) {
            Some(v) => Op::Number(v),
            None if attribute(word) => Op::Column(word.to_owned()),
            None => Op::Word(word.to_owned()),
        };
        self.emit(op, range)?;
        Ok(after)
    }

    fn reference(&mut self, after: &'a str, kind: RefKind, id: &'a str, at: usize) -> Parsed<'a> {
        let (rest, indices) = many_m_n(0, 2, index).parse(after).unwrap_or((after, vec![]));
        if rest.starts_with('[') {
            return Err(self.bad_index(rest));
        }
        let range = at..place(self.text, rest);
        if id.is_empty() {
            return Err(self.fault(Code::SYNTAX, range, "a name is missing after the underscore"));
        }
        let particle = matches!(kind, RefKind::ComputeAtom | RefKind::FixAtom);
        if particle && indices.is_empty() {
            let message = format!("`{}` needs the particle's number", &self.text[range.clone()]);
            let mut f = self.fault(Code::SYNTAX, range, message);
            f.help.push(format!(
                "write {0}_{id}[1], or {1}_{id} for all",
                kind.letter(),
                kind.letter().to_ascii_lowercase()
            ));
            return Err(f);
        }
        self.emit(Op::Reference(kind, id.to_owned(), indices), range)?;
        Ok(rest)
    }

    /// A name followed by a parenthesis.
    fn call(&mut self, after: &'a str, word: &'a str, at: usize, depth: usize) -> Parsed<'a> {
        let range = at..at + word.len();
        let open = after.trim_start();
        if let Some(g) = functions::group(word) {
            return self.group(&open[1..], g, at);
        }
        if let Some(row) = special::find(word) {
            return self.special(&open[1..], row, at);
        }
        let Some(function) = functions::find(word) else { return Err(self.no_function(word, range)) };
        self.deeper(range.clone(), depth)?;
        let mut rest = &open[1..];
        let mut count = 0;
        if let Ok((end, _)) = spaced(char(')')).parse(rest) {
            rest = end;
        } else {
            loop {
                rest = self.binary(rest, 0, depth + 1)?;
                count += 1;
                match opt(spaced(char(','))).parse(rest) {
                    Ok((next, Some(_))) => rest = next,
                    _ => break,
                }
            }
            rest = self.close(rest, place(self.text, open))?;
        }
        let range = at..place(self.text, rest);
        if count != function.arity {
            let wanted = function.arity;
            let s = if wanted == 1 { "" } else { "s" };
            let message = format!("{word}() takes {wanted} argument{s}, not {count}");
            return Err(self.fault(Code::SYNTAX, range, message));
        }
        self.emit(Op::Call(function), range)?;
        Ok(rest)
    }

    /// `count(group)`, `xcm(group,x,region)`: words between commas, no formulas.
    fn group(&mut self, inside: &'a str, g: &Group, at: usize) -> Parsed<'a> {
        let body: IResult<&str, &str> = take_till(|c| c == ')' || c == '(').parse(inside);
        let (rest, body) = body.unwrap_or(("", inside));
        let rest = self.close(rest, place(self.text, inside) - 1)?;
        let range = at..place(self.text, rest);
        let args = Self::names(body, place(self.text, inside));
        let least = 1 + usize::from(!g.words.is_empty());
        if args.len() < least || args.len() > least + 1 || args.iter().any(|a| a.text.is_empty()) {
            let usage = if least == 1 { "group" } else { "group,component" };
            let message = format!("{0}() reads {0}({usage}) or {0}({usage},region)", g.name);
            return Err(self.fault(Code::SYNTAX, range, message));
        }
        if least == 2 && !g.words.contains(&args[1].text.as_str()) {
            let message = format!("`{}` is no component of {}()", args[1].text, g.name);
            let mut f = self.fault(Code::BAD_VALUE, args[1].range.clone(), message);
            f.help.push(format!("one of {}", g.words.join(" ")));
            return Err(f);
        }
        self.emit(Op::Group(g.name.to_owned(), args), range)?;
        Ok(rest)
    }

    /// `sum(v_list)`, `is_active(pair,single)`: names between commas, up to the matching parenthesis.
    fn special(&mut self, inside: &'a str, row: &'static special::Row, at: usize) -> Parsed<'a> {
        let (rest, body) = balanced(inside).unwrap_or(("", inside));
        let rest = self.close(rest, place(self.text, inside) - 1)?;
        let range = at..place(self.text, rest);
        let from = place(self.text, inside);
        let mut args = Self::names(body, from);
        if row.usage.is_empty() && body.trim().is_empty() {
            args.clear();
        }
        // a pattern may hold commas of its own
        if row.what == special::Special::IsOs {
            args = vec![Self::name(body, from)];
        }
        if args.len() != row.usage.len() || args.iter().any(|a| a.text.is_empty()) {
            let message = format!("{0}() reads {0}({1})", row.name, row.usage.join(","));
            return Err(self.fault(Code::SYNTAX, range, message));
        }
        self.emit(Op::Special(row, args), range)?;
        Ok(rest)
    }

    /// Names between commas, each with its bytes of the formula; `from` is the first byte of the list.
    fn names(list: &str, from: usize) -> Vec<Name> {
        let mut at = from;
        let mut names = vec![];
        for part in list.split(',') {
            names.push(Self::name(part, at));
            at += part.len() + 1;
        }
        names
    }

    fn name(part: &str, from: usize) -> Name {
        let text = part.trim();
        let at = from + part.len() - part.trim_start().len();
        Name { text: text.to_owned(), range: at..at + text.len() }
    }

    /// `[1,3,7]`: numbers between commas.
    fn vector(&mut self, input: &'a str, at: usize) -> Parsed<'a> {
        let Some(end) = input.find(']') else {
            return Err(self.fault(Code::SYNTAX, at..at + 1, "this bracket is never closed"));
        };
        let mut list = vec![];
        let mut from = at + 1;
        for word in input[1..end].split(',') {
            let lead = word.len() - word.trim_start().len();
            let range = from + lead..from + lead + word.trim().len();
            from += word.len() + 1;
            let Some(v) = number::parse(word.trim()) else {
                let range = if range.is_empty() { at..at + end + 1 } else { range };
                let message = format!("`{}` is not a number: a vector is written [1,3,7]", word.trim());
                return Err(self.fault(Code::BAD_NUMBER, range, message));
            };
            list.push(v);
        }
        self.emit(Op::Vector(list), at..at + end + 1)?;
        Ok(&input[end + 1..])
    }

    /// The closing parenthesis of the one at byte `open`.
    fn close(&self, rest: &'a str, open: usize) -> Parsed<'a> {
        let closed: IResult<&str, char> = spaced(char(')')).parse(rest);
        if let Ok((after, _)) = closed {
            return Ok(after);
        }
        if rest.trim().is_empty() {
            return Err(self.fault(Code::SYNTAX, open..open + 1, "this parenthesis is never closed"));
        }
        Err(self.fault(
            Code::SYNTAX,
            self.word_at(rest.trim_start()),
            "an operator, a comma or ) is expected here",
        ))
    }

    fn no_function(&self, word: &str, range: Range<usize>) -> Fault {
        if word.starts_with("py_") {
            let message = format!("perigrain has no Python inside, so no function {word}()");
            return self.fault(Code::NOT_SUPPORTED, range, message);
        }
        let mut f = self.fault(Code::UNKNOWN_NAME, range, format!("there is no function {word}()"));
        if let Some(n) = nearest(word, functions::names()) {
            f.help.push(format!("did you mean {n}()?"));
        }
        f
    }

    fn bad_index(&self, rest: &str) -> Fault {
        let at = place(self.text, rest);
        let end = rest.find(']').map_or(self.text.len(), |k| at + k + 1);
        self.fault(Code::SYNTAX, at..end, "an index is a whole number from 1, or v_name, in brackets")
    }

    fn deeper(&self, range: Range<usize>, depth: usize) -> Result<(), Fault> {
        if depth < DEPTH {
            return Ok(());
        }
        Err(self.fault(Code::SYNTAX, range, format!("parentheses nest deeper than {DEPTH}")))
    }

    fn emit(&mut self, op: Op, range: Range<usize>) -> Result<(), Fault> {
        if self.steps.len() >= STEPS {
            return Err(self.fault(Code::SYNTAX, range, format!("the formula has more than {STEPS} parts")));
        }
        self.steps.push(Step { op, range });
        Ok(())
    }

    /// The word (or sign) at the front of `rest`; the last byte if nothing is left.
    fn word_at(&self, rest: &str) -> Range<usize> {
        let at = place(self.text, rest);
        if rest.is_empty() {
            return self.text.char_indices().next_back().map_or(0, |(k, _)| k)..self.text.len();
        }
        let word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
        let len = rest.find(|c| !word(c)).unwrap_or(rest.len());
        at..at + len.max(rest.chars().next().map_or(0, char::len_utf8))
    }

    fn fault(&self, code: Code, range: Range<usize>, message: impl Into<String>) -> Fault {
        Fault { code, range, message: message.into(), help: vec![] }
    }
}
