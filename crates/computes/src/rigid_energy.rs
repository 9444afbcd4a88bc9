//! compute ke/rigid, erotate/rigid: kinetic energy of rigid bodies.

use super::{Compute, ComputeStyle};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::math::vec3::dot;
use perigrain_lang::{Args, RefKind, ValueRef};
use perigrain_plan::{Op, Stage, When};
use perigrain_styles::rigid_bodies::{Body, bodies, bodies_key};
use perigrain_styles::step_op::{Wanted, fill};
use perigrain_styles::words::{Kind, Syntax, Value, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style, UseKind};
use perigrain_world::field::{MEMO, RIGID};
use perigrain_world::{Numbers, SlotId};

/// `compute ke/rigid`.
pub struct KeRigid;

/// `compute erotate/rigid`.
pub struct ErotateRigid;

impl Style for KeRigid {
    fn name(&self) -> &'static str {
        "ke/rigid"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Kinetic energy of the translation of rigid bodies.",
            text: "Scalar (extensive), in energy units: Σ ½ M v² of the centres of all bodies of the fix. The group decides nothing. 0 before bodies are set up, when a run begins.",
            example: "unfix motion\nset group plate diameter 0.0\nfix body plate rigid single\ncompute k all ke/rigid body",
        }
    }
}

impl Style for ErotateRigid {
    fn name(&self) -> &'static str {
        "erotate/rigid"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Kinetic energy of the rotation of rigid bodies.",
            text: "Scalar (extensive), in energy units: Σ ½ ω · I ω about the centres of all bodies of the fix. The group decides nothing. 0 before bodies are set up, when a run begins.",
            example: "unfix motion\nset group plate diameter 0.0\nfix body plate rigid single\ncompute r all erotate/rigid body",
        }
    }
}

#[derive(Words)]
struct Line {
    /// A `fix rigid`, `rigid/nve`, `rigid/small` or `rigid/nve/small`.
    #[word(name = "fix-ID")]
    fix: RigidFix,
}

impl ComputeStyle for KeRigid {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        declared(|b| b.mass * dot(b.v, b.v), args, cx)
    }
}

impl ComputeStyle for ErotateRigid {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
        declared(|b| dot(b.omega, b.momentum), args, cx)
    }
}

fn declared(twice: fn(&Body) -> f64, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Compute>> {
    let Line { fix } = read(args, cx)?;
    Ok(Box::new(Energy { id: cx.id.to_string(), fix, twice }))
}

/// A rigid fix that another style refers to.
#[derive(Clone)]
pub(super) struct RigidFix {
    /// Its ID.
    pub id: String,
    /// Its style.
    pub style: &'static str,
}

impl RigidFix {
    /// Key of its bodies.
    pub fn bodies(&self) -> Numbers {
        bodies_key(self.style, &self.id)
    }
}

/// The ID of a fix rigid.
impl Value for RigidFix {
    const KIND: Kind = Kind::Fix;
    fn value(_: &str, args: &mut Args, cx: &BuildCx) -> Result<Self> {
        let word = args.expect("the ID of a fix rigid")?;
        let r = ValueRef { kind: RefKind::Fix, name: word.text.clone(), index: vec![], span: word.span };
        let Some(style) = cx.names.fix_style(&r.name) else {
            cx.value(&r, false)?;
            return fail(Code::UNKNOWN_NAME, word.span, format!("there is no fix `{}`", r.name));
        };
        cx.uses(UseKind::Fix, &r.name);
        if style.starts_with("rigid") {
            return Ok(Self { id: r.name, style });
        }
        let text = format!("fix `{}` (style {style}) has no rigid bodies", r.name);
        let d = Diagnostic::error(Code::WRONG_KIND, word.span, text);
        Err(d.help("fixes rigid, rigid/nve, rigid/small and rigid/nve/small have").into())
    }
}

#[derive(Clone)]
struct Energy {
    id: String,
    fix: RigidFix,
    /// Twice the energy of a body [mass velocity²].
    twice: fn(&Body) -> f64,
}

impl Compute for Energy {
    fn shape(&self) -> Shape {
        Shape { scalar: true, scalar_extensive: true, ..Shape::default() }
    }

    fn op(&self, _cx: &mut dyn SealCx, slot: SlotId, stage: Stage, when: &When) -> Result<Box<dyn Op>> {
        let (me, kept) = (self.clone(), self.fix.bodies());
        Ok(fill(&self.id, &Wanted { slot, stage, when }, MEMO | RIGID, move |w, _, out| {
            let twice = bodies(w, kept).iter().fold(0.0, |sum, body| sum + (me.twice)(body));
            out.scalar = 0.5 * w.settings.units.constants().mvv2e * twice;
            Ok(())
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    #[test]
    fn only_fixes_of_bodies() {
        let b = Bench::new(AtomStyle::default(), &[[0.0; 3]; 2]);
        for words in ["", "missing"] {
            assert!(b.compute(&KeRigid, words).is_err() && b.compute(&ErotateRigid, words).is_err());
        }
    }
}
