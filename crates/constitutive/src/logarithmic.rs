//! Hencky elasticity with plastic flow and damage, total Lagrangian.
//!
//! b = F C_p⁻¹ Fᵀ = Σ λ² n⊗n has the elastic strain ε = ½ ln b = Σ ln λ n⊗n. The Kirchhoff stress is τ = K tr ε 1 + 2G dev ε, and
//! P = τ F⁻ᵀ. Flow takes strain from ε along dev ε (and its trace), so that the new b = exp 2ε has the same axes, and
//! C_p⁻¹ = F⁻¹ b F⁻ᵀ.
//!
//! Source: J. C. Simo, Comput. Methods Appl. Mech. Eng. 99, 61 (1992); E. A. de Souza Neto, D. Perić, D. R. J. Owen,
//! Computational Methods for Plasticity (2008), section 14.4.

use crate::brittle::Brittle;
use crate::damage::{Damage, Flowed};
use crate::elastic::Elastic;
use crate::flow::{Flow, Returned};
use crate::site::{Failure, Memory, Moment, Response};
use crate::spectral::{exponential, half_logarithm, principal};
use crate::tensor::{
    Mat3, Sym3, UNIT, carried, carried_back, determinant, deviator, inverse_transposed, plus, product_left,
    scaled, square, trace,
};

/// The elastic strain of a site.
struct Strained {
    /// tr ε.
    volume: f64,
    /// dev ε.
    deviator: Sym3,
    /// F⁻ᵀ.
    inverse: Mat3,
}

impl Strained {
    /// From F and C_p⁻¹.
    fn new(f: &Mat3, plastic: &Sym3) -> Result<Self, Failure> {
        let (jacobian, inverse) = inverse_transposed(f);
        if jacobian <= 0.0 {
            return Err(Failure::Inverted(jacobian));
        }
        let b = carried(f, plastic);
        let strain = half_logarithm(&plus(&b, -1.0)).ok_or(Failure::Flat(jacobian))?;
        Ok(Self { volume: trace(&strain), deviator: deviator(&strain), inverse })
    }

    /// Energies of the undamaged matter: what damage leaves alone (pressure in compression), and the rest.
    fn energies(&self, elastic: &Elastic) -> [f64; 2] {
        let of_volume = 0.5 * elastic.bulk * self.volume * self.volume;
        let of_shape = elastic.shear * square(&self.deviator);
        if self.volume < 0.0 { [of_volume, of_shape] } else { [0.0, of_volume + of_shape] }
    }

    /// P = τ F⁻ᵀ, energy and equivalent stress, with the damage of the memory.
    fn response(&self, elastic: &Elastic, memory: Memory) -> Response {
        let intact = 1.0 - memory.damage;
        let pressure = elastic.bulk * self.volume * if self.volume < 0.0 { 1.0 } else { intact };
        let tau = plus(&scaled(&self.deviator, 2.0 * intact * elastic.shear), pressure);
        let [kept, damaged] = self.energies(elastic);
        Response {
            piola: product_left(&tau, &self.inverse),
            memory,
            energy: kept + intact * damaged,
            dissipated: 0.0,
            released: 0.0,
            mises: intact * self.equivalent(elastic),
        }
    }

    /// Equivalent stress q = 2G √(3/2)|dev ε| of the undamaged matter.
    fn equivalent(&self, elastic: &Elastic) -> f64 {
        2.0 * elastic.shear * (1.5 * square(&self.deviator)).sqrt()
    }

    /// The largest principal Kirchhoff stress of the undamaged matter.
    fn largest(&self, elastic: &Elastic) -> f64 {
        elastic.bulk * self.volume + 2.0 * elastic.shear * principal(&self.deviator)[0]
    }

    /// C_p⁻¹ = F⁻¹ exp(2ε) F⁻ᵀ.
    fn plastic(&self) -> Sym3 {
        let twice = scaled(&plus(&self.deviator, self.volume / 3.0), 2.0);
        carried_back(&self.inverse, &exponential(&twice))
    }
}

impl Elastic {
    /// Hencky elasticity without a past.
    ///
    /// # Errors
    /// det F is not positive.
    pub fn hencky(&self, f: &Mat3, memory: &Memory) -> Result<Response, Failure> {
        Ok(Strained::new(f, &UNIT)?.response(self, *memory))
    }

    /// Hencky elasticity and damage where matter is pulled.
    ///
    /// # Errors
    /// det F is not positive, or sites are too far apart.
    pub fn brittle(
        &self,
        law: &Brittle,
        f: &Mat3,
        memory: &Memory,
        moment: &Moment,
    ) -> Result<Response, Failure> {
        let strained = Strained::new(f, &UNIT)?;
        let mut after = *memory;
        let freed = law.grow(self, &mut after, strained.largest(self), moment)?;
        let memory = if moment.advance { after } else { *memory };
        let released = freed * strained.energies(self)[1];
        Ok(Response { memory, released, ..strained.response(self, after) })
    }

    /// What flow and damage leave as they are: the stress and the energy of what was remembered.
    ///
    /// # Errors
    /// det F is not positive.
    pub fn frozen(&self, f: &Mat3, memory: &Memory) -> Result<Response, Failure> {
        Ok(Strained::new(f, &memory.plastic)?.response(self, *memory))
    }

    /// Hencky elasticity, plastic flow and damage.
    ///
    /// # Errors
    /// det F is not positive, or flow finds no state.
    pub fn plastic(
        &self,
        (flow, damage): (&Flow, Option<&Damage>),
        f: &Mat3,
        memory: &Memory,
        moment: &Moment,
    ) -> Result<Response, Failure> {
        let mut strained = Strained::new(f, &memory.plastic)?;
        let trial = [strained.equivalent(self), strained.volume];
        let Some(returned) = flow.returned(self, trial, memory.strain, moment)? else {
            return Ok(strained.response(self, *memory));
        };
        strained.deviator = scaled(&strained.deviator, returned.deviator);
        strained.volume = returned.volume;
        let mut after = Memory { strain: memory.strain + returned.step, ..*memory };
        if let Some(damage) = damage {
            damage.grow(&mut after, self.flowed(&strained, &returned, damage), moment);
        }
        let grown = after.damage - memory.damage;
        let response = Response {
            dissipated: (1.0 - memory.damage - 0.5 * grown) * returned.dissipated,
            released: grown * strained.energies(self)[1],
            ..strained.response(self, after)
        };
        if !moment.advance {
            return Ok(Response { memory: *memory, ..response });
        }
        let plastic = strained.plastic();
        after.plastic = if flow.keeps_volume() { unimodular(plastic) } else { plastic };
        Ok(Response { memory: after, ..response })
    }

    /// The flow of a step, for damage.
    fn flowed(&self, strained: &Strained, returned: &Returned, damage: &Damage) -> Flowed {
        Flowed {
            step: returned.step,
            ratio: self.bulk * strained.volume / strained.equivalent(self),
            limit: returned.limit,
            largest: if damage.needs_largest() { strained.largest(self) } else { 0.0 },
        }
    }
}

/// Flow without change of volume keeps det C_p = 1: rounding would add up over steps. The determinant is 1 to rounding, so
/// that a step of Newton's method is its cube root.
#[inline]
fn unimodular(plastic: Sym3) -> Sym3 {
    scaled(&plastic, 1.0 - (determinant(&plastic) - 1.0) / 3.0)
}
