//! Surfaces of triangles that fixes declare (`fix surface`): walls lean on them, movers move them, dumps write them.

mod motion;

pub use motion::{Course, Movement, Mover};

use perigrain_base::math::body::{Quat, UNTURNED, back, normalized, turned};
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_lang::Param;
use perigrain_mesh::{Facets, Triangle};
use perigrain_world::{Constant, Key, Named, Numbers, World};
use std::sync::Arc;

/// All declared surfaces, by the ID of their fix.
pub static SURFACES: Constant<Named<MeshSurface>> = Constant::new("mesh surfaces");

/// A surface of triangles as declared, with the movers that later lines have added.
#[derive(Clone, Debug)]
pub struct MeshSurface {
    /// The triangles where the line puts them.
    pub mesh: Arc<Facets>,
    /// Their numbers in the file, from 1.
    pub numbers: Arc<[u32]>,
    /// The type whose coefficients its contacts have.
    pub kind: u16,
    /// Its temperature.
    pub temperature: Option<Param>,
    /// Velocity that the surface has without moving, at the three corners of each triangle [length/time].
    pub slide: Option<Arc<[[Vec3; 3]]>>,
    /// The reference point of its torque, in its first position.
    pub about: Vec3,
    /// What moves it, in the order of the lines.
    pub movers: Vec<Mover>,
    /// Whether a servo moves it.
    pub steered: bool,
    /// Finnie's wear coefficients of each type of grains.
    pub wear: Option<Arc<[f64]>>,
    /// Where its state is.
    pub keys: SurfaceKeys,
}

/// Names of a surface's state in `memo`.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceKeys {
    /// Position and velocity ([`SurfacePose`]).
    pub pose: Numbers,
    /// Force and torque of grains on it at the last step.
    pub load: Numbers,
    /// Force on the triangles that grains touched at the last step: number from 0, three components.
    pub touched: Numbers,
    /// Wear of each triangle.
    pub wear: Numbers,
}

impl SurfaceKeys {
    /// Those of a fix.
    pub fn of(id: &str) -> Self {
        let key: Numbers = Key::new(&format!("surface/{id}"));
        let [pose, load, touched, wear] = ["/pose", "/load", "/touched", "/wear"].map(|tail| key.with(tail));
        Self { pose, load, touched, wear }
    }

    /// All names.
    pub fn names(&self) -> [&'static str; 4] {
        [self.pose, self.load, self.touched, self.wear].map(Key::text)
    }
}

impl MeshSurface {
    /// Its present position.
    pub fn pose(&self, w: &World) -> SurfacePose {
        SurfacePose::load(w, self.keys.pose)
    }

    /// Its triangles where they are now.
    pub fn triangles(&self, w: &World) -> Vec<Triangle> {
        let pose = self.pose(w);
        self.mesh.triangles().iter().map(|t| t.map(|p| pose.at(p))).collect()
    }

    /// The velocity that the surface has at a point of a triangle without moving, both in its own frame.
    pub fn sliding(&self, part: usize, x: Vec3) -> Vec3 {
        let (Some(slide), Some(triangle)) = (&self.slide, self.mesh.triangles().get(part)) else {
            return [0.0; 3];
        };
        let weights = barycentric(triangle, x);
        let corners = &slide[part];
        (0..3).fold([0.0; 3], |sum, k| add(sum, scale(weights[k], corners[k])))
    }

    /// The fastest speed with which its points move [length/time]; a speed along the surface moves none.
    pub fn speed(&self, w: &World) -> f64 {
        let pose = self.pose(w);
        let moving = self.corners().into_iter().map(|c| length(pose.velocity_at(pose.at(c))));
        moving.fold(0.0, f64::max)
    }

    /// The corners of the box around its triangles, in its own frame; none of a surface without triangles.
    pub fn corners(&self) -> Vec<Vec3> {
        let (mut lo, mut hi) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for p in self.mesh.triangles().as_flattened() {
            (0..3).for_each(|d| (lo[d], hi[d]) = (lo[d].min(p[d]), hi[d].max(p[d])));
        }
        match lo[0] <= hi[0] {
            true => {
                (0..8).map(|k| [0, 1, 2].map(|d| if k & (1 << d) == 0 { lo[d] } else { hi[d] })).collect()
            }
            false => vec![],
        }
    }
}

/// The weights of a triangle's corners at a point of its plane.
fn barycentric([a, b, c]: &Triangle, x: Vec3) -> Vec3 {
    let (p, q, r) = (sub(*b, *a), sub(*c, *a), sub(x, *a));
    let (pp, pq, qq, rp, rq) = (dot(p, p), dot(p, q), dot(q, q), dot(r, p), dot(r, q));
    let whole = pp * qq - pq * pq;
    let (v, w) = ((qq * rp - pq * rq) / whole, (pp * rq - pq * rp) / whole);
    [1.0 - v - w, v, w]
}

/// The part of a velocity in the plane of a triangle, with the length of the whole; nothing if it is normal to the plane.
pub fn in_plane(triangle: &Triangle, v: Vec3) -> Vec3 {
    let [a, b, c] = triangle;
    let n = cross(sub(*b, *a), sub(*c, *a));
    let n = scale(1.0 / length(n), n);
    let along = sub(v, scale(dot(v, n), n));
    let (whole, part) = (length(v), length(along));
    // A velocity along the normal has no direction in the plane but rounding.
    if part > 1e-12 * whole { scale(whole / part, along) } else { [0.0; 3] }
}

/// Where a surface is and how it moves: x = q x₀ q* + s, v = v₀ + ω × x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePose {
    /// The rotation q.
    pub turn: Quat,
    /// The shift s [length].
    pub shift: Vec3,
    /// The velocity v₀ of the point of the body at the origin [length/time].
    pub velocity: Vec3,
    /// The angular velocity ω [1/time].
    pub omega: Vec3,
}

impl Default for SurfacePose {
    fn default() -> Self {
        Self { turn: UNTURNED, shift: [0.0; 3], velocity: [0.0; 3], omega: [0.0; 3] }
    }
}

impl SurfacePose {
    /// The stored one, or that of a surface at rest in its first position.
    pub fn load(w: &World, key: Numbers) -> Self {
        let Some(&[q0, q1, q2, q3, x, y, z, u, v, t, a, b, c]) = w.memo.get(key).map(Vec::as_slice) else {
            return Self::default();
        };
        Self { turn: [q0, q1, q2, q3], shift: [x, y, z], velocity: [u, v, t], omega: [a, b, c] }
    }

    /// Stores it.
    pub fn store(&self, w: &mut World, key: Numbers) {
        let vectors = [self.shift, self.velocity, self.omega];
        w.memo.put(key, self.turn.iter().chain(vectors.as_flattened()).copied());
    }

    /// Whether it is where its line puts it.
    pub fn is_first(&self) -> bool {
        (self.turn, self.shift) == (UNTURNED, [0.0; 3])
    }

    /// Whether it moves.
    pub fn moves(&self) -> bool {
        (self.velocity, self.omega) != ([0.0; 3], [0.0; 3])
    }

    /// Where a point is.
    #[inline]
    pub fn at(&self, x: Vec3) -> Vec3 {
        add(turned(self.turn, x), self.shift)
    }

    /// A place in the surface's own frame.
    #[inline]
    pub fn undo(&self, x: Vec3) -> Vec3 {
        turned(back(self.turn), sub(x, self.shift))
    }

    /// A direction of the surface's own frame in space.
    #[inline]
    pub fn direction(&self, v: Vec3) -> Vec3 {
        turned(self.turn, v)
    }

    /// The velocity of its point at a place.
    #[inline]
    pub fn velocity_at(&self, x: Vec3) -> Vec3 {
        add(self.velocity, cross(self.omega, x))
    }

    /// Shifts it.
    pub fn shift_by(&mut self, way: Vec3) {
        self.shift = add(self.shift, way);
    }

    /// Turns it about an axis of unit length through a point.
    pub fn turn_about(&mut self, point: Vec3, axis: Vec3, angle: f64) {
        let by = perigrain_base::math::body::turn(axis, angle);
        self.turn = normalized(perigrain_base::math::body::after(by, self.turn));
        self.shift = add(point, turned(by, sub(self.shift, point)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // The triangle (0,0,0) (0.06,0,0) (0,0.06,0) and a velocity of (3, 0, 4): 5 along x.
    #[test]
    fn sliding_keeps_its_speed_in_the_plane_of_a_face() {
        let flat = [[0.0; 3], [0.06, 0.0, 0.0], [0.0, 0.06, 0.0]];
        assert_eq!(in_plane(&flat, [3.0, 0.0, 4.0]), [5.0, 0.0, 0.0]);
        assert_eq!(in_plane(&flat, [0.0, 0.0, 4.0]), [0.0; 3]);
        let [a, b, c] = barycentric(&flat, [0.03, 0.015, 0.0]);
        assert!((a - 0.25).abs() < 1e-15 && (b - 0.5).abs() < 1e-15 && (c - 0.25).abs() < 1e-15);
    }

    #[test]
    fn a_quarter_turn_there_and_back() {
        let mut pose = SurfacePose::default();
        pose.turn_about([1.0, 0.0, 0.0], [0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2);
        pose.shift_by([0.0, 0.0, 2.0]);
        let x = pose.at([3.0, 0.0, 5.0]);
        assert!(length(sub(x, [1.0, 2.0, 7.0])) < 1e-15, "{x:?}");
        assert!(length(sub(pose.undo(x), [3.0, 0.0, 5.0])) < 1e-14);
    }
}
