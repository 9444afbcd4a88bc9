//! Elastic constants of a simple cubic lattice of bonds, and micro-moduli that make one of them right.

use crate::families::{Influence, VolumeRule};
use perigrain_base::math::vec3::{Vec3, length};

/// What a lattice of microelastic bonds is, relative to the solid whose bulk modulus c = 18K/(πδ⁴) stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeConstants {
    /// Neighbours of each particle.
    pub neighbours: usize,
    /// K/K0.
    pub bulk: f64,
    /// E/E0 for a pull along a lattice axis, E0 = 1.5 K0.
    pub young: f64,
    /// Poisson's ratio of that pull.
    pub nu: f64,
    /// 2 C44/(C11 − C12): 1 where directions are alike.
    pub zener: f64,
}

/// The constants for a horizon in lattice spacings and micro-moduli of a shape: C_ijkl = ½ Σ c w |xi| n_i n_j n_k n_l V over the family.
pub fn constants(horizon: f64, rule: VolumeRule, shape: Influence) -> LatticeConstants {
    let reach = rule.reach(horizon, 1.0) * (1.0 + 1e-9);
    let edge = reach.floor() as i32;
    let (mut neighbours, mut c11, mut c12) = (0, 0.0, 0.0);
    let side = || (-edge..=edge).map(f64::from);
    for (x, y, z) in side().flat_map(|x| side().flat_map(move |y| side().map(move |z| (x, y, z)))) {
        let length = (x * x + y * y + z * z).sqrt();
        if length == 0.0 || length > reach {
            continue;
        }
        neighbours += 1;
        let c = shape.shape(length, horizon) * rule.weight(length, horizon, 1.0);
        let half = 0.5 * c * length / length.powi(4);
        c11 += half * x.powi(4);
        c12 += half * x * x * y * y;
    }
    let whole = std::f64::consts::PI * horizon.powi(4) / 18.0;
    LatticeConstants {
        neighbours,
        bulk: (c11 + 2.0 * c12) / 3.0 / whole,
        young: (c11 - c12) * (c11 + 2.0 * c12) / (c11 + c12) / (1.5 * whole),
        nu: c12 / (c11 + c12),
        zener: 2.0 * c12 / (c11 - c12),
    }
}

/// ½ Σ w |ξ_n| [length] over the vectors from a site to its partners: times the volume of a site, the share of the square of
/// volumes that bonds across a plane have for each area, n being the plane's normal. The mean over the axes along which any
/// bond leads.
pub fn crossing(vectors: impl Iterator<Item = Vec3>, horizon: f64, (rule, dx): (VolumeRule, f64)) -> f64 {
    let mut sums = [0.0; 3];
    for xi in vectors {
        let weight = 0.5 * rule.weight(length(xi), horizon, dx);
        sums.iter_mut().zip(xi).for_each(|(sum, x)| *sum += weight * x.abs());
    }
    // Sites of turned lattices lie in a plane but for rounding.
    let most = sums.iter().copied().fold(0.0, f64::max);
    let (count, sum) =
        sums.iter().filter(|s| **s > 1e-9 * most).fold((0.0, 0.0), |(n, all), s| (n + 1.0, all + s));
    sum / f64::max(count, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// πδ⁴/4 in whole balls: the sphere's ∫ |ξ_n| over half of it, which the lattice misses by few per cent at 6 spacings.
    #[test]
    fn planes_across_fine_lattices_cross_the_bonds_of_balls() {
        let edge = |rule: VolumeRule| -> f64 {
            let side = || (-7..=7).map(f64::from);
            let all = side().flat_map(|x| side().flat_map(move |y| side().map(move |z| [x, y, z])));
            let reach = rule.reach(6.0, 1.0);
            crossing(all.filter(|xi| length(*xi) > 0.0 && length(*xi) <= reach), 6.0, (rule, 1.0))
        };
        let ball = std::f64::consts::PI * 6.0f64.powi(4) / 4.0;
        assert!((edge(VolumeRule::Full) / ball - 1.0).abs() < 0.02, "{}", edge(VolumeRule::Full) / ball);
        // Nearest neighbours alone: one bond of length 1 along each axis.
        let six = [
            [1.0, 0.0, 0.0],
            [-1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, -1.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 0.0, -1.0],
        ];
        assert_eq!(crossing(six.into_iter(), 1.4, (VolumeRule::None, 1.0)), 1.0);
    }

    #[test]
    fn constants_of_the_table() {
        // test-cases.md 3a: horizon; neighbours, K/K0, E/E0, nu, Zener for no weights, LAMMPS', whole partial volumes.
        let table = [
            (
                2.0,
                [
                    (32, 0.9714, 1.081, 0.222, 0.797),
                    (32, 0.7880, 0.805, 0.245, 0.959),
                    (80, 1.1289, 1.197, 0.235, 0.887),
                ],
            ),
            (
                3.0,
                [
                    (122, 1.1208, 0.997, 0.278, 1.248),
                    (122, 0.9002, 0.833, 0.269, 1.161),
                    (178, 1.0622, 1.077, 0.246, 0.972),
                ],
            ),
            (
                3.015,
                [
                    (122, 1.0987, 0.978, 0.278, 1.248),
                    (122, 0.8896, 0.822, 0.269, 1.165),
                    (178, 1.0590, 1.075, 0.246, 0.970),
                ],
            ),
            (
                4.0,
                [
                    (256, 0.9432, 0.926, 0.254, 1.036),
                    (256, 0.8629, 0.845, 0.255, 1.042),
                    (388, 1.0266, 1.028, 0.250, 0.997),
                ],
            ),
            (
                5.0,
                [
                    (514, 0.9785, 0.951, 0.257, 1.059),
                    (514, 0.8962, 0.880, 0.255, 1.038),
                    (738, 1.0227, 1.023, 0.250, 1.000),
                ],
            ),
            (
                6.0,
                [
                    (924, 1.0298, 0.989, 0.260, 1.082),
                    (924, 0.9367, 0.916, 0.256, 1.046),
                    (1188, 1.0109, 1.015, 0.249, 0.993),
                ],
            ),
        ];
        for (m, rows) in table {
            for (rule, row) in [VolumeRule::None, VolumeRule::Lammps, VolumeRule::Full].into_iter().zip(rows)
            {
                let c = constants(m, rule, Influence::One);
                assert_eq!(c.neighbours, row.0, "{m} {rule:?}");
                // The digits printed there.
                assert!((c.bulk - row.1).abs() < 6e-5, "{m} {rule:?} {c:?}");
                for (a, b) in [(c.young, row.2), (c.nu, row.3), (c.zener, row.4)] {
                    assert!((a - b).abs() < 6e-4, "{m} {rule:?} {c:?}");
                }
            }
        }
    }
}
