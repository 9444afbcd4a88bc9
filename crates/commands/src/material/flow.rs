//! Words of `material` for elastic laws, plastic flow and damage.

use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Span};
use perigrain_constitutive::sheet::{Curve, Fault, Key, Sheet, Strain};
use perigrain_styles::words::{At, Words};

/// What a line says of the law of stress and strain.
#[derive(Clone, Words)]
#[word(keywords)]
pub enum Flow {
    /// The elastic law of `peri/cauchy`; `hencky` by default, the only one that flows.
    Elastic(#[word(name = "law")] ElasticLaw),
    /// The first yield stress of Mises flow, A of Johnson and Cook [pressure].
    #[word("yield")]
    Yield(#[word(name = "value", what = "yield")] At<f64>),
    /// How the yield stress grows; `perfect` by default.
    Hardening(#[word(name = "law")] HardeningLaw),
    /// The modulus of linear hardening, of a yield stress or of a cohesion [pressure].
    #[word("H")]
    H(#[word(name = "value", what = "H")] At<f64>),
    /// The saturation stress of `voce` [pressure].
    #[word("sigma_inf")]
    SigmaInf(#[word(name = "value", what = "sigma_inf")] At<f64>),
    /// The exponent of `voce`.
    #[word("b")]
    SmallB(#[word(name = "value", what = "b")] At<f64>),
    /// The exponent of `swift` and `johnson-cook`.
    #[word("n")]
    N(#[word(name = "value", what = "n")] At<f64>),
    /// The strain of `swift`.
    #[word("eps0")]
    Eps0(#[word(name = "value", what = "eps0")] At<f64>),
    /// The modulus of hardening of `johnson-cook` [pressure].
    #[word("B")]
    B(#[word(name = "value", what = "B")] At<f64>),
    /// The coefficient of the rate of `johnson-cook`.
    #[word("C")]
    C(#[word(name = "value", what = "C")] At<f64>),
    /// The exponent of temperature of `johnson-cook`.
    #[word("m")]
    M(#[word(name = "value", what = "m")] At<f64>),
    /// The rate of plastic strain below which rates have no effect [1/time].
    #[word("rate0")]
    Rate0(#[word(name = "value", what = "rate0")] At<f64>),
    /// The temperature up to which temperatures have no effect [temperature].
    #[word("Tr")]
    Tr(#[word(name = "value", what = "Tr")] At<f64>),
    /// The melting temperature [temperature].
    #[word("Tm")]
    Tm(#[word(name = "value", what = "Tm")] At<f64>),
    /// D₁ of the fracture strain of Johnson and Cook.
    #[word("D1")]
    D1(#[word(name = "value", what = "D1")] At<f64>),
    /// D₂, what triaxiality adds.
    #[word("D2")]
    D2(#[word(name = "value", what = "D2")] At<f64>),
    /// D₃, the exponent of triaxiality.
    #[word("D3")]
    D3(#[word(name = "value", what = "D3")] At<f64>),
    /// D₄, the coefficient of the rate.
    #[word("D4")]
    D4(#[word(name = "value", what = "D4")] At<f64>),
    /// D₅, the coefficient of temperature.
    #[word("D5")]
    D5(#[word(name = "value", what = "D5")] At<f64>),
    /// The equivalent plastic strain at which damage begins, in place of D1 to D5.
    #[word("eps_f")]
    EpsF(#[word(name = "value", what = "eps_f")] At<f64>),
    /// The fracture energy of softening after damage has begun [energy/area].
    #[word("Gf")]
    Gf(#[word(name = "value", what = "Gf")] At<f64>),
    /// The cohesion of flow of Drucker and Prager, in place of `yield` [pressure].
    Cohesion(#[word(name = "value", what = "cohesion")] At<f64>),
    /// The angle of friction of Drucker and Prager, in degrees.
    Phi(#[word(name = "value", what = "phi")] At<f64>),
    /// The angle of dilation of Drucker and Prager, in degrees, at most phi.
    Psi(#[word(name = "value", what = "psi")] At<f64>),
}

/// Elastic laws.
#[derive(Clone, Copy, Words)]
#[word(what = "elastic law", of = Strain)]
pub enum ElasticLaw {
    /// Logarithmic strains.
    Hencky,
    /// Compressible neo-Hooke.
    NeoHooke,
    /// Small strains and rotations.
    Linear,
}

/// Laws of hardening.
#[derive(Clone, Copy, Words)]
#[word(what = "hardening", of = Curve)]
pub enum HardeningLaw {
    /// None.
    Perfect,
    /// σ₀ + Hε̄.
    Linear,
    /// σ₀ + (σ∞ − σ₀)(1 − e^(−bε̄)) + Hε̄.
    Voce,
    /// σ₀(1 + ε̄/ε₀)ⁿ.
    Swift,
    /// The points of a file.
    Table,
    /// (A + Bε̄ⁿ)(1 + C ln ε̄̇/ε̄̇₀)(1 − T*ᵐ).
    #[word("johnson-cook")]
    JohnsonCook,
}

impl Flow {
    /// Puts the value into a data sheet; its place, and whether the value is unknown yet.
    pub fn put(self, sheet: &mut Sheet, word: Span) -> (Span, bool) {
        let (key, at) = match self {
            Self::Elastic(law) => {
                sheet.elastic = Some(law.into());
                return (word, false);
            }
            Self::Hardening(law) => {
                sheet.hardening = Some(law.into());
                return (word, false);
            }
            Self::Yield(at) => (Key::Yield, at),
            Self::H(at) => (Key::H, at),
            Self::SigmaInf(at) => (Key::SigmaInf, at),
            Self::SmallB(at) => (Key::SmallB, at),
            Self::N(at) => (Key::N, at),
            Self::Eps0(at) => (Key::Eps0, at),
            Self::B(at) => (Key::B, at),
            Self::C(at) => (Key::C, at),
            Self::M(at) => (Key::M, at),
            Self::Rate0(at) => (Key::Rate0, at),
            Self::Tr(at) => (Key::Tr, at),
            Self::Tm(at) => (Key::Tm, at),
            Self::D1(at) => (Key::D1, at),
            Self::D2(at) => (Key::D2, at),
            Self::D3(at) => (Key::D3, at),
            Self::D4(at) => (Key::D4, at),
            Self::D5(at) => (Key::D5, at),
            Self::EpsF(at) => (Key::EpsF, at),
            Self::Gf(at) => (Key::Gf, at),
            Self::Cohesion(at) => (Key::Cohesion, at),
            Self::Phi(at) => (Key::Phi, at),
            Self::Psi(at) => (Key::Psi, at),
        };
        sheet.set(key, at.value);
        (at.span, at.unknown)
    }
}

/// A fault of a data sheet as a problem of the line: where its key stands, else at the file's name or the whole line.
pub fn fault(fault: Fault, id: &str, file: Option<&str>, at: Span) -> Diagnostics {
    let of = file.map_or(String::new(), |file| format!(" ({file})"));
    match fault {
        Fault::Missing { key, law, example } => {
            let text = format!("material `{id}`{of} has no {key}, which {law} needs");
            let help = match file {
                Some(file) => format!(
                    "write `{key} = {example}` in {file}, or `{key} value` in the line, in the deck's units"
                ),
                None => {
                    format!("add `{key} value` in the deck's units: a file has it as `{key} = {example}`")
                }
            };
            Diagnostic::error(Code::MISSING_ARGUMENT, at, text).help(help).into()
        }
        Fault::Refused { why, .. } => {
            Diagnostic::error(Code::BAD_VALUE, at, format!("material `{id}`{of}: {why}")).into()
        }
    }
}
