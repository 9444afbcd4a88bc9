//! Elastic laws.

use crate::site::{Failure, Memory, Response};
use crate::tensor::{
    Mat3, UNIT, carried, deviator, inverse_transposed, matrix, plus, scaled, square, symmetric_minus, trace,
};

/// Isotropic elastic constants.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Elastic {
    /// Bulk modulus K [pressure].
    pub bulk: f64,
    /// Shear modulus G [pressure].
    pub shear: f64,
}

impl Elastic {
    /// From Young's modulus E [pressure] and Poisson's ratio ν.
    pub fn from_young(young: f64, nu: f64) -> Self {
        Self { bulk: young / (3.0 * (1.0 - 2.0 * nu)), shear: young / (2.0 * (1.0 + nu)) }
    }

    /// Young's modulus E [pressure].
    pub fn young(&self) -> f64 {
        9.0 * self.bulk * self.shear / (3.0 * self.bulk + self.shear)
    }

    /// Small strains: P = K tr ε + 2G dev ε with ε = sym(F − 1); U = ½K (tr ε)² + G dev ε:dev ε. Rotations make stress.
    pub fn linear(&self, f: &Mat3, memory: &Memory) -> Response {
        let strain = symmetric_minus(f, 1.0);
        let (volume, dev) = (trace(&strain), deviator(&strain));
        let stress = plus(&scaled(&dev, 2.0 * self.shear), self.bulk * volume);
        self.response(matrix(&stress), memory, volume, square(&dev))
    }

    /// Compressible neo-Hooke: P = G(F − F⁻ᵀ) + λ ln J F⁻ᵀ, U = ½G(tr FFᵀ − 3 − 2 ln J) + ½λ ln²J with λ = K − ⅔G.
    ///
    /// Source: J. Bonet, R. D. Wood, Nonlinear Continuum Mechanics for Finite Element Analysis (2008), section 6.4.3.
    ///
    /// # Errors
    /// J = det F is not positive.
    pub fn neo_hooke(&self, f: &Mat3, memory: &Memory) -> Result<Response, Failure> {
        let (jacobian, inverse) = inverse_transposed(f);
        if jacobian <= 0.0 {
            return Err(Failure::Inverted(jacobian));
        }
        let (lame, log) = (self.bulk - 2.0 / 3.0 * self.shear, jacobian.ln());
        let spherical = lame * log - self.shear;
        let b = carried(f, &UNIT);
        Ok(Response {
            piola: std::array::from_fn(|i| {
                std::array::from_fn(|j| self.shear * f[i][j] + spherical * inverse[i][j])
            }),
            memory: *memory,
            energy: 0.5 * self.shear * (trace(&b) - 3.0 - 2.0 * log) + 0.5 * lame * log * log,
            dissipated: 0.0,
            released: 0.0,
            mises: self.shear * (1.5 * square(&deviator(&b))).sqrt(),
        })
    }

    /// A response without dissipation whose energy is quadratic: of the change of volume, and of the deviator's square.
    fn response(&self, piola: Mat3, memory: &Memory, volume: f64, square: f64) -> Response {
        Response {
            piola,
            memory: *memory,
            energy: 0.5 * self.bulk * volume * volume + self.shear * square,
            dissipated: 0.0,
            released: 0.0,
            mises: 2.0 * self.shear * (1.5 * square).sqrt(),
        }
    }
}
