//! fix nve/sphere: velocity Verlet of spheres, translation and rotation.

use super::dipoles::{self, Update};
use super::kick::{self as kicks, Turning};
use super::{Facts, Fix, FixStyle, Moves};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::field::{F, KIND, MASK, MASS, OMEGA, QUAT, RADIUS, TORQUE, TRAVEL, TYPE_MASS, V, X};
use perigrain_world::{GroupId, World};

/// I / (m R²) of a solid sphere.
const INERTIA: f64 = 0.4;
/// I / (m R²) of a disc about its axis.
const DISC: f64 = 0.5;

/// The style for particles with orientations.
pub(crate) const ORIENTED: &str = "nve/bpm/sphere";

/// The style.
pub struct NveSphere;

impl Style for NveSphere {
    fn name(&self) -> &'static str {
        "nve/sphere"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Moves and turns the group's spheres by velocity Verlet.",
            text: "As `fix nve`, and with each half kick ω += Δt/2 · torque/I, I = 2/5 m R² (solid spheres). \
                   Orientations stay as they are: spheres with bonds that bend and twist need `fix nve/bpm/sphere`. \
                   Every particle of the group needs a radius. `update` needs particles with dipoles (`atom_style \
                   hybrid sphere dipole`).",
            example: "fix 1 all nve/sphere",
        }
    }
}

/// The words of fix nve/sphere and fix nve/bpm/sphere.
#[derive(Words)]
pub(crate) struct Line {
    #[word(keyword, placed)]
    update: Option<At<At<Update>>>,
    /// I = 1/2 m R² instead of 2/5 m R², for flat scenes.
    #[word(flag, placed)]
    disc: Option<Span>,
}

impl FixStyle for NveSphere {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        if !cx.world.particles.style.sphere {
            return Err(Diagnostic::error(Code::WRONG_ORDER, cx.span, "fix nve/sphere needs spheres")
                .help("put `atom_style sphere` (or `hybrid sphere peri`) at the top of the deck")
                .into());
        }
        declared("nve/sphere", args, cx)
    }
}

/// Reads the words of either style; [`ORIENTED`] integrates orientations too.
pub(crate) fn declared(name: &'static str, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
    let (Line { update, disc }, oriented) = (read(args, cx)?, name == ORIENTED);
    if let Some(update) = &update
        && !cx.world.particles.style.dipole
    {
        let text = "`update dipole` needs particles with a dipole, and these have none";
        let d = Diagnostic::error(Code::CONFLICT, update.span.to(update.value.span), text);
        let spheres = if oriented { "bpm/sphere" } else { "sphere" };
        return Err(d.help(format!("`atom_style hybrid {spheres} dipole` has both")).into());
    }
    if let Some(span) = disc.filter(|_| !cx.world.settings.two_dimensional) {
        return fail(Code::CONFLICT, span, "`disc` belongs to flat scenes (`dimension 2`)");
    }
    let (inertia, update) = (if disc.is_some() { DISC } else { INERTIA }, update.map(|u| u.value.value));
    let turning = Turning { inertia, oriented };
    Ok(Box::new(Declared { name, id: cx.id.to_string(), group: cx.group, turning, update }))
}

#[derive(Clone)]
struct Declared {
    name: &'static str,
    id: String,
    group: GroupId,
    turning: Turning,
    /// Integration scheme of the dipole moments.
    update: Option<Update>,
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let (group, turning, span) = (self.group, self.turning, cx.span());
        let p = &cx.world().particles;
        let member = |i: &usize| p.mask[*i] & group.bit() != 0;
        if let Some(i) = (0..p.len()).filter(member).find(|&i| p.radius[i] <= 0.0) {
            let text = format!("fix {} needs spheres, but particle {} has no radius", self.name, p.tag[i]);
            return Err(Diagnostic::error(Code::INCOMPLETE, span, text)
                .help("add `set … diameter …`, or move this particle with `fix nve`")
                .into());
        }
        let name = format!("fix {} {}", self.id, self.name);
        let turned = if turning.oriented { X | V | OMEGA | QUAT } else { X | V | OMEGA };
        let access = || {
            Needs::new().read(F | TORQUE | MASS | RADIUS | MASK | KIND | TYPE_MASS).add(TRAVEL).write(turned)
        };
        let idle = |_: &mut World, _: &Tick| Ok(());
        let first = StepOp::new(name.clone(), Stage::InitialIntegrate, access(), idle);
        let moments = self.update.map(|update| dipoles::op(name.clone(), group, update));
        let second = StepOp::new(name, Stage::FinalIntegrate, access(), idle);
        let first = kicks::first(first.in_every_level().reporting(), group, Some(turning));
        let second = kicks::second(second.in_every_level().reporting(), group, Some(turning));
        Ok(std::iter::once(first.boxed()).chain(moments).chain([second.boxed()]).collect())
    }

    fn facts(&self, _: &World) -> Facts {
        let moves = if self.turning.oriented { Moves::Turns } else { Moves::Freely };
        Facts { moves, ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::AtomStyle;

    fn bench() -> Bench {
        let mut b = Bench::new(AtomStyle { sphere: true, ..AtomStyle::default() }, &[[1.0, 0.0, 0.0]; 2]);
        b.world.particles.radius = vec![0.5; 2].into();
        b
    }

    #[test]
    fn spheres_turn_with_the_inertia_of_solid_ones() {
        let mut b = bench();
        b.world.clock.dt = 0.5;
        b.world.particles.f = vec![[4.0, 0.0, 0.0]; 2].into();
        b.world.particles.torque = vec![[0.0, 0.4, 0.0]; 2].into();
        b.world.particles.mask[1] = 0;
        let fix = b.fix(&NveSphere, "").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::InitialIntegrate).unwrap();
        b.stage(&mut ops, Stage::FinalIntegrate).unwrap();
        // m = 2, R = 0.5: I = 0.2, so dω = 0.5 · 0.4/0.2 = 1 over the whole step.
        let p = &b.world.particles;
        assert!((p.omega[0][1] - 1.0).abs() < 1e-15 && p.omega[1] == [0.0; 3]);
        assert_eq!((p.v[0][0], p.x[0][0]), (1.0, 1.25));
    }

    #[test]
    fn points_and_unknown_words_are_refused() {
        let mut b = bench();
        b.world.particles.radius[1] = 0.0;
        let fix = b.fix(&NveSphere, "").unwrap();
        let e = b.seal(&*fix).err().unwrap();
        assert_eq!(e.0[0].message, "fix nve/sphere needs spheres, but particle 2 has no radius");
        for words in ["disc", "update dipole", "update dipole/dlm"] {
            assert_eq!(b.fix(&NveSphere, words).err().unwrap().0[0].code, Code::CONFLICT);
        }
        b.world.settings.two_dimensional = true;
        assert!(b.fix(&NveSphere, "disc").is_ok());
        assert_eq!(b.fix(&NveSphere, "dics").err().unwrap().0[0].code, Code::UNKNOWN_KEYWORD);
        b.world.particles.style.sphere = false;
        assert!(b.fix(&NveSphere, "").is_err());
    }
}
