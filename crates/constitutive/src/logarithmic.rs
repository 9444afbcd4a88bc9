//! Hencky elasticity with plastic flow, total Lagrangian.
//!
//! b = F C_p⁻¹ Fᵀ = Σ λ² n⊗n has the elastic strain ε = ½ ln b = Σ ln λ n⊗n. The Kirchhoff stress is τ = K tr ε 1 + 2G dev ε, and
//! P = τ F⁻ᵀ. Flow takes strain from ε along dev ε (and its trace), so that the new b = exp 2ε has the same axes, and
//! C_p⁻¹ = F⁻¹ b F⁻ᵀ.
//!
//! Source: J. C. Simo, Comput. Methods Appl. Mech. Eng. 99, 61 (1992); E. A. de Souza Neto, D. Perić, D. R. J. Owen,
//! Computational Methods for Plasticity (2008), section 14.4.

use crate::elastic::Elastic;
use crate::flow::{Flow, returned};
use crate::site::{Failure, Memory, Moment, Response};
use crate::spectral::{exponential, half_logarithm};
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
        if !(jacobian > 0.0) {
            return Err(Failure::Inverted(jacobian));
        }
        let b = carried(f, plastic);
        let strain = half_logarithm(&plus(&b, -1.0)).ok_or(Failure::Inverted(jacobian))?;
        Ok(Self { volume: trace(&strain), deviator: deviator(&strain), inverse })
    }

    /// P = τ F⁻ᵀ, energy and equivalent stress.
    fn response(&self, elastic: &Elastic, memory: Memory) -> Response {
        let pressure = elastic.bulk * self.volume;
        let tau = plus(&scaled(&self.deviator, 2.0 * elastic.shear), pressure);
        let square = square(&self.deviator);
        Response {
            piola: product_left(&tau, &self.inverse),
            memory,
            energy: 0.5 * pressure * self.volume + elastic.shear * square,
            dissipated: 0.0,
            released: 0.0,
            mises: 2.0 * elastic.shear * (1.5 * square).sqrt(),
        }
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

    /// Hencky elasticity and plastic flow.
    ///
    /// # Errors
    /// det F is not positive, or flow finds no state.
    pub fn plastic(
        &self,
        flow: &Flow,
        f: &Mat3,
        memory: &Memory,
        moment: &Moment,
    ) -> Result<Response, Failure> {
        let mut strained = Strained::new(f, &memory.plastic)?;
        let q = 2.0 * self.shear * (1.5 * square(&strained.deviator)).sqrt();
        let Flow::Mises(hardening) = flow;
        let Some((step, [before, after])) = returned(hardening, self.shear, q, memory.strain)? else {
            return Ok(strained.response(self, *memory));
        };
        strained.deviator = scaled(&strained.deviator, 1.0 - 3.0 * self.shear * step / q);
        let memory = match moment.advance {
            true => {
                Memory { plastic: unimodular(strained.plastic()), strain: memory.strain + step, ..*memory }
            }
            false => *memory,
        };
        let dissipated = 0.5 * (before + after) * step;
        Ok(Response { dissipated, ..strained.response(self, memory) })
    }
}

/// Flow without change of volume keeps det C_p = 1: rounding would add up over steps. The determinant is 1 to rounding, so
/// that a step of Newton's method is its cube root.
#[inline]
fn unimodular(plastic: Sym3) -> Sym3 {
    scaled(&plastic, 1.0 - (determinant(&plastic) - 1.0) / 3.0)
}
