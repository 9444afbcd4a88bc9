//! Stiffness tensors as 6 × 6 matrices (xx yy zz yz xz xy, engineering shears), and their moduli.

use super::six::{Matrix6, full, invert};
use perigrain_base::math::vec3::Vec3;

/// Row and column of the strain for each of the six components.
pub const VOIGT: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)];

/// The strain of one load case: 1 along an axis, or a shear with halves that add up to 1.
pub fn strain(case: usize) -> [Vec3; 3] {
    let (i, j) = VOIGT[case];
    let mut out = [[0.0; 3]; 3];
    out[i][j] += 0.5;
    out[j][i] += 0.5;
    out
}

/// Moduli of a tensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moduli {
    /// Young's modulus along x, y, z [pressure].
    pub young: Vec3,
    /// Poisson's ratio: contraction along the second axis for a load along the first.
    pub poisson: [Vec3; 3],
    /// Bulk modulus, the mean of the values for uniform strain and uniform stress [pressure].
    pub bulk: f64,
    /// Shear modulus, likewise [pressure].
    pub shear: f64,
}

impl Moduli {
    /// The moduli of a tensor; `None` if some resistance is negative, so that it is not a stiffness.
    ///
    /// For a shear or tension without resistance the modulus is zero.
    pub fn new(c: &Matrix6) -> Option<Self> {
        let found = invert(c, 0);
        if found.negative || c.iter().flatten().any(|a| !a.is_finite()) {
            return None;
        }
        let d = full(&found.inverse);
        let gone = |a: usize| found.without >> a & 1 == 1;
        // Without a pivot the compliance is infinite.
        let over = |a: f64, without: bool| if without || a <= 0.0 { 0.0 } else { 1.0 / a };
        let young = [0, 1, 2].map(|a| over(d[a][a], gone(a)));
        let poisson = [0, 1, 2].map(|a| {
            [0, 1, 2].map(|b| if a == b || young[a] == 0.0 { 0.0 } else { 0.0 - d[a][b] * young[a] })
        });
        let of = |m: &Matrix6| {
            let sum = |rows: std::ops::Range<usize>| rows.map(|a| m[a][a]).sum::<f64>();
            (sum(0..3), m[0][1] + m[0][2] + m[1][2], sum(3..6))
        };
        let ((along, beside, shears), (d_along, d_beside, d_shears)) = (of(c), of(&d));
        let bulk =
            [(along + 2.0 * beside) / 9.0, over(d_along + 2.0 * d_beside, [0, 1, 2].into_iter().any(gone))];
        let shear = [
            (along - beside + 3.0 * shears) / 15.0,
            over((4.0 * (d_along - d_beside) + 3.0 * d_shears) / 15.0, found.without != 0),
        ];
        let mean = |[a, b]: [f64; 2]| 0.5 * (a + b);
        Some(Self { young, poisson, bulk: mean(bulk), shear: mean(shear) })
    }

    /// Mean Young's modulus of the three axes [pressure].
    pub fn mean_young(&self) -> f64 {
        self.young.iter().sum::<f64>() / 3.0
    }

    /// Mean Poisson's ratio of the six pairs of axes.
    pub fn mean_poisson(&self) -> f64 {
        self.poisson.iter().flatten().sum::<f64>() / 6.0
    }
}
