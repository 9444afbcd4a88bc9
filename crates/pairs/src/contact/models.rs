//! The models of granular contacts as words with their numbers, from the tables of `contact`.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span, nearest};
use perigrain_contact::normal::{Bound, MOST, Number, STYLES, Style};
use perigrain_contact::{
    Area, Cdt, Cohesion, Damping, Drag, Epsd, Epsd2, Friction, Grip, Heat, Normal, Pull, Rolling, Sds, Slip,
    Tangential, Twisting,
};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{
    Alternative, At, Grammar, Kind, NonNegative, Nullable, Part, Placeholder, Value, Words, inner,
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
    stiffness: Stiffness,
    /// The place of the stiffness.
    at: Span,
    rubbing: Rubbing,
    /// The place of `slip`.
    slip: Span,
}

/// Numbers of all tangential models.
#[derive(Words)]
struct Rubbing {
    /// The tangential damping x_gamma; `NULL` stands for √(k_t/S_n), S_n = dF_n/dδ.
    #[word(what = "the tangential damping x_gamma (or NULL)")]
    x_gamma: At<Nullable<NonNegative>>,
    /// The coefficient of friction mu.
    #[word(non_negative)]
    mu: f64,
    #[word(keyword, name = "whole|spring", like = Slips, default = Slip::Whole)]
    slip: Slip,
}

/// What slides at the limit of friction.
#[derive(Words)]
#[word(what = "value of slip", of = Slip)]
enum Slips {
    /// Spring and dashpot together reach the limit.
    Whole,
    /// The spring alone reaches the limit, as in LIGGGHTS; no dashpot acts in a step in which it slides.
    Spring,
}

/// A tangential stiffness as it is written.
#[derive(Clone, Copy)]
enum Stiffness {
    /// `NULL`.
    Null,
    /// k_t.
    Is(f64),
    /// `ratio r`: k_t = r F_n/δ.
    Ratio(f64),
}

impl Value for Stiffness {
    const KIND: Kind = Kind::Or(
        &Kind::Choice(&[Alternative {
            word: "ratio",
            about: "k_t is r times the normal stiffness F_n/δ.",
            parts: &[Part::Word(Placeholder { name: "r", kind: Kind::Number, about: "", unit: "" })],
        }]),
        &Kind::OrNull(&Kind::Number),
    );

    fn value(what: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        if args.eat("ratio") {
            return args
                .non_negative("the ratio of the tangential stiffness to the normal one")
                .map(Self::Ratio);
        }
        let Nullable(kt) = Nullable::<NonNegative>::value(what, args, cx)?;
        Ok(kt.map_or(Self::Null, |kt| Self::Is(kt.0)))
    }
}

/// The stiffness of tangential models with a spring.
#[derive(Words)]
struct Spring {
    /// The tangential stiffness kt; of Mindlin's a pressure [force/length].
    #[word(what = "the tangential stiffness kt")]
    kt: Stiffness,
}

/// The tangential models, each with its spring.
const FRICTIONS: [Alternative; Friction::ALL.len()] = {
    let mut all = [EMPTY; Friction::ALL.len()];
    let mut k = 0;
    while k < all.len() {
        let kind = Friction::ALL[k];
        let parts: &[Part] = match kind {
            Friction::None => &[],
            Friction::LinearNohistory => &[Part::All(Rubbing::GRAMMAR)],
            _ => &[Part::All(Spring::GRAMMAR), Part::All(Rubbing::GRAMMAR)],
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
            Friction::None | Friction::LinearNohistory => Stiffness::Is(0.0),
            _ => inner::<Spring>(args, cx)?.kt,
        };
        if kind == Friction::None {
            let x_gamma = At { value: Nullable(Some(NonNegative(0.0))), span: at, unknown: false };
            let rubbing = Rubbing { x_gamma, mu: 0.0, slip: Slip::Whole };
            return Ok(Self { kind, stiffness, at, rubbing, slip: at });
        }
        // `slip` stands behind the numbers.
        let numbers = 2;
        let slip = args.peek_at(numbers).map_or(at, |word| word.span);
        Ok(Self { kind, stiffness, at, rubbing: inner(args, cx)?, slip })
    }
}

impl Sliding {
    /// The model beside this one along the normal.
    ///
    /// # Errors
    /// `NULL` or `ratio` in the place of a number that the normal model does not provide; `slip spring` where there is no such
    /// spring.
    pub fn tangential(&self, normal: &Normal) -> Result<Tangential> {
        let wrong = self.wrong_stiffness(normal).or(self.wrong_drag(normal)).or(self.wrong_slip());
        if let Some((at, text, help)) = wrong {
            return Err(Diagnostic::error(Code::CONFLICT, at, text).help(help).into());
        }
        let Rubbing { x_gamma, mu, slip } = &self.rubbing;
        let drag = x_gamma.value.0.map_or(Drag::Matched, |x| Drag::Times(x.0));
        let (stiffness, of_normal) = match self.stiffness {
            Stiffness::Is(kt) => (Some(kt), false),
            Stiffness::Ratio(r) => (Some(r), true),
            Stiffness::Null if self.kind.by_radius() => (None, false),
            Stiffness::Null => (Some(1.0), true),
        };
        Ok(Tangential { drag, of_normal, slip: *slip, ..Tangential::new(self.kind, stiffness, 0.0, *mu) })
    }

    fn wrong_stiffness(&self, normal: &Normal) -> Option<Wrong> {
        let (kind, linear) = (self.kind.name(), normal.exponent() == 1.0);
        let (text, help) = match self.stiffness {
            Stiffness::Is(_) => return None,
            Stiffness::Ratio(_) | Stiffness::Null if self.kind == Friction::LinearHistory && linear => {
                return None;
            }
            Stiffness::Ratio(_) => (
                "`ratio` is the ratio of two constant stiffnesses".to_string(),
                "use `linear_history` with hooke or hooke/velocity, or write the stiffness kt",
            ),
            Stiffness::Null if !self.kind.takes_material() => (
                format!("`tangential {kind}` needs a stiffness kt, not `NULL`"),
                "write the stiffness kt; mindlin, mindlin/force and mindlin_rescale take it from the material, \
                 linear_history from hooke and hooke/velocity",
            ),
            Stiffness::Null if normal.material().is_none() => (
                format!("`NULL` needs a material, which {} does not have", normal.name()),
                "write the stiffness kt, or use hertz/material",
            ),
            Stiffness::Null => return None,
        };
        Some((self.at, text, help))
    }

    /// `x_gamma NULL` needs stiffnesses k_t and dF_n/dδ with a constant ratio.
    fn wrong_drag(&self, normal: &Normal) -> Option<Wrong> {
        let (kind, n) = (self.kind, normal.exponent());
        let (simple, material) = (!normal.pulls(), normal.material().is_some());
        let known = match self.stiffness {
            _ if self.rubbing.x_gamma.value.0.is_some() => true,
            _ if normal.name() == "none" => false,
            _ if kind == Friction::LinearNohistory => n == 1.0 || (n == 1.5 && material && simple),
            Stiffness::Ratio(_) => true,
            Stiffness::Null | Stiffness::Is(_) if kind.by_radius() => n == 1.5 && simple,
            Stiffness::Null => true,
            Stiffness::Is(_) => n == 1.0 && !material && simple,
        };
        let (normal, kind) = (normal.name(), kind.name());
        let text = || {
            format!(
                "`NULL` for x_gamma needs a constant ratio of k_t to dF_n/dδ: {normal} and {kind} have none"
            )
        };
        let help = "write x_gamma, or use mindlin with hertz or hertz/material, linear_history with hooke or \
                    hooke/velocity";
        (!known).then(|| (self.rubbing.x_gamma.span, text(), help))
    }

    fn wrong_slip(&self) -> Option<Wrong> {
        let fits = self.rubbing.slip == Slip::Whole || self.kind.slips_by_spring();
        let text = || {
            format!(
                "`slip spring` needs the displacement of a spring, which {} does not remember",
                self.kind.name()
            )
        };
        (!fits).then(|| (self.slip, text(), "use it with mindlin or linear_history"))
    }

    /// The place of `slip spring`, if it is asked.
    pub fn slips_by_spring(&self) -> Option<Span> {
        (self.rubbing.slip == Slip::Spring).then_some(self.slip)
    }
}

/// Place, message and help of a refusal.
type Wrong = (Span, String, &'static str);

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
    /// A torque of constant size against the relative spin ω: μ k_n δ R̄ ω_t/|ω|, ω_t its part across the normal.
    Cdt(ConstantTorque),
    /// A spring of the stiffness k_r = c k_n μ² R̄² against ω_t, at most μ R̄ |F_n|, and a dashpot 2 η √(I_r k_r), which does not act
    /// while the spring slides (Ai et al. 2011).
    Epsd(SpringTorque),
    /// The spring of epsd with k_r = k_t R̄², without a dashpot; k_t is that of the tangential model.
    Epsd2(ConstantTorque),
}

/// Words of a torque with a coefficient of friction.
#[derive(Words)]
pub struct ConstantTorque {
    /// The coefficient of rolling friction mu.
    #[word(non_negative)]
    mu: f64,
    /// Counts the spin about the normal too.
    #[word(flag)]
    full: bool,
}

/// Words of a torque with a spring and a dashpot.
#[derive(Words)]
pub struct SpringTorque {
    /// The coefficient of rolling friction mu.
    #[word(non_negative)]
    mu: f64,
    /// The part eta of the critical damping.
    #[word(non_negative)]
    eta: f64,
    /// The factor c of the stiffness, 2.25 without it.
    c: Option<Factor>,
    /// Counts the spin about the normal too.
    #[word(flag)]
    full: bool,
}

/// A factor, which begins as a number does.
struct Factor(f64);

impl Value for Factor {
    const KIND: Kind = Kind::Number;
    fn value(what: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.non_negative(what).map(Self)
    }
    fn begins(word: &Word) -> bool {
        word.unknown || word.text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
    }
}

/// The factor of the stiffness of `epsd` (Ai et al. 2011).
const USUAL_FACTOR: f64 = 2.25;

/// A model of cohesion.
#[derive(Words)]
#[word(style, what = "cohesion model")]
pub enum Cohesions {
    /// No cohesion.
    None,
    /// A pull k A while the two touch, A the circle in which the spheres intersect.
    Sjkr(Pulling),
    /// The same with A = 4 π δ R̄, on walls 2 π δ R.
    Sjkr2(Pulling),
}

/// Words of a pull.
#[derive(Words)]
pub struct Pulling {
    /// The energy density k [energy/volume].
    #[word(what = "the energy density k", non_negative)]
    k: f64,
    /// The limit of friction counts from the force with the pull.
    #[word(flag)]
    reduce: bool,
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
    /// 2 k √A (T_j − T_i) flows, A the area of contact; unlike types have k = 2 k_i k_j/(k_i + k_j).
    Contact(Through),
}

/// Words of the heat through the area of contact.
#[derive(Words)]
pub struct Through {
    /// The conductivity k [energy/(time length temperature)].
    #[word(what = "the conductivity", non_negative)]
    k: f64,
    #[word(keyword, name = "AREA", default = Areas::Overlap, shown = "overlap")]
    area: Areas,
    /// The factor of δ in A, for grains softer than their material.
    #[word(keyword, name = "f", what = "the factor of the overlap", positive)]
    scaled: Option<f64>,
}

/// What A is.
#[derive(Clone, Copy, Words)]
#[word(what = "area of contact")]
enum Areas {
    /// The circle in which the spheres intersect.
    Overlap,
    /// π times the square of the larger radius; on walls the circle.
    Projection,
    /// A itself.
    Constant(#[word(name = "A", what = "the area", positive)] f64),
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
            Rollings::Cdt(ConstantTorque { mu, full }) => Self::Cdt(Cdt { mu, full }),
            Rollings::Epsd(SpringTorque { mu, eta, c, full }) => {
                Self::Epsd(Epsd { mu, eta, factor: c.map_or(USUAL_FACTOR, |c| c.0), full })
            }
            // The stiffness is that of the pair.
            Rollings::Epsd2(ConstantTorque { mu, full }) => {
                Self::Epsd2(Epsd2 { mu, full, grip: Grip::Is(0.0) })
            }
        }
    }
}

impl From<Cohesions> for Cohesion {
    fn from(cohesion: Cohesions) -> Self {
        let pull = |words: Pulling| Pull { density: words.k, reduces: words.reduce };
        match cohesion {
            Cohesions::None => Self::None,
            Cohesions::Sjkr(words) => Self::Sjkr(pull(words)),
            Cohesions::Sjkr2(words) => Self::Sjkr2(pull(words)),
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
            Heating::Contact(Through { k, area, scaled }) => {
                let area = match area {
                    Areas::Overlap => Area::Overlap(scaled.unwrap_or(1.0)),
                    Areas::Projection => Area::Projection,
                    Areas::Constant(area) => Area::Constant(area),
                };
                Self::Contact { conductivity: k, area }
            }
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
        check(|cohesion: Cohesions| Cohesion::from(cohesion).name());
        check(|heat: Heating| Heat::from(heat).name());
        check(|damping: Dampings| Damping::from(damping).name().split(' ').next().unwrap());
        check(|sliding: Sliding| sliding.kind.name());
    }

    #[test]
    fn normal_models_have_the_numbers_of_their_table() {
        let shown: Vec<String> = NORMALS.iter().map(Alternative::shown).collect();
        assert_eq!(shown[..4], ["none", "hooke kn eta", "hooke/velocity E eta nu V", "hertz kn eta"]);
    }
}
