//! Prescribed paths of particles for fix move: linear, oscillating, rotating, or given by variables.

use perigrain_base::math::body::{Quat, turn};
use perigrain_base::math::vec3::{Vec3, add, cross, dot, scale, sub};
use perigrain_lang::{Param, ValueRef};
use perigrain_styles::Reading;
use perigrain_world::World;

/// The path; components without a value are integrated.
#[derive(Clone, Debug)]
pub enum Path {
    /// Velocity.
    Linear([Option<f64>; 3]),
    /// Amplitude and angular frequency 2π/period.
    Wiggle([Option<f64>; 3], f64),
    /// Rotation about an axis, in addition to a velocity.
    Turn {
        /// A point of the axis.
        point: Vec3,
        /// Direction of the axis, of length 1.
        axis: Vec3,
        /// Angular velocity.
        omega: f64,
        /// Velocity of the axis.
        velocity: Vec3,
    },
    /// Displacements and velocities.
    Variables(Box<[[Option<ValueRef>; 3]; 2]>),
}

/// Where a variable path finds its values during a step: displacements, velocities.
pub type Readings = [[Option<Reading>; 3]; 2];

/// Prescribed motion of one particle at one time: positions and velocities by component.
#[derive(Clone, Copy, Debug, Default)]
pub struct Given {
    /// Unwrapped positions.
    pub x: [Option<f64>; 3],
    /// Velocities.
    pub v: [Option<f64>; 3],
}

impl Path {
    /// Which components are prescribed.
    pub fn given(&self) -> [bool; 3] {
        match self {
            Path::Linear(a) | Path::Wiggle(a, _) => a.map(|a| a.is_some()),
            Path::Turn { .. } => [true; 3],
            Path::Variables(both) => std::array::from_fn(|d| both[0][d].is_some() || both[1][d].is_some()),
        }
    }

    /// The parameters to plan, as in [`Readings`].
    pub fn params(&self) -> [[Option<Param>; 3]; 2] {
        match self {
            Path::Variables(both) => both.clone().map(|list| list.map(|r| r.map(Param::Ref))),
            _ => Default::default(),
        }
    }

    /// The prescribed motion at time `t` of the particle `i` that started at `start`.
    pub fn at(&self, w: &World, i: usize, start: Vec3, t: f64, readings: &Readings) -> Given {
        match self {
            Path::Linear(v) => Given { x: std::array::from_fn(|d| v[d].map(|v| start[d] + v * t)), v: *v },
            Path::Wiggle(a, omega) => {
                let (sin, cos) = (omega * t).sin_cos();
                Given {
                    x: std::array::from_fn(|d| a[d].map(|a| start[d] + a * sin)),
                    v: a.map(|a| a.map(|a| a * omega * cos)),
                }
            }
            Path::Turn { axis, omega, velocity, .. } => {
                let (place, arm) = self.turned(start, t);
                let v = add(scale(*omega, cross(*axis, arm)), *velocity);
                Given { x: add(place, scale(t, *velocity)).map(Some), v: v.map(Some) }
            }
            Path::Variables(..) => {
                let [way, speed] = readings;
                Given {
                    x: std::array::from_fn(|d| way[d].map(|r| start[d] + r.atom(w, i))),
                    v: speed.map(|r| r.map(|r| r.atom(w, i))),
                }
            }
        }
    }

    /// The initial position of a particle that is at `x` at time `t`; for variables, which have no past, `x`
    /// itself.
    pub fn start(&self, x: Vec3, t: f64) -> Vec3 {
        match self {
            Path::Linear(v) => std::array::from_fn(|d| x[d] - v[d].unwrap_or(0.0) * t),
            Path::Wiggle(a, omega) => {
                let sin = (omega * t).sin();
                std::array::from_fn(|d| x[d] - a[d].unwrap_or(0.0) * sin)
            }
            Path::Turn { velocity, .. } => self.turned(sub(x, scale(t, *velocity)), -t).0,
            Path::Variables(..) => x,
        }
    }

    /// A position rotated about the axis for a time, and its distance vector from the axis.
    fn turned(&self, start: Vec3, t: f64) -> (Vec3, Vec3) {
        let Path::Turn { point, axis, omega, .. } = self else { return (start, [0.0; 3]) };
        let (sin, cos) = (omega * t).sin_cos();
        let from_point = sub(start, *point);
        let along = scale(dot(from_point, *axis), *axis);
        let arm = sub(from_point, along);
        let side = cross(*axis, arm);
        let turned = add(scale(cos, arm), scale(sin, side));
        (add(add(*point, along), turned), turned)
    }

    /// The rotation of particles at time `t`, if the path rotates them.
    pub fn turn(&self, t: f64) -> Option<Quat> {
        match self {
            Path::Turn { axis, omega, .. } => Some(turn(*axis, omega * t)),
            _ => None,
        }
    }

    /// The angular velocity that the path imposes on spheres.
    pub fn spin(&self) -> Option<Vec3> {
        match self {
            Path::Turn { axis, omega, .. } => Some(scale(*omega, *axis)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // A quarter turn about the z axis through (1, 0, 0), by hand.
    #[test]
    fn a_quarter_turn_and_back() {
        let (w, none) = (World::default(), Readings::default());
        let turn = Path::Turn {
            point: [1.0, 0.0, 0.0],
            axis: [0.0, 0.0, 1.0],
            omega: std::f64::consts::FRAC_PI_2,
            velocity: [0.0, 0.0, 2.0],
        };
        let now = turn.at(&w, 0, [3.0, 0.0, 5.0], 1.0, &none);
        let near =
            |a: [Option<f64>; 3], b: Vec3| a.iter().zip(b).all(|(a, b)| (a.unwrap() - b).abs() < 1e-14);
        assert!(near(now.x, [1.0, 2.0, 7.0]), "{now:?}");
        assert!(near(now.v, [-std::f64::consts::PI, 0.0, 2.0]), "{now:?}");
        let back = turn.start(now.x.map(Option::unwrap), 1.0);
        assert!(near(back.map(Some), [3.0, 0.0, 5.0]), "{back:?}");
        assert_eq!(turn.spin(), Some([0.0, 0.0, std::f64::consts::FRAC_PI_2]));
    }
}
