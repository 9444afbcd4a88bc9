//! The words of bond bpm/beam.

use crate::bond::options::{Breaking, Options};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::math::cformat::general;
use perigrain_bonded::beam::{Coeffs, Criterion, Potential};
use perigrain_bonded::stiffness::Shear;
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Alternative, Kind, Value, Words};

/// The words of the style.
#[derive(Words)]
pub struct Style {
    #[word(keyword, default = Shearing::Paper)]
    shear: Shearing,
    #[word(keyword, like = Criteria, default = Criterion::Sum)]
    criterion: Criterion,
    /// How the motion of the ends bends a beam.
    #[word(keyword = "kinematics", shown = "potential")]
    _kinematics: Option<Kinematics>,
    #[word(flatten)]
    breaking: Breaking,
    /// Whether forces are multiplied with 1 − B⁴, B the share of the strength that is used up; energy is not kept then.
    #[word(keyword, shown = "no")]
    smooth: bool,
}

/// How stiff bonds are against shear.
#[derive(Words)]
#[word(what = "shear stiffness")]
enum Shearing {
    /// G A/r0.
    Paper,
    /// 1/k = r0/(K G A) + r0³/(12 E I), K being 0.9 unless given, with which a chain of bonds is a Timoshenko beam at its
    /// nodes however few they are.
    Timoshenko(#[word(name = "K", what = "the factor of shear of the section", positive)] Option<f64>),
    /// No shear.
    None,
}

/// When bonds break.
#[derive(Words)]
#[word(what = "criterion", of = Criterion)]
enum Criteria {
    /// Both sums count.
    Sum,
    /// Each of the four is tested alone, N and M_b only where the bond is pulled.
    Separate,
}

/// The only kinematics that there are.
struct Kinematics;

impl Value for Kinematics {
    const KIND: Kind = Kind::Choice(&[Alternative { word: "potential", about: "", parts: &[] }]);

    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        let span = args.here();
        if args.choice("kinematics", &["potential", "incremental"])? == "incremental" {
            let text = "bond_style bpm/beam: `kinematics incremental` is not in perigrain yet";
            let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text);
            return Err(d.help("`kinematics potential` has the same forces for small turns").into());
        }
        Ok(Self)
    }
}

impl Style {
    /// The options and the law.
    ///
    /// # Errors
    /// `break no` with smoothed forces.
    pub fn options(self) -> Result<(Options, Potential)> {
        let shear = match self.shear {
            Shearing::Paper => Shear::Paper,
            Shearing::Timoshenko(factor) => Shear::Timoshenko(factor.unwrap_or(0.9)),
            Shearing::None => Shear::None,
        };
        let options = self.breaking.options(self.smooth)?;
        Ok((options, Potential { shear, criterion: self.criterion, smooth: self.smooth }))
    }
}

/// The words of `bond_coeff`.
#[derive(Words)]
#[word(refused = "yield")]
pub struct Own {
    /// Young's modulus E [pressure].
    #[word(name = "E", positive)]
    young: f64,
    /// Poisson's ratio nu.
    #[word(name = "nu", with = poisson, kind = Kind::Number)]
    poisson: f64,
    radius: Thickness,
    /// Strengths in tension and in shear, S1 and S2 below; without them nothing breaks [pressure].
    #[word(keyword, name = "S1 S2", what = "the strength {}", positive)]
    strength: Option<[f64; 2]>,
    /// How much moments count for the strength, from 0 to 1: B below.
    #[word(keyword, name = "B", with = moment, kind = Kind::Number, default = 1.0)]
    moment: f64,
    /// Multiplies both strengths of every bond with a number of a Weibull distribution of modulus M and mean 1, which belongs
    /// to the IDs of its ends.
    #[word(keyword, name = "M SEED")]
    weibull: Option<(Modulus, Seed)>,
    /// Dashpots of so many times the critical damping of the two ends on the bond: of all modes, or of stretch, shear, twist and
    /// bending.
    #[word(keyword, name = "Z")]
    damping: Option<Dashpots>,
}

/// The radius of a beam in a deck.
#[derive(Words)]
#[word(what = "radius of the beam")]
enum Thickness {
    /// The radius of all bonds.
    Radius(#[word(name = "R", what = "the radius of the beam", positive)] f64),
    /// The radius over that of the bond's smaller end.
    Ratio(#[word(name = "L", what = "the radius of the beam over that of its smaller end", positive)] f64),
}

/// The modulus of a Weibull distribution.
struct Modulus(f64);

impl Value for Modulus {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        args.positive("the modulus of the scatter").map(Self)
    }
}

/// The seed of a scatter of strengths.
struct Seed(u64);

impl Value for Seed {
    const KIND: Kind = Kind::Whole;
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        Ok(Self(args.integer_from(1, "the seed")? as u64))
    }
}

/// One number for all modes, or four.
#[derive(Words)]
struct Dashpots {
    #[word(name = "Z", what = "the damping as a share of the critical one", non_negative)]
    first: f64,
    #[word(name = "ZS ZT ZB", what = "the damping as a share of the critical one", non_negative)]
    others: Option<[f64; 3]>,
}

fn poisson(args: &mut Args, _: &BuildCx) -> Result<f64> {
    let span = args.here();
    let poisson = args.number("Poisson's ratio nu")?;
    if !(poisson > -1.0 && poisson <= 0.5) {
        return fail(Code::BAD_VALUE, span, "Poisson's ratio lies between -1 and 0.5");
    }
    Ok(poisson)
}

fn moment(args: &mut Args, _: &BuildCx) -> Result<f64> {
    let span = args.here();
    let moment = args.non_negative("how much moments count")?;
    if moment > 1.0 {
        return fail(Code::BAD_VALUE, span, "moments count between 0 and 1");
    }
    Ok(moment)
}

impl Own {
    /// The coefficients; `at` is the place of the line's first word.
    ///
    /// # Errors
    /// Words about a strength that is missing.
    pub fn line(self, at: Span) -> Result<Line> {
        if self.strength.is_none() && (self.weibull.is_some() || self.moment != 1.0) {
            let text = "`moment` and `weibull` are about a `strength`, which is missing";
            let d = Diagnostic::error(Code::CONFLICT, at, text);
            return Err(d.help("`strength S1 S2`: in tension and in shear").into());
        }
        let coeffs = Coeffs {
            elastic: [self.young, self.poisson],
            strength: self.strength.unwrap_or([f64::INFINITY; 2]),
            moment: self.moment,
            damping: self.damping.map_or([0.0; 4], Dashpots::modes),
        };
        let radius = match self.radius {
            Thickness::Radius(r) => Radius::Given(r),
            Thickness::Ratio(ratio) => Radius::Ratio(ratio),
        };
        let weibull = self.weibull.map(|(Modulus(modulus), Seed(seed))| (modulus, seed));
        Ok(Line { coeffs, radius, weibull })
    }
}

impl Dashpots {
    /// Of stretch, shear, twist and bending.
    fn modes(self) -> [f64; 4] {
        let [shear, twist, bend] = self.others.unwrap_or([self.first; 3]);
        [self.first, shear, twist, bend]
    }
}

/// How thick beams are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Radius {
    /// This [length].
    Given(f64),
    /// This times the radius of the smaller end.
    Ratio(f64),
}

impl Radius {
    /// The number of the deck's line.
    pub fn number(&mut self) -> &mut f64 {
        match self {
            Self::Given(r) | Self::Ratio(r) => r,
        }
    }

    /// Between spheres of these radii [length].
    pub fn of(self, radii: [f64; 2]) -> f64 {
        match self {
            Self::Given(r) => r,
            Self::Ratio(ratio) => ratio * radii[0].min(radii[1]),
        }
    }
}

/// The coefficients of a type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// What is the same for all bonds.
    pub coeffs: Coeffs,
    /// How thick they are.
    pub radius: Radius,
    /// Modulus and seed of the scatter of strengths.
    pub weibull: Option<(f64, u64)>,
}

impl Line {
    /// As a data file has it.
    pub fn written(&self) -> String {
        let number = |a: f64| general(a, 16);
        let Coeffs { elastic, strength, moment, damping } = self.coeffs;
        let (word, radius) = match self.radius {
            Radius::Given(r) => ("radius", r),
            Radius::Ratio(r) => ("ratio", r),
        };
        let mut text = format!("{} {} {word} {}", number(elastic[0]), number(elastic[1]), number(radius));
        if strength != [f64::INFINITY; 2] {
            text += &format!(
                " strength {} {} moment {}",
                number(strength[0]),
                number(strength[1]),
                number(moment)
            );
        }
        if let Some((modulus, seed)) = self.weibull {
            text += &format!(" weibull {} {seed}", number(modulus));
        }
        if damping != [0.0; 4] {
            text += &format!(" damping {}", damping.map(number).join(" "));
        }
        text
    }
}
