//! The functions and constants of formulas, as tables.

use super::super::value::Clock;
use super::time;
use perigrain_base::math::rng::Marsaglia;
use std::f64::consts::PI;

/// What a function does.
pub(super) enum Body {
    /// It computes; the error explains what is wrong with the numbers.
    Plain(fn(&[f64], &Clock) -> Result<f64, String>),
    /// It draws from a random stream, whose seed is the last number.
    Draw(fn(&mut Marsaglia, &[f64]) -> Result<f64, String>),
}

/// One function.
pub(super) struct Function {
    /// As written.
    pub name: &'static str,
    /// How many arguments.
    pub arity: usize,
    /// What it does.
    pub body: Body,
}

impl std::fmt::Debug for Function {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// A function of a group of particles.
pub(super) struct Group {
    /// As written.
    pub name: &'static str,
    /// The words its second argument may be; none if there is no such argument.
    pub words: &'static [&'static str],
}

const DIM: &[&str] = &["x", "y", "z"];
const FACE: &[&str] = &["xmin", "xmax", "ymin", "ymax", "zmin", "zmax"];
const DIMDIM: &[&str] = &["xx", "yy", "zz", "xy", "yz", "xz"];

const GROUPS: &[Group] = &[
    Group { name: "count", words: &[] },
    Group { name: "mass", words: &[] },
    Group { name: "charge", words: &[] },
    Group { name: "xcm", words: DIM },
    Group { name: "vcm", words: DIM },
    Group { name: "fcm", words: DIM },
    Group { name: "bound", words: FACE },
    Group { name: "gyration", words: &[] },
    Group { name: "ke", words: &[] },
    Group { name: "angmom", words: DIM },
    Group { name: "torque", words: DIM },
    Group { name: "inertia", words: DIMDIM },
    Group { name: "omega", words: DIM },
];

/// The words that stand for a number.
pub(super) const CONSTANTS: &[&str] = &["PI", "version", "yes", "no", "on", "off", "true", "false"];

const fn plain(
    name: &'static str,
    arity: usize,
    body: fn(&[f64], &Clock) -> Result<f64, String>,
) -> Function {
    Function { name, arity, body: Body::Plain(body) }
}

const fn draw(name: &'static str, body: fn(&mut Marsaglia, &[f64]) -> Result<f64, String>) -> Function {
    Function { name, arity: 3, body: Body::Draw(body) }
}

static FUNCTIONS: &[Function] = &[
    plain("sqrt", 1, |a, _| within(a[0] >= 0.0, "the root of a negative number", a[0].sqrt())),
    plain("exp", 1, |a, _| Ok(a[0].exp())),
    plain("ln", 1, |a, _| within(a[0] > 0.0, LOG, a[0].ln())),
    plain("log", 1, |a, _| within(a[0] > 0.0, LOG, a[0].log10())),
    plain("abs", 1, |a, _| Ok(a[0].abs())),
    plain("sin", 1, |a, _| Ok(a[0].sin())),
    plain("cos", 1, |a, _| Ok(a[0].cos())),
    plain("tan", 1, |a, _| Ok(a[0].tan())),
    plain("asin", 1, |a, _| within(a[0].abs() <= 1.0, ARC, a[0].asin())),
    plain("acos", 1, |a, _| within(a[0].abs() <= 1.0, ARC, a[0].acos())),
    plain("atan", 1, |a, _| Ok(a[0].atan())),
    plain("atan2", 2, |a, _| Ok(a[0].atan2(a[1]))),
    draw("random", |r, a| Ok(r.uniform() * (a[1] - a[0]) + a[0])),
    draw("normal", |r, a| {
        within(a[1] >= 0.0, "a negative deviation", 0.0)?;
        Ok(a[0] + a[1] * r.gaussian())
    }),
    plain("ceil", 1, |a, _| Ok(a[0].ceil())),
    plain("floor", 1, |a, _| Ok(a[0].floor())),
    plain("round", 1, |a, _| Ok(if a[0] - a[0].floor() >= 0.5 { a[0].ceil() } else { a[0].floor() })),
    plain("sign", 1, |a, _| Ok(if a[0] >= 0.0 { 1.0 } else { -1.0 })),
    plain("ternary", 3, |a, _| Ok(if a[0] != 0.0 { a[1] } else { a[2] })),
    plain("ramp", 2, time::ramp),
    plain("stagger", 2, time::stagger),
    plain("logfreq", 3, time::logfreq),
    plain("logfreq2", 3, time::logfreq2),
    plain("logfreq3", 3, time::logfreq3),
    plain("stride", 3, time::stride),
    plain("stride2", 6, time::stride2),
    plain("vdisplace", 2, |a, c| Ok(a[0] + a[1] * time::elapsed(c))),
    plain("swiggle", 3, |a, c| Ok(a[0] + a[1] * phase(a[2], c)?.sin())),
    plain("cwiggle", 3, |a, c| Ok(a[0] + a[1] * (1.0 - phase(a[2], c)?.cos()))),
];

const LOG: &str = "the logarithm of a number that is not positive";
const ARC: &str = "a sine or cosine beyond 1";

fn within(ok: bool, what: &str, value: f64) -> Result<f64, String> {
    if ok { Ok(value) } else { Err(what.to_owned()) }
}

/// ω t of an oscillation with this period.
fn phase(period: f64, clock: &Clock) -> Result<f64, String> {
    if period == 0.0 {
        return Err("the period must not be zero".into());
    }
    Ok(2.0 * PI / period * time::elapsed(clock))
}

/// The function of this name.
pub(super) fn find(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|f| f.name == name)
}

/// The group function of this name.
pub(super) fn group(name: &str) -> Option<&'static Group> {
    GROUPS.iter().find(|g| g.name == name)
}

/// Every function there is.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    let special = super::special::SPECIALS.iter().map(|s| s.name);
    FUNCTIONS.iter().map(|f| f.name).chain(GROUPS.iter().map(|g| g.name)).chain(special)
}

/// The number a word stands for.
pub(super) fn constant(name: &str) -> Option<f64> {
    Some(match name {
        "PI" => PI,
        // the version whose decks perigrain reads
        "version" => 20250722.0,
        "yes" | "on" | "true" => 1.0,
        "no" | "off" | "false" => 0.0,
        _ => return None,
    })
}
