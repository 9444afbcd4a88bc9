//! The words of `pair_coeff … granular`: models by name, each with its numbers; what is not there is refused by name.

use super::Coeff;
use crate::diag::{Code, Diagnostic, Diagnostics, Result};
use crate::lang::{Args, Word};
use crate::laws::contact::driver::{Average, Curvature};
use crate::laws::contact::{Damping, Model, Normal, Tangential};

/// Keywords after the normal model.
const KEYWORDS: [&str; 9] = [
    "tangential",
    "damping",
    "limit_damping",
    "rolling",
    "twisting",
    "heat",
    "cutoff",
    "average",
    "curvature",
];

/// Reads a granular model: to the end of the line, or to one of the words `ends` (what follows the model of a wall).
///
/// # Errors
/// Every mistake in the line.
pub fn coeff(args: &mut Args, ends: &[&str]) -> Result<Coeff> {
    let first = args.expect("the normal model")?;
    let normal = normal(first, args)?;
    let mut tangential = None;
    let mut c = Coeff {
        model: Model {
            normal,
            damping: Damping::default(),
            tangential: Tangential::Mindlin { stiffness: None, x_gamma: 0.0, mu: 0.0 },
            limit_damping: false,
        },
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
            "limit_damping" => c.model.limit_damping = true,
            "rolling" => absent("rolling", &["sds"], args)?,
            "twisting" => absent("twisting", &["sds", "marshall"], args)?,
            "heat" => absent("heat", &["radius", "area"], args)?,
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
            _ => return Err(args.unknown(word, &KEYWORDS)),
        }
    }
    let Some(tangential) = tangential else {
        return Err(Diagnostic::error(
            Code::MISSING_ARGUMENT,
            args.here(),
            "a granular contact needs a tangential model",
        )
        .help("add `tangential mindlin NULL 1.0 0.5`; friction 0 makes spheres smooth")
        .into());
    };
    c.model.tangential = tangential;
    check_restitution(first, &c.model)?;
    Ok(c)
}

fn normal(word: &Word, args: &mut Args) -> Result<Normal> {
    match word.text.as_str() {
        "hertz" => Ok(Normal::Hertz {
            stiffness: args.non_negative("the stiffness kn")?,
            eta: args.non_negative("the damping eta")?,
        }),
        "hertz/material" => {
            let young = args.positive("Young's modulus E")?;
            let eta = args.non_negative("the damping eta")?;
            let at = args.here();
            let poisson = args.number("Poisson's ratio nu")?;
            if !(-1.0..=0.5).contains(&poisson) {
                let text = format!("Poisson's ratio lies between -1 and 0.5, {poisson} does not");
                return Err(Diagnostic::error(Code::BAD_VALUE, at, text).into());
            }
            Ok(Normal::HertzMaterial { young, eta, poisson })
        }
        "none" | "hooke" | "dmt" | "jkr" | "mdr" => {
            Err(not_yet("normal model", word, "hertz or hertz/material"))
        }
        _ => Err(unknown(word, "normal model of granular contacts", &["hertz", "hertz/material"])),
    }
}

fn tangential(normal: &Normal, args: &mut Args) -> Result<Tangential> {
    let word = args.expect("the tangential model")?;
    match word.text.as_str() {
        "mindlin" => {
            let stiffness = if args.peek_text() == "NULL" {
                let null = args.expect("kt")?;
                if normal.material().is_none() {
                    let text = format!("`NULL` needs a material, which {} does not have", normal.name());
                    return Err(Diagnostic::error(Code::CONFLICT, null.span, text)
                        .help("write the stiffness kt, or use hertz/material")
                        .into());
                }
                None
            } else {
                Some(args.non_negative("the tangential stiffness kt")?)
            };
            let x_gamma = args.non_negative("the tangential damping x_gamma")?;
            let mu = args.non_negative("the coefficient of friction mu")?;
            Ok(Tangential::Mindlin { stiffness, x_gamma, mu })
        }
        "none"
        | "linear_nohistory"
        | "linear_history"
        | "linear_history_classic"
        | "mindlin_classic"
        | "mindlin/force"
        | "mindlin_rescale"
        | "mindlin_rescale/force" => Err(not_yet("tangential model", word, "mindlin")),
        _ => Err(unknown(word, "tangential model", &["mindlin"])),
    }
}

fn damping(args: &mut Args) -> Result<Damping> {
    let word = args.expect("the damping model")?;
    if let Some(d) = Damping::ALL.into_iter().find(|d| d.name() == word.text) {
        return Ok(d);
    }
    let names = Damping::ALL.map(Damping::name);
    if ["none", "mdr"].contains(&word.text.as_str()) {
        return Err(not_yet("damping model", word, &names.join(", ")));
    }
    Err(unknown(word, "damping model", &names))
}

/// A part that can only be `none` so far.
fn absent(part: &str, known: &[&str], args: &mut Args) -> Result<()> {
    let word = args.expect(&format!("the {part} model"))?;
    match word.text.as_str() {
        "none" => Ok(()),
        w if known.contains(&w) => Err(not_yet(&format!("{part} model"), word, "none")),
        _ => Err(unknown(word, &format!("{part} model"), &["none"])),
    }
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

fn not_yet(what: &str, word: &Word, have: &str) -> Diagnostics {
    Diagnostic::error(
        Code::NOT_SUPPORTED,
        word.span,
        format!("{what} `{}` is not in perigrain yet", word.text),
    )
    .help(format!("there is: {have}"))
    .into()
}

fn unknown(word: &Word, what: &str, known: &[&str]) -> Diagnostics {
    let d = Diagnostic::error(Code::UNKNOWN_STYLE, word.span, format!("unknown {what}: `{}`", word.text));
    match crate::diag::nearest(&word.text, known.iter().copied()) {
        Some(n) => d.help(format!("did you mean `{n}`?")),
        None => d.help(format!("known here: {}", known.join(" "))),
    }
    .into()
}
