//! The words of bond bpm/beam.

use crate::bond::options::Options;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::cformat::general;
use perigrain_bonded::beam::{Coeffs, Criterion, Potential};
use perigrain_bonded::stiffness::Shear;
use perigrain_lang::Args;

/// Reads the line of the style.
///
/// # Errors
/// Every mistake in it.
pub fn style(args: &mut Args) -> Result<(Options, Potential)> {
    let mut law = Potential { shear: Shear::Paper, criterion: Criterion::Sum, smooth: false };
    let options = Options::read(args, false, |word, args| {
        match word {
            "shear" => law.shear = shear(args)?,
            "criterion" => {
                let name = args.choice("criterion", &["sum", "separate"])?;
                law.criterion = if name == "sum" { Criterion::Sum } else { Criterion::Separate };
            }
            "kinematics" => {
                let span = args.here();
                if args.choice("kinematics", &["potential", "incremental"])? == "incremental" {
                    let text = "bond_style bpm/beam: `kinematics incremental` is not in perigrain yet";
                    let d = Diagnostic::error(Code::NOT_SUPPORTED, span, text);
                    return Err(d.help("`kinematics potential` has the same forces for small turns").into());
                }
            }
            _ => return Ok(false),
        }
        Ok(true)
    })?;
    law.smooth = options.smooth;
    Ok((options, law))
}

fn shear(args: &mut Args) -> Result<Shear> {
    Ok(match args.choice("shear stiffness", &["paper", "timoshenko", "none"])? {
        "paper" => Shear::Paper,
        "none" => Shear::None,
        _ if args.peek().is_some_and(|w| w.text.parse::<f64>().is_ok()) => {
            Shear::Timoshenko(args.positive("the factor of shear of the section")?)
        }
        _ => Shear::Timoshenko(0.9),
    })
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
    /// Reads the words after the types.
    ///
    /// # Errors
    /// Every mistake in them.
    pub fn read(args: &mut Args) -> Result<Self> {
        let young = args.positive("Young's modulus E")?;
        let span = args.here();
        let poisson = args.number("Poisson's ratio nu")?;
        if !(poisson > -1.0 && poisson <= 0.5) {
            return fail(Code::BAD_VALUE, span, "Poisson's ratio lies between -1 and 0.5");
        }
        let radius = match args.choice("radius of the beam", &["radius", "ratio"])? {
            "radius" => Radius::Given(args.positive("the radius of the beam")?),
            _ => Radius::Ratio(args.positive("the radius of the beam over that of its smaller end")?),
        };
        let coeffs = Coeffs {
            elastic: [young, poisson],
            strength: [f64::INFINITY; 2],
            moment: 1.0,
            damping: [0.0; 4],
        };
        let mut line = Self { coeffs, radius, weibull: None };
        while let Some(word) = args.next() {
            match word.text.as_str() {
                "strength" => {
                    let tension = args.positive("the strength in tension")?;
                    line.coeffs.strength = [tension, args.positive("the strength in shear")?];
                }
                "moment" => {
                    let span = args.here();
                    line.coeffs.moment = args.non_negative("how much moments count")?;
                    if line.coeffs.moment > 1.0 {
                        return fail(Code::BAD_VALUE, span, "moments count between 0 and 1");
                    }
                }
                "weibull" => {
                    let modulus = args.positive("the modulus of the scatter")?;
                    line.weibull = Some((modulus, args.integer_from(1, "the seed")? as u64));
                }
                "damping" => line.coeffs.damping = damping(args)?,
                "yield" => {
                    let text = "bond_style bpm/beam: `yield` is not in perigrain yet";
                    return fail(Code::NOT_SUPPORTED, word.span, text);
                }
                _ => return Err(args.unknown(word, &["strength", "moment", "weibull", "damping"])),
            }
        }
        let unbroken = line.coeffs.strength == [f64::INFINITY; 2];
        if unbroken && (line.weibull.is_some() || line.coeffs.moment != 1.0) {
            let text = "`moment` and `weibull` are about a `strength`, which is missing";
            let d = Diagnostic::error(Code::CONFLICT, args.name_span(), text);
            return Err(d.help("`strength S1 S2`: in tension and in shear").into());
        }
        Ok(line)
    }

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

/// One number for all modes, or four.
fn damping(args: &mut Args) -> Result<[f64; 4]> {
    let what = "the damping as a share of the critical one";
    let first = args.non_negative(what)?;
    if args.peek().is_none_or(|w| w.text.parse::<f64>().is_err()) {
        return Ok([first; 4]);
    }
    Ok([first, args.non_negative(what)?, args.non_negative(what)?, args.non_negative(what)?])
}
