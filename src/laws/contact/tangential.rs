//! Friction across the normal: a spring and a dashpot that slide at the Coulomb limit.

use super::normal::{effective_shear, effective_young, geometric};
use super::{Advance, Normal};
use crate::math::real::Real;
use crate::math::vec3::{Vec3, add, choose, dot, length, scale, sub};
use crate::world::Compat;

/// Component along the normal, relative to the Coulomb limit, below which a spring counts as tangential.
const TILT: f64 = 1e-10;

/// A tangential model with the coefficients a deck gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tangential {
    /// `mindlin kt|NULL x_gamma mu`: no-slip stiffness k_t a on an accumulated displacement.
    Mindlin {
        /// k_t [pressure]; `None` (NULL): 8 G* from the normal model's material.
        stiffness: Option<f64>,
        /// Tangential damping in units of the normal one.
        x_gamma: f64,
        /// Coefficient of friction.
        mu: f64,
    },
}

impl Tangential {
    /// The word decks use.
    pub fn name(&self) -> &'static str {
        match self {
            Tangential::Mindlin { .. } => "mindlin",
        }
    }

    /// The spring between grains of two types: coefficients mix geometrically, G* as Mindlin's theory wants.
    /// LAMMPS 22Jul2025 takes E* of the pair for both moduli of a mixed pair and √(ν_i ν_j) for both ratios,
    /// against its own manual, which `mixed` and `compat` together reproduce.
    pub fn spring(&self, other: &Tangential, normals: [&Normal; 2], mixed: bool, compat: Compat) -> Spring {
        let Tangential::Mindlin { stiffness: k1, x_gamma: x1, mu: m1 } = *self;
        let Tangential::Mindlin { stiffness: k2, x_gamma: x2, mu: m2 } = *other;
        let stiffness = match (k1, k2) {
            (Some(k1), Some(k2)) => geometric(k1, k2),
            _ => 8.0 * shear(normals, mixed && compat == Compat::Lammps),
        };
        Spring { stiffness, x_gamma: geometric(x1, x2), mu: geometric(m1, m2) }
    }
}

/// G* of two materials; zero for normal models without one (decks that ask for it are refused).
fn shear(normals: [&Normal; 2], artefact: bool) -> f64 {
    let [Some((e1, nu1)), Some((e2, nu2))] = normals.map(Normal::material) else { return 0.0 };
    if artefact {
        let (e, nu) = (effective_young([e1, e2], [nu1, nu2]), geometric(nu1, nu2));
        return effective_shear([e, e], [nu, nu]);
    }
    effective_shear([e1, e2], [nu1, nu2])
}

/// Mindlin's spring and dashpot with a slider, ready for contacts of one pair of types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// k_t in F_t = −k_t a ξ [pressure].
    pub stiffness: f64,
    /// Tangential damping in units of the normal one.
    pub x_gamma: f64,
    /// Coefficient of friction.
    pub mu: f64,
}

impl Spring {
    /// The tangential force on i, F_t = −k_t a ξ − x_γ η v_t, at most μ |F_n|; `xi` is the accumulated
    /// displacement: turned into the present tangent plane with its length kept (Luding 2008, eq. 17), moved
    /// on by v_t dt, and shortened to what the slider carries when it slides (eq. 20).
    #[inline]
    pub fn force<R: Real>(
        &self,
        n: Vec3<R>,
        a: R,
        eta: R,
        v_t: Vec3<R>,
        normal_force: R,
        xi: &mut Vec3<R>,
        step: Advance,
    ) -> Vec3<R> {
        let zero = a.like(0.0);
        let stiffness = a * self.stiffness;
        let damping = eta * self.x_gamma;
        let limit = normal_force * self.mu;
        if step.history {
            let tilt = dot(*xi, n);
            let tilted = (tilt.abs() * stiffness).above(limit * TILT);
            if R::any(tilted) {
                *xi = choose::<R>(tilted, into_plane(*xi, n, tilt), *xi);
            }
            *xi = add(*xi, scale(a.like(step.dt), v_t));
        }
        let trial = sub(scale(-damping, v_t), scale(stiffness, *xi));
        let size = length(trial);
        let slides = size.above(limit);
        if !R::any(slides) {
            return trial;
        }
        let stretched = dot(*xi, *xi).above(zero);
        let sliding = scale(R::choose(stretched, limit / size, zero), trial);
        let carried = scale(a.like(-1.0) / stiffness, add(sliding, scale(damping, v_t)));
        *xi = choose::<R>(R::both(slides, stretched), carried, *xi);
        choose::<R>(slides, sliding, trial)
    }
}

/// `xi` without its component `tilt` along `n`, at its old length.
#[inline]
fn into_plane<R: Real>(xi: Vec3<R>, n: Vec3<R>, tilt: R) -> Vec3<R> {
    let flat = sub(xi, scale(tilt, n));
    let flat_length = length(flat);
    let one = tilt.like(1.0);
    scale(R::choose(flat_length.above(tilt.like(0.0)), length(xi) / flat_length, one), flat)
}
