//! A material: elastic constants and a law.

use crate::brittle::Brittle;
use crate::damage::Damage;
use crate::elastic::Elastic;
use crate::flow::Flow;
use crate::site::{Failure, Memory, Moment, Response};
use crate::tensor::{Mat3, is_finite};

/// How stress follows from strain.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Law {
    /// Small strains and small rotations: P = K tr ε + 2G dev ε, ε = sym(F − 1).
    Linear,
    /// Compressible neo-Hooke.
    NeoHooke,
    /// Logarithmic strain: τ = K tr ε + 2G dev ε, ε = ½ ln FFᵀ.
    Hencky,
    /// Logarithmic strain, and damage where matter is pulled.
    Brittle(Brittle),
    /// Logarithmic elastic strain, plastic flow, and damage that softens.
    Plastic {
        /// Yield surface and flow rule.
        flow: Flow,
        /// Damage by flow; `None`: none.
        damage: Option<Damage>,
    },
}

/// A material of which sites are made.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Material {
    /// Elastic constants.
    pub elastic: Elastic,
    /// The law.
    pub law: Law,
}

impl Material {
    /// The stress of a site with deformation gradient `f`, and what the site remembers afterwards.
    ///
    /// # Errors
    /// The deformation gradient is not finite or turns matter inside out, or flow finds no state.
    #[inline]
    pub fn respond(&self, f: &Mat3, memory: &Memory, moment: &Moment) -> Result<Response, Failure> {
        if !is_finite(f) {
            return Err(Failure::NotFinite);
        }
        match &self.law {
            Law::Linear => Ok(self.elastic.linear(f, memory)),
            Law::NeoHooke => self.elastic.neo_hooke(f, memory),
            Law::Hencky => self.elastic.hencky(f, memory),
            Law::Brittle(law) => self.elastic.brittle(law, f, memory, moment),
            Law::Plastic { flow, damage } => self.elastic.plastic((flow, damage.as_ref()), f, memory, moment),
        }
    }

    /// The same while nothing flows and damage does not grow: what is stored at other strains and the same memory.
    ///
    /// # Errors
    /// The deformation gradient turns matter inside out.
    pub fn frozen(&self, f: &Mat3, memory: &Memory) -> Result<Response, Failure> {
        match &self.law {
            Law::Linear => Ok(self.elastic.linear(f, memory)),
            Law::NeoHooke => self.elastic.neo_hooke(f, memory),
            Law::Hencky | Law::Brittle(_) | Law::Plastic { .. } => self.elastic.frozen(f, memory),
        }
    }

    /// Bulk modulus K [pressure].
    pub fn bulk(&self) -> f64 {
        self.elastic.bulk
    }

    /// Shear modulus G [pressure].
    pub fn shear(&self) -> f64 {
        self.elastic.shear
    }

    /// Whether sites remember anything: elastic laws return the memory that they are given.
    pub fn remembers(&self) -> bool {
        matches!(self.law, Law::Brittle(_) | Law::Plastic { .. })
    }
}
