//! Elastic matter that softens where it is pulled: concrete, rock, ceramics.

use crate::elastic::Elastic;
use crate::site::{Failure, Memory, Moment};

/// Rankine's limit with a crack band: where the largest principal stress of the undamaged matter σ̃ exceeds f_t, damage lets the
/// stress fall on a line over the displacement Δx σ̃/E until G_f is spent:
/// (1 − D)σ̃ = f_t (s − w)/(s − 1), w = max σ̃/f_t over time, s = 2EG_f/(f_t²Δx) the w at which nothing is left.
///
/// Source: Z. P. Bažant, B. H. Oh, Mater. Struct. 16, 155 (1983).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Brittle {
    /// Tensile strength f_t [pressure].
    pub strength: f64,
    /// Fracture energy G_f [energy/area].
    pub energy: f64,
}

impl Brittle {
    /// The spacing below which stress can fall so slowly: 2EG_f/f_t² [length].
    pub fn largest_spacing(&self, elastic: &Elastic) -> f64 {
        2.0 * elastic.young() * self.energy / (self.strength * self.strength)
    }

    /// Lets the memory of a site grow to a largest principal stress; returns the energy that damage set free, as a multiple of the
    /// energy of the undamaged matter that it acts on. Exact where stresses grow in proportion.
    ///
    /// # Errors
    /// The spacing is too large.
    #[inline]
    pub fn grow(
        &self,
        elastic: &Elastic,
        memory: &mut Memory,
        largest: f64,
        moment: &Moment,
    ) -> Result<f64, Failure> {
        let most = self.largest_spacing(elastic);
        let end = most / moment.spacing;
        if end <= 1.0 {
            return Err(Failure::Coarse { spacing: moment.spacing, most });
        }
        let (before, now) = (memory.wear, largest / self.strength);
        if now <= before.max(1.0) {
            memory.wear = before.max(now);
            return Ok(0.0);
        }
        memory.wear = now;
        if memory.onset == 0.0 {
            memory.onset = self.strength;
        }
        let slope = end / (end - 1.0);
        // D = s/(s − 1) (1 − 1/w).
        memory.damage = (slope * (1.0 - 1.0 / now)).min(1.0);
        // ∫ ψ dD with ψ = ψ_now (w/w_now)².
        Ok(slope * (now.min(end) - before.clamp(1.0, end)) / (now * now))
    }
}
