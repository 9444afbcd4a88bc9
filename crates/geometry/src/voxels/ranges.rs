//! Ranges of grey values, each with its type.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::math::cformat::general;
use perigrain_lang::Word;
use perigrain_styles::words::{At, OneType, Words};

/// Ranges with both ends in them, and the types of what lies in them.
#[derive(Clone, Debug, Default)]
pub struct Ranges {
    list: Vec<(f64, f64, u16)>,
}

/// The words for it.
#[derive(Words)]
pub struct List {
    /// A range of grey values, both ends in it (`7` alone is one, too), and the type of its particles; other values are empty.
    #[word(name = "LO:HI T", what = "the type")]
    ranges: Vec<(Word, OneType)>,
}

impl Ranges {
    /// What the words ask for.
    ///
    /// # Errors
    /// No range, ranges that are none, two with values in common.
    pub fn new(given: &At<List>) -> Result<Self> {
        let mut r = Self::default();
        for (range, kind) in &given.value.ranges {
            let (lo, hi) = ends(range)?;
            if let Some((x, y, _)) = r.list.iter().find(|(x, y, _)| lo <= *y && hi >= *x && !range.unknown) {
                let text = format!(
                    "`{}` has values in common with {}:{}",
                    range.text,
                    general(*x, 9),
                    general(*y, 9)
                );
                return fail(Code::CONFLICT, range.span, text);
            }
            r.list.push((lo, hi, kind.0));
        }
        if r.list.is_empty() {
            return fail(
                Code::MISSING_ARGUMENT,
                given.span,
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
