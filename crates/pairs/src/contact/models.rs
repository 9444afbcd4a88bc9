//! The models of granular contacts as words with their numbers, from the tables of `contact`.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, nearest};
use perigrain_contact::normal::{Bound, MOST, Number, STYLES, Style};
use perigrain_contact::{Damping, Friction, Heat, Normal, Rolling, Sds, Tangential, Twisting};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{
    Alternative, Grammar, Kind, NonNegative, Nullable, Part, Placeholder, Value, Words, inner,
};

/// An entry of a table that is still to be filled in.
const EMPTY: Alternative = Alternative { word: "", about: "", parts: &[] };

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

/// A tangential model with its numbers.
pub struct Sliding {
    kind: Friction,
    /// Nothing for `NULL`, which stands at the place beside it.
    stiffness: Option<f64>,
    at: Span,
    rubbing: Rubbing,
}

/// Numbers of all tangential models.
#[derive(Words)]
struct Rubbing {
    /// The tangential damping x_gamma.
    #[word(non_negative)]
    x_gamma: f64,
    /// The coefficient of friction mu.
    #[word(non_negative)]
    mu: f64,
}

/// The stiffness of tangential models with a spring.
#[derive(Words)]
struct Spring {
    /// The tangential stiffness kt; of Mindlin's a pressure [force/length].
    #[word(what = "the tangential stiffness kt")]
    kt: Nullable<NonNegative>,
}

/// The same where `NULL` is refused.
const STIFFNESS: Part = match Spring::GRAMMAR.parts {
    [Part::Word(kt)] => Part::Word(Placeholder { kind: Kind::Number, ..*kt }),
    _ => panic!("a spring has one number"),
};

/// The tangential models, each with its spring.
const FRICTIONS: [Alternative; Friction::ALL.len()] = {
    let mut all = [EMPTY; Friction::ALL.len()];
    let mut k = 0;
    while k < all.len() {
        let kind = Friction::ALL[k];
        let parts: &[Part] = match kind {
            Friction::None => &[],
            Friction::LinearNohistory => &[Part::All(Rubbing::GRAMMAR)],
            _ if kind.takes_material() => &[Part::All(Spring::GRAMMAR), Part::All(Rubbing::GRAMMAR)],
            _ => &[STIFFNESS, Part::All(Rubbing::GRAMMAR)],
        };
        all[k] = Alternative { word: kind.name(), about: kind.formula(), parts };
        k += 1;
    }
    all
};

impl Value for Sliding {
    const KIND: Kind = Kind::Models(&FRICTIONS);

    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the tangential model")?;
        let Some(kind) = Friction::ALL.into_iter().find(|f| f.name() == word.text) else {
            return Err(unknown(word, "tangential model", &FRICTIONS));
        };
        let at = args.here();
        let stiffness = match kind {
            Friction::None | Friction::LinearNohistory => Some(0.0),
            _ => inner::<Spring>(args, cx)?.kt.0.map(|kt| kt.0),
        };
        let rubbing = match kind {
            Friction::None => Rubbing { x_gamma: 0.0, mu: 0.0 },
            _ => inner(args, cx)?,
        };
        Ok(Self { kind, stiffness, at, rubbing })
    }
}

impl Sliding {
    /// The model beside this one along the normal.
    ///
    /// # Errors
    /// `NULL` in the place of a stiffness, unless the normal model has a material and the spring is Mindlin's.
    pub fn tangential(&self, normal: &Normal) -> Result<Tangential> {
        let kind = self.kind;
        let wrong = if self.stiffness.is_some() {
            None
        } else if !kind.takes_material() {
            let help = "write the stiffness kt; mindlin, mindlin/force and mindlin_rescale take it from the material";
            Some((format!("`tangential {}` needs a stiffness kt, not `NULL`", kind.name()), help))
        } else if normal.material().is_none() {
            let text = format!("`NULL` needs a material, which {} does not have", normal.name());
            Some((text, "write the stiffness kt, or use hertz/material"))
        } else {
            None
        };
        match wrong {
            Some((text, help)) => Err(Diagnostic::error(Code::CONFLICT, self.at, text).help(help).into()),
            None => Ok(Tangential::new(kind, self.stiffness, self.rubbing.x_gamma, self.rubbing.mu)),
        }
    }
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

/// A model of rolling resistance.
#[derive(Words)]
#[word(style, what = "rolling model")]
pub enum Rollings {
    /// No resistance.
    None,
    /// A spring, dashpot and slider for the rolling velocity R̄ (ω_i − ω_j) × n; its force, at most mu times the normal force,
    /// acts only as a torque with arm R̄.
    Sds(Slider),
}

/// A model of resistance to twisting.
#[derive(Words)]
#[word(style, what = "twisting model")]
pub enum Twistings {
    /// No resistance.
    None,
    /// The stiffness k_t a²/2, damping x_gamma η a²/2 and friction 2/3 a mu of the tangential model (k_t before any factor a).
    Marshall,
    /// A spring, dashpot and slider for the spin about the normal.
    Sds(Slider),
}

/// A spring, dashpot and slider.
#[derive(Words)]
pub struct Slider {
    /// The stiffness k.
    #[word(non_negative)]
    k: f64,
    /// The damping gamma.
    #[word(non_negative)]
    gamma: f64,
    /// The friction mu.
    #[word(non_negative)]
    mu: f64,
}

/// A model of heat conduction between particles of temperatures T.
#[derive(Words)]
#[word(style, what = "heat model")]
pub enum Heating {
    /// No heat flows.
    None,
    /// h π a² (T_j − T_i) flows, see fix heat/flow.
    Area(#[word(name = "h", what = "the heat transfer coefficient", non_negative)] f64),
    /// 2 k a (T_j − T_i) flows.
    Radius(#[word(name = "k", what = "the conductivity", non_negative)] f64),
}

impl From<Slider> for Sds {
    fn from(slider: Slider) -> Self {
        Self { stiffness: slider.k, damping: slider.gamma, mu: slider.mu }
    }
}

impl From<Rollings> for Rolling {
    fn from(rolling: Rollings) -> Self {
        match rolling {
            Rollings::None => Self::None,
            Rollings::Sds(slider) => Self::Sds(slider.into()),
        }
    }
}

impl From<Twistings> for Twisting {
    fn from(twisting: Twistings) -> Self {
        match twisting {
            Twistings::None => Self::None,
            Twistings::Marshall => Self::Marshall,
            Twistings::Sds(slider) => Self::Sds(slider.into()),
        }
    }
}

impl From<Heating> for Heat {
    fn from(heat: Heating) -> Self {
        match heat {
            Heating::None => Self::None,
            Heating::Area(h) => Self::Area(h),
            Heating::Radius(k) => Self::Radius(k),
        }
    }
}

/// The refusal of a word that names no model.
fn unknown(word: &Word, what: &str, known: &[Alternative]) -> Diagnostics {
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
    use super::*;
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
        check(|heat: Heating| Heat::from(heat).name());
        check(|damping: Dampings| Damping::from(damping).name().split(' ').next().unwrap());
        check(|sliding: Sliding| sliding.kind.name());
    }

    #[test]
    fn normal_models_have_the_numbers_of_their_table() {
        let shown: Vec<String> = NORMALS.iter().map(Alternative::shown).collect();
        assert_eq!(shown[..4], ["none", "hooke kn eta", "hertz kn eta", "hertz/material E eta nu"]);
    }
}
