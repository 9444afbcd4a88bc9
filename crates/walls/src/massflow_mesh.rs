//! fix massflow/mesh: counts grains that pass through a surface, and their mass.

use crate::shared::forget;
use crate::surface::SurfaceId;
use crate::{Fix, FixStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_lang::Args;
use perigrain_mesh::Triangle;
use perigrain_plan::{Needs, Op, Stage, Tick};
use perigrain_styles::mesh_surface::{MeshSurface, SURFACES, SurfacePose};
use perigrain_styles::step_op::StepOp;
use perigrain_styles::words::{At, Syntax, Words, read};
use perigrain_styles::{BuildCx, Doc, SealCx, Shape, Style};
use perigrain_world::field::{Fields, MASK, MASS, MEMO, SLOTS, TAG, V, X};
use perigrain_world::{GroupId, Key, Numbers, SlotId, World};
use std::collections::{BTreeMap, BTreeSet};

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
                   output, deleted mass and number. The counts continue after a restart.",
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
        Ok(Box::new(Declared {
            id: cx.id.to_string(),
            group: cx.group,
            surface: mesh.text,
            side,
            once,
            deletes,
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

impl Fix for Declared {
    fn declare(&self, w: &mut World) -> Result<()> {
        self.remove(w);
        let keys = self.keys();
        w.memo.insert(keys.sums, vec![0.0; SUMS]);
        w.memo.insert(keys.near, vec![]);
        w.memo.insert(keys.counted, vec![]);
        let slot = w.slots.id(&format!("f_{}", self.id));
        w.slots.get_mut(slot).vector = vec![0.0; 6];
        Ok(())
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
        let keys = self.keys();
        let names = [keys.sums, keys.near, keys.counted, surface.keys.pose].map(Key::text);
        let slot = cx.slot(&format!("f_{}", self.id));
        let needs = Needs::new().read(X | V | MASS | MASK | TAG).write(MEMO | SLOTS).only(&names);
        let access = if self.deletes { Needs::new().read(X | V).write(Fields::ALL) } else { needs };
        let running = Running::new(self.clone(), surface, slot);
        let name = format!("fix {} massflow/mesh", self.id);
        let op = StepOp::new(name, Stage::Exchange, access, move |w, t| {
            running.run(w, t);
            Ok(())
        });
        let op = op.in_setup(true);
        Ok(vec![if self.deletes { op.requesting_rows().boxed() } else { op.boxed() }])
    }
}

/// How many numbers `Keys::sums` has.
const SUMS: usize = 9;

/// The count during a run.
struct Running {
    fix: Declared,
    keys: Keys,
    surface: MeshSurface,
    slot: SlotId,
    /// The corners of the box around the surface in its own frame.
    corners: Vec<Vec3>,
}

impl Running {
    fn new(fix: Declared, surface: MeshSurface, slot: SlotId) -> Self {
        let corners = surface.corners();
        Self { keys: fix.keys(), fix, surface, slot, corners }
    }

    fn run(&self, w: &mut World, t: &Tick) {
        if self.fix.deletes {
            w.whole(Fields::ALL);
        }
        let passed = if t.setup { vec![] } else { self.passed(w, t) };
        let mut sums =
            w.memo.get(self.keys.sums).filter(|m| m.len() == SUMS).cloned().unwrap_or(vec![0.0; SUMS]);
        let mut gone = vec![];
        if !passed.is_empty() {
            let mut counted: BTreeSet<u64> =
                w.memo.get(self.keys.counted).into_iter().flatten().map(|tag| *tag as u64).collect();
            for i in passed {
                let (tag, mass) = (u64::from(w.particles.tag[i]), w.particles.mass[i]);
                if self.fix.once && !counted.insert(tag) {
                    continue;
                }
                sums[0] += mass;
                sums[1] += 1.0;
                if self.fix.deletes {
                    sums[2] += mass;
                    sums[3] += 1.0;
                    gone.push(i);
                }
            }
            if self.fix.once {
                w.memo.insert(self.keys.counted, counted.into_iter().map(|tag| tag as f64).collect());
            }
        }
        let time = w.clock.time();
        if !t.quiet || t.setup {
            let since = time - sums[6];
            for k in 0..2 {
                let more = sums[k] - sums[4 + k];
                sums[7 + k] = if since > 0.0 { more / since } else { 0.0 };
                sums[4 + k] = sums[k];
            }
            sums[6] = time;
        }
        let out = w.slots.get_mut(self.slot);
        out.step = Some(t.step);
        out.vector = vec![sums[0], sums[1], sums[7], sums[8], sums[2], sums[3]];
        w.memo.insert(self.keys.sums, sums);
        delete(w, &gone);
    }

    /// The grains that have passed in this step, in the order of their IDs; remembers where those near the surface are.
    fn passed(&self, w: &mut World, t: &Tick) -> Vec<usize> {
        let pose = self.surface.pose(w);
        let before: BTreeMap<u64, Vec3> = w
            .memo
            .get(self.keys.near)
            .into_iter()
            .flat_map(|all| all.chunks_exact(4))
            .map(|row| (row[0] as u64, [row[1], row[2], row[3]]))
            .collect();
        let (p, bit) = (&w.particles, self.fix.group.bit());
        let (lo, hi, margin) = self.around(&pose, w.settings.neighbor.skin);
        // The thinnest side first: most grains are beyond it.
        let mut axes = [0, 1, 2];
        axes.sort_by(|a, b| (hi[*a] - lo[*a]).total_cmp(&(hi[*b] - lo[*b])));
        let near = |i: &usize| {
            let x = &p.x[*i];
            axes.iter().all(|d| x[*d] >= lo[*d] && x[*d] <= hi[*d]) && p.mask[*i] & bit != 0
        };
        let mut found: Vec<(u32, usize, Vec3)> =
            (0..p.len()).filter(near).map(|i| (p.tag[i], i, pose.undo(p.x[i]))).collect();
        found.sort_unstable_by_key(|one| one.0);
        let (mut passed, mut near) = (vec![], Vec::with_capacity(4 * found.len()));
        for (tag, i, now) in found {
            near.extend([f64::from(tag), now[0], now[1], now[2]]);
            let came = |v: Vec3| pose.undo(sub(p.x[i], scale(t.dt, v)));
            // A grain that the box or a line of the deck has put elsewhere has not come from where it was.
            let here = |from: &&Vec3| length(sub(now, **from)) <= margin;
            let from = before.get(&u64::from(tag)).filter(here).copied().unwrap_or_else(|| came(p.v[i]));
            if self.crosses(from, now, &pose) {
                passed.push(i);
            }
        }
        w.memo.insert(self.keys.near, near);
        passed
    }

    /// The box around the surface where it is, wider by twice a skin, and that margin: no grain moves so far in a step.
    fn around(&self, pose: &SurfacePose, skin: f64) -> (Vec3, Vec3, f64) {
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in self.corners.iter().map(|p| pose.at(*p)) {
            (0..3).for_each(|d| (lo[d], hi[d]) = (lo[d].min(p[d]), hi[d].max(p[d])));
        }
        let widest = (0..3).map(|d| hi[d] - lo[d]).fold(0.0, f64::max);
        let margin = 2.0 * skin.max(1e-3 * widest);
        (lo.map(|x| x - margin), hi.map(|x| x + margin), margin)
    }

    /// Whether a way in the frame of the surface passes a triangle towards its outer side.
    fn crosses(&self, from: Vec3, to: Vec3, pose: &SurfacePose) -> bool {
        let reach = length(sub(to, from));
        let mut near = vec![];
        self.surface.mesh.around(to, 1.001 * reach + f64::MIN_POSITIVE, &mut near);
        near.iter().any(|k| {
            let triangle = &self.surface.mesh.triangles()[*k as usize];
            let [a, b, c] = triangle;
            let normal = cross(sub(*b, *a), sub(*c, *a));
            let outer = match self.fix.side {
                Side::Along(v) => dot(v, pose.direction(normal)),
                Side::Towards(p) => dot(sub(p, pose.at(*a)), pose.direction(normal)),
                Side::AwayFrom(p) => -dot(sub(p, pose.at(*a)), pose.direction(normal)),
            };
            let normal = scale(outer.signum(), normal);
            let [before, after] = [from, to].map(|x| dot(sub(x, *a), normal));
            // A centre on the face itself has passed.
            before < 0.0 && after >= 0.0 && {
                let part = before / (before - after);
                inside(triangle, add(from, scale(part, sub(to, from))))
            }
        })
    }
}

/// Whether a point of a triangle's plane lies in it, its edges included.
fn inside([a, b, c]: &Triangle, x: Vec3) -> bool {
    let normal = cross(sub(*b, *a), sub(*c, *a));
    let least = -1e-12 * dot(normal, normal);
    [[a, b], [b, c], [c, a]].iter().all(|[p, q]| dot(cross(sub(**q, **p), sub(x, **p)), normal) >= least)
}

/// Deletes particles.
fn delete(w: &mut World, gone: &[usize]) {
    if gone.is_empty() {
        return;
    }
    let mut marked = gone.to_vec();
    marked.sort_unstable();
    // From the end, so that a particle moved into a gap is never one of them.
    let mut order: Vec<usize> = (0..w.n()).collect();
    for k in marked.into_iter().rev() {
        order.swap_remove(k);
    }
    w.gather(&order);
    w.rebuild.due = true;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_belong_to_both_triangles() {
        let [a, b, c, d] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let [lower, upper] = [[a, b, c], [a, c, d]];
        assert!(inside(&lower, [0.5, 0.5, 0.0]) && inside(&upper, [0.5, 0.5, 0.0]));
        assert!(inside(&lower, [0.7, 0.2, 0.0]) && !inside(&upper, [0.7, 0.2, 0.0]));
        assert!(!inside(&lower, [1.1, 0.2, 0.0]));
    }
}
