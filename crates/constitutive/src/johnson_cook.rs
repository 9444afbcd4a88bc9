//! Yield stress and fracture strain of Johnson and Cook.
//!
//! Source: G. R. Johnson, W. H. Cook, Proc. 7th Int. Symp. Ballistics, 541 (1983), and Eng. Fract. Mech. 21, 31 (1985).

use crate::hardening::Flowing;

/// The plastic strain at which the slope of ε̄ⁿ is taken where it is infinite, at ε̄ = 0.
const LEAST_STRAIN: f64 = 1e-12;

/// Reference states of rate and temperature, which strength and fracture strain share.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reference {
    /// Rate ε̄̇₀ below which rates have no effect [1/time].
    pub rate: f64,
    /// Temperature T_r at and below which temperatures have no effect [temperature].
    pub temperature: f64,
    /// Melting temperature T_m [temperature].
    pub melting: f64,
}

impl Reference {
    /// T* = (T − T_r)/(T_m − T_r), from 0 to 1; 0 without a temperature.
    #[inline]
    pub fn homologous(&self, temperature: Option<f64>) -> f64 {
        let scale = self.melting - self.temperature;
        temperature.map_or(0.0, |t| ((t - self.temperature) / scale).clamp(0.0, 1.0))
    }

    /// ln max(1, ε̄̇/ε̄̇₀) of an increment of strain in a time, and its derivative by the increment; without time 0.
    #[inline]
    pub fn log_rate(&self, step: f64, dt: f64) -> (f64, f64) {
        match step > self.rate * dt && dt > 0.0 {
            true => ((step / (self.rate * dt)).ln(), 1.0 / step),
            false => (0.0, 0.0),
        }
    }
}

/// σ_y = (A + Bε̄ⁿ)(1 + C ln max(1, ε̄̇/ε̄̇₀))(1 − T*ᵐ).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct JohnsonCook {
    /// First yield stress A [pressure].
    pub yields: f64,
    /// Modulus B of hardening [pressure].
    pub modulus: f64,
    /// Exponent n of hardening.
    pub exponent: f64,
    /// Coefficient C of the rate.
    pub rate: f64,
    /// Exponent m of temperature.
    pub thermal: f64,
    /// Where rate and temperature begin to act.
    pub reference: Reference,
}

impl JohnsonCook {
    /// σ_y and its derivative by the increment of strain.
    #[inline]
    pub fn limit(&self, at: Flowing) -> (f64, f64) {
        let strain = (at.before + at.step).max(0.0);
        let power = self.modulus * strain.powf(self.exponent);
        let held = self.yields + if strain > 0.0 { power } else { 0.0 };
        let (log, slope) = self.reference.log_rate(at.step, at.dt);
        let factor = 1.0 + self.rate * log;
        let strained = strain.max(LEAST_STRAIN);
        let hardens = self.exponent * self.modulus * strained.powf(self.exponent - 1.0) * factor
            + held * self.rate * slope;
        (at.thermal * held * factor, at.thermal * hardens)
    }

    /// 1 − T*ᵐ.
    #[inline]
    pub fn thermal(&self, temperature: Option<f64>) -> f64 {
        match self.reference.homologous(temperature) {
            0.0 => 1.0,
            t => 1.0 - t.powf(self.thermal),
        }
    }
}

/// ε_f = (D₁ + D₂ e^(D₃ p/q))(1 + D₄ ln max(1, ε̄̇/ε̄̇₀))(1 + D₅T*), p the mean stress (tension positive), q that of Mises.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FractureStrain {
    /// D₁ to D₅.
    pub d: [f64; 5],
    /// Where rate and temperature begin to act.
    pub reference: Reference,
}

impl FractureStrain {
    /// ε_f at a ratio p/q, for an increment of strain in a time.
    #[inline]
    pub fn at(&self, ratio: f64, step: f64, dt: f64, temperature: Option<f64>) -> f64 {
        let [d1, d2, d3, d4, d5] = self.d;
        let rate = 1.0 + d4 * self.reference.log_rate(step, dt).0;
        (d1 + d2 * (d3 * ratio).exp()) * rate * (1.0 + d5 * self.reference.homologous(temperature))
    }
}
