//! How a mover moves a surface: along a line or about an axis, by a function of time or at the rate of variables.

use perigrain_base::math::vec3::Vec3;
use perigrain_lang::ValueRef;
use perigrain_world::{Key, Numbers};

/// A function of the time since the mover's line that is zero at time zero.
#[derive(Clone, Debug, PartialEq)]
pub enum Course {
    /// r t.
    Steady(f64),
    /// A sin ω t: amplitude, angular frequency.
    Sine(f64, f64),
    /// Σ C (cos(ω t + φ) − cos φ): amplitude, phase, angular frequency.
    Modes(Vec<[f64; 3]>),
}

impl Course {
    /// Its value and rate at a time.
    pub fn at(&self, t: f64) -> [f64; 2] {
        match self {
            Self::Steady(rate) => [rate * t, *rate],
            Self::Sine(amplitude, omega) => {
                let (sin, cos) = (omega * t).sin_cos();
                [amplitude * sin, amplitude * omega * cos]
            }
            Self::Modes(modes) => modes.iter().fold([0.0; 2], |[way, rate], [c, phase, omega]| {
                let (sin, cos) = (omega * t + phase).sin_cos();
                [way + c * (cos - phase.cos()), rate - c * omega * sin]
            }),
        }
    }
}

/// The motion of a mover.
#[derive(Clone, Debug)]
pub enum Movement {
    /// Along a vector, which the course multiplies.
    Line(Vec3, Course),
    /// At a velocity that equal-style variables give.
    Velocity(Box<[ValueRef; 3]>),
    /// About an axis of unit length; the course is the angle [rad].
    Turn(Vec3, Course),
    /// About an axis of unit length at an angular velocity that an equal-style variable gives.
    Rate(Vec3, ValueRef),
}

/// What moves a surface.
#[derive(Clone, Debug)]
pub struct Mover {
    /// The ID of its fix.
    pub id: String,
    /// Its motion.
    pub movement: Movement,
    /// A point of its axis where the line puts it.
    pub point: Vec3,
    /// The time since its line.
    pub elapsed: Numbers,
    /// The point of its axis, which earlier movers carry.
    pub carried: Numbers,
    /// Values of its variables at the last step.
    pub rates: Numbers,
}

impl Mover {
    /// That of a fix.
    pub fn new(id: &str, movement: Movement, point: Vec3) -> Self {
        let elapsed: Numbers = Key::new(&format!("move/mesh/{id}"));
        let [carried, rates] = ["/point", "/rates"].map(|tail| elapsed.with(tail));
        Self { id: id.to_string(), movement, point, elapsed, carried, rates }
    }

    /// The names of its state.
    pub fn names(&self) -> [&'static str; 3] {
        [self.elapsed, self.carried, self.rates].map(Key::text)
    }

    /// The variables that it follows.
    pub fn variables(&self) -> &[ValueRef] {
        match &self.movement {
            Movement::Velocity(all) => &all[..],
            Movement::Rate(_, one) => std::slice::from_ref(one),
            _ => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    // LIGGGHTS manual, move/mesh viblin; both sums evaluated in Python to ten digits: -0.2040375978 - 0.0653848484.
    #[test]
    fn vibrations_begin_without_a_jump() {
        let modes = Course::Modes(vec![[0.4, 1.3, 2.0 * PI / 0.02], [0.1, 2.0, 2.0 * PI / 0.07]]);
        assert_eq!(modes.at(0.0)[0], 0.0);
        assert!((modes.at(0.01)[0] + 0.2694224462).abs() < 1e-9, "{:?}", modes.at(0.01));
        // 10 degrees, period 0.07, at 0.01: 7.818314825 degrees.
        let riggle = Course::Sine(10.0f64.to_radians(), 2.0 * PI / 0.07);
        assert!((riggle.at(0.01)[0].to_degrees() - 7.818314825).abs() < 1e-9);
        for course in [modes, riggle, Course::Steady(3.0)] {
            let (h, t) = (1e-6, 0.013);
            let rate = (course.at(t + h)[0] - course.at(t - h)[0]) / (2.0 * h);
            assert!((rate - course.at(t)[1]).abs() < 1e-6 * rate.abs().max(1.0), "{course:?}");
        }
    }
}
