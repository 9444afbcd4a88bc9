//! Diameters of poured spheres: one value, a range, or several with given fractions.

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::rng::ParkMiller;
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Grammar, Kind, Part, Value, Words};
use std::f64::consts::PI;

/// Diameters of the spheres.
#[derive(Words)]
#[word(what = "distribution of diameters")]
pub enum Diameters {
    /// One diameter for all.
    One(#[word(name = "D", what = "the diameter", positive)] f64),
    /// Uniform between two diameters.
    Range(
        #[word(name = "Dlo", what = "the smallest diameter", positive)] f64,
        #[word(name = "Dhi", what = "the largest diameter", positive)] At<f64>,
    ),
    /// So many diameters, each with its share of the number; shares sum to 1.
    Poly(#[word(name = "shares")] Shares),
}

/// Radii with their shares of the number.
pub struct Shares(Vec<[f64; 2]>);

impl Value for Shares {
    const KIND: Kind = Kind::Words(&Grammar {
        parts: &[Part::bare("n", Kind::Whole), Part::Many(&[Part::number("D"), Part::number("P")], 1)],
        keywords: &[],
        refused: &[],
    });
    fn value(_: &str, args: &mut Args, _: &BuildCx) -> Result<Self> {
        shares(args).map(Self)
    }
}

/// A distribution of radii.
#[derive(Clone, Debug, PartialEq)]
pub enum Sizes {
    /// One radius.
    One(f64),
    /// Uniform between two radii.
    Range(f64, f64),
    /// Radii and their number fractions.
    Poly(Vec<[f64; 2]>),
}

impl Sizes {
    /// Those of these diameters.
    ///
    /// # Errors
    /// A smallest diameter above the largest.
    pub fn new(diameters: Diameters) -> Result<Self> {
        Ok(match diameters {
            Diameters::One(d) => Self::One(0.5 * d),
            Diameters::Range(lo, hi) if lo > hi.value => {
                let text = format!("the diameters must rise: {lo} is above {}", hi.value);
                return fail(Code::BAD_VALUE, hi.span, text);
            }
            Diameters::Range(lo, hi) => Self::Range(0.5 * lo, 0.5 * hi.value),
            Diameters::Poly(Shares(list)) => Self::Poly(list),
        })
    }

    /// The smallest radius.
    pub fn smallest(&self) -> f64 {
        match self {
            Self::One(r) | Self::Range(r, _) => *r,
            Self::Poly(list) => list.iter().filter(|p| p[1] > 0.0).fold(f64::INFINITY, |a, p| p[0].min(a)),
        }
    }

    /// The largest radius.
    pub fn largest(&self) -> f64 {
        match self {
            Self::One(r) => *r,
            Self::Range(_, hi) => *hi,
            Self::Poly(list) => list.iter().fold(0.0, |a, p| p[0].max(a)),
        }
    }

    /// The volume of a sphere (in a flat scene the area) by which LAMMPS counts: that of the largest radius
    /// of a range, the mean for fractions.
    pub fn space(&self, flat: bool) -> f64 {
        let one = |r: f64| if flat { PI * r * r } else { 4.0 / 3.0 * PI * r * r * r };
        match self {
            Self::One(r) => one(*r),
            Self::Range(_, hi) => one(*hi),
            Self::Poly(list) => list.iter().map(|[r, share]| one(*r) * share).sum(),
        }
    }

    /// The next radius.
    pub fn sample(&self, stream: &mut ParkMiller) -> f64 {
        match self {
            Self::One(r) => *r,
            Self::Range(lo, hi) => lo + stream.uniform() * (hi - lo),
            Self::Poly(list) => {
                let value = stream.uniform();
                let mut sum = 0.0;
                for [r, share] in list {
                    sum += share;
                    if sum >= value {
                        return *r;
                    }
                }
                list.last().map_or(0.0, |p| p[0])
            }
        }
    }
}

fn shares(args: &mut Args) -> Result<Vec<[f64; 2]>> {
    let start = args.here();
    let count = args.integer_from(1, "the number of diameters")?;
    let mut list = vec![];
    for k in 1..=count {
        let radius = 0.5 * args.positive(&format!("diameter {k}"))?;
        let share = args.non_negative(&format!("the share of diameter {k}"))?;
        list.push([radius, share]);
    }
    let sum: f64 = list.iter().map(|p| p[1]).sum();
    // LAMMPS' tolerance.
    if (sum - 1.0).abs() > 1e-3 {
        let text = format!("the shares of diameters must sum to 1, not {sum}");
        let d = Diagnostic::error(Code::BAD_VALUE, start.to(args.here()), text);
        return Err(d.help("write `poly N D1 P1 D2 P2 …` with P1 + P2 + … = 1").into());
    }
    Ok(list)
}
