//! Normal damping, F = −η v_n, with η from a coefficient or from the coefficient of restitution.

use perigrain_base::math::real::Real;
use perigrain_world::Compat;
use std::f64::consts::PI;

/// How η is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Damping {
    /// `none`: η = 0.
    None,
    /// `velocity`: η = η₀ [mass/time].
    Velocity,
    /// `mass_velocity`: η = η₀ m̄, η₀ [1/time].
    MassVelocity,
    /// `viscoelastic` (Brilliantov et al. 1996): η = η₀ a m̄, η₀ [1/(time length)].
    #[default]
    Viscoelastic,
    /// `tsuji` (Tsuji et al. 1992): η = √2 α_T(e) √(m̄ k), k = F/δ; for `hooke` 2/√5 of that.
    Tsuji,
    /// `coeff_restitution`: η = α √(m̄ k), k = F/δ, with β = −ln e/√(π² + ln² e): α = √(2 (n + 1)) β for
    /// forces ∝ δⁿ, which is √5 β for Hertz and 2 β for `hooke`; exact for all.
    CoeffRestitution,
    /// `mdr 1`: η = η₀ √(m̄ k) with the k of plastic grains.
    Mdr,
    /// `mdr 2`: η = η₀.
    MdrConstant,
}

impl Damping {
    /// The models for every normal model except `mdr`.
    pub const ALL: [Damping; 6] = [
        Damping::None,
        Damping::Velocity,
        Damping::MassVelocity,
        Damping::Viscoelastic,
        Damping::Tsuji,
        Damping::CoeffRestitution,
    ];

    /// The word in decks.
    pub const fn name(self) -> &'static str {
        match self {
            Damping::None => "none",
            Damping::Velocity => "velocity",
            Damping::MassVelocity => "mass_velocity",
            Damping::Viscoelastic => "viscoelastic",
            Damping::Tsuji => "tsuji",
            Damping::CoeffRestitution => "coeff_restitution",
            Damping::Mdr => "mdr 1",
            Damping::MdrConstant => "mdr 2",
        }
    }

    /// Its formula, for the help page.
    pub const fn formula(self) -> &'static str {
        match self {
            Damping::None => "No damping.",
            Damping::Velocity => "η = eta.",
            Damping::MassVelocity => "η = eta m̄.",
            Damping::Viscoelastic => "η = eta a m̄.",
            Damping::Tsuji => "η = √2 α_T(e) √(m̄ k), for hooke 2/√5 of it.",
            Damping::CoeffRestitution => {
                "η = 2β √(m̄ k) for hooke and √5 β √(m̄ k) for the others, β = −ln e/√(π²+ln²e)."
            }
            Damping::Mdr => "η = e √(m̄ k) with k = 2 E_c (a_i + a_j), on walls E_c a/2.",
            Damping::MdrConstant => "η = e.",
        }
    }

    /// Whether the normal model's `eta` is a coefficient of restitution for this model.
    pub fn wants_restitution(self) -> bool {
        matches!(self, Damping::Tsuji | Damping::CoeffRestitution)
    }

    /// The constant factor: η₀ itself, or α(e) for normal forces ∝ δⁿ, with n the `exponent`. For these, −ln
    /// e = π β/√(1 − β²) with α = √(2 (n + 1)) β: the impact is that of a damped spring in δ^((n+1)/2), at
    /// any velocity. LAMMPS 22Jul2025 omits the √2 of `tsuji` (it gives e = 0.78 for a requested 0.70);
    /// LAMMPS of 2026 has it, for every normal model, `hooke` included. `compat` reproduces both.
    pub fn constant(self, eta: f64, exponent: f64, compat: Compat) -> f64 {
        match self {
            Damping::None => 0.0,
            Damping::Velocity
            | Damping::MassVelocity
            | Damping::Viscoelastic
            | Damping::Mdr
            | Damping::MdrConstant => eta,
            Damping::Tsuji if compat == Compat::Lammps2025 => tsuji(eta),
            Damping::Tsuji if compat == Compat::Lammps2026 => std::f64::consts::SQRT_2 * tsuji(eta),
            // Tsuji's curve holds for forces ∝ δ^(3/2), where √5 β gives e.
            Damping::Tsuji if exponent == 1.0 => 2.0 * (2.0_f64 / 5.0).sqrt() * tsuji(eta),
            Damping::Tsuji => std::f64::consts::SQRT_2 * (0.4 * (exponent + 1.0)).sqrt() * tsuji(eta),
            Damping::CoeffRestitution => {
                let log = eta.ln();
                let front = (2.0 * (exponent + 1.0)).sqrt();
                -front * log / (PI * PI + log * log).sqrt()
            }
        }
    }

    /// Whether η grows with the contact radius.
    pub fn by_radius(self) -> bool {
        self == Damping::Viscoelastic
    }

    /// η divided by its constant, for contact radius `a`, normal stiffness F/δ = `secant` and effective mass.
    #[inline(always)]
    pub fn form<R: Real>(self, a: R, secant: R, mass: R) -> R {
        match self {
            Damping::None | Damping::Velocity | Damping::MdrConstant => mass.like(1.0),
            Damping::MassVelocity => mass,
            Damping::Viscoelastic => mass * a,
            Damping::Tsuji | Damping::CoeffRestitution | Damping::Mdr => (mass * secant).sqrt(),
        }
    }
}

/// α_T(e): Tsuji's curve as a polynomial, as given in LAMMPS' manual.
fn tsuji(e: f64) -> f64 {
    // Coefficients of e⁶ … e⁰.
    [4.8218, -18.022, 27.467, -22.348, 11.087, -4.2783, 1.2728].iter().fold(0.0, |sum, c| sum * e + c)
}
