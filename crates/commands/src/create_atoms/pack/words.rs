//! The words of packings that set the sizes of spheres.

use super::Sizes;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;

/// Takes a number above `low` and not above `high`.
pub fn in_range(a: &mut Args, what: &str, low: f64, high: f64, remedy: &str) -> Result<f64> {
    let (span, unknown) = (a.here(), a.peek().is_some_and(|w| w.unknown));
    let value = a.number(what)?;
    if unknown {
        return Ok(high);
    }
    if value > low && value <= high {
        return Ok(value);
    }
    let text = format!("{what} must be greater than {low} and at most {high}, not {value}");
    Err(Diagnostic::error(Code::BAD_VALUE, span, text).help(remedy).into())
}

/// Some diameters and their shares, by number or by mass.
pub fn mixture(a: &mut Args) -> Result<Sizes> {
    let by = a.choice("measure of the shares", &["number", "mass"])?;
    let more = |a: &Args| a.peek().is_some_and(|w| w.unknown || w.text.parse::<f64>().is_ok());
    let mut parts = vec![];
    while parts.len() < 2 || more(a) {
        parts.push((a.positive("a diameter of the mixture")?, a.positive("the share of this diameter")?));
    }
    Ok(if by == "mass" { Sizes::by_mass(&parts) } else { Sizes::by_number(&parts) })
}

/// The types behind `types`, one for each size of a mixture.
pub fn own_types(a: &mut Args, sizes: &Sizes, types: usize) -> Result<Vec<u16>> {
    let Sizes::Mix(parts) = sizes else { return Ok(vec![]) };
    if !a.eat("types") {
        return Ok(vec![]);
    }
    parts.iter().map(|_| super::super::one_type(a, types)).collect()
}

/// A distribution of diameters; of one alone unless `all` are possible.
pub fn sizes(a: &mut Args, all: bool) -> Result<Sizes> {
    let known: &[&'static str] = if all { &["mono", "uniform", "lognormal", "mix"] } else { &["mono"] };
    match a.choice("distribution of sizes", known)? {
        "mono" => a.positive("the diameter").map(Sizes::Mono),
        "uniform" => {
            let low = a.positive("the smallest diameter")?;
            let span = a.here();
            let high = a.positive("the largest diameter")?;
            if high < low {
                let text = format!("the largest diameter {high} is below the smallest, {low}");
                return fail(Code::BAD_VALUE, span, text);
            }
            Ok(Sizes::Uniform(low, high))
        }
        _ => {
            let median = a.positive("the median diameter")?;
            let remedy =
                "it is the standard deviation of the logarithm: about the relative scatter of diameters";
            Ok(Sizes::Lognormal(median, in_range(a, "the width of the distribution", 0.0, 0.5, remedy)?))
        }
    }
}
