//! Correspondence measures: deformation gradient, strain and stress of a particle from its living bonds.

use crate::families::{Families, PeriView};
use perigrain_base::math::vec3::{length, sub};

/// A tensor, row by row.
pub type Tensor = [[f64; 3]; 3];

/// Determinants of the shape tensor below this share of its mean eigenvalue cubed count as zero: bonds then lie in a
/// plane or on a line up to rounding.
const FLAT: f64 = 1e-10;

impl Families {
    /// The deformation gradient of a particle, F = (Σ ω w Y⊗ξ V_j) K⁻¹ with the shape tensor K = Σ ω w ξ⊗ξ V_j over
    /// the living bonds (Silling et al. 2007; Hartmann et al. 2023, Eq. 26 and 27). A family that lies and stays in a plane of constant z
    /// is not strained across it. `None` without three, or in such a plane two, bonds in independent directions.
    pub fn gradient(&self, view: &PeriView, i: usize) -> Option<Tensor> {
        let (mut shape, mut moved) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        self.each(i, |n| {
            let j = n.partner as usize;
            let Some(pair) = self.table.get(view.kind[i], view.kind[j]).filter(|_| n.alive) else { return };
            let (xi, y) = (self.first_bond(view, i, j), view.bounds.nearest(sub(view.x[j], view.x[i])));
            let length = length(xi);
            let volume = self.weight_of(&n, length, pair.horizon);
            let share = self.law.influence.of(length, pair.horizon) * volume * view.volume[j];
            for a in 0..3 {
                for b in 0..3 {
                    shape[a][b] += share * xi[a] * xi[b];
                    moved[a][b] += share * y[a] * xi[b];
                }
            }
        });
        if flat(&shape) && moved[2] == [0.0; 3] {
            (shape[2][2], moved[2][2]) = (shape[0][0], shape[0][0]);
        }
        let inverse = inverse(&shape)?;
        Some([0, 1, 2].map(|a| [0, 1, 2].map(|b| (0..3).map(|k| moved[a][k] * inverse[k][b]).sum())))
    }
}

/// Families whose shape tensor has less than this share of the least eigenvalue of the whole family's are torn: F then is what a few
/// bonds about a hinge say.
pub(crate) const HINGE: f64 = 0.05;

/// Shape tensors of a family.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shapes {
    /// Of the bonds that live.
    pub(crate) left: Tensor,
    /// Of all bonds.
    pub(crate) whole: Tensor,
    /// Whether any is broken.
    pub(crate) broken: bool,
}

impl Families {
    /// Whether so much of a particle's family is broken that what is left is a mechanism: more than `most` of its volume, or in some
    /// direction nearly all. F of such a family measures how its hinges turn, not how a solid is strained.
    pub fn torn(&self, view: &PeriView, i: usize, most: f64) -> bool {
        if !self.damaged.get(i).copied().unwrap_or(false) {
            return false;
        }
        let Shapes { mut left, mut whole, broken } = self.shapes(view, i);
        if flat(&whole) {
            // No mechanism is to be found across the plane.
            let most = whole[0][0] + whole[1][1];
            (left[2][2], whole[2][2]) = (most, most);
        }
        broken
            && (self.damage(i, view.volume) > most
                || least_eigenvalue(&left) < HINGE * least_eigenvalue(&whole))
    }

    /// The shape tensors of a particle's family.
    pub(crate) fn shapes(&self, view: &PeriView, i: usize) -> Shapes {
        let Shapes { mut left, mut whole, mut broken } = Shapes::default();
        self.each(i, |n| {
            let j = n.partner as usize;
            let Some(pair) = self.table.get(view.kind[i], view.kind[j]) else { return };
            let xi = self.first_bond(view, i, j);
            let length = length(xi);
            let volume = self.weight_of(&n, length, pair.horizon);
            let share = self.law.influence.of(length, pair.horizon) * volume * view.volume[j];
            broken |= !n.alive;
            for (a, b) in (0..3).flat_map(|a| (0..3).map(move |b| (a, b))) {
                let term = share * xi[a] * xi[b];
                whole[a][b] += term;
                left[a][b] += if n.alive { term } else { 0.0 };
            }
        });
        Shapes { left, whole, broken }
    }
}

/// Whether no bond of a shape tensor leaves a plane of constant z.
fn flat(shape: &Tensor) -> bool {
    shape[2][2] == 0.0 && shape[0][0] > 0.0
}

/// The least eigenvalue of a symmetric tensor (Smith, Comm. ACM 4 (1961) 168).
pub(crate) fn least_eigenvalue(t: &Tensor) -> f64 {
    let mean = (t[0][0] + t[1][1] + t[2][2]) / 3.0;
    let off = t[0][1] * t[0][1] + t[0][2] * t[0][2] + t[1][2] * t[1][2];
    let square = (0..3).map(|k| (t[k][k] - mean).powi(2)).sum::<f64>() + 2.0 * off;
    let size = (square / 6.0).sqrt();
    if size == 0.0 {
        return mean;
    }
    let unit = [0, 1, 2].map(|a| [0, 1, 2].map(|b| (t[a][b] - if a == b { mean } else { 0.0 }) / size));
    let angle = (0.5 * determinant(&unit)).clamp(-1.0, 1.0).acos() / 3.0;
    mean + 2.0 * size * (angle + 2.0 * std::f64::consts::PI / 3.0).cos()
}

/// The inverse of a tensor whose eigenvalues are not negative; `None` if one of them vanishes.
pub(crate) fn inverse(t: &Tensor) -> Option<Tensor> {
    let mean = (t[0][0] + t[1][1] + t[2][2]) / 3.0;
    let whole = determinant(t);
    if whole.is_nan() || whole <= FLAT * mean.powi(3) {
        return None;
    }
    Some([0, 1, 2].map(|a| {
        [0, 1, 2].map(|b| {
            let (p, q, r, s) = ((b + 1) % 3, (b + 2) % 3, (a + 1) % 3, (a + 2) % 3);
            (t[p][r] * t[q][s] - t[p][s] * t[q][r]) / whole
        })
    }))
}

/// det.
pub fn determinant(t: &Tensor) -> f64 {
    t[0][0] * (t[1][1] * t[2][2] - t[1][2] * t[2][1]) - t[0][1] * (t[1][0] * t[2][2] - t[1][2] * t[2][0])
        + t[0][2] * (t[1][0] * t[2][1] - t[1][1] * t[2][0])
}

/// The Green–Lagrange strain ½(FᵀF − 1): xx yy zz xy xz yz.
pub fn green_lagrange(f: &Tensor) -> [f64; 6] {
    let of = |a: usize, b: usize| {
        let unit = if a == b { 1.0 } else { 0.0 };
        0.5 * ((0..3).map(|k| f[k][a] * f[k][b]).sum::<f64>() - unit)
    };
    [of(0, 0), of(1, 1), of(2, 2), of(0, 1), of(0, 2), of(1, 2)]
}

/// The Cauchy stress of a compressible Neo-Hooke solid, σ = (G/J)(FFᵀ − 1) + (λ/2J)(J² − 1)1 with λ = K − 2G/3
/// (Hartmann et al. 2023, Eq. 28 to 30): xx yy zz xy xz yz. `None` where J is not positive.
pub fn neo_hooke(f: &Tensor, bulk: f64, shear: f64) -> Option<[f64; 6]> {
    let j = determinant(f);
    if j.is_nan() || j <= 0.0 {
        return None;
    }
    let lambda = bulk - 2.0 * shear / 3.0;
    let pressure = 0.5 * lambda / j * (j * j - 1.0);
    let of = |a: usize, b: usize| {
        let left = (0..3).map(|k| f[a][k] * f[b][k]).sum::<f64>();
        if a == b { shear / j * (left - 1.0) + pressure } else { shear / j * left }
    };
    Some([of(0, 0), of(1, 1), of(2, 2), of(0, 1), of(0, 2), of(1, 2)])
}

/// Von Mises' equivalent stress of xx yy zz xy xz yz.
pub fn von_mises(s: &[f64; 6]) -> f64 {
    let square = |a: f64| a * a;
    let normal = square(s[0] - s[1]) + square(s[1] - s[2]) + square(s[2] - s[0]);
    (0.5 * normal + 3.0 * (square(s[3]) + square(s[4]) + square(s[5]))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_eigenvalue() {
        // diag(1, 2, 5) turned by 0.3 about z and then 0.8 about x, and tensors with equal ones.
        let turn = |t: &Tensor, a: usize, b: usize, by: f64| {
            let mut r = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            (r[a][a], r[b][b], r[a][b], r[b][a]) = (by.cos(), by.cos(), -by.sin(), by.sin());
            let times = |a: &Tensor, b: &Tensor, back: bool| -> Tensor {
                let of = |i: usize, j: usize, k: usize| a[i][k] * if back { b[j][k] } else { b[k][j] };
                [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| of(i, j, k)).sum()))
            };
            times(&times(&r, t, false), &r, true)
        };
        let t = turn(&turn(&[[5.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 2.0]], 0, 1, 0.3), 1, 2, 0.8);
        assert!((least_eigenvalue(&t) - 1.0).abs() < 1e-14);
        assert_eq!(least_eigenvalue(&[[3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]]), 3.0);
        // One direction alone: the others have none. An arc cosine near 1 keeps half of the digits.
        assert!(least_eigenvalue(&[[4.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]).abs() < 1e-7);
    }

    #[test]
    fn closed_forms_of_the_neo_hooke_solid() {
        // physics.md 3.1 and 4.8: incompressible compression to λ = √(1 − 2·0.134) has σ_vM = G |λ² − 1/λ| = 0.4368 G.
        let k = 0.732f64.sqrt();
        let side = k.powf(-0.5);
        let f = [[side, 0.0, 0.0], [0.0, side, 0.0], [0.0, 0.0, k]];
        let stress = neo_hooke(&f, 50.0, 1.0).unwrap();
        assert!((von_mises(&stress) - (1.0 / k - k * k)).abs() < 1e-14);
        assert!((von_mises(&stress) - 0.4368).abs() < 5e-5);
        // Simple shear: E_xy = γ/2, σ_xy = Gγ.
        let f = [[1.0, 0.3, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert_eq!(green_lagrange(&f)[3], 0.15);
        assert!((neo_hooke(&f, 7.0, 2.0).unwrap()[3] - 0.6).abs() < 1e-15);
        // A tiny strain: Hooke's law with K = 7, G = 2, λ = 17/3.
        let e = 1e-7;
        let f = [[1.0 + e, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let stress = neo_hooke(&f, 7.0, 2.0).unwrap();
        // Second order in e, and rounding of 1e-16 over 1e-7.
        assert!(
            (stress[0] / e - (7.0 + 8.0 / 3.0)).abs() < 1e-5 && (stress[1] / e - 17.0 / 3.0).abs() < 1e-5
        );
        assert!(neo_hooke(&[[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], 1.0, 1.0).is_none());
    }
}
