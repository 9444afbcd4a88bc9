//! The keywords of `velocity`.

use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_styles::common::units_lattice;
use perigrain_styles::{BuildCx, UseKind};

const KEYWORDS: [&str; 9] = ["dist", "sum", "mom", "rot", "temp", "bias", "loop", "rigid", "units"];

/// In which order random numbers are given out.
#[derive(Clone, Copy, PartialEq)]
pub enum Loop {
    /// By id.
    All,
    /// As stored.
    Local,
    /// By place.
    Geom,
}

/// What stands behind the style.
pub struct Options {
    /// Drawn from a normal distribution.
    pub gaussian: bool,
    /// Added to the present velocities.
    pub sum: bool,
    /// The drift of the new ones is taken away.
    pub momentum: bool,
    /// Their rotation too.
    pub rotation: bool,
    /// In which order numbers are drawn.
    pub order: Loop,
    /// Lengths are in lattice spacings.
    pub lattice: bool,
    /// The compute that gives the temperature.
    pub compute: Option<ValueRef>,
    /// The flow that this compute takes away stays as it is.
    pub bias: bool,
    /// The fix whose rigid bodies are stopped, each by itself.
    pub rigid: Option<Word>,
}

/// Reads them.
pub fn options(a: &mut Args, cx: &BuildCx) -> Result<Options> {
    let mut o = Options {
        gaussian: false,
        sum: false,
        momentum: true,
        rotation: false,
        order: Loop::All,
        lattice: true,
        compute: None,
        bias: false,
        rigid: None,
    };
    let mut bias = None;
    while let Some(word) = a.next() {
        match word.text.as_str() {
            "dist" => o.gaussian = a.choice("distribution", &["uniform", "gaussian"])? == "gaussian",
            "sum" => o.sum = a.flag("sum")?,
            "mom" => o.momentum = a.flag("mom")?,
            "rot" => o.rotation = a.flag("rot")?,
            "loop" => {
                o.order = match a.choice("loop", &["all", "local", "geom"])? {
                    "all" => Loop::All,
                    "local" => Loop::Local,
                    _ => Loop::Geom,
                }
            }
            "units" => o.lattice = units_lattice(a)?,
            "temp" => o.compute = Some(temperature_compute(a, cx)?),
            "bias" => {
                o.bias = a.flag("bias")?;
                bias = Some(word.span);
            }
            "rigid" => o.rigid = Some(rigid_fix(a, cx)?),
            _ => return Err(a.unknown(word, &KEYWORDS)),
        }
    }
    if o.bias {
        takes_flow_away(&o, bias, cx)?;
    }
    Ok(o)
}

/// `bias yes` needs a temperature that takes a flow away.
fn takes_flow_away(o: &Options, bias: Option<Span>, cx: &BuildCx) -> Result<()> {
    let d = match &o.compute {
        None => Diagnostic::error(Code::CONFLICT, bias, "`bias yes` needs `temp` with a temperature"),
        Some(r) if !cx.names.compute(&r.name).is_some_and(|s| s.flow) => {
            let text = format!("compute `{}` takes no flow velocity away", r.name);
            Diagnostic::error(Code::WRONG_KIND, r.span, text)
        }
        Some(_) => return Ok(()),
    };
    Err(d
        .help("computes temp/com, temp/deform, temp/partial, temp/profile, temp/ramp and temp/region take one away")
        .into())
}

/// The fix that a word names, if it is one of rigid bodies.
fn rigid_fix(a: &mut Args, cx: &BuildCx) -> Result<Word> {
    let id = a.expect("a fix")?;
    match cx.names.fix_style(&id.text) {
        Some("rigid" | "rigid/small") => {
            cx.uses(UseKind::Fix, &id.text);
            Ok(id.clone())
        }
        Some(style) => {
            let text = format!("fix `{}` is of style {style} and has no rigid bodies", id.text);
            fail(Code::WRONG_KIND, id.span, text)
        }
        None => fail(Code::UNKNOWN_NAME, id.span, format!("there is no rigid body fix `{}`", id.text)),
    }
}

/// The compute that a word names, if it is one of temperature.
fn temperature_compute(a: &mut Args, cx: &BuildCx) -> Result<ValueRef> {
    let word = a.expect("a compute")?;
    let r = ValueRef { kind: RefKind::Compute, name: word.text.clone(), index: vec![], span: word.span };
    cx.value(&r, false)?;
    match cx.names.compute_style(&word.text) {
        Some(style) if !style.starts_with("temp") => {
            let text = format!("compute `{}` is of style {style} and computes no temperature", word.text);
            fail(Code::WRONG_KIND, word.span, text)
        }
        _ => Ok(r),
    }
}
