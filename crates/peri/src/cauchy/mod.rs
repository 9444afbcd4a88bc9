//! Correspondence: forces from the stress of materials at deformation gradients that families define.
//!
//! With xi a bond at the start, y = xi + eta the bond now, ω its influence and w its share of volume,
//!
//! ```text
//! K = Σ ω w xi⊗xi V_j            over living bonds [length² × weight × volume]
//! F = 1 + E,  E = (Σ ω w eta⊗xi V_j) K⁻¹
//! U = Σ_i V_i [W(F_i) + ½ γ_i Σ ω w |z|² V_j],   z = y − F xi = eta − E xi,   γ = g 15G/m
//! f_i = Σ ω w V_i V_j [(M_i + M_j) xi + (γ_i + γ_j) eta],   M = P K⁻¹ − γ E
//! ```
//!
//! P being the first Piola-Kirchhoff stress of the material at F (Silling et al. 2007). The second term of U is node control: without it
//! motions between sites that leave all F as they are would have no energy (Silling 2017). Forces are the exact derivative of U, since
//! Σ ω w z⊗xi V_j = 0; written in eta they are zero to the last bit where nothing has moved.
//!
//! Three passes: [`lattice`] and [`list`] add up eta⊗xi at both ends, [`site`] settles E, P and M, and the force sweeps of all laws end with
//! the loops of this one. [`shape`] has K⁻¹, [`energy`] what thermo output wants.

pub(crate) mod energy;
pub(crate) mod lattice;
pub(crate) mod list;
pub(crate) mod shape;
pub(crate) mod site;
pub(crate) mod spent;
pub mod stress;

use perigrain_constitutive::{Failure, Memory};

/// Numbers of E, P, W and the temperature of a site.
pub(crate) const LAST: usize = 20;

/// What the sites of a body (cells or records) have under correspondence.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Continuum {
    /// What materials remember, [`Memory::NUMBERS`] for each site; empty where no material remembers.
    pub memory: Vec<f64>,
    /// E without thermal strain, P, W and the temperature of the last step that advanced, in rows of [`LAST`] numbers, where materials remember: a site that is looked at where the step
    /// has left it has the stress of that step, to the last bit and whatever the rate.
    pub last: Vec<f64>,
    /// The least eigenvalue of K of each site's whole family.
    pub whole: Vec<f64>,
    /// Stored energy W of the last evaluation, per reference volume.
    pub energy: Vec<f64>,
    /// Kirchhoff stress P Fᵀ of the last evaluation: xx yy zz xy xz yz.
    pub stress: Vec<[f64; 6]>,
    /// K⁻¹ of living bonds: xx yy zz xy xz yz. Zeros where there is no site or its family is torn; empty where it is to be found.
    #[serde(skip)]
    pub inverse: Vec<[f64; 6]>,
    /// What the last evaluation turned into heat, and what it took as fracture energy: over volumes of sites, by chunks of sites.
    #[serde(skip)]
    pub lost: Vec<[f64; 2]>,
    /// Plastic work of each site in the last evaluation [energy]; empty where temperatures have no effect.
    #[serde(skip)]
    pub flowed: Vec<f64>,
    /// Sites of the last evaluation that bear nothing: damaged through, or torn; ascending.
    #[serde(skip)]
    pub spent: Vec<u32>,
    /// The first site whose material had no answer in the last evaluation.
    #[serde(skip)]
    pub fault: Option<(u32, Failure)>,
}

impl Continuum {
    /// Memory held.
    pub fn bytes(&self) -> usize {
        8 * (self.memory.len() + self.last.len() + self.whole.len() + self.energy.len())
            + 48 * (self.stress.len() + self.inverse.len())
            + 16 * self.lost.len()
            + 8 * self.flowed.len()
    }

    /// What a site remembers.
    pub fn memory_of(&self, site: usize) -> Memory {
        let row = self.memory.as_chunks::<{ Memory::NUMBERS }>().0.get(site);
        row.map_or_else(Memory::default, |row| Memory::from_numbers(*row))
    }
}
