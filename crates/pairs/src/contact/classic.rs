//! The words of `pair_style gran/*` and `fix wall/gran hooke|hooke/history|hertz/history`: seven numbers for all pairs.

use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::units::UnitSystem;
use perigrain_contact::{Arm, Classic};
use perigrain_lang::Args;
use perigrain_styles::BuildCx;
use perigrain_styles::words::{Alternative, NonNegative, Nullable, Words, inner};

/// The largest coefficient of friction that is taken for one, as in LAMMPS.
const MOST_FRICTION: f64 = 1e4;

/// The words of a pair style.
#[derive(Words)]
pub struct Line {
    #[word(flatten)]
    numbers: Numbers,
    /// Keeps the normal force from pulling.
    #[word(flag)]
    limit_damping: bool,
    #[word(keyword, like = Ends, default = Arm::Radius)]
    arms: Arm,
}

/// The numbers of a classic force.
#[derive(Words)]
pub struct Numbers {
    /// The stiffness Kn along the normal; of `hertz` styles a pressure [force/length].
    #[word(name = "Kn", what = "the stiffness Kn", non_negative)]
    normal: f64,
    /// The stiffness Kt across the normal; `NULL` stands for 2/7 Kn [force/length].
    #[word(name = "Kt", what = "the stiffness Kt (or NULL)")]
    tangential: Nullable<NonNegative>,
    /// The damping gamma_n along the normal; of `hertz` styles per length [1/time].
    #[word(what = "the damping gamma_n", non_negative)]
    gamma_n: f64,
    /// The damping gamma_t across the normal; `NULL` stands for gamma_n/2 [1/time].
    #[word(what = "the damping gamma_t (or NULL)")]
    gamma_t: Nullable<NonNegative>,
    /// The coefficient of friction xmu.
    #[word(with = friction, kind = Kind::Number)]
    xmu: f64,
    /// What damping there is across the normal.
    #[word(with = damps, kind = Kind::Models(FLAGS))]
    dampflag: bool,
}

/// The values of `dampflag`.
const FLAGS: &[Alternative] = &[
    Alternative { word: "0", about: "None.", parts: &[] },
    Alternative { word: "1", about: "That of gamma_t.", parts: &[] },
];

/// Where the arms of friction end.
#[derive(Words)]
#[word(what = "end of the arms", of = Arm)]
enum Ends {
    /// Torques of friction act with the full radii as arms, as in LAMMPS.
    Radius,
    /// They act in the middle of the overlap, as those of pair_style granular.
    Middle,
}

/// A coefficient of friction.
fn friction(args: &mut Args, _: &BuildCx) -> Result<f64> {
    let at = args.here();
    let mu = args.non_negative("the coefficient of friction xmu")?;
    if mu > MOST_FRICTION {
        let text = format!("the coefficient of friction xmu lies between 0 and 10000, {mu} does not");
        return fail(Code::BAD_VALUE, at, text);
    }
    Ok(mu)
}

/// Whether friction is damped.
fn damps(args: &mut Args, _: &BuildCx) -> Result<bool> {
    let at = args.here();
    match args.integer("dampflag")? {
        0 => Ok(false),
        1 => Ok(true),
        flag => fail(
            Code::BAD_VALUE,
            at,
            format!("dampflag is 0 (no damping across the normal) or 1, not {flag}"),
        ),
    }
}

impl Numbers {
    /// As the contact model has them; of `hertz` styles Kn and Kt are pressures in the deck's units.
    fn model(self, hertz: bool, units: UnitSystem) -> Classic {
        let or = |given: Nullable<NonNegative>, other: f64| given.0.map_or(other, |number| number.0);
        let pressure = if hertz { units.constants().nktv2p } else { 1.0 };
        let stiffness = [self.normal, or(self.tangential, self.normal * 2.0 / 7.0)].map(|k| k / pressure);
        let gamma_t = or(self.gamma_t, 0.5 * self.gamma_n);
        let gamma = [self.gamma_n, if self.dampflag { gamma_t } else { 0.0 }];
        Classic { stiffness, gamma, mu: self.xmu, limit_damping: false, arm: Arm::Radius }
    }
}

/// Reads the words of a pair style.
///
/// # Errors
/// Missing words, negative numbers, a friction beyond 10⁴, a flag that is neither 0 nor 1.
pub fn line(args: &mut Args, hertz: bool, cx: &BuildCx) -> Result<Classic> {
    let Line { numbers, limit_damping, arms } = inner(args, cx)?;
    Ok(Classic { limit_damping, arm: arms, ..numbers.model(hertz, cx.world.settings.units) })
}

/// Reads the numbers of a wall, and `limit_damping` behind them.
///
/// # Errors
/// As [`line`].
pub fn numbers(args: &mut Args, hertz: bool, cx: &BuildCx) -> Result<Classic> {
    let model = inner::<Numbers>(args, cx)?.model(hertz, cx.world.settings.units);
    Ok(Classic { limit_damping: args.eat("limit_damping"), ..model })
}
