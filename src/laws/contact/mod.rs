//! Contact of spheres: what two touching grains (or a grain and a wall) do to each other.
//!
//! A law is a pure function of local data: [`Geometry`] of the contact, the [`Motion`] of both sides and
//! the contact's history give a [`Wrench`]. Pair and wall drivers call the same laws.

pub mod bodies;
pub mod damping;
pub mod driver;
pub mod law;
pub mod normal;
pub mod tangential;

pub use damping::Damping;
pub use law::{Granular, Model, Unmixable};
pub use normal::Normal;
pub use tangential::Tangential;

use crate::math::vec3::{Vec3, sub};

/// Where and how two spheres i and j touch; a wall is a j of radius 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Unit vector from j to i.
    pub normal: Vec3,
    /// Depth R_i + R_j − |x_i − x_j| > 0 [length].
    pub overlap: f64,
    /// Radii of i and j [length].
    pub radii: [f64; 2],
    /// Effective radius R̄, by default R_i R_j / (R_i + R_j) [length].
    pub curvature: f64,
    /// Effective mass m̄ = m_i m_j / (m_i + m_j) [mass].
    pub mass: f64,
}

impl Geometry {
    /// The contact of two spheres with centres `d` = x_i − x_j apart; `None` when they do not touch.
    #[inline]
    pub fn of_spheres(d: Vec3, radii: [f64; 2], masses: [f64; 2]) -> Option<Self> {
        let [ri, rj] = radii;
        let sum = ri + rj;
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if square >= sum * sum {
            return None;
        }
        let distance = square.sqrt();
        Some(Self {
            normal: [d[0] / distance, d[1] / distance, d[2] / distance],
            overlap: sum - distance,
            radii,
            curvature: ri * rj / sum,
            mass: masses[0] * masses[1] / (masses[0] + masses[1]),
        })
    }

    /// The same contact with another effective radius, for instance that of a sphere on a flat body.
    #[must_use]
    pub fn with_curvature(self, curvature: f64) -> Self {
        Self { curvature, ..self }
    }
}

/// How one side of a contact moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Velocity of the centre [length/time].
    pub velocity: Vec3,
    /// Angular velocity [1/time]; zero for peridynamic particles and walls.
    pub spin: Vec3,
}

/// The part of a step that contact history sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advance {
    /// Step size [time].
    pub dt: f64,
    /// Whether history moves on: no in the setup of a run, where forces are only evaluated.
    pub history: bool,
}

/// What a contact does: `force` on i (its opposite on j) and the torques on both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force on i [force].
    pub force: Vec3,
    /// Torque on i about its centre.
    pub torque_i: Vec3,
    /// Torque on j about its centre.
    pub torque_j: Vec3,
}

impl Wrench {
    /// The same contact shared among several: every part times `s`.
    #[must_use]
    pub fn scaled(self, s: f64) -> Self {
        use crate::math::vec3::scale;
        Self {
            force: scale(s, self.force),
            torque_i: scale(s, self.torque_i),
            torque_j: scale(s, self.torque_j),
        }
    }
}

/// A law of contact between spheres.
pub trait ContactLaw: Copy + Sync {
    /// What a contact remembers while it lasts; its default is a contact that has just begun.
    type History: Copy + Default + Send;

    /// Force and torques of one contact; `history` moves on with it.
    fn contact(
        &self,
        g: &Geometry,
        i: &Motion,
        j: &Motion,
        history: &mut Self::History,
        step: Advance,
    ) -> Wrench;
}

/// Relative velocity of i against j, split along and across the normal.
#[inline]
fn split_velocity(g: &Geometry, i: &Motion, j: &Motion) -> (f64, Vec3) {
    use crate::math::vec3::{dot, scale};
    let relative = sub(i.velocity, j.velocity);
    let along = dot(relative, g.normal);
    (along, sub(relative, scale(along, g.normal)))
}

#[cfg(test)]
mod tests;
