//! Regions that are shifted and turned by variables.

use super::ReadVariable;
use perigrain_base::diag::{Result, Span};
use perigrain_base::math::vec3::{cross, dot, scale, sub};

/// An equal-style variable and the place in the deck that names it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Variable {
    /// Its name, without `v_`.
    pub name: String,
    /// Where.
    #[serde(skip)]
    pub span: Span,
}

/// An angle [radians] with its sine and its cosine; restart files hold the number.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(from = "f64", into = "f64")]
pub struct Angle {
    value: f64,
    sin: f64,
    cos: f64,
}

impl Angle {
    /// The number.
    pub fn value(self) -> f64 {
        self.value
    }

    /// The same angle the other way round.
    #[must_use]
    pub fn back(self) -> Self {
        Self { value: -self.value, sin: -self.sin, cos: self.cos }
    }
}

impl From<f64> for Angle {
    fn from(value: f64) -> Self {
        Self { value, sin: value.sin(), cos: value.cos() }
    }
}

impl From<Angle> for f64 {
    fn from(angle: Angle) -> f64 {
        angle.value
    }
}

/// A rotation by a variable's angle.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Turn {
    /// Gives the angle [radians].
    pub variable: Variable,
    /// A point on the axis.
    pub point: [f64; 3],
    /// The axis' direction, of length 1.
    pub axis: [f64; 3],
    /// The length of the axis as the deck has it, by which LAMMPS' walls are too fast.
    pub given: f64,
    /// The present angle.
    pub angle: Angle,
}

/// How a region moves: first turned, then shifted.
#[derive(Clone, Debug, PartialEq, Default, serde::Serialize, serde::Deserialize)]
pub struct Motion {
    /// Variables of the displacement along x, y, z.
    pub shift: [Option<Variable>; 3],
    /// The rotation.
    pub turn: Option<Turn>,
    /// The present displacement.
    pub now: [f64; 3],
}

impl Motion {
    /// Its variables.
    pub fn variables(&self) -> impl Iterator<Item = &Variable> {
        self.shift.iter().flatten().chain(self.turn.iter().map(|t| &t.variable))
    }

    /// Evaluates displacement and angle.
    pub(super) fn place(&mut self, read: &mut ReadVariable) -> Result<()> {
        for (now, variable) in self.now.iter_mut().zip(&self.shift) {
            if let Some(variable) = variable
                && let Some(value) = read(variable)?
            {
                *now = value;
            }
        }
        if let Some(turn) = &mut self.turn
            && let Some(angle) = read(&turn.variable)?
        {
            turn.angle = angle.into();
        }
        Ok(())
    }

    /// Where a point would be had the region not moved, as seen from the region.
    #[inline]
    pub(super) fn undo(&self, x: [f64; 3]) -> [f64; 3] {
        let x = sub(x, self.now);
        match &self.turn {
            Some(t) => turned(x, t.point, t.axis, t.angle.back()),
            None => x,
        }
    }
}

/// A place turned about an axis of unit length through a point (Rodrigues), summed in LAMMPS' order: random streams that
/// belong to places see every bit.
pub fn turned(x: [f64; 3], point: [f64; 3], axis: [f64; 3], angle: Angle) -> [f64; 3] {
    let arm = sub(x, point);
    let along = scale(dot(arm, axis), axis);
    let across = sub(arm, along);
    let ahead = cross(axis, across);
    [0, 1, 2].map(|d| point[d] + along[d] + (across[d] * angle.cos + ahead[d] * angle.sin))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::{Region, Shape};

    // Walls used the sine of the opposite angle before it was kept.
    #[test]
    fn sines_are_odd_and_cosines_even_to_the_bit() {
        for k in -2000..2000 {
            let a = f64::from(k) * 0.7310585786300049;
            assert_eq!(Angle::from(a).back(), Angle::from(-a));
        }
    }

    #[test]
    fn first_turned_then_shifted() {
        let variable = Variable { name: "a".into(), span: Span::default() };
        let turn = Turn {
            variable: variable.clone(),
            point: [1.0, 0.0, 0.0],
            axis: [0.0, 0.0, 1.0],
            given: 1.0,
            angle: std::f64::consts::FRAC_PI_2.into(),
        };
        let motion = Motion { shift: [None, None, None], turn: Some(turn), now: [0.0, 0.0, 5.0] };
        let ball = Shape::Sphere { center: [3.0, 0.0, 0.0], radius: 0.1 };
        let mut region = Region { motion: Some(motion), ..Region::inside(ball) };
        // (3, 0, 0) is 2 from the axis along x: a quarter turn brings it to (1, 2, 0), the shift to (1, 2, 5).
        assert!(region.contains([1.0, 2.0, 5.0]) && !region.contains([3.0, 0.0, 5.0]));
        assert!(region.follows() && region.bounds().is_none());
        region.place(&mut |v| Ok((v.name == "a").then_some(0.0))).unwrap();
        assert!(region.contains([3.0, 0.0, 5.0]));
    }
}
