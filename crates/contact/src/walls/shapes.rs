//! Walls given by formulas: planes normal to an axis, infinite cylinders; and walls that are shifted.

use super::{Near, Wall};
use perigrain_base::math::vec3::{Vec3, add, scale, sub};

/// Planes normal to one axis, facing each other: part 0 the lower, part 1 the upper one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planes {
    /// The axis, 0 to 2.
    pub axis: usize,
    /// Position of the lower plane.
    pub lo: Option<f64>,
    /// Position of the upper plane.
    pub hi: Option<f64>,
    /// Velocity of each plane.
    pub velocity: [Vec3; 2],
    /// Of two planes only the nearer one acts, as in LAMMPS.
    pub nearer: bool,
}

impl Planes {
    /// Whether `x` is within `reach` of a plane [length].
    #[inline]
    fn reached(&self, x: Vec3, reach: f64) -> bool {
        // A missing plane is infinitely far away.
        let [lo, hi] = [self.lo, self.hi].map(|plane| plane.unwrap_or(f64::INFINITY));
        (x[self.axis] - lo).abs() < reach || (x[self.axis] - hi).abs() < reach
    }

    /// The contact points on the planes.
    fn met(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        let x = x[self.axis];
        let mut meet = |part: u32, height: f64, sign: f64| {
            let distance = height.abs();
            if distance < reach {
                let mut normal = [0.0; 3];
                // A particle beyond the plane is pushed further, as from its other side (LAMMPS).
                normal[self.axis] = if height < 0.0 { -sign } else { sign };
                out.push(Near {
                    part,
                    normal,
                    distance,
                    radius: 0.0,
                    velocity: self.velocity[part as usize],
                });
            }
        };
        match (self.lo.map(|lo| x - lo), self.hi.map(|hi| -(x - hi))) {
            (Some(above), Some(below)) if self.nearer => match above < below {
                true => meet(0, above, 1.0),
                false => meet(1, below, -1.0),
            },
            (above, below) => {
                if let Some(above) = above {
                    meet(0, above, 1.0);
                }
                if let Some(below) = below {
                    meet(1, below, -1.0);
                }
            }
        }
    }
}

impl Wall for Planes {
    fn planes(&self) -> Option<&Planes> {
        Some(self)
    }

    #[inline]
    fn close(&self, x: Vec3, reach: f64, _: &mut Vec<Near>) -> bool {
        self.reached(x, reach)
    }

    #[inline(always)]
    fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        if self.reached(x, reach) {
            self.met(x, reach, out);
        }
    }
}

/// An infinite cylinder about the z axis, which acts on both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube {
    /// Its radius.
    pub radius: f64,
    /// Its velocity as a whole.
    pub velocity: Vec3,
    /// Speed of its surface about the axis: positive for clockwise rotation seen from above.
    pub spin: f64,
    /// Cohesive spheres stick on the outside only, as in LAMMPS.
    pub lammps: bool,
}

impl Wall for Tube {
    fn close(&self, x: Vec3, reach: f64, _spare: &mut Vec<Near>) -> bool {
        (x[0].hypot(x[1]) - self.radius).abs() < reach
    }

    fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        let r = (x[0] * x[0] + x[1] * x[1]).sqrt();
        let depth = self.radius - r;
        let away = if r > 0.0 { [x[0] / r, x[1] / r, 0.0] } else { [1.0, 0.0, 0.0] };
        if depth.abs() < reach {
            out.push(Near {
                part: 0,
                normal: scale(if depth >= 0.0 { -1.0 } else { 1.0 }, away),
                distance: depth.abs(),
                radius: if depth > 0.0 { -2.0 * self.radius } else { 2.0 * self.radius },
                velocity: add(self.velocity, [self.spin * away[1], -self.spin * away[0], 0.0]),
            });
        }
    }

    fn holds(&self, near: &Near) -> bool {
        !self.lammps || near.radius > 0.0
    }
}

/// An infinite cylinder about an axis parallel to x, y or z, which acts on both sides and counts as flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// The axis, 0 to 2.
    pub axis: usize,
    /// Position of the axis, in the two directions that follow it in the order x y z x y.
    pub center: [f64; 2],
    /// Its radius.
    pub radius: f64,
    /// Its velocity as a whole.
    pub velocity: Vec3,
    /// Angular velocity about the axis, right-handed: the surface moves at the speed of the grain's centre.
    pub omega: f64,
}

impl Cylinder {
    /// The directions across the axis, and where a place lies in them.
    fn across(&self, x: Vec3) -> ([usize; 2], [f64; 2]) {
        let dims = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        (dims, [0, 1].map(|k| x[dims[k]] - self.center[k]))
    }
}

impl Wall for Cylinder {
    fn close(&self, x: Vec3, reach: f64, _spare: &mut Vec<Near>) -> bool {
        let [a, b] = self.across(x).1;
        (a.hypot(b) - self.radius).abs() < reach
    }

    fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        let ([u, v], [a, b]) = self.across(x);
        let r = (a * a + b * b).sqrt();
        let depth = self.radius - r;
        if depth.abs() >= reach {
            return;
        }
        let away = if r > 0.0 { [a / r, b / r] } else { [1.0, 0.0] };
        let side = if depth >= 0.0 { -1.0 } else { 1.0 };
        let (mut normal, mut velocity) = ([0.0; 3], self.velocity);
        (normal[u], normal[v]) = (side * away[0], side * away[1]);
        velocity[u] -= self.omega * b;
        velocity[v] += self.omega * a;
        out.push(Near { part: 0, normal, distance: depth.abs(), radius: 0.0, velocity });
    }
}

/// A wall shifted by a vector, which moves at a velocity besides its own.
pub struct Shifted<'a> {
    /// The wall in its first position.
    pub wall: &'a dyn Wall,
    /// The shift.
    pub shift: Vec3,
    /// The velocity.
    pub velocity: Vec3,
}

impl Wall for Shifted<'_> {
    fn close(&self, x: Vec3, reach: f64, spare: &mut Vec<Near>) -> bool {
        self.wall.close(sub(x, self.shift), reach, spare)
    }

    fn near(&self, x: Vec3, reach: f64, out: &mut Vec<Near>) {
        let from = out.len();
        self.wall.near(sub(x, self.shift), reach, out);
        out[from..].iter_mut().for_each(|near| near.velocity = add(near.velocity, self.velocity));
    }

    fn holds(&self, near: &Near) -> bool {
        self.wall.holds(near)
    }

    fn passes_some(&self) -> bool {
        self.wall.passes_some()
    }

    fn passes(&self, from: u32, to: u32) -> bool {
        self.wall.passes(from, to)
    }
}
