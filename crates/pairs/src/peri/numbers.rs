//! Numbers of peridynamic laws as LAMMPS' decks give them, to pairs of types and to types of bonds alike.

use super::below_zero;
use perigrain_base::diag::{Code, Result, fail};
use perigrain_lang::Args;
use perigrain_peri::families::{LawKind, Moduli};

/// Reads how stiff bonds of a law are: the micro-modulus c, or the moduli K and G.
///
/// # Errors
/// Numbers that are missing or out of range.
pub fn stiffness(kind: LawKind, args: &mut Args) -> Result<(f64, Moduli)> {
    let mut moduli = Moduli::default();
    if kind.bond_based() {
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

/// Reads what a law has besides its stiffness: how bonds relax or flow.
///
/// # Errors
/// As [`stiffness`].
pub fn beyond_elastic(kind: LawKind, args: &mut Args, moduli: &mut Moduli) -> Result<()> {
    let at = args.here();
    match kind {
        LawKind::Ves => {
            moduli.lambda = args.non_negative("the relaxing share lambda")?;
            if moduli.lambda > 1.0 {
                return fail(Code::BAD_VALUE, at, "lambda is the share of G that relaxes: from 0 to 1");
            }
            moduli.tau = args.positive("the relaxation time tau")?;
        }
        LawKind::Yield | LawKind::NonlinearElastic => {
            moduli.syc = args.number("the stretch syc at which bonds flow")?;
            below_zero(moduli.syc, at)?;
        }
        LawKind::ElasticPlastic => moduli.yield_stress = args.positive("the yield stress")?,
        _ => {}
    }
    Ok(())
}
