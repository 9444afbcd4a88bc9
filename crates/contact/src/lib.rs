//! Contacts of spheres: forces between two touching grains, or between a grain and a wall.
//!
//! A law is a pure function of local data: [`Geometry`] of the contact, the [`Motion`] of both sides and
//! the contact's history give a [`Wrench`]. Pair and wall drivers call the same laws.

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

pub mod bodies;
pub mod cohesion;
pub mod damping;
pub mod driver;
pub mod fast;
pub mod heat;
pub mod law;
pub mod mdr;
pub mod model;
pub mod normal;
pub mod slider;
pub mod tangential;
mod together;
pub mod turning;
pub mod walls;

pub use cohesion::{Bridge, Cohesion, Profile, Pull};
pub use damping::Damping;
pub use heat::{Area, Heat};
pub use law::Granular;
pub use model::{Arm, Classic, Model, Unmixable};
pub use normal::Normal;
pub use slider::Slip;
pub use tangential::{Drag, Friction, Tangential};
pub use turning::{Cdt, Epsd, Epsd2, Grip, Rolling, Sds, Twisting};

pub use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::{Vec3, sub};

/// The largest number of history entries of a contact in the vectorized loop, and of a normal law.
pub const MOST_MEMORY: usize = 11;

/// The geometry of a contact between spheres i and j; a wall is a j of radius 0 and infinite mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Geometry<R = f64> {
    /// Unit vector from j to i.
    pub normal: Vec3<R>,
    /// Depth R_i + R_j − |x_i − x_j| [length]; negative only where an existing contact still holds (cohesion).
    pub overlap: R,
    /// Radii of i and j [length].
    pub radii: [R; 2],
    /// Effective radius R̄, by default R_i R_j / (R_i + R_j) [length].
    pub curvature: R,
    /// Effective mass m̄ = m_i m_j / (m_i + m_j) [mass].
    pub mass: R,
}

impl Geometry {
    /// The contact of two spheres whose centres are `d` = x_i − x_j apart; `None` if their distance exceeds
    /// the sum of their radii and `gap` (which an existing cohesive contact can span).
    #[inline]
    pub fn of_spheres(d: Vec3, radii: [f64; 2], masses: [f64; 2], gap: f64) -> Option<Self> {
        let [ri, rj] = radii;
        let sum = ri + rj;
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if square >= (sum + gap) * (sum + gap) {
            return None;
        }
        Some(Self::between(d, square.sqrt(), radii, masses))
    }

    /// The same at any distance; `distance` is the length of `d`.
    #[inline]
    pub fn between(d: Vec3, distance: f64, [ri, rj]: [f64; 2], masses: [f64; 2]) -> Self {
        let sum = ri + rj;
        Self {
            normal: perigrain_base::math::vec3::scale(1.0 / distance, d),
            overlap: sum - distance,
            radii: [ri, rj],
            curvature: ri * rj / sum,
            mass: masses[0] * masses[1] / (masses[0] + masses[1]),
        }
    }

    /// The same contact with another effective radius, for example that of a sphere on a flat body.
    #[must_use]
    pub fn with_curvature(self, curvature: f64) -> Self {
        Self { curvature, ..self }
    }
}

/// Motion of one side of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion<R = f64> {
    /// Velocity of the centre (of a wall: of its surface at the contact) [length/time].
    pub velocity: Vec3<R>,
    /// Angular velocity [1/time]; zero for peridynamic particles and walls.
    pub spin: Vec3<R>,
}

/// What a few laws need of the two sides beyond geometry and motion ([`Granular::needs_ends`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ends<R = f64> {
    /// 1/I = 1/(I_i + m_i R_i²) + 1/(I_j + m_j R_j²) of spheres: inertia about the contact point [mass length²].
    pub inertia: R,
    /// 1 where i is the grain with the smaller tag, else −1: histories of torques are those on that grain.
    pub side: R,
}

/// I + m R² of a sphere divided by m R².
const ABOUT_CONTACT: f64 = 7.0 / 5.0;

impl Ends {
    /// Of two spheres; a mass may be infinite.
    pub fn of_spheres(radii: [f64; 2], masses: [f64; 2]) -> Self {
        let inverse = |k: usize| 1.0 / (ABOUT_CONTACT * masses[k] * radii[k] * radii[k]);
        Self { inertia: 1.0 / (inverse(0) + inverse(1)), side: 1.0 }
    }

    /// From the geometry alone: exact for walls and for spheres of one density.
    pub fn of(g: &Geometry) -> Self {
        let [ri, rj] = g.radii;
        if rj == 0.0 {
            return Self { inertia: ABOUT_CONTACT * g.mass * ri * ri, side: 1.0 };
        }
        let both = g.mass * (ri.powi(3) + rj.powi(3));
        Self::of_spheres(g.radii, [both / rj.powi(3), both / ri.powi(3)])
    }
}

impl<R: Real> Ends<R> {
    /// Of a grain on a wall.
    #[inline(always)]
    pub(crate) fn on_wall(g: &Geometry<R>) -> Self {
        Self { inertia: g.mass * g.radii[0] * g.radii[0] * ABOUT_CONTACT, side: g.mass.like(1.0) }
    }

    /// Where no law needs them.
    #[inline(always)]
    pub(crate) fn none(like: R) -> Self {
        Self { inertia: like.like(0.0), side: like.like(1.0) }
    }
}

/// The time step as seen by contact histories.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advance {
    /// Step size [time].
    pub dt: f64,
    /// Whether histories are updated: not in the setup of a run, where forces are only evaluated.
    pub history: bool,
}

/// Result of a contact: `force` on i (the opposite acts on j) and the torques on both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Wrench<R = f64> {
    /// Force on i [force].
    pub force: Vec3<R>,
    /// Torque on i about its centre.
    pub torque_i: Vec3<R>,
    /// Torque on j about its centre.
    pub torque_j: Vec3<R>,
}

/// Conservative part of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stored {
    /// Elastic and cohesive force along the normal, without damping [force].
    pub push: f64,
    /// Energy that this force can return [energy].
    pub normal: f64,
    /// Energy of the tangential spring [energy].
    pub across: f64,
    /// Whether all other work of the force is dissipated by plastic flow and new surfaces.
    pub flows: bool,
}

impl Wrench {
    /// The wrench times `s`, for a contact that is shared among several.
    #[must_use]
    pub fn scaled(self, s: f64) -> Self {
        use perigrain_base::math::vec3::scale;
        Self {
            force: scale(s, self.force),
            torque_i: scale(s, self.torque_i),
            torque_j: scale(s, self.torque_j),
        }
    }
}

/// Relative velocity of i against j, split into normal and tangential parts.
#[inline(always)]
fn split_velocity<R: Real>(g: &Geometry<R>, i: &Motion<R>, j: &Motion<R>) -> (R, Vec3<R>) {
    use perigrain_base::math::vec3::{dot, scale};
    let relative = sub(i.velocity, j.velocity);
    let along = dot(relative, g.normal);
    (along, sub(relative, scale(along, g.normal)))
}

#[cfg(test)]
mod tests;
