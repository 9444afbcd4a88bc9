//! Laws against closed forms and against properties that every law has.

mod damage;
mod elastic;
mod functions;
mod plastic;
mod pressure;
mod properties;
mod sheet;

use crate::{Elastic, Hardening, Law, Mat3, Material, Memory, Moment, Response, Sym3};
use perigrain_base::math::scatter::uniform;

/// An advancing step without rates.
const STEP: Moment = Moment { dt: 0.0, temperature: None, spacing: 1.0, advance: true };

const UNIT: Mat3 = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A material of Hencky elasticity with Mises flow.
fn mises(young: f64, nu: f64, hardening: Hardening) -> Material {
    Material { elastic: Elastic::from_young(young, nu), law: flowing(hardening) }
}

/// Mises flow without damage.
fn flowing(hardening: Hardening) -> Law {
    Law::Plastic { flow: crate::Flow::Mises(hardening), damage: None }
}

/// A B.
fn times(a: &Mat3, b: &Mat3) -> Mat3 {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

/// Aᵀ.
fn transposed(a: &Mat3) -> Mat3 {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// Kirchhoff stress τ = P Fᵀ.
fn kirchhoff(r: &Response, f: &Mat3) -> Mat3 {
    times(&r.piola, &transposed(f))
}

/// Rotation by an angle about an axis (Rodrigues).
fn rotation(axis: [f64; 3], angle: f64) -> Mat3 {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|a| a / length);
    let (s, c) = angle.sin_cos();
    let w = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let w2 = times(&w, &w);
    std::array::from_fn(|i| std::array::from_fn(|j| UNIT[i][j] + s * w[i][j] + (1.0 - c) * w2[i][j]))
}

/// Entries between −1 and 1.
fn random(seed: u64) -> Mat3 {
    std::array::from_fn(|i| std::array::from_fn(|j| 2.0 * uniform(seed, (3 * i + j) as u64) - 1.0))
}

/// 1 + size · random.
fn near_unit(seed: u64, size: f64) -> Mat3 {
    let r = random(seed);
    std::array::from_fn(|i| std::array::from_fn(|j| UNIT[i][j] + size * r[i][j]))
}

/// Largest entry of a − b.
fn apart(a: &Mat3, b: &Mat3) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// F of simple shear.
fn shear(gamma: f64) -> Mat3 {
    [[1.0, gamma, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
}

/// Stretches along the axes.
fn stretches(s: [f64; 3]) -> Mat3 {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { s[i] } else { 0.0 }))
}

/// The stretch across a bar of this axial logarithmic strain with which its sides carry no stress: bisection.
fn free_sides(axial: f64, stress: impl Fn([f64; 3]) -> [[f64; 3]; 3]) -> [f64; 3] {
    let (mut low, mut high) = (-1.5 * axial.abs(), 1.5 * axial.abs());
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        let s = [axial.exp(), middle.exp(), middle.exp()];
        match stress(s)[1][1] < 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    let across = (0.5 * (low + high)).exp();
    [axial.exp(), across, across]
}

fn determinant(s: &Sym3) -> f64 {
    crate::tensor::determinant(s)
}
