//! fix wall/reflect: flat walls that reflect particles.

use super::faces::{Face, Spot, Walls, check};
use super::{Facts, Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::par;
use perigrain_lang::Args;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{Syntax, Units, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Style};
use perigrain_world::field::{MASK, SLOTS, V, X};
use perigrain_world::{GroupId, World};

/// The style.
pub struct WallReflect;

impl Style for WallReflect {
    fn name(&self) -> &'static str {
        "wall/reflect"
    }
    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Throws particles back that have gone through flat walls.",
            text: "After the drift of a step a particle of the group whose centre is at a distance d beyond a wall is \
                   put as far inside, and its velocity across the wall changes sign. Up to six walls. A moving wall \
                   gives no velocity to the particles it reflects. Sizes of spheres do not count, nor does their spin \
                   change. Faces of that direction must not be periodic.\n\n\
                   Energy is kept to first order in the time step only. Not in minimizations, and not under `run_style \
                   respa`, in which LAMMPS silently reflects no particle.",
            example: "fix floor grains wall/reflect zlo -0.001 zhi EDGE units box",
        }
    }
}

#[derive(Words)]
struct Line {
    #[word(flatten)]
    walls: Walls<Bare>,
    /// Places, numbers and variables, are in these units.
    #[word(keyword)]
    units: Units,
}

/// Behind the place of a wall stands nothing.
#[derive(Words)]
struct Bare {}

impl FixStyle for WallReflect {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let Line { walls, units } = read(args, cx)?;
        check(&walls.0, false, args, cx)?;
        if cx.names.all(perigrain_styles::UseKind::Fix).iter().any(|id| is_rigid(cx, id)) {
            let text = "a wall that puts particles back pulls rigid bodies apart for a moment: `fix wall/harmonic` does not";
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, cx.span, text));
        }
        let (faces, scale) = (walls.0.into_iter().map(|(face, _)| face).collect(), units.scales(cx.world));
        Ok(Box::new(Declared { id: cx.id.to_string(), group: cx.group, faces, scale }))
    }
}

fn is_rigid(cx: &BuildCx, id: &str) -> bool {
    cx.names.fix_style(id).is_some_and(|style| style.starts_with("rigid"))
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    faces: Vec<Face>,
    scale: [f64; 3],
}

/// Reflects particles of the group that are beyond the face at `at`.
fn reflect(w: &mut World, bit: u32, face: &Face, at: f64) {
    let d = face.axis;
    let (mut x, mut v) = (std::mem::take(&mut w.particles.x), std::mem::take(&mut w.particles.v));
    let world: &World = w;
    par::each((&mut x[..], &mut v[..], &world.particles.mask[..]), |first, (x, v, mask)| {
        let own = world.moved_in(first..first + mask.len()).flatten().map(|row| row - first);
        for k in own.filter(|k| mask[*k] & bit != 0) {
            if face.depth(x[k], at) < 0.0 {
                x[k][d] = at + (at - x[k][d]);
                v[k][d] = -v[k][d];
            }
        }
    });
    (w.particles.x, w.particles.v) = (x, v);
}

impl Fix for Declared {
    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let stage = Stage::PostIntegrate;
        let mut walls: Vec<(Face, Spot)> = vec![];
        for face in &self.faces {
            walls.push((face.clone(), face.seal(cx, stage, self.scale)?));
        }
        let bit = self.group.bit();
        let access = Needs::new().read(MASK | SLOTS).write(X | V);
        let op = StepOp::new(format!("fix {} wall/reflect", self.id), stage, access, move |w, _| {
            for (face, spot) in &walls {
                let at = spot.get(w);
                reflect(w, bit, face, at);
            }
            Ok(())
        });
        Ok(vec![op.one_by_one().boxed()])
    }

    fn facts(&self, _: &World) -> Facts {
        Facts { needs_whole_steps: Some("in LAMMPS it reflects no particle in them"), ..Facts::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_styles::testing::Bench;
    use perigrain_world::{AtomStyle, Boundary, Domain, Face as Side, Lattice};

    fn scene() -> Bench {
        let mut b = Bench::new(AtomStyle::default(), &[[3.0, -9.5, 1.0], [-11.0, 12.0, 0.0]]);
        let mut faces = Boundary::default();
        (faces.0[0], faces.0[1]) = ([Side::Fixed; 2], [Side::Fixed; 2]);
        b.world.domain = Some(Domain::new([-10.0; 3], [10.0; 3], faces)).into();
        b.world.particles.v = vec![[1.0, -2.0, 3.0]; 2].into();
        b.equal.insert("h".into(), 1.0);
        b.world.lattice = Lattice::none(0.5);
        b
    }

    // By hand: as far inside as they were outside.
    #[test]
    fn those_beyond_are_put_back_and_turned() {
        let mut b = scene();
        let fix = b.fix(&WallReflect, "xlo EDGE xhi v_h yhi 20 ylo -18.5").unwrap();
        let mut ops = b.seal(&*fix).unwrap();
        b.stage(&mut ops, Stage::PostIntegrate).unwrap();
        // The wall at 1 · 0.5: 3 → -2; faces at -10 and at 20 · 0.5: -11 → -9, 12 → 8; at -18.5 · 0.5: -9.5 → -9.
        assert_eq!(b.world.particles.x, [[-2.0, -9.0, 1.0], [-9.0, 8.0, 0.0]]);
        assert_eq!(b.world.particles.v, [[-1.0, 2.0, 3.0], [-1.0, 2.0, 3.0]]);
    }

    #[test]
    fn mistakes_are_named() {
        let b = scene();
        for words in [
            "",
            "units box",
            "xlo",
            "xlo EDGE xlo 1",
            "zlo EDGE",
            "xlo EDGE ylow 1",
            "xlo v_q",
            "xlo c_q",
            "xlo EDGE units metres",
        ] {
            assert!(b.fix(&WallReflect, words).is_err(), "{words}");
        }
    }
}
