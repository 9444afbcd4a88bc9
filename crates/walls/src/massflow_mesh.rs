//! fix massflow/mesh: counts grains that pass through a surface, and their mass.

mod passing;
mod running;

use crate::shared::forget;
use crate::surface::SurfaceId;
use crate::{Fix, FixStyle};
use passing::Target;
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::{Vec3, cross, dot, length, sub};
use perigrain_lang::Args;
use perigrain_mesh::Triangle;
use perigrain_plan::{Needs, Op, Stage};
use perigrain_styles::fix::Facts;
use perigrain_styles::mesh_surface::{MeshSurface, SURFACES};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{Fields, MASK, MASS, MEMO, RADIUS, SLOTS, TAG, V, X};
use perigrain_world::{GroupId, Key, Numbers, World};
use running::{Running, SUMS};
use std::path::PathBuf;

/// The style.
pub struct MassflowMesh;

impl Style for MassflowMesh {
    fn name(&self) -> &'static str {
        "massflow/mesh"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Behind(Line::GRAMMAR),
            summary: "Counts grains of the group whose centres pass through a surface of `fix surface`.",
            text: "A grain counts when its centre passes a triangle from the inner to the outer side: in the direction of \
                   `vec_side`, or towards `point_at_outlet` (away from it with `inside_out`). With `count multiple` it \
                   counts again each time it comes through, with `count once` the first time alone. `delete_atoms yes` \
                   deletes what has counted; it and `point_at_outlet` need `count once`. The surface may move; no wall has \
                   to lean on it.\n\n\
                   Vector of 6 (extensive): mass and number so far, mass and number per time since the last step with \
                   output, deleted mass and number. The counts continue after a restart.\n\n\
                   The file has a row for each grain that counts, in LIGGGHTS' format: ID, with `writeTime` the time, diameter, \
                   position and velocity at the step in which it has passed, with four digits.",
            example: "fix gate all surface blade.stl type 1 scale 0.001\nfix out grains massflow/mesh mesh gate vec_side 0 0 -1",
        }
    }
}

#[derive(Words)]
struct Line {
    /// The surface.
    #[word(keyword, name = "surfaceID", shown = "required")]
    mesh: Option<SurfaceId>,
    /// The direction in which grains count.
    #[word(keyword, name = "x y z", what = "{}", placed)]
    vec_side: Option<At<[f64; 3]>>,
    /// A point on the outer side.
    #[word(keyword, name = "x y z", what = "{}", placed)]
    point_at_outlet: Option<At<[f64; 3]>>,
    /// The point is on the inner side.
    #[word(flag)]
    inside_out: bool,
    #[word(keyword, default = Count::Multiple)]
    count: Count,
    /// Whether grains are deleted that have counted.
    #[word(keyword, what = "delete_atoms", placed, shown = "no")]
    delete_atoms: Option<At<bool>>,
    /// The grains that count are listed in this file.
    #[word(keyword, name = "name", what = "the file's name")]
    file: Option<At<PathBuf>>,
    /// They are listed in this file, behind what it holds.
    #[word(keyword, name = "name", what = "the file's name")]
    append: Option<At<PathBuf>>,
    /// The list has the time.
    #[word(flag = "writeTime", placed)]
    write_time: Option<Span>,
}

/// How often a grain counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Words)]
#[word(what = "way of counting")]
enum Count {
    /// Each time it passes.
    Multiple,
    /// The first time alone.
    Once,
}

/// On which side of a triangle grains arrive.
#[derive(Clone, Copy, Debug)]
enum Side {
    Along(Vec3),
    Towards(Vec3),
    AwayFrom(Vec3),
}

impl FixStyle for MassflowMesh {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Fix>> {
        let line: Line = read(args, cx)?;
        let refuse = |code, span, text: &str, help: &str| {
            Err(Diagnostic::error(code, span, text).help(help.to_string()).into())
        };
        let Some(SurfaceId(mesh)) = line.mesh else {
            return refuse(
                Code::MISSING_ARGUMENT,
                cx.span,
                "the surface is missing",
                "write `mesh ID` of a `fix surface`",
            );
        };
        let side = match (line.vec_side, line.point_at_outlet) {
            (Some(at), None) if length(at.value) > 0.0 && !line.inside_out => Side::Along(at.value),
            (Some(at), None) if line.inside_out => {
                let text = "`inside_out` belongs to `point_at_outlet`";
                return refuse(Code::CONFLICT, at.span, text, "turn `vec_side` round");
            }
            (Some(at), None) => {
                return refuse(
                    Code::BAD_VALUE,
                    at.span,
                    "vec_side has no direction",
                    "write `vec_side 0 0 -1`",
                );
            }
            (None, Some(at)) if line.inside_out => Side::AwayFrom(at.value),
            (None, Some(at)) => Side::Towards(at.value),
            (None, None) => {
                let text = "the outer side is missing";
                return refuse(
                    Code::MISSING_ARGUMENT,
                    cx.span,
                    text,
                    "write `vec_side x y z` or `point_at_outlet x y z`",
                );
            }
            (Some(_), Some(at)) => {
                let text = "`vec_side` and `point_at_outlet` both state the outer side";
                return refuse(Code::CONFLICT, at.span, text, "leave out one of them");
            }
        };
        let deletes = line.delete_atoms.is_some_and(|at| at.value);
        if line.count == Count::Multiple {
            let span = match (line.point_at_outlet, line.delete_atoms.filter(|at| at.value)) {
                (Some(at), _) => Some(at.span),
                (None, Some(at)) => Some(at.span),
                (None, None) => None,
            };
            if let Some(span) = span {
                return refuse(Code::CONFLICT, span, "this needs `count once`", "add `count once`");
            }
        }
        let once = line.count == Count::Once;
        let target = Target::of(line.file, line.append, line.write_time.is_some());
        if let (Some(span), None) = (line.write_time, &target) {
            let text = "`writeTime` is about the file of this fix, which has none";
            return refuse(Code::CONFLICT, span, text, "add `file NAME`");
        }
        Ok(Box::new(Declared {
            id: cx.id.to_string(),
            group: cx.group,
            surface: mesh.text,
            side,
            once,
            deletes,
            target,
        }))
    }
}

#[derive(Clone)]
struct Declared {
    id: String,
    group: GroupId,
    surface: String,
    side: Side,
    once: bool,
    deletes: bool,
    target: Option<Target>,
}

/// Names of its state.
#[derive(Clone, Copy)]
struct Keys {
    /// Mass, number, deleted mass and number; mass, number and time at the last output; both rates.
    sums: Numbers,
    /// Grains near the surface at the last step: ID and place in the frame of the surface.
    near: Numbers,
    /// IDs of the grains that have counted.
    counted: Numbers,
}

impl Declared {
    fn keys(&self) -> Keys {
        let sums: Numbers = Key::new(&format!("massflow/mesh/{}", self.id));
        Keys { sums, near: sums.with("/near"), counted: sums.with("/counted") }
    }
}

impl Declared {
    /// Refuses `vec_side` along a face: which side is the outer one is open there.
    fn check_side(&self, surface: &MeshSurface, cx: &mut dyn SealCx) -> Result<()> {
        let Side::Along(v) = self.side else { return Ok(()) };
        let steep = |[a, b, c]: &Triangle| {
            let normal = cross(sub(*b, *a), sub(*c, *a));
            dot(v, normal).abs() > 1e-3 * length(v) * length(normal)
        };
        let Some(k) = surface.triangles(cx.world()).iter().position(|t| !steep(t)) else { return Ok(()) };
        let text = format!("`vec_side` lies in triangle {} of surface `{}`", k + 1, self.surface);
        let d = Diagnostic::error(Code::BAD_VALUE, cx.span(), text);
        Err(d.help("give it a part across the surface, or write `point_at_outlet` with `count once`").into())
    }
}

impl Fix for Declared {
    fn facts(&self, _: &World) -> Facts {
        Facts { file: self.target.as_ref().map(|target| target.path().clone()), ..Facts::default() }
    }

    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        let keys = self.keys();
        w.memo.insert(keys.sums, vec![0.0; SUMS]);
        w.memo.insert(keys.near, vec![]);
        w.memo.insert(keys.counted, vec![]);
        let slot = w.slots.id(&format!("f_{}", self.id));
        w.slots.get_mut(slot).vector = vec![0.0; 6];
        match &self.target {
            Some(target) if !w.promised.instead => target.begin(),
            _ => Ok(()),
        }
    }

    fn remove(&self, w: &mut World) {
        let keys = self.keys();
        forget(w, keys.sums);
        w.memo.remove(keys.sums);
    }

    fn shape(&self) -> Shape {
        Shape { vector: 6, vector_extensive: true, ..Shape::default() }
    }

    fn ops(&self, cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        let Some(surface) =
            cx.world().facts.get(*SURFACES).and_then(|all| all.look_up(&self.surface)).cloned()
        else {
            let text = format!("surface `{}` is gone", self.surface);
            let d = Diagnostic::error(Code::UNKNOWN_NAME, cx.span(), text);
            return Err(d.help("declare it again before the run, or remove this fix with `unfix`").into());
        };
        self.check_side(&surface, cx)?;
        let keys = self.keys();
        let names = [keys.sums, keys.near, keys.counted, surface.keys.pose].map(Key::text);
        let slot = cx.slot(&format!("f_{}", self.id));
        let needs = Needs::new().read(X | V | MASS | MASK | TAG).write(MEMO | SLOTS).only(&names);
        let needs = if self.target.is_some() { needs.read(RADIUS) } else { needs };
        let access = if self.deletes { Needs::new().read(X | V).write(Fields::ALL) } else { needs };
        let mut running = Running::new(self.clone(), surface, slot);
        let name = format!("fix {} massflow/mesh", self.id);
        let op = StepOp::new(name, Stage::Exchange, access, move |w, t| running.run(w, t));
        let op = op.in_setup(true);
        Ok(vec![if self.deletes { op.requesting_rows().boxed() } else { op.boxed() }])
    }
}
