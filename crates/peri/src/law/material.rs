//! What bonds are made of: how they count for their length, and moduli.

/// How much a bond counts for its length in state-based sums (`peri_modify influence`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Influence {
    /// 1/|xi|, as LAMMPS' state-based styles.
    #[default]
    Inverse,
    /// 1 (Silling et al. 2007; Hartmann et al. 2023).
    One,
    /// exp(−|xi|²/δ²).
    Gaussian,
}

impl Influence {
    /// The words of a deck with their meaning.
    pub const NAMES: [(&'static str, Influence); 3] =
        [("inverse", Influence::Inverse), ("one", Influence::One), ("gaussian", Influence::Gaussian)];

    /// ω of a bond of reference length `length` with horizon `delta`.
    pub fn of(self, length: f64, delta: f64) -> f64 {
        match self {
            Self::Inverse => 1.0 / length,
            Self::One => 1.0,
            Self::Gaussian => (-(length / delta).powi(2)).exp(),
        }
    }

    /// What the weighted volume ∫ ω |ξ|² of a whole ball is proportional to as its radius changes.
    pub fn whole(self, delta: f64) -> f64 {
        match self {
            Self::Inverse => delta.powi(4),
            Self::One | Self::Gaussian => delta.powi(5),
        }
    }

    /// What a micro-modulus of this shape is at `length`, over the constant one with the same bulk modulus: g(|xi|)
    /// ∫ x³ dx/∫ g x³ dx over the horizon, K being (2π/9) ∫ c ξ³ dξ.
    pub fn shape(self, length: f64, delta: f64) -> f64 {
        match self {
            Self::Inverse => 0.75 * delta / length,
            Self::One => 1.0,
            // ∫ exp(−x²) x³ dx from 0 to 1 is ½ − 1/e.
            Self::Gaussian => 0.25 / (0.5 - (-1.0f64).exp()) * self.of(length, delta),
        }
    }
}

/// Moduli of a state-based material; what a law does not use is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Moduli {
    /// Bulk modulus.
    pub bulk: f64,
    /// Shear modulus.
    pub shear: f64,
    /// Share of the shear modulus that relaxes.
    pub lambda: f64,
    /// Its relaxation time.
    pub tau: f64,
    /// Yield stress in tension.
    pub yield_stress: f64,
    /// Stretch at which microelastic bonds flow, below zero.
    pub syc: f64,
    /// Stretch beyond which microelastic bonds soften.
    #[serde(default)]
    pub peak: f64,
    /// Conductivity [energy/(time length temperature)].
    #[serde(default)]
    pub conductivity: f64,
    /// Specific heat [energy/(mass temperature)].
    #[serde(default)]
    pub heat_capacity: f64,
    /// Thermal expansion [1/temperature].
    #[serde(default)]
    pub expansion: f64,
    /// The temperature at which there is no thermal strain.
    #[serde(default)]
    pub stress_free: f64,
    /// The fraction of plastic work that becomes heat.
    #[serde(default)]
    pub taylor_quinney: f64,
}

impl Moduli {
    /// Steps of length √(ρ/this) are stable for a state-based body of this horizon, whatever its shape [pressure/length²].
    ///
    /// The exact limit of the cubic lattice is 1.48 Δx/√(K/ρ) at ν = 0.25 and 3.39 at 0.48 for a horizon of 3.015 Δx (Bloch waves, weights
    /// of LAMMPS), but free bodies vibrate faster: a particle at an edge has a small weighted volume, and a dilatation that its own
    /// displacement changes. The numbers cover rods of 2 × 2 particles, plates, blocks and jittered points, horizons of 2 to 4 spacings and all
    /// weights (`tests/families/limits.rs`); large blocks stand steps 1.5 (ν = 0.25) to 1.8 times (0.48) as long.
    pub fn fastest(&self, horizon: f64) -> f64 {
        (FASTEST[0] * self.bulk + FASTEST[1] * self.shear) / (horizon * horizon)
    }
}

impl Moduli {
    /// K + 4G/3, of which ρc² of longitudinal waves is [pressure].
    fn longitudinal(&self) -> f64 {
        self.bulk + 4.0 / 3.0 * self.shear
    }

    /// Steps of this length times √ρ are stable for a body under correspondence of points about so far apart, whatever its shape and horizon
    /// [length/√pressure]: where a family is two layers thick its gradient is that of two neighbours.
    pub fn thin_step(&self, spacing: f64) -> f64 {
        THIN * spacing / self.longitudinal().sqrt()
    }

    /// The same for bodies that are thicker than their horizon is long, points on a lattice or a little off it.
    pub fn thick_step(&self, horizon: f64) -> f64 {
        THICK * horizon / self.longitudinal().sqrt()
    }
}

/// See [`Moduli::thin_step`]; `tests/families/cauchy.rs` has the limits.
const THIN: f64 = 0.6;

/// See [`Moduli::thick_step`].
const THICK: f64 = 0.48;

/// See [`Moduli::fastest`].
const FASTEST: [f64; 2] = [11.4, 19.6];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn influence_functions() {
        assert_eq!(Influence::Inverse.of(0.5, 2.0), 2.0);
        assert_eq!(Influence::One.of(0.5, 2.0), 1.0);
        assert!((Influence::Gaussian.of(2.0, 2.0) - (-1.0f64).exp()).abs() < 1e-16);
    }

    #[test]
    fn shapes_keep_the_bulk_modulus() {
        // ∫ g x³ dx = 1/4 by the midpoint rule with a thousand points: off by its h²/24 · (first derivatives), 1e-6.
        for (_, influence) in Influence::NAMES {
            let at = |k: i32| (f64::from(k) + 0.5) / 1000.0;
            let sum: f64 = (0..1000).map(|k| influence.shape(at(k), 1.0) * at(k).powi(3)).sum();
            assert!((sum / 1000.0 - 0.25).abs() < 1e-6, "{influence:?} {sum}");
        }
    }
}
