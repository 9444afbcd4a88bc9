//! Heat of plastic work.

/// How plastic work warms a site from which no heat flows.
///
/// Source: G. I. Taylor, H. Quinney, Proc. R. Soc. A 143, 307 (1934).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Heating {
    /// Fraction β of plastic work that becomes heat.
    pub fraction: f64,
    /// Density of the reference configuration ρ [mass/volume].
    pub density: f64,
    /// Heat capacity c [energy/mass temperature].
    pub capacity: f64,
}

impl Heating {
    /// The rise of temperature ΔT = β w/(ρc) by plastic work w per reference volume [temperature].
    #[inline]
    pub fn rise(&self, dissipated: f64) -> f64 {
        self.fraction * dissipated / (self.density * self.capacity)
    }
}
