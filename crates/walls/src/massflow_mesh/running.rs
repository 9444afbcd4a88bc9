//! The count of fix massflow/mesh during a run.

use super::passing::{Passing, Target};
use super::{Declared, Keys, Side};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_mesh::Triangle;
use perigrain_plan::Tick;
use perigrain_styles::mesh_surface::{MeshSurface, SurfacePose};
use perigrain_world::field::Fields;
use perigrain_world::{SlotId, World};
use std::collections::{BTreeMap, BTreeSet};

/// How many numbers `Keys::sums` has.
pub const SUMS: usize = 9;

/// The count during a run.
pub struct Running {
    fix: Declared,
    keys: Keys,
    surface: MeshSurface,
    slot: SlotId,
    /// The corners of the box around the surface in its own frame.
    corners: Vec<Vec3>,
    passing: Option<Passing>,
}

impl Running {
    /// The count before its first step.
    pub fn new(fix: Declared, surface: MeshSurface, slot: SlotId) -> Self {
        let corners = surface.corners();
        let passing = fix.target.as_ref().map(Target::open);
        Self { keys: fix.keys(), fix, surface, slot, corners, passing }
    }

    /// Counts what has passed in this step.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if self.fix.deletes {
            w.whole(Fields::ALL);
        }
        let passed = if t.setup { vec![] } else { self.passed(w, t) };
        let mut sums =
            w.memo.get(self.keys.sums).filter(|m| m.len() == SUMS).cloned().unwrap_or(vec![0.0; SUMS]);
        let mut new = vec![];
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
                }
                new.push(i);
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
        if let Some(passing) = &mut self.passing {
            passing.add(w, &new)?;
        }
        if self.fix.deletes {
            delete(w, &new);
        }
        Ok(())
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
