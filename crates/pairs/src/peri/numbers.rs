//! Numbers of peridynamic laws as LAMMPS' decks give them, to pairs of types and to types of bonds alike.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_peri::families::Moduli;
use perigrain_peri::law::Style;
use perigrain_peri::law::style::{Bound, Number};

/// Reads how stiff bonds of a law are: the micro-modulus c, or the moduli K and G.
///
/// # Errors
/// Numbers that are missing or out of range.
pub fn stiffness(law: &Style, args: &mut Args) -> Result<(f64, Moduli)> {
    let mut moduli = Moduli::default();
    if law.bond_based {
        return Ok((args.non_negative("the micro-modulus c")?, moduli));
    }
    moduli.bulk = args.positive("the bulk modulus K")?;
    moduli.shear = args.non_negative("the shear modulus G")?;
    Ok((0.0, moduli))
}

/// Reads how far bonds reach and when they break: horizon, s00 and alpha.
///
/// # Errors
/// As [`stiffness`].
pub fn lasting(args: &mut Args) -> Result<(f64, f64, f64)> {
    let horizon = args.positive("the horizon")?;
    let s00 = args.non_negative("the critical stretch s00")?;
    Ok((horizon, s00, args.non_negative("alpha")?))
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
