//! The models of resistance to rolling and twisting as words with their numbers.

use perigrain_base::diag::Result;
use perigrain_contact::{Cdt, Epsd, Epsd2, Grip, Rolling, Sds, Twisting};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Kind, Value, Words};

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

impl From<Twistings> for Twisting {
    fn from(twisting: Twistings) -> Self {
        match twisting {
            Twistings::None => Self::None,
            Twistings::Marshall => Self::Marshall,
            Twistings::Sds(slider) => Self::Sds(slider.into()),
        }
    }
}
