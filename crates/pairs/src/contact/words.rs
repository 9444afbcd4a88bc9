//! The words of `pair_coeff … granular`: models by name, each with its numbers; unknown models are refused by name.

use super::Coeff;
use perigrain_base::diag::{Code, Diagnostic, Diagnostics, Result, Span};
use perigrain_contact::driver::{Average, Curvature};
use perigrain_contact::normal::{Bound, Number, STYLES};
use perigrain_contact::{Arm, Damping, Friction, Heat, Model, Normal, Rolling, Sds, Tangential, Twisting};
use perigrain_lang::{Args, Word};

/// Keywords after the normal model.
const KEYWORDS: [&str; 11] = [
    "tangential",
    "damping",
    "limit_damping",
    "synchronized_verlet",
    "rolling",
    "twisting",
    "heat",
    "cutoff",
    "average",
    "curvature",
    "arms",
];

/// Reads a granular model: to the end of the line, or to one of the words `ends` (what follows the model of a wall).
///
/// # Errors
/// Every mistake in the line.
pub fn coeff(args: &mut Args, ends: &[&str]) -> Result<Coeff> {
    let first = args.expect("the normal model")?;
    let normal = normal(first, args)?;
    let mut tangential = None;
    let (mut limit, mut synchronized) = (None, None);
    let mut c = Coeff {
        model: Model::new(normal, Damping::default(), Tangential::SMOOTH),
        average: Average::None,
        curvature: Curvature::Both,
        cutoff: None,
        span: first.span,
    };
    while !ends.contains(&args.peek_text())
        && let Some(word) = args.next()
    {
        match word.text.as_str() {
            "tangential" => tangential = Some(self::tangential(&normal, args)?),
            "damping" => c.model.damping = damping(args)?,
            "limit_damping" => limit = Some(word.span),
            "synchronized_verlet" => synchronized = Some(word.span),
            "rolling" => c.model.rolling = rolling(args)?,
            "twisting" => c.model.twisting = twisting(args)?,
            "heat" => c.model.heat = heat(args)?,
            "cutoff" => c.cutoff = Some(args.positive("the cutoff")?),
            "average" => {
                c.average = match args.choice("way of averaging", &["none", "particle", "body"])? {
                    "particle" => Average::Particle,
                    "body" => Average::Body,
                    _ => Average::None,
                }
            }
            "curvature" => {
                c.curvature = match args.choice("curvature", &["both", "impactor"])? {
                    "impactor" => Curvature::Impactor,
                    _ => Curvature::Both,
                }
            }
            "arms" => {
                c.model.arm = match args.choice("end of the arms", &["middle", "point"])? {
                    "point" => Arm::Point,
                    _ => Arm::Middle,
                }
            }
            _ => return Err(args.unknown(word, &KEYWORDS)),
        }
    }
    let Some(tangential) = tangential else {
        return Err(Diagnostic::error(
            Code::MISSING_ARGUMENT,
            args.here(),
            "a granular contact needs a tangential model",
        )
        .help("add `tangential mindlin NULL 1.0 0.5`; `tangential none` makes spheres smooth")
        .into());
    };
    c.model.tangential = tangential;
    c.model.limit_damping = limit.is_some();
    c.model.synchronized = synchronized.is_some();
    check_synchrony(&c.model, synchronized)?;
    check_mdr(first, &c)?;
    check_restitution(first, &c.model)?;
    check_cohesion(first, &c.model, limit)?;
    Ok(c)
}

fn normal(word: &Word, args: &mut Args) -> Result<Normal> {
    let Some(style) = Normal::style(&word.text) else {
        let names: Vec<&str> = STYLES.iter().map(|style| style.name).collect();
        return Err(unknown(word, "normal model of granular contacts", &names));
    };
    let numbers = style.numbers.iter().map(|number| self::number(number, args));
    Ok(Normal::new(style, &numbers.collect::<Result<Vec<f64>>>()?))
}

fn number(number: &Number, args: &mut Args) -> Result<f64> {
    let (ok, wrong, help) = match number.bound {
        Bound::Positive => return args.positive(number.name),
        Bound::NonNegative => return args.non_negative(number.name),
        Bound::Where { ok, wrong, help } => (ok, wrong, help),
    };
    let at = args.here();
    let a = args.number(number.name)?;
    if ok(a) {
        return Ok(a);
    }
    let wrong = Diagnostic::error(Code::BAD_VALUE, at, wrong.replace("{}", &a.to_string()));
    Err(help.into_iter().fold(wrong, |d, help| d.help(help)).into())
}

fn tangential(normal: &Normal, args: &mut Args) -> Result<Tangential> {
    let word = args.expect("the tangential model")?;
    let Some(kind) = Friction::ALL.into_iter().find(|f| f.name() == word.text) else {
        return Err(unknown(word, "tangential model", &Friction::ALL.map(Friction::name)));
    };
    if kind == Friction::None {
        return Ok(Tangential::SMOOTH);
    }
    let stiffness = match kind {
        Friction::LinearNohistory => Some(0.0),
        _ if args.peek_text() == "NULL" => {
            check_null(kind, normal, args.expect("kt")?)?;
            None
        }
        _ => Some(args.non_negative("the tangential stiffness kt")?),
    };
    let x_gamma = args.non_negative("the tangential damping x_gamma")?;
    let mu = args.non_negative("the coefficient of friction mu")?;
    Ok(Tangential::new(kind, stiffness, x_gamma, mu))
}

/// `NULL` in the place of a stiffness: only where the normal model has a material and the spring is Mindlin's.
fn check_null(kind: Friction, normal: &Normal, null: &Word) -> Result<()> {
    let (text, help) = if !kind.takes_material() {
        let text = format!("`tangential {}` needs a stiffness kt, not `NULL`", kind.name());
        (text, "write the stiffness kt; mindlin, mindlin/force and mindlin_rescale take it from the material")
    } else if normal.material().is_none() {
        let text = format!("`NULL` needs a material, which {} does not have", normal.name());
        (text, "write the stiffness kt, or use hertz/material")
    } else {
        return Ok(());
    };
    Err(Diagnostic::error(Code::CONFLICT, null.span, text).help(help).into())
}

fn damping(args: &mut Args) -> Result<Damping> {
    let word = args.expect("the damping model")?;
    if let Some(d) = Damping::ALL.into_iter().find(|d| d.name() == word.text) {
        return Ok(d);
    }
    if word.text == "mdr" {
        return Ok(match args.choice("kind of damping mdr", &["1", "2"])? {
            "1" => Damping::Mdr,
            _ => Damping::MdrConstant,
        });
    }
    let names = [&Damping::ALL.map(Damping::name)[..], &["mdr"]].concat();
    Err(unknown(word, "damping model", &names))
}

fn rolling(args: &mut Args) -> Result<Rolling> {
    let word = args.expect("the rolling model")?;
    match word.text.as_str() {
        "none" => Ok(Rolling::None),
        "sds" => Ok(Rolling::Sds(sds("rolling", args)?)),
        _ => Err(unknown(word, "rolling model", &["none", "sds"])),
    }
}

fn twisting(args: &mut Args) -> Result<Twisting> {
    let word = args.expect("the twisting model")?;
    match word.text.as_str() {
        "none" => Ok(Twisting::None),
        "marshall" => Ok(Twisting::Marshall),
        "sds" => Ok(Twisting::Sds(sds("twisting", args)?)),
        _ => Err(unknown(word, "twisting model", &["none", "marshall", "sds"])),
    }
}

fn sds(part: &str, args: &mut Args) -> Result<Sds> {
    Ok(Sds {
        stiffness: args.non_negative(&format!("the {part} stiffness k"))?,
        damping: args.non_negative(&format!("the {part} damping gamma"))?,
        mu: args.non_negative(&format!("the {part} friction mu"))?,
    })
}

fn heat(args: &mut Args) -> Result<Heat> {
    let word = args.expect("the heat model")?;
    match word.text.as_str() {
        "none" => Ok(Heat::None),
        "area" => Ok(Heat::Area(args.non_negative("the heat transfer coefficient")?)),
        "radius" => Ok(Heat::Radius(args.non_negative("the conductivity")?)),
        _ => Err(unknown(word, "heat model", &["none", "area", "radius"])),
    }
}

/// `mdr` goes with its own damping or none, that damping with nothing else.
fn check_mdr(normal: &Word, c: &Coeff) -> Result<()> {
    let own = matches!(c.model.damping, Damping::Mdr | Damping::MdrConstant);
    let suits = own || c.model.damping == Damping::None;
    let text = match (c.model.normal.in_grains(), own) {
        (true, _) if !suits => "the normal model mdr goes with `damping mdr` or `none`",
        (true, _)
            if c.average != Average::None || c.curvature != Curvature::Both || c.model.arm == Arm::Point =>
        {
            "the normal model mdr knows no `average`, no `curvature` and no `arms point`"
        }
        (true, _) | (false, false) => return Ok(()),
        (false, true) => "damping mdr goes with the normal model mdr alone",
    };
    Err(Diagnostic::error(Code::CONFLICT, normal.span, text)
        .help("write `mdr E nu Y gamma psi_b e … damping mdr 1`, or `damping none`")
        .into())
}

/// `synchronized_verlet` is about springs across the normal, as in LAMMPS.
fn check_synchrony(model: &Model, synchronized: Option<Span>) -> Result<()> {
    let Some(span) = synchronized.filter(|_| model.tangential.kind == Friction::LinearNohistory) else {
        return Ok(());
    };
    let text = "synchronized_verlet turns springs, and `tangential linear_nohistory` has none";
    let d = Diagnostic::error(Code::CONFLICT, span, text);
    Err(d.help("leave the word out, or take `linear_history` or one of the `mindlin` models").into())
}

/// Where the damping model reads `eta` as a coefficient of restitution, it must be one.
fn check_restitution(normal: &Word, model: &Model) -> Result<()> {
    let e = model.normal.eta();
    let least_is_open = model.damping == Damping::CoeffRestitution;
    if !model.damping.wants_restitution() || (e <= 1.0 && (e > 0.0 || !least_is_open)) {
        return Ok(());
    }
    let text = format!(
        "damping {} takes the second number of {} as coefficient of restitution, between 0 and 1: {e} is none",
        model.damping.name(),
        model.normal.name()
    );
    Err(Diagnostic::error(Code::BAD_VALUE, normal.span, text).into())
}

/// What does not go with grains that stick together.
fn check_cohesion(normal: &Word, model: &Model, limit: Option<Span>) -> Result<()> {
    let name = model.normal.name();
    if model.damping.wants_restitution() && !model.normal.takes_restitution() {
        let text =
            format!("damping {} is made for grains that only push, {name} pulls", model.damping.name());
        return Err(Diagnostic::error(Code::CONFLICT, normal.span, text)
            .help("use damping velocity, mass_velocity or viscoelastic")
            .into());
    }
    if let Some(span) = limit.filter(|_| model.normal.pulls()) {
        let text = format!("limit_damping would cut off the attraction of {name}");
        return Err(Diagnostic::error(Code::CONFLICT, span, text).help("leave the word out").into());
    }
    Ok(())
}

fn unknown(word: &Word, what: &str, known: &[&str]) -> Diagnostics {
    let d = Diagnostic::error(Code::UNKNOWN_STYLE, word.span, format!("unknown {what}: `{}`", word.text));
    match perigrain_base::diag::nearest(&word.text, known.iter().copied()) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("known here: {}", known.join(" "))),
    }
    .into()
}
