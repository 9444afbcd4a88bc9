//! The tangential models as words with their numbers.

use super::models::{EMPTY, unknown};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_contact::{Drag, Friction, Normal, Slip, Tangential};
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{
    Alternative, At, Kind, NonNegative, Nullable, Part, Placeholder, Value, Words, inner,
};

/// A tangential model with its numbers.
pub struct Sliding {
    pub(super) kind: Friction,
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
