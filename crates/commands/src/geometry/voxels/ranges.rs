//! Ranges of grey values, each with its type.

use super::super::words::kind;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;

/// Ranges with both ends in them, and the types of what lies in them.
#[derive(Clone, Debug, Default)]
pub struct Ranges {
    list: Vec<(f64, f64, u16)>,
}

impl Ranges {
    /// Takes `LO:HI T …` up to the next keyword.
    ///
    /// # Errors
    /// No range, ranges that are none, two with values in common.
    pub fn read(word: &Word, a: &mut Args, cx: &BuildCx, keywords: &[&str]) -> Result<Self> {
        let mut r = Self::default();
        while let Some(range) = a.peek().filter(|w| !keywords.contains(&w.text.as_str())) {
            a.next();
            let (lo, hi) = ends(range)?;
            let kind = kind(a, cx)?;
            if let Some((x, y, _)) = r.list.iter().find(|(x, y, _)| lo <= *y && hi >= *x && !range.unknown) {
                let text = format!(
                    "`{}` has values in common with {}:{}",
                    range.text,
                    general(*x, 9),
                    general(*y, 9)
                );
                return fail(Code::CONFLICT, range.span, text);
            }
            r.list.push((lo, hi, kind));
        }
        if r.list.is_empty() {
            return fail(
                Code::MISSING_ARGUMENT,
                word.span,
                "`types` needs ranges of grey values and their types, as `128:255 1`",
            );
        }
        Ok(r)
    }

    /// The types, each once.
    pub fn types(&self) -> Vec<u16> {
        let mut types: Vec<u16> = self.list.iter().map(|r| r.2).collect();
        types.sort_unstable();
        types.dedup();
        types
    }

    /// The type of a grey value, 0 for none.
    pub fn of(&self, value: f64) -> u16 {
        self.list.iter().find(|(lo, hi, _)| value >= *lo && value <= *hi).map_or(0, |r| r.2)
    }
}

fn ends(word: &Word) -> Result<(f64, f64)> {
    let (lo, hi) = word.text.split_once(':').unwrap_or((&word.text, &word.text));
    let end = |s: &str| s.parse::<f64>().ok().filter(|x| x.is_finite());
    match (end(lo), end(hi)) {
        (Some(lo), Some(hi)) if lo <= hi => Ok((lo, hi)),
        _ if word.unknown => Ok((0.0, 0.0)),
        _ => fail(Code::BAD_VALUE, word.span, format!("`{}` is no range of grey values LO:HI", word.text)),
    }
}
