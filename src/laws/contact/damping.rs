//! Damping along the normal, F = −η v_n, with η from a coefficient or from the coefficient of restitution.

use crate::math::real::Real;
use crate::world::Compat;

/// How η is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Damping {
    /// `velocity`: η = η₀ [mass/time].
    Velocity,
    /// `mass_velocity`: η = η₀ m̄, η₀ [1/time].
    MassVelocity,
    /// `viscoelastic` (Brilliantov et al. 1996): η = η₀ a m̄, η₀ [1/(time length)].
    #[default]
    Viscoelastic,
    /// `tsuji` (Tsuji et al. 1992): η = √2 α_T(e) √(m̄ k a).
    Tsuji,
    /// `coeff_restitution`: η = α_e √(m̄ k a), α_e = −√5 ln e / √(π² + ln² e), exact for Hertz.
    CoeffRestitution,
}

impl Damping {
    /// All of them.
    pub const ALL: [Damping; 5] = [
        Damping::Velocity,
        Damping::MassVelocity,
        Damping::Viscoelastic,
        Damping::Tsuji,
        Damping::CoeffRestitution,
    ];

    /// The word decks use.
    pub fn name(self) -> &'static str {
        match self {
            Damping::Velocity => "velocity",
            Damping::MassVelocity => "mass_velocity",
            Damping::Viscoelastic => "viscoelastic",
            Damping::Tsuji => "tsuji",
            Damping::CoeffRestitution => "coeff_restitution",
        }
    }

    /// Whether the normal model's `eta` is a coefficient of restitution here.
    pub fn wants_restitution(self) -> bool {
        matches!(self, Damping::Tsuji | Damping::CoeffRestitution)
    }

    /// The constant in front: η₀ itself, or α(e). LAMMPS 22Jul2025 leaves out the √2 of `tsuji`
    /// (it returns e = 0.78 where 0.70 is asked for), which `compat` reproduces.
    pub fn constant(self, eta: f64, compat: Compat) -> f64 {
        match self {
            Damping::Velocity | Damping::MassVelocity | Damping::Viscoelastic => eta,
            Damping::Tsuji if compat == Compat::Lammps => tsuji(eta),
            Damping::Tsuji => std::f64::consts::SQRT_2 * tsuji(eta),
            Damping::CoeffRestitution => {
                let log = eta.ln();
                let pi = std::f64::consts::PI;
                -5.0_f64.sqrt() * log / (pi * pi + log * log).sqrt()
            }
        }
    }

    /// η for contact radius `a`, normal stiffness F/δ = `secant` = k a and effective mass.
    #[inline]
    pub fn coefficient<R: Real>(self, constant: f64, a: R, secant: R, mass: R) -> R {
        match self {
            Damping::Velocity => a.like(constant),
            Damping::MassVelocity => mass * constant,
            Damping::Viscoelastic => mass * constant * a,
            Damping::Tsuji | Damping::CoeffRestitution => (mass * secant).sqrt() * constant,
        }
    }
}

/// α_T(e), the polynomial through Tsuji's curve as LAMMPS' manual prints it.
fn tsuji(e: f64) -> f64 {
    // Coefficients of e⁶ … e⁰.
    [4.8218, -18.022, 27.467, -22.348, 11.087, -4.2783, 1.2728].iter().fold(0.0, |sum, c| sum * e + c)
}
