//! The keywords of `velocity`.

use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Args, RefKind, ValueRef, Word};
use perigrain_styles::words::{At, Units, Words};
use perigrain_styles::{BuildCx, UseKind};

/// In which order random numbers are given out.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "loop")]
pub enum Loop {
    /// Numbers are drawn for ids 1 … N in order.
    All,
    /// Numbers are drawn in storage order.
    Local,
    /// Each place has a stream of its own.
    Geom,
}

/// How random numbers are distributed.
#[derive(Clone, Copy, PartialEq, Words)]
#[word(what = "distribution")]
pub enum Distribution {
    Uniform,
    Gaussian,
}

/// What stands behind the style.
#[derive(Words)]
pub struct Options {
    /// The distribution of `create`.
    #[word(keyword, default = Distribution::Uniform)]
    pub dist: Distribution,
    /// Whether velocities are added to the present ones.
    #[word(keyword, default = false)]
    pub sum: bool,
    /// Whether `create` takes the mean away.
    #[word(keyword = "mom", default = true)]
    pub momentum: bool,
    /// Whether `create` takes the rotation away.
    #[word(keyword = "rot", default = false)]
    pub rotation: bool,
    /// The order in which `create` draws.
    #[word(keyword = "loop", default = Loop::All)]
    pub order: Loop,
    /// The temperature compute that gives the present temperature, for `create` and `scale`.
    #[word(keyword = "temp", name = "COMPUTE", with = temperature_compute, kind = Kind::Compute)]
    pub compute: Option<ValueRef>,
    /// Whether the flow that the compute of `temp` takes away stays as it is, and the rest is made or scaled.
    #[word(keyword, what = "bias", placed, shown = "no")]
    bias: Option<At<bool>>,
    /// `zero` stops each body of this fix rigid by itself, its particles following.
    #[word(keyword, name = "FIX", with = rigid_fix, kind = Kind::Fix)]
    pub rigid: Option<Word>,
    /// The unit of velocities and distances.
    #[word(keyword, default = Units::Lattice)]
    pub units: Units,
}

impl Options {
    /// Whether the flow that the compute takes away stays as it is.
    pub fn keeps_flow(&self) -> bool {
        self.bias.as_ref().is_some_and(|bias| bias.value)
    }

    /// Refuses options that do not go together.
    ///
    /// # Errors
    /// `bias yes` without a temperature that takes a flow away.
    pub fn check(&self, cx: &BuildCx) -> Result<()> {
        match self.bias.as_ref().filter(|bias| bias.value) {
            Some(bias) => takes_flow_away(self, bias.span, cx),
            None => Ok(()),
        }
    }
}

/// `bias yes` needs a temperature that takes a flow away.
fn takes_flow_away(o: &Options, bias: Span, cx: &BuildCx) -> Result<()> {
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
