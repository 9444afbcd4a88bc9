//! The words of packings.

use super::{DENSEST, Fill, ROUNDS, Sizes};
use crate::create_atoms::packing::pores;
use crate::create_atoms::words::Joined;
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, Word};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Grammar, Keyword, Kind, OneType, Or, Part, Seed, Value, Words};

/// Spheres in a region.
#[derive(Words)]
pub struct Plain {
    #[word(name = "REGION", what = "a region", kind = Kind::Region)]
    pub region: Word,
    #[word(name = "SHARE")]
    pub fill: At<Filling>,
    #[word(name = "SEED")]
    pub seed: Seed,
    #[word(keyword, shown = "mono 1", placed)]
    pub sizes: Option<At<Distribution>>,
    #[word(flatten)]
    pub effort: Effort,
    #[word(flatten)]
    pub joined: Joined,
}

/// Walls round pores.
#[derive(Words)]
pub struct Opal {
    #[word(name = "REGION", what = "a region", kind = Kind::Region)]
    pub region: Word,
    /// The diameter of pores [length].
    #[word(name = "PORE", positive)]
    pub diameter: At<f64>,
    /// The spacing of pores, in diameters: 1 lets them just touch, less opens windows between them.
    #[word(name = "S", with = within(SPACING), kind = Kind::Number)]
    pub spacing: At<f64>,
    #[word(name = "SHARE")]
    pub fill: At<Filling>,
    #[word(name = "SEED")]
    pub seed: Seed,
    #[word(keyword, shown = "mono 1", placed)]
    pub sizes: Option<At<OneSize>>,
    #[word(keyword, like = AlongZ, default = pores::Axis::Layers, shown = "111")]
    pub axis: pores::Axis,
    #[word(flatten)]
    pub effort: Effort,
    #[word(flatten)]
    pub joined: Joined,
}

/// What is left of a packing.
#[derive(Words)]
pub struct Aggregate {
    #[word(name = "REGION", what = "a region", kind = Kind::Region)]
    pub region: Word,
    /// The share of the volume before spheres are taken away.
    #[word(name = "SHARE", with = within(SHARE), kind = Kind::Number)]
    pub share: At<f64>,
    #[word(name = "SEED")]
    pub seed: Seed,
    /// The porosity: the part of the region's volume without spheres.
    #[word(name = "POROSITY", with = within(POROSITY), kind = Kind::Number)]
    pub porosity: At<f64>,
    /// The wavelength of the random field [length].
    #[word(name = "LAMBDA", what = "the wavelength", positive)]
    pub wavelength: At<f64>,
    #[word(keyword, shown = "mono 1", placed)]
    pub sizes: Option<At<OneSize>>,
    #[word(flatten)]
    pub effort: Effort,
    #[word(flatten)]
    pub joined: Joined,
}

/// How far a packing goes.
#[derive(Words)]
pub struct Effort {
    /// The largest overlap that may be left, a part of the distance of touching spheres. 0 makes all diameters smaller in the end, by what is
    /// needed for no overlap at all.
    #[word(keyword, name = "O", with = overlap, kind = Kind::Number)]
    pub overlap: Option<f64>,
    /// The number of rounds at most.
    #[word(keyword, name = "N", what = "the number of rounds", from = 1, default = ROUNDS, shown = "1000")]
    pub rounds: usize,
}

/// How full the region is to be.
pub type Filling = Or<Numbered, Share>;

/// The number of spheres.
#[derive(Clone, Copy, Words)]
#[word(what = "fill")]
pub enum Numbered {
    /// So many spheres, of all sizes together.
    Number(#[word(name = "N", what = "the number of spheres", from = 1)] usize),
}

/// A share of the volume.
#[derive(Clone, Copy)]
pub struct Share(pub f64);

impl Value for Share {
    const KIND: Kind = Kind::Number;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        within(SHARE)(args, cx).map(|share| Self(share.value))
    }
}

impl From<Filling> for Fill {
    fn from(filling: Filling) -> Self {
        match filling {
            Or::Word(Numbered::Number(n)) => Self::Number(n),
            Or::Else(Share(share)) => Self::Share(share),
        }
    }
}

/// Which direction of the lattice of pores lies along z.
#[derive(Words)]
#[word(what = "direction along z", of = pores::Axis)]
pub enum AlongZ {
    /// The direction [111] of the lattice of pores lies along z, x along a row of pores.
    #[word("111")]
    Layers,
    /// The direction [100] does.
    #[word("100")]
    Cube,
}

/// The sizes of spheres.
#[derive(Words)]
#[word(what = "distribution of sizes")]
pub enum Distribution {
    /// All diameters are alike.
    Mono(#[word(name = "D", what = "the diameter", positive)] At<f64>),
    /// Diameters between two.
    Uniform(
        #[word(name = "D1", what = "the smallest diameter", positive)] f64,
        #[word(name = "D2", what = "the largest diameter", positive)] At<f64>,
    ),
    /// The median D, and the standard deviation S of the logarithm (up to 0.5), cut at 2.5 deviations.
    Lognormal(
        #[word(name = "D", what = "the median diameter", positive)] f64,
        #[word(name = "S", with = within(WIDTH), kind = Kind::Number)] At<f64>,
    ),
    /// Two and more diameters, each with its part of the number or of the mass, however these add up; behind `types` each of them has a type
    /// of its own.
    Mix(#[word(name = "mixture")] Mix),
}

/// The size of spheres.
#[derive(Words)]
#[word(what = "distribution of sizes")]
pub enum OneSize {
    /// All diameters are alike.
    Mono(#[word(name = "D", what = "the diameter", positive)] At<f64>),
}

impl Distribution {
    /// The sizes, the types of a mixture that has its own, and where the last of the first words stands.
    pub fn parts(self) -> Result<(Sizes, Vec<u16>, Span)> {
        Ok(match self {
            Self::Mono(d) => (Sizes::Mono(d.value), vec![], d.span),
            Self::Uniform(low, high) if high.value < low => {
                let text = format!("the largest diameter {} is below the smallest, {low}", high.value);
                return fail(Code::BAD_VALUE, high.span, text);
            }
            Self::Uniform(low, high) => (Sizes::Uniform(low, high.value), vec![], high.span),
            Self::Lognormal(median, width) => (Sizes::Lognormal(median, width.value), vec![], width.span),
            Self::Mix(Mix { sizes, types, span }) => (sizes, types, span),
        })
    }
}

/// Some diameters with their shares, and their types.
pub struct Mix {
    sizes: Sizes,
    types: Vec<u16>,
    /// The place of the first diameter.
    span: Span,
}

impl Value for Mix {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[
            Part::bare("measure", Measure::KIND),
            Part::Many(&[Part::number("D"), Part::number("P")], 2),
        ],
        keywords: &[Keyword {
            word: "types",
            values: &[Part::Many(&[Part::bare("T", Kind::Types)], 1)],
            about: "",
            default: "",
            repeats: false,
        }],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let (by, span) = (Measure::value("", args, cx)?, args.here());
        let more = |a: &Args| a.peek().is_some_and(|w| w.unknown || w.text.parse::<f64>().is_ok());
        let mut parts = vec![];
        while parts.len() < 2 || more(args) {
            let diameter = args.positive("a diameter of the mixture")?;
            parts.push((diameter, args.positive("the share of this diameter")?));
        }
        let mut types = vec![];
        if args.eat("types") {
            for _ in &parts {
                types.push(OneType::value("the type", args, cx)?.0);
            }
        }
        let sizes = match by {
            Measure::Mass => Sizes::by_mass(&parts),
            Measure::Number => Sizes::by_number(&parts),
        };
        Ok(Self { sizes, types, span })
    }
}

/// What shares are parts of.
#[derive(Words)]
#[word(what = "measure of the shares")]
enum Measure {
    Number,
    Mass,
}

/// A range of numbers with its name and a remedy.
struct Range(&'static str, [f64; 2], &'static str);

const SHARE: Range = Range(
    "the share of the volume",
    [0.0, DENSEST],
    "random packings of equal spheres reach 0.64; write for example 0.6",
);
const SPACING: Range = Range(
    "the spacing of pores, in diameters",
    [0.5, 1.0],
    "1 lets them just touch, less opens windows between them",
);
const POROSITY: Range =
    Range("the porosity", [0.0, 1.0], "it is the part of the region's volume without spheres");
const WIDTH: Range = Range(
    "the width of the distribution",
    [0.0, 0.5],
    "it is the standard deviation of the logarithm: about the relative scatter of diameters",
);

/// Takes a number above the lower end of a range and not above the upper one.
fn within(Range(what, [low, high], remedy): Range) -> impl Fn(&mut Args, &BuildCx) -> Result<At<f64>> {
    move |args, _| {
        let number = At::read(args, |args| args.number(what))?;
        let (value, span) = (number.value, number.span);
        if number.unknown {
            return Ok(At { value: high, ..number });
        }
        if value > low && value <= high {
            return Ok(number);
        }
        let text = format!("{what} must be greater than {low} and at most {high}, not {value}");
        Err(Diagnostic::error(Code::BAD_VALUE, span, text).help(remedy).into())
    }
}

/// Takes the largest overlap.
fn overlap(args: &mut Args, _: &BuildCx) -> Result<f64> {
    let remedy = "it is a part of the distance of touching spheres, 0 for none";
    let overlap = At::read(args, |args| args.non_negative("the largest overlap"))?;
    if overlap.value >= 0.5 && !overlap.unknown {
        let text = format!("the largest overlap must be below 0.5, not {}", overlap.value);
        return Err(Diagnostic::error(Code::BAD_VALUE, overlap.span, text).help(remedy).into());
    }
    Ok(overlap.value)
}
