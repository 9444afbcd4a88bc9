//! The words of a line, declared once: what a style reads is what its syntax line, its page, Tab and editors show.
//!
//! A style's line is a struct with `#[derive(Words)]` ([how](perigrain_words)). [`read`] takes a line apart by it, and [`Grammar`] is
//! the same declaration as data, for everything that shows or completes lines.

mod grammar;
mod values;

pub use crate::BuildCx;
pub use grammar::{Alternative, Form, Grammar, Keyword, Kind, Part, Placeholder, Syntax, alternatives};
pub use perigrain_base::diag::Result;
pub use perigrain_lang::{Args, Word};
pub use perigrain_words::Words;
pub use values::{
    At, AtomVariable, Axis, BondType, Fraction, GlobalValue, Idle, MarsagliaSeed, NonNegative, Nullable,
    OneType, Or, PerAtom, Positive, Reference, Seed, Steps, Turned, Types, Units, Value, VelocityAxis, Whole,
};

use crate::common::{choice_or_refuse, left_over, not_here, unknown_style};
use perigrain_base::diag::{Code, Diagnostics, Span, fail};

/// A line, or a part of one, as words in order and keywords.
pub trait Words: Sized {
    /// The declaration as data.
    const GRAMMAR: &'static Grammar;

    /// Takes the words that stand in order; keywords have their defaults.
    ///
    /// # Errors
    /// Every mistake in them.
    fn begin(args: &mut Args, cx: &BuildCx) -> Result<Self>;

    /// Takes what stands behind a keyword; `false` if it is none of these.
    ///
    /// # Errors
    /// Every mistake in the words behind it.
    fn keyword(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool>;
}

/// Two declarations side by side.
impl<A: Words, B: Words> Words for (A, B) {
    const GRAMMAR: &'static Grammar =
        &Grammar { parts: &[Part::All(A::GRAMMAR), Part::All(B::GRAMMAR)], keywords: &[], refused: &[] };

    fn begin(args: &mut Args, cx: &BuildCx) -> Result<Self> {
        Ok((A::begin(args, cx)?, B::begin(args, cx)?))
    }

    fn keyword(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool> {
        Ok(self.0.keyword(word, args, cx)? || self.1.keyword(word, args, cx)?)
    }
}

/// Takes a whole line apart.
///
/// # Errors
/// Every mistake in its words; unknown keywords, with the nearest one.
pub fn read<T: Words>(args: &mut Args, cx: &BuildCx) -> Result<T> {
    read_or(args, cx, |_| None)
}

/// As [`read`]; `foreign` refuses words that it knows where none of the line's keywords stands.
///
/// # Errors
/// As [`read`].
pub fn read_or<T: Words>(
    args: &mut Args,
    cx: &BuildCx,
    foreign: impl Fn(&Word) -> Option<Diagnostics>,
) -> Result<T> {
    args.keywords(|text| T::GRAMMAR.has(text));
    let mut line = T::begin(args, cx)?;
    while let Some(word) = args.next() {
        if !line.keyword(word, args, cx)? {
            return Err(foreign(word).unwrap_or_else(|| unexpected::<T>(word, args)));
        }
    }
    Ok(line)
}

/// Takes apart what stands within another line: it ends before the first word that is none of its own.
///
/// # Errors
/// Every mistake in its words.
pub fn inner<T: Words>(args: &mut Args, cx: &BuildCx) -> Result<T> {
    let mut part = T::begin(args, cx)?;
    while let Some(word) = args.peek().filter(|word| T::GRAMMAR.has(&word.text)) {
        args.next();
        part.keyword(word, args, cx)?;
    }
    Ok(part)
}

/// The refusal of a word where a keyword should stand.
fn unexpected<T: Words>(word: &Word, args: &Args) -> Diagnostics {
    let known = T::GRAMMAR.known();
    if T::GRAMMAR.refuses(&word.text) {
        return not_here(word, &format!("keyword of {}", args.command()));
    }
    if known.is_empty() || known.contains(&word.text.as_str()) {
        return left_over(word, args);
    }
    args.unknown(word, &known)
}

/// Takes one of the words of a table, for what stands beside it.
///
/// # Errors
/// Any other word, with the nearest known one.
pub fn one_in<T: Clone>(what: &str, args: &mut Args, rows: &[(&'static str, T)]) -> Result<T> {
    let names: Vec<&'static str> = rows.iter().map(|row| row.0).collect();
    let name = args.choice(what, &names)?;
    match rows.iter().find(|row| row.0 == name) {
        Some((_, value)) => Ok(value.clone()),
        None => unreachable!("`choice` takes none but these words"),
    }
}

/// The refusal of a keyword that has been given before.
///
/// # Errors
/// Always.
pub fn twice<T>(word: &Word) -> Result<T> {
    fail(Code::CONFLICT, word.span, format!("`{}` is given twice", word.text))
}

/// The refusal of a keyword where one of a list should stand.
///
/// # Errors
/// Always.
pub fn lacking<T>(what: &str, args: &Args) -> Result<T> {
    let text = format!("{what} is missing before `{}`", args.peek_text());
    fail(Code::MISSING_ARGUMENT, args.here(), text)
}

/// Takes one of the known words; one that only LAMMPS knows is refused by name.
///
/// # Errors
/// Any other word, with the nearest known one.
pub fn one_of(what: &str, args: &mut Args, known: &[&'static str], refused: &[&str]) -> Result<&'static str> {
    choice_or_refuse(args, what, known, refused)
}

/// As [`one_of`], where the words are styles.
///
/// # Errors
/// Any other word, with the nearest known one.
pub fn style_of(
    what: &str,
    args: &mut Args,
    known: &[&'static str],
    refused: &[&str],
) -> Result<&'static str> {
    let word = args.expect(what)?;
    if refused.contains(&word.text.as_str()) {
        return Err(not_here(word, what));
    }
    known.iter().find(|k| **k == word.text).copied().ok_or_else(|| unknown_style(word, what, known))
}

/// One of several forms of a line: its first word says which words and keywords stand behind it.
pub trait Forms: Sized {
    /// The declaration as data.
    const FORMS: &'static [Form];

    /// Takes the word and the whole line behind it apart.
    ///
    /// # Errors
    /// Every mistake in its words.
    fn form(args: &mut Args, cx: &BuildCx) -> Result<Self>;
}

/// Takes the end of a line: nothing stands there.
///
/// # Errors
/// Words left over.
pub fn nothing(args: &mut Args, foreign: impl Fn(&Word) -> Option<Diagnostics>) -> Result<()> {
    match args.peek().and_then(foreign) {
        Some(refusal) => Err(refusal),
        None => args.finish(),
    }
}

/// Keywords of which each counts, in their order.
pub trait Keywords: Sized {
    /// The declaration as data.
    const GRAMMAR: &'static Grammar;

    /// Takes what stands behind a keyword; nothing if it is none of these.
    ///
    /// # Errors
    /// Every mistake in the words behind it.
    fn keyword(word: &Word, args: &mut Args, cx: &BuildCx) -> Result<Option<Self>>;
}

/// All [`Keywords`] of a line.
#[derive(Clone, Debug)]
pub struct Each<T>(pub Vec<Given<T>>);

/// What a keyword says.
#[derive(Clone, Debug)]
pub struct Given<T> {
    /// The keyword.
    pub word: Word,
    /// The place of the keyword and the first word behind it.
    pub span: Span,
    /// What it says.
    pub value: T,
}

impl<T: Keywords> Words for Each<T> {
    const GRAMMAR: &'static Grammar = T::GRAMMAR;

    fn begin(_: &mut Args, _: &BuildCx) -> Result<Self> {
        Ok(Self(vec![]))
    }

    fn keyword(&mut self, word: &Word, args: &mut Args, cx: &BuildCx) -> Result<bool> {
        let span = word.span.to(args.here());
        let given = T::keyword(word, args, cx)?;
        let found = given.is_some();
        self.0.extend(given.map(|value| Given { word: word.clone(), span, value }));
        Ok(found)
    }
}
