//! Surfaces of regions as walls: where a sphere is near one, how the surface is curved there and how it moves.

use super::motion::turned;
use super::{Region, Shape};
use perigrain_base::math::vec3::{Vec3, add, cross, length, scale, sub};

/// A place of a wall near a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// Which part of the wall: history goes with it.
    pub part: u32,
    /// Unit vector from the wall's nearest point to the sphere's centre.
    pub normal: Vec3,
    /// How far the centre is from that point [length].
    pub distance: f64,
    /// The wall's radius of curvature there: negative where it is hollow, 0 where it is flat [length].
    pub radius: f64,
    /// Velocity of the wall there [length/time].
    pub velocity: Vec3,
}

/// Which sides of a surface count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// As seen from inside.
    Inner,
    /// As seen from outside.
    Outer,
    /// Both: a shell.
    Both,
}

/// How a region is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Look<'a> {
    /// The region as it was a while ago, and how long ago that is; without it the surface rests.
    pub before: Option<(&'a Region, f64)>,
    /// LAMMPS' curvature of cones and open cylinders, its unions seen from outside, its velocities of changing shapes.
    pub lammps: bool,
}

/// What a search knows on its way through a region's parts.
struct Search<'s> {
    x: Vec3,
    reach: f64,
    dt: f64,
    lammps: bool,
    /// All surfaces near enough: sides and what other parts hide do not count.
    unfiltered: bool,
    out: &'s mut Vec<Near>,
}

impl Region {
    /// Finds the places of the region's surface nearer than `reach` to `x`: one for each of its parts that faces the
    /// region's side, in the order of the parts.
    pub fn near(&self, x: Vec3, reach: f64, look: &Look, out: &mut Vec<Near>) {
        let (before, dt) = look.before.map_or((None, 1.0), |(r, dt)| (Some(r), dt));
        let mut search = Search { x, reach, dt, lammps: look.lammps, unfiltered: false, out };
        self.search(&mut search, false, 0, before);
    }

    /// Whether some surface of the region, seen from whatever side, is nearer than `reach` to `x`.
    pub fn close(&self, x: Vec3, reach: f64, spare: &mut Vec<Near>) -> bool {
        spare.clear();
        let mut search = Search { x, reach, dt: 1.0, lammps: false, unfiltered: true, out: spare };
        self.search(&mut search, false, 0, None);
        !spare.is_empty()
    }

    /// Whether a contact with part `from` of the surface may continue as one with part `to`: neighbours on a mesh.
    pub fn passes(&self, from: u32, to: u32) -> bool {
        matches!(&self.shape, Shape::Mesh(solid) if solid.passes(from, to))
    }

    /// How many parts its surface has.
    fn parts(&self) -> u32 {
        match &self.shape {
            Shape::Block { .. } | Shape::Prism { .. } => 7,
            Shape::Cylinder { .. } | Shape::Cone { .. } => 4,
            Shape::Sphere { .. } | Shape::Ellipsoid { .. } | Shape::Plane { .. } => 1,
            Shape::Mesh(solid) => solid.triangles().len() as u32,
            Shape::Union(parts) | Shape::Intersect(parts) => parts.iter().map(Region::parts).sum(),
        }
    }

    fn search(&self, s: &mut Search, flip: bool, base: u32, before: Option<&Region>) {
        let outside = self.outside != flip;
        match &self.shape {
            Shape::Union(parts) => {
                // LAMMPS turns this test round for unions seen from outside, and nothing is left of their surface.
                let hidden = !(s.lammps && outside);
                combined(parts, s, outside, base, before, hidden);
            }
            Shape::Intersect(parts) => combined(parts, s, outside, base, before, false),
            // Which place it is does not matter.
            Shape::Mesh(solid) if s.unfiltered => {
                let at = self.motion.as_ref().map_or(s.x, |m| m.undo(s.x));
                if solid.close(at, s.reach) {
                    s.out.push(Near {
                        part: base,
                        normal: [0.0; 3],
                        distance: 0.0,
                        radius: 0.0,
                        velocity: [0.0; 3],
                    });
                }
            }
            shape => {
                let side = match (self.open != 0 || s.unfiltered, outside) {
                    (true, _) => Side::Both,
                    (false, true) => Side::Outer,
                    (false, false) => Side::Inner,
                };
                let from = s.out.len();
                let at = self.motion.as_ref().map_or(s.x, |m| m.undo(s.x));
                shape.faces(at, s.reach, side, self.open, s.lammps, s.out);
                for k in from..s.out.len() {
                    let mut near = s.out[k];
                    if let Some(b) = before {
                        near.velocity = self.shape_rate(b, at, &near, s);
                    }
                    if let Some(turn) = self.motion.as_ref().and_then(|m| m.turn.as_ref()) {
                        near.normal = turned(near.normal, [0.0; 3], turn.axis, turn.angle);
                        near.velocity = turned(near.velocity, [0.0; 3], turn.axis, turn.angle);
                    }
                    near.part += base;
                    if let Some(b) = before {
                        near.velocity = add(near.velocity, self.carried(b, s, &near));
                    }
                    s.out[k] = near;
                }
            }
        }
    }

    /// Velocity of the surface by the region's motion since `before`.
    fn carried(&self, before: &Region, s: &Search, near: &Near) -> Vec3 {
        let (Some(now), Some(was)) = (&self.motion, &before.motion) else { return [0.0; 3] };
        let mut velocity = scale(1.0 / s.dt, sub(now.now, was.now));
        if let (Some(turn), Some(old)) = (&now.turn, &was.turn) {
            // LAMMPS takes the axis of the deck for one of length 1 here, and here alone.
            let length = if s.lammps { turn.given } else { 1.0 };
            let spin = scale((turn.angle.value() - old.angle.value()) / s.dt * length, turn.axis);
            let place = sub(s.x, scale(near.distance, near.normal));
            velocity = add(velocity, cross(spin, sub(place, add(turn.point, now.now))));
        }
        velocity
    }

    /// Velocity of the surface by the change of the shape since `before`, along the normal; all as seen from the region.
    fn shape_rate(&self, before: &Region, at: Vec3, near: &Near, s: &Search) -> Vec3 {
        let lammps_knows = matches!(self.shape, Shape::Cylinder { .. } | Shape::Sphere { .. });
        if self.shape == before.shape || (s.lammps && !lammps_knows) {
            return [0.0; 3];
        }
        let mut then = vec![];
        // As far as twice what is near: the shape changes little in a step.
        before.shape.faces(at, 2.0 * s.reach, Side::Both, before.open, s.lammps, &mut then);
        match then.iter().find(|n| n.part == near.part) {
            Some(n) => scale((n.distance - near.distance) / s.dt, near.normal),
            None => [0.0; 3],
        }
    }

    /// An upper bound of how far any point of the surface within the corners of a box has moved since `before`;
    /// infinite where the shape has changed.
    pub fn travel(&self, before: &Region, corners: &[Vec3]) -> f64 {
        if let (Shape::Union(a) | Shape::Intersect(a), Shape::Union(b) | Shape::Intersect(b)) =
            (&self.shape, &before.shape)
        {
            return a.iter().zip(b).map(|(a, b)| a.travel(b, corners)).fold(0.0, f64::max);
        }
        if self.shape != before.shape {
            return f64::INFINITY;
        }
        let (Some(now), Some(was)) = (&self.motion, &before.motion) else { return 0.0 };
        let mut far = length(sub(now.now, was.now));
        if let (Some(turn), Some(old)) = (&now.turn, &was.turn) {
            let arm = |c: &Vec3| length(sub(*c, add(turn.point, now.now)));
            far +=
                (turn.angle.value() - old.angle.value()).abs() * corners.iter().map(arm).fold(0.0, f64::max);
        }
        far
    }

    /// Everything that variables change, as numbers.
    pub fn pose(&self, out: &mut Vec<f64>) {
        out.extend(self.given.iter().map(|g| self.shape.get(g.number)));
        if let Some(m) = &self.motion {
            out.extend(m.now);
            out.extend(m.turn.as_ref().map(|t| t.angle.value()));
        }
        if let Shape::Union(parts) | Shape::Intersect(parts) = &self.shape {
            parts.iter().for_each(|p| p.pose(out));
        }
    }

    /// The region in a pose; what the numbers do not reach stays.
    pub fn set_pose(&mut self, numbers: &mut impl Iterator<Item = f64>) {
        for given in &self.given {
            numbers.by_ref().take(1).for_each(|a| self.shape.set(given.number, a));
        }
        if let Some(m) = &mut self.motion {
            m.now.iter_mut().zip(numbers.by_ref().take(3)).for_each(|(now, a)| *now = a);
            if let Some(turn) = &mut m.turn {
                numbers.by_ref().take(1).for_each(|a| turn.angle = a.into());
            }
        }
        if let Shape::Union(parts) | Shape::Intersect(parts) = &mut self.shape {
            parts.iter_mut().for_each(|p| p.set_pose(numbers));
        }
    }
}

/// The places of several regions, but those that another one hides: where being inside it is `hidden`.
fn combined(parts: &[Region], s: &mut Search, flip: bool, base: u32, before: Option<&Region>, hidden: bool) {
    let then = match before.map(|b| &b.shape) {
        // LAMMPS takes moving parts for resting ones.
        Some(Shape::Union(then) | Shape::Intersect(then)) if !s.lammps => then.as_slice(),
        _ => &[],
    };
    let mut base = base;
    for (k, part) in parts.iter().enumerate() {
        let from = s.out.len();
        part.search(s, flip, base, then.get(k));
        base += part.parts();
        if s.unfiltered {
            continue;
        }
        let mut at = from;
        while let Some(near) = s.out.get(at) {
            let place = sub(s.x, scale(near.distance, near.normal));
            let hides =
                |(j, other): (usize, &Region)| j != k && other.open == 0 && other.contains(place) == hidden;
            if parts.iter().enumerate().any(hides) {
                s.out.remove(at);
            } else {
                at += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests;
