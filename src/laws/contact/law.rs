//! The granular law: one normal, one damping and one tangential model, mixed for a pair of types.

use super::tangential::Spring;
use super::{Advance, ContactLaw, Damping, Geometry, Motion, Normal, Tangential, Wrench, split_velocity};
use crate::math::real::Real;
use crate::math::vec3::{add, cross, scale, sub};
use crate::world::Compat;

/// What a deck says about contacts of one pair of types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Along the normal.
    pub normal: Normal,
    /// Dissipation along the normal.
    pub damping: Damping,
    /// Across the normal.
    pub tangential: Tangential,
    /// `limit_damping`: the normal force never pulls.
    pub limit_damping: bool,
}

/// Two models of different kinds cannot be mixed: which words differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unmixable(pub &'static str, pub &'static str);

impl Model {
    /// The law for a pair of types whose model was given.
    pub fn law(&self, compat: Compat) -> Granular {
        self.pair(self, false, compat)
    }

    /// The law for a pair of types of which only the like pairs were given, by LAMMPS' rules: geometric means,
    /// moduli as E* and G*, `limit_damping` if either has it.
    ///
    /// # Errors
    /// When the models are not of one kind.
    pub fn mixed(&self, other: &Model, compat: Compat) -> Result<Granular, Unmixable> {
        let names = |m: &Model| [m.normal.name(), m.damping.name(), m.tangential.name()];
        for (a, b) in names(self).into_iter().zip(names(other)) {
            if a != b {
                return Err(Unmixable(a, b));
            }
        }
        Ok(self.pair(other, true, compat))
    }

    fn pair(&self, other: &Model, mixed: bool, compat: Compat) -> Granular {
        let eta = super::normal::geometric(self.normal.eta(), other.normal.eta());
        let normals = [&self.normal, &other.normal];
        Granular {
            stiffness: self.normal.stiffness(&other.normal),
            damping: self.damping,
            damping_constant: self.damping.constant(eta, compat),
            limit_damping: self.limit_damping || other.limit_damping,
            spring: self.tangential.spring(&other.tangential, normals, mixed, compat),
        }
    }
}

/// The granular contact law of one pair of types (LAMMPS' `pair_style granular`), F on i from j:
/// F = (k a δ − η v_n) n + F_t with a = √(R̄ δ).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Granular {
    /// k in F = k a δ [pressure].
    pub stiffness: f64,
    /// How η is made.
    pub damping: Damping,
    /// Its constant.
    pub damping_constant: f64,
    /// Whether the normal force never pulls.
    pub limit_damping: bool,
    /// Across the normal.
    pub spring: Spring,
}

impl ContactLaw for Granular {
    /// The accumulated tangential displacement of i against j [length].
    fn memory(&self) -> usize {
        3
    }

    #[inline]
    fn contact<R: Real>(
        &self,
        g: &Geometry<R>,
        i: &Motion<R>,
        j: &Motion<R>,
        history: &mut [R],
        step: Advance,
    ) -> Wrench<R> {
        let a = (g.curvature * g.overlap).sqrt();
        let secant = a * self.stiffness;
        let eta = self.damping.coefficient(self.damping_constant, a, secant, g.mass);

        let (v_n, v_across) = split_velocity(g, i, j);
        let mut normal_force = secant * g.overlap - eta * v_n;
        if self.limit_damping {
            normal_force = normal_force.most(a.like(0.0));
        }

        // Slip of the two surfaces: v_t − (R_i ω_i + R_j ω_j) × n, full radii as in LAMMPS.
        let spin = add(scale(g.radii[0], i.spin), scale(g.radii[1], j.spin));
        let v_t = sub(v_across, cross(spin, g.normal));
        let mut slip = [history[0], history[1], history[2]];
        let friction = self.spring.force(g.normal, a, eta, v_t, normal_force.abs(), &mut slip, step);
        history[..3].copy_from_slice(&slip);

        // Lever arms end in the middle of the overlap.
        let lever = cross(friction, g.normal);
        let arm = |k: usize| g.radii[k] - g.overlap * 0.5;
        Wrench {
            force: add(scale(normal_force, g.normal), friction),
            torque_i: scale(arm(0), lever),
            torque_j: scale(arm(1), lever),
        }
    }
}
