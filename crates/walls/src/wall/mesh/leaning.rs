//! A wall of surfaces that other lines declare (`fix surface`).

use super::super::{Common, Form, Surface, op};
use perigrain_base::diag::{Code, Diagnostic, Result, Span};
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_contact::Wrench;
use perigrain_contact::walls::{FacetNear, Near, Touch, Wall};
use perigrain_plan::Tick;
use perigrain_styles::SealCx;
use perigrain_styles::mesh_surface::{MeshSurface, SURFACES, SurfacePose};
use perigrain_world::{Numbers, Outline, SlotId, World};
use std::collections::BTreeSet;

/// Surfaces by the IDs of their fixes.
#[derive(Clone)]
pub struct Leaning {
    /// The IDs and where they stand.
    pub ids: Vec<(String, Span)>,
}

impl Form for Leaning {
    const STYLE: &'static str = "wall/mesh";
    const SHOWS: bool = true;

    fn kinds(&self, w: &World) -> Vec<u16> {
        let all = w.facts.get(*SURFACES);
        let kinds = self.ids.iter().filter_map(|(id, _)| Some(all?.look_up(id)?.kind));
        kinds.collect::<BTreeSet<u16>>().into_iter().collect()
    }

    fn declare(&self, _w: &mut World, _key: Numbers) {}

    fn outline(&self) -> Outline {
        // Each surface has an outline of its own.
        Outline::new(|_| vec![])
    }

    fn surface(&self, fix: &Common, cx: &mut dyn SealCx) -> Result<Box<dyn Surface>> {
        let mut surfaces: Vec<One> = vec![];
        for (place, (id, span)) in self.ids.iter().enumerate() {
            let slot = cx.slot(&format!("f_{id}"));
            let known = cx.world().facts.get(*SURFACES).and_then(|all| all.look_up(id)).cloned();
            let Some(surface) = known else {
                let d = Diagnostic::error(Code::UNKNOWN_NAME, *span, format!("there is no surface `{id}`"));
                return Err(d
                    .help("declare it above this line with `fix ID all surface FILE type T`")
                    .into());
            };
            if let Some(kind) = fix.material.lent.as_ref().and_then(super::super::words::Lent::kind)
                && kind != surface.kind
            {
                let text = format!("surface `{id}` is of type {}, this wall of type {kind}", surface.kind);
                let d = Diagnostic::error(Code::CONFLICT, *span, text);
                return Err(d.help("`coeff NULL` has the law of each surface's own type").into());
            }
            let areas = surface.mesh.triangles().iter().map(perigrain_mesh::area).collect();
            let (pose, corners) = (surface.pose(cx.world()), surface.corners());
            let (is_first, moves) = (pose.is_first(), pose.moves());
            let place = place as u32;
            surfaces.push(One { surface, slot, place, first: 0, pose, is_first, moves, corners, areas });
        }
        // Those of one type stand together.
        surfaces.sort_by_key(|one| one.surface.kind);
        let mut first = 0;
        for one in &mut surfaces {
            one.first = first;
            first += one.count();
        }
        Ok(Box::new(All { surfaces }))
    }
}

/// One surface during a run.
struct One {
    surface: MeshSurface,
    slot: SlotId,
    /// Its number in the line, from 0.
    place: u32,
    /// The number of its first triangle among those of all surfaces.
    first: u32,
    pose: SurfacePose,
    /// Whether it is in its first position, and whether it moves.
    is_first: bool,
    moves: bool,
    corners: Vec<Vec3>,
    areas: Vec<f64>,
}

impl One {
    /// Its number of triangles.
    fn count(&self) -> u32 {
        self.areas.len() as u32
    }

    /// The contact points within reach among these triangles, which are numbered as those of all surfaces.
    fn near(&self, pieces: &[u32], x: Vec3, reach: f64, spare: &mut Vec<FacetNear>, out: &mut Vec<Near>) {
        // Turning a vector there and back takes longer than all the rest, and most surfaces stand where their lines put them.
        let pose = (!self.is_first).then_some(&self.pose);
        let own = pose.map_or(x, |pose| pose.undo(x));
        let members = (pieces, self.first);
        self.surface.mesh.near_among(
            members,
            own,
            reach,
            spare,
            |FacetNear { part, normal, distance, .. }| {
                let mut velocity = [0.0; 3];
                if self.surface.slide.is_some() {
                    velocity = self.surface.sliding(part as usize, sub(own, scale(distance, normal)));
                    velocity = pose.map_or(velocity, |pose| pose.direction(velocity));
                }
                let normal = pose.map_or(normal, |pose| pose.direction(normal));
                if self.moves {
                    velocity = add(self.pose.velocity_at(sub(x, scale(distance, normal))), velocity);
                }
                out.push(Near { part: self.first + part, normal, distance, radius: 0.0, velocity });
            },
        );
    }

    /// Adds what grains do to it.
    fn feel(&self, w: &mut World, contacts: &[(&Touch, &Wrench)], t: &Tick) {
        let own = self.first..self.first + self.count();
        let about = self.pose.at(self.surface.about);
        let keys = self.surface.keys;
        let mut contacts = contacts.iter().filter(|(touch, _)| own.contains(&touch.near.part)).peekable();
        if contacts.peek().is_none() {
            return;
        }
        let (mut force, mut torque) = ([0.0; 3], [0.0; 3]);
        let mut touched = w.memo.get_mut(keys.touched).map(std::mem::take).unwrap_or_default();
        let mut worn = vec![];
        for (touch, wrench) in contacts {
            let (i, part) = (touch.grain as usize, touch.near.part - self.first);
            let foot = sub(w.particles.x[i], scale(touch.near.distance, touch.near.normal));
            force = sub(force, wrench.force);
            torque = sub(torque, cross(sub(foot, about), wrench.force));
            touched.push(f64::from(part));
            touched.extend(wrench.force.map(|f| -f));
            if let (Some(coefficients), false) = (&self.surface.wear, t.setup) {
                let k = coefficients[usize::from(w.particles.kind[i]) - 1];
                let v = sub(w.particles.v[i], touch.near.velocity);
                worn.push((part as usize, k * finnie(v, touch.near.normal) * length(wrench.force) * t.dt));
            }
        }
        if let Some(wear) = w.memo.get_mut(keys.wear) {
            for (part, work) in worn {
                if let Some(own) = wear.get_mut(part) {
                    *own += work / self.areas[part];
                }
            }
        }
        w.memo.insert(keys.touched, touched);
        if let Some(load) = w.memo.get_mut(keys.load) {
            load.iter_mut().zip(force.iter().chain(&torque)).for_each(|(sum, more)| *sum += more);
            let shown = w.slots.get_mut(self.slot).vector.iter_mut();
            shown.zip(load).for_each(|(to, from)| *to = *from);
        }
    }
}

/// Finnie's wear by impact of a force [force], without coefficient and area: 2 f |v|, with the angle g between velocity
/// and face, f = sin 2g − 3 sin² g for tan g < 1/3, else cos² g/3; nothing while the grain leaves. Source: LIGGGHTS
/// manual, fix mesh/surface/stress; all digits measured with LIGGGHTS 3.8.0, where spins do not count.
fn finnie(v: Vec3, normal: Vec3) -> f64 {
    let along = dot(v, normal);
    let across = length(sub(v, scale(along, normal)));
    let speed = length(v);
    if along >= 0.0 || speed == 0.0 {
        return 0.0;
    }
    let (sin, cos) = (-along / speed, across / speed);
    let part = if sin < cos / 3.0 { 2.0 * sin * cos - 3.0 * sin * sin } else { cos * cos / 3.0 };
    2.0 * part * speed
}

/// All surfaces of a wall during a run.
struct All {
    surfaces: Vec<One>,
}

impl Surface for All {
    fn place(&mut self, w: &mut World, _t: &Tick) -> Result<f64> {
        let mut way = 0.0f64;
        for one in &mut self.surfaces {
            let pose = one.surface.pose(w);
            let before = std::mem::replace(&mut one.pose, pose);
            (one.is_first, one.moves) = (pose.is_first(), pose.moves());
            if pose == before {
                continue;
            }
            // Of a rigid displacement a corner of the box around the surface moves farthest.
            let ways = one.corners.iter().map(|c| length(sub(pose.at(*c), before.at(*c))));
            way = ways.fold(way, f64::max);
        }
        Ok(way)
    }

    fn stands(&self) -> bool {
        self.surfaces.iter().all(|one| one.surface.movers.is_empty() && !one.surface.steered)
    }

    fn show(&self, _w: &World, of: Option<u16>, see: &mut dyn FnMut(&dyn Wall)) {
        let all = &self.surfaces;
        see(&Placed(match of {
            None => all,
            Some(kind) => {
                let from = all.partition_point(|one| one.surface.kind < kind);
                &all[from..all.partition_point(|one| one.surface.kind <= kind)]
            }
        }));
    }

    fn follow(&mut self, w: &World) {
        self.surfaces.iter_mut().for_each(|one| one.pose = one.surface.pose(w));
    }

    fn piece(&self, part: u32) -> [u32; 2] {
        let one = &self.surfaces[Placed(&self.surfaces).of(part)];
        let number = one.surface.numbers.get((part - one.first) as usize).map_or(part, |number| number - 1);
        [one.place, number]
    }

    fn feel(&mut self, w: &mut World, contacts: &[(&Touch, &Wrench)], _: [f64; op::FELT], t: &Tick) {
        if w.is_narrow() {
            // Nothing reads sums over the particles of a single rank.
            return;
        }
        self.surfaces.iter().for_each(|one| one.feel(w, contacts, t));
    }

    fn shares(&self) -> bool {
        true
    }

    fn feels(&self) -> bool {
        self.surfaces.iter().any(|one| one.surface.steered || one.surface.wear.is_some())
    }
}

/// The surfaces at their present positions.
struct Placed<'a>(&'a [One]);

impl Placed<'_> {
    /// The surface that has a triangle.
    fn of(&self, part: u32) -> usize {
        self.0.partition_point(|one| one.first <= part) - 1
    }
}

impl Wall for Placed<'_> {
    fn close(&self, x: Vec3, reach: f64, _spare: &mut Vec<Near>) -> bool {
        self.0.iter().any(|one| one.surface.mesh.close(one.pose.undo(x), reach))
    }

    fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        let mut pieces = vec![];
        self.pieces(x, reach, &mut pieces);
        self.near_pieces(&pieces, x, reach, &mut vec![], out);
    }

    fn pieces(&self, x: Vec3, reach: f64, out: &mut Vec<u32>) -> bool {
        for one in self.0 {
            let from = out.len();
            one.surface.mesh.around(one.pose.undo(x), reach, out);
            out[from..].iter_mut().for_each(|part| *part += one.first);
        }
        true
    }

    fn near_pieces(
        &self,
        pieces: &[u32],
        x: Vec3,
        reach: f64,
        spare: &mut Vec<FacetNear>,
        out: &mut Vec<Near>,
    ) {
        let mut rest = pieces;
        for one in self.0 {
            let (own, others) = rest.split_at(rest.partition_point(|part| *part < one.first + one.count()));
            rest = others;
            if !own.is_empty() {
                one.near(own, x, reach, spare, out);
            }
        }
    }

    fn passes_some(&self) -> bool {
        true
    }

    fn passes(&self, from: u32, to: u32) -> bool {
        let (a, b) = (self.of(from), self.of(to));
        let one = &self.0[a];
        a == b && one.surface.mesh.passes(from - one.first, to - one.first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // LIGGGHTS 3.8.0, mesh_wear_1: 2 f |v| |F| dt/area = 4.9223972661e-07 with the force of its dump.
    #[test]
    fn wear_of_a_shallow_impact() {
        let force = length([-0.00734969344092, 0.0, 0.00990416728042]);
        let wear = finnie([0.03, 0.0, -0.002], [0.0, 0.0, 1.0]) * force * 1e-5 / 0.0018;
        assert!((wear / 4.9223972661e-07 - 1.0).abs() < 1e-10, "{wear}");
        assert_eq!(finnie([0.03, 0.0, 0.002], [0.0, 0.0, 1.0]), 0.0);
    }
}
