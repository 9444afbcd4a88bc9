//! Reading words of LIGGGHTS: numbers that may be formulas still, whole numbers that may be reals, words out of a list.

use crate::native::instead;
use perigrain_base::diag::{Code, Diagnostic, Result, nearest};
use perigrain_lang::args::parse_number;
use perigrain_lang::{Args, Word, blame};

/// Whether values are still to be put into the word: a deck is being rewritten, not run.
pub(crate) fn is_open(word: &Word) -> bool {
    word.text.contains('$')
}

/// Takes a number, a `${variable}` of a deck that is rewritten, or `v_name` where `variable` allows it.
pub(crate) fn number(args: &mut Args, what: &str) -> Result<Word> {
    let word = args.expect(what)?;
    if !is_open(word) {
        parse_number(word, what)?;
    }
    Ok(word.clone())
}

/// Takes three numbers.
pub(crate) fn vector(args: &mut Args, what: &str) -> Result<Vec<Word>> {
    (0..3).map(|_| number(args, what)).collect()
}

/// The whole number that a word means: a real is cut off behind its point, with a note.
pub(crate) fn rounded(word: &Word) -> (Word, Option<Diagnostic>) {
    if is_open(word) || word.unknown || word.text.parse::<i64>().is_ok() {
        return (word.clone(), None);
    }
    let Ok(x) = word.text.parse::<f64>() else { return (word.clone(), None) };
    let near = x.round();
    if (x - near).abs() <= 1e-9 * near.abs().max(1.0) {
        return (instead(word, format!("{near:.0}")), None);
    }
    let text = format!("`{}` is no whole number: read as {:.0}", word.text, x.trunc());
    (instead(word, format!("{:.0}", x.trunc())), Some(Diagnostic::note(Code::DIALECT, word.span, text)))
}

/// The value of a number, where the deck is run.
pub(crate) fn value(word: &Word) -> Option<f64> {
    if is_open(word) { None } else { word.text.parse().ok() }
}

/// What a formula or a variable of the deck is in a larger formula.
pub(crate) fn inside(word: &Word) -> String {
    let name = word.text.strip_prefix("${").and_then(|rest| rest.strip_suffix('}'));
    let letter = word.text.strip_prefix('$').filter(|rest| rest.len() == 1);
    if let Some(name) = name.or(letter).filter(|name| !name.contains('$')) {
        return format!("v_{name}");
    }
    match word.text.strip_prefix("$(").and_then(|rest| rest.strip_suffix(')')) {
        Some(formula) => format!("({formula})"),
        None => word.text.clone(),
    }
}

/// Twice a number.
pub(crate) fn twice(word: &Word) -> Word {
    match value(word) {
        Some(x) => instead(word, format!("{}", 2.0 * x)),
        None => instead(word, format!("$(2*{})", inside(word))),
    }
}

/// The error for a word that is none of these; `what` is its kind.
pub(crate) fn unknown(word: &Word, what: &str, known: &[&str]) -> Diagnostic {
    let d = blame(word, Code::UNKNOWN_KEYWORD, format!("unknown {what} of LIGGGHTS: `{}`", word.text));
    match nearest(&word.text, known.iter().copied()) {
        Some(near) => d.help(format!("did you mean `{near}`?")),
        None => d.help(format!("known: {}", known.join(" "))),
    }
}

/// Takes one of these words.
pub(crate) fn choice<'k>(args: &mut Args, what: &str, known: &[&'k str]) -> Result<&'k str> {
    let word = args.expect(what)?;
    match known.iter().find(|k| **k == word.text) {
        Some(k) => Ok(k),
        None => Err(unknown(word, what, known).into()),
    }
}

/// A word of LIGGGHTS that has no counterpart, with the remedy.
pub(crate) fn without_counterpart(word: &Word, what: &str, help: &str) -> Diagnostic {
    let text = format!("`{}`, {what}, is a word of LIGGGHTS without counterpart here", word.text);
    blame(word, Code::NO_COUNTERPART, text).help(help)
}
