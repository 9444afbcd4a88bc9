//! The normal and damping models of granular contacts as words with their numbers, from the tables of `contact`.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, nearest};
use perigrain_contact::normal::{Bound, MOST, Number, STYLES, Style};
use perigrain_contact::{Damping, Normal};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Alternative, Grammar, Kind, Part, Placeholder, Value, Words};

/// An entry of a table that is still to be filled in.
pub(super) const EMPTY: Alternative = Alternative { word: "", about: "", parts: &[] };

/// A normal model with the word that names it.
pub struct Law {
    /// The model.
    pub model: Normal,
    /// Its name.
    pub word: Word,
}

/// The numbers of each normal model as words.
const NUMBERS: &[[Part; MOST]; STYLES.len()] = &{
    let mut all = [[Part::All(Grammar::NONE); MOST]; STYLES.len()];
    let mut k = 0;
    while k < STYLES.len() {
        let mut n = 0;
        while n < STYLES[k].numbers.len() {
            let Number { word, name, .. } = STYLES[k].numbers[n];
            all[k][n] = Part::Word(Placeholder { name: word, kind: Kind::Number, about: name, unit: "" });
            n += 1;
        }
        k += 1;
    }
    all
};

/// The normal models, each with its formula.
const NORMALS: [Alternative; STYLES.len()] = {
    let mut all = [EMPTY; STYLES.len()];
    let mut k = 0;
    while k < STYLES.len() {
        let Style { name, formula, numbers, .. } = STYLES[k];
        all[k] = Alternative { word: name, about: formula, parts: NUMBERS[k].split_at(numbers.len()).0 };
        k += 1;
    }
    all
};

impl Value for Law {
    const KIND: Kind = Kind::Models(&NORMALS);

    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let word = args.expect("the normal model")?;
        let Some(style) = Normal::style(&word.text) else {
            return Err(unknown(word, "normal model of granular contacts", &NORMALS));
        };
        let numbers = style.numbers.iter().map(|number| self::number(number, args));
        let model = Normal::new(style, &numbers.collect::<Result<Vec<f64>>>()?);
        Ok(Self { model, word: word.clone() })
    }
}

fn number(number: &Number, args: &mut Args) -> Result<f64> {
    let (ok, wrong, help) = match number.bound {
        Bound::Positive => return args.positive(number.name),
        Bound::NonNegative => return args.non_negative(number.name),
        Bound::Where { ok, wrong, help } => (ok, wrong, help),
    };
    let at = args.here();
    let a = args.number(number.name)?;
    if ok(a) {
        return Ok(a);
    }
    let wrong = Diagnostic::error(Code::BAD_VALUE, at, wrong.replace("{}", &a.to_string()));
    Err(help.into_iter().fold(wrong, |d, help| d.help(help)).into())
}

/// A damping model.
pub struct Dampings(Damping);

impl From<Dampings> for Damping {
    fn from(damping: Dampings) -> Self {
        damping.0
    }
}

/// The two kinds of `mdr`.
#[derive(Words)]
#[word(what = "kind of damping mdr", of = Damping)]
enum OfMdr {
    /// η = e √(m̄ k) with k = 2 E_c (a_i + a_j), on walls E_c a/2.
    #[word("1")]
    Mdr,
    /// η = e.
    #[word("2")]
    MdrConstant,
}

/// The damping models, each with its η.
const DAMPINGS: [Alternative; Damping::ALL.len() + 1] = {
    let mut all = [EMPTY; Damping::ALL.len() + 1];
    let mut k = 0;
    while k < Damping::ALL.len() {
        all[k] = Alternative { word: Damping::ALL[k].name(), about: Damping::ALL[k].formula(), parts: &[] };
        k += 1;
    }
    all[k] = Alternative {
        word: "mdr",
        about: "For the normal model mdr: `1` has η = e √(m̄ k) with k = 2 E_c (a_i + a_j), on walls E_c a/2, `2` η = e.",
        parts: &[Part::Word(Placeholder { name: "1|2", kind: OfMdr::KIND, about: "", unit: "" })],
    };
    all
};

impl Value for Dampings {
    const KIND: Kind = Kind::Models(&DAMPINGS);

    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the damping model")?;
        if let Some(damping) = Damping::ALL.into_iter().find(|d| d.name() == word.text) {
            return Ok(Self(damping));
        }
        if word.text == "mdr" {
            return OfMdr::value("kind of damping mdr", args, cx).map(|kind| Self(kind.into()));
        }
        Err(unknown(word, "damping model", &DAMPINGS))
    }
}

/// The refusal of a word that names no model.
pub(super) fn unknown(word: &Word, what: &str, known: &[Alternative]) -> Diagnostics {
    let d = Diagnostic::error(Code::UNKNOWN_STYLE, word.span, format!("unknown {what}: `{}`", word.text));
    match nearest(&word.text, known.iter().map(|one| one.word)) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => {
            let known: Vec<&str> = known.iter().map(|one| one.word).collect();
            d.help(format!("known here: {}", known.join(" ")))
        }
    }
    .into()
}

#[cfg(test)]
mod tests {
    use super::super::sliding::Sliding;
    use super::super::sticking::{Cohesions, Heating};
    use super::super::turning::{Rollings, Twistings};
    use super::*;
    use perigrain_contact::{Cohesion, Heat, Rolling, Twisting};
    use perigrain_styles::testing::Bench;

    /// Reads each word of a place with four numbers behind it, and checks what the model is called.
    fn check<T: Value>(name: impl Fn(T) -> &'static str) {
        for one in T::KIND.choices() {
            let read = Bench::default().modify(&format!("{} 1 0.3 0.4 0.5", one.word), |args, cx| {
                assert_eq!(name(T::value("a model", args, cx)?), one.word);
                Ok(())
            });
            assert!(read.is_ok(), "{}: {read:?}", one.word);
        }
    }

    #[test]
    fn words_are_the_names_of_models() {
        check(|rolling: Rollings| Rolling::from(rolling).name());
        check(|twisting: Twistings| Twisting::from(twisting).name());
        check(|cohesion: Cohesions| Cohesion::from(cohesion).name());
        check(|heat: Heating| Heat::from(heat).name());
        check(|damping: Dampings| Damping::from(damping).name().split(' ').next().unwrap());
        check(|sliding: Sliding| sliding.kind.name());
    }

    #[test]
    fn normal_models_have_the_numbers_of_their_table() {
        let shown: Vec<String> = NORMALS.iter().map(Alternative::shown).collect();
        let expected = [
            "none",
            "hooke kn eta",
            "hooke/velocity E eta nu V",
            "hooke/hysteresis E eta nu V stiffen stick phi",
            "hertz kn eta",
        ];
        assert_eq!(shown[..5], expected);
    }
}
