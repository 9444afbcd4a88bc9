//! Numbers of peridynamic laws as LAMMPS' decks give them, to pairs of types and to types of bonds alike.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_peri::families::Moduli;
use perigrain_peri::law::Style;
use perigrain_peri::law::style::{Bound, Number};
use perigrain_styles::BuildCx;
use perigrain_styles::words::{At, Words, inner};

/// The stiffness of bonds that are alike at both ends.
#[derive(Words)]
pub struct Micromodulus {
    /// The micro-modulus c [energy/length⁷].
    #[word(non_negative)]
    c: f64,
}

/// The moduli of ends of bonds.
#[derive(Words)]
pub struct Elastic {
    /// The bulk modulus K [pressure].
    #[word(name = "K", positive)]
    bulk: f64,
    /// The shear modulus G [pressure].
    #[word(name = "G", non_negative)]
    shear: f64,
}

/// How far bonds reach.
#[derive(Words)]
pub struct Reach {
    /// The horizon [length].
    #[word(positive)]
    horizon: f64,
}

/// How far bonds reach and when they break.
#[derive(Words)]
pub struct Lasting {
    #[word(flatten)]
    reach: Reach,
    /// The critical stretch s00.
    #[word(non_negative)]
    s00: f64,
    /// By which part compression strengthens bonds.
    #[word(what = "alpha", non_negative)]
    alpha: f64,
}

/// What it takes to part bonds that soften.
#[derive(Words)]
pub struct Area {
    /// The fracture energy G [energy/area].
    #[word(name = "G", positive)]
    energy: At<f64>,
}

/// Reads how stiff bonds of a law are: the micro-modulus c, or the moduli K and G.
///
/// # Errors
/// Numbers that are missing or out of range.
pub fn stiffness(law: &Style, args: &mut Args, cx: &BuildCx) -> Result<(f64, Moduli)> {
    let mut moduli = Moduli::default();
    if law.bond_based {
        return Ok((inner::<Micromodulus>(args, cx)?.c, moduli));
    }
    let Elastic { bulk, shear } = inner(args, cx)?;
    (moduli.bulk, moduli.shear) = (bulk, shear);
    Ok((0.0, moduli))
}

/// Reads how far bonds reach: the horizon.
///
/// # Errors
/// As [`stiffness`].
pub fn reach(args: &mut Args, cx: &BuildCx) -> Result<f64> {
    Ok(inner::<Reach>(args, cx)?.horizon)
}

/// Reads how far bonds reach and when they break: horizon, s00 and alpha.
///
/// # Errors
/// As [`stiffness`].
pub fn lasting(args: &mut Args, cx: &BuildCx) -> Result<(f64, f64, f64)> {
    let Lasting { reach, s00, alpha } = inner(args, cx)?;
    Ok((reach.horizon, s00, alpha))
}

/// Reads the fracture energy of bonds that soften.
///
/// # Errors
/// As [`stiffness`].
pub fn area(args: &mut Args, cx: &BuildCx) -> Result<At<f64>> {
    Ok(inner::<Area>(args, cx)?.energy)
}

/// Reads what a law has besides its stiffness: how bonds relax, flow or soften.
///
/// # Errors
/// As [`stiffness`].
pub fn beyond_elastic(law: &Style, args: &mut Args, moduli: &mut Moduli) -> Result<()> {
    law.numbers.iter().try_for_each(|number| read(number, 0, args, moduli))
}

/// Reads a number of a law; `line` says which of its names messages use.
///
/// # Errors
/// As [`stiffness`].
pub fn read(number: &Number, line: usize, args: &mut Args, moduli: &mut Moduli) -> Result<()> {
    let (at, what) = (args.here(), number.what[line]);
    let value = match number.bound {
        Bound::Positive => args.positive(what)?,
        Bound::Share(wrong) => {
            let value = args.non_negative(what)?;
            if value > 1.0 {
                return fail(Code::BAD_VALUE, at, wrong);
            }
            value
        }
        Bound::Negative(wrong) => {
            let value = args.number(what)?;
            if value >= 0.0 || value.is_nan() {
                return fail(Code::BAD_VALUE, at, format!("{wrong}: {value}"));
            }
            value
        }
    };
    *(number.of)(moduli) = value;
    Ok(())
}

/// What a line of numbers says of these moduli beyond K and G.
pub fn written<'a>(law: &'a Style, moduli: &Moduli) -> impl Iterator<Item = f64> + use<'a> {
    let mut moduli = *moduli;
    law.numbers.iter().map(move |number| *(number.of)(&mut moduli))
}
