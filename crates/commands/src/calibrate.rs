//! `calibrate`: the stiffness of bonded bodies without a run, and coefficients of bonds that give a stiffness.

mod dsm;
mod fit;
mod found;
mod model;
mod scene;
mod tensor;
#[cfg(test)]
mod tests;
mod words;

use super::{Act, CommandStyle};
use found::Found;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Args;
use perigrain_styles::common::{self, populated};
use perigrain_styles::{ActCx, BuildCx, Compute, Doc, Style};
use perigrain_world::GroupId;
use scene::Scene;
use words::{Solver, Words};

/// The command.
pub struct Calibrate;

impl Style for Calibrate {
    fn name(&self) -> &'static str {
        "calibrate"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: "calibrate dsm ID GROUP  …",
            summary: "The stiffness of bonded bodies, without a run.",
            text: "…",
            example: "…",
        }
    }
}

/// Which calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Dsm,
    Ste,
    Periodic,
    Fit,
}

impl CommandStyle for Calibrate {
    fn parse(&self, a: &mut Args, cx: &BuildCx) -> Result<Box<dyn Act>> {
        common::domain(cx)?;
        let name = a.choice("kind of calibration", &["dsm", "ste", "periodic", "fit"])?;
        let kind = match name {
            "dsm" => Kind::Dsm,
            "ste" => Kind::Ste,
            "periodic" => Kind::Periodic,
            _ => Kind::Fit,
        };
        let word = a.expect("an ID for the results")?;
        if !word.unknown && !word.text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            let text = format!("`{}` is no ID: it may hold letters, digits and underscores", word.text);
            return fail(Code::BAD_VALUE, word.span, text);
        }
        if let Some(style) = cx.names.compute_style(&word.text).filter(|s| *s != self.name()) {
            let text = format!("there is a compute {style} of the ID `{}` already", word.text);
            let d = Diagnostic::error(Code::DUPLICATE_NAME, word.span, text);
            return Err(d.help("choose another ID: results are read as `c_ID[1]`").into());
        }
        let group = cx.group(a.expect("a group")?)?;
        if cx.world.bonds.coeffs.is_none() {
            let text = "there is no bond_style: nothing says how stiff bonds are";
            let d = Diagnostic::error(Code::WRONG_ORDER, a.name_span(), text);
            return Err(d.help("put `bond_style` and `bond_coeff` before this line").into());
        }
        let words = Words::read(a, name, cx.world.bonds.types)?;
        if let Some((true, at)) = words.contacts {
            let text = "contacts do not count in `calibrate` yet";
            return Err(Diagnostic::error(Code::NOT_SUPPORTED, at, text).help("say `contacts no`").into());
        }
        let fields = if words.fields { 2 } else { 0 };
        let tensor = match kind {
            Kind::Dsm => false,
            Kind::Ste | Kind::Periodic => true,
            Kind::Fit => words.solver != Solver::Dsm,
        };
        if kind == Kind::Fit && (words.targets.is_empty() || words.vary.is_empty()) {
            let text = "a fit needs a `target` and something to `vary`";
            let d = Diagnostic::error(Code::INCOMPLETE, a.name_span(), text);
            return Err(d.help("as `target K 2.0e4 vary bond 1 E`").into());
        }
        let found = Found::new(&word.text, tensor, fields);
        Ok(Box::new(Calibration { kind, id: word.text.clone(), group, words, found }))
    }
}

/// A line to be worked off.
struct Calibration {
    kind: Kind,
    id: String,
    group: GroupId,
    words: Words,
    found: Found,
}

impl Act for Calibration {
    fn apply(self: Box<Self>, cx: &mut ActCx) -> Result<()> {
        populated(cx.world, "calibrate", cx.span)?;
        common::settle(cx.world);
        let Some(style) = cx.values.bonds() else {
            return fail(Code::WRONG_ORDER, cx.span, "there is no bond_style");
        };
        if cx.world.adaptations() > 0.0 {
            let text = "bonds count with the coefficients of the deck's lines, not with those that fix adapt has given";
            cx.note(Diagnostic::warning(Code::NO_EFFECT, cx.span, text));
        }
        let scene = Scene::new(cx.world, self.group, style.as_ref(), cx.span)?;
        match self.kind {
            Kind::Dsm => dsm::run(cx, &self.id, &scene, &self.words, &self.found),
            Kind::Ste => tensor::ste(cx, &self.id, &scene, &self.words, &self.found),
            Kind::Periodic => tensor::periodic(cx, &self.id, &scene, &self.words, &self.found),
            Kind::Fit => fit::run(cx, &self.id, scene, &self.words, style, &self.found),
        }
    }

    fn leaves(&self) -> Option<(String, Box<dyn Compute>)> {
        Some((self.id.clone(), Box::new(self.found.clone())))
    }
}
