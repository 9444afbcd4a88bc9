//! The numbers of `pair_style gran/*` and `fix wall/gran hooke|hooke/history|hertz/history`: seven words for all pairs.

use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::units::UnitSystem;
use perigrain_contact::{Arm, Classic};
use perigrain_lang::Args;

/// The largest coefficient of friction that is taken for one, as in LAMMPS.
const MOST_FRICTION: f64 = 1e4;

/// Reads what may follow the numbers of a pair style: `arms radius|middle`, and `limit_damping` behind it.
///
/// # Errors
/// Another end of the arms.
pub fn options(args: &mut Args, numbers: &mut Classic) -> Result<()> {
    if args.eat("arms") {
        numbers.arm = match args.choice("end of the arms", &["radius", "middle"])? {
            "middle" => Arm::Middle,
            _ => Arm::Radius,
        };
    }
    numbers.limit_damping |= args.eat("limit_damping");
    Ok(())
}

/// Reads `Kn Kt gamma_n gamma_t xmu dampflag [limit_damping]`; of `hertz` styles Kn and Kt are pressures in the deck's
/// units.
///
/// # Errors
/// Missing words, negative numbers, a friction beyond 10⁴, a flag that is neither 0 nor 1.
pub fn numbers(args: &mut Args, hertz: bool, units: UnitSystem) -> Result<Classic> {
    let kn = args.non_negative("the stiffness Kn")?;
    let kt = if args.eat("NULL") { kn * 2.0 / 7.0 } else { args.non_negative("the stiffness Kt (or NULL)")? };
    let gamma_n = args.non_negative("the damping gamma_n")?;
    let gamma_t =
        if args.eat("NULL") { 0.5 * gamma_n } else { args.non_negative("the damping gamma_t (or NULL)")? };
    let at = args.here();
    let mu = args.non_negative("the coefficient of friction xmu")?;
    if mu > MOST_FRICTION {
        let text = format!("the coefficient of friction xmu lies between 0 and 10000, {mu} does not");
        return Err(Diagnostic::error(Code::BAD_VALUE, at, text).into());
    }
    let at = args.here();
    let flag = args.integer("dampflag")?;
    if !(0..=1).contains(&flag) {
        let text = format!("dampflag is 0 (no damping across the normal) or 1, not {flag}");
        return Err(Diagnostic::error(Code::BAD_VALUE, at, text).into());
    }
    let limit_damping = args.eat("limit_damping");
    let gamma = [gamma_n, if flag == 1 { gamma_t } else { 0.0 }];
    let pressure = if hertz { units.constants().nktv2p } else { 1.0 };
    let stiffness = [kn, kt].map(|k| k / pressure);
    Ok(Classic { stiffness, gamma, mu, limit_damping, arm: Arm::Radius })
}
