//! Logarithm and exponential of tensors.

use super::*;
use crate::spectral::{exponential, half_logarithm, principal};
use crate::tensor::{carried, plus, scaled};

/// Tensors of these principal values in random axes.
fn turned(values: [f64; 3], seed: u64) -> Sym3 {
    let q = rotation(random(seed)[0], 3.0 * random(seed)[1][0]);
    carried(&q, &[values[0], values[1], values[2], 0.0, 0.0, 0.0])
}

/// Principal values: apart, equal, nearly equal, large and tiny.
const VALUES: [[f64; 3]; 14] = [
    [0.3, 0.1, -0.2],
    [0.3, 0.3, -0.2],
    [0.3, -0.2, -0.2],
    [0.3, 0.3 - 1e-9, -0.2],
    [0.3, -0.2 + 1e-14, -0.2],
    [0.1, 0.1, 0.1],
    [1e-3, 1e-3 - 1e-12, 1e-3 - 3e-12],
    [40.0, 1e-3, -0.9],
    [1e-9, 0.0, -1e-9],
    [0.0, 0.0, 0.0],
    // Series: the edge of their range, and a large change of volume.
    [0.07, 0.02, -0.024],
    [0.07, 0.02, -0.026],
    [9.3, 9.0, 8.8],
    [-0.9, -0.902, -0.904],
];

#[test]
fn logarithms_are_those_of_principal_values_also_where_these_agree() {
    for (k, values) in VALUES.into_iter().enumerate() {
        for seed in 0..50 {
            let log = half_logarithm(&turned(values, seed)).unwrap();
            let expected = turned(values.map(|x| 0.5 * x.ln_1p()), seed);
            // Rounding of A, times the largest slope 1/(1 + least) of the logarithm.
            let size = values.iter().fold(0f64, |a, x| a.max(x.abs())) / (1.0 + values[2]);
            for (a, b) in log.iter().zip(&expected) {
                assert!((a - b).abs() <= 8.0 * f64::EPSILON * size, "{k} {seed}: {log:?} {expected:?}");
            }
        }
    }
}

#[test]
fn exponentials_undo_logarithms() {
    for (k, values) in VALUES.into_iter().enumerate() {
        for seed in 0..50 {
            let a = turned(values, seed);
            let log = half_logarithm(&a).unwrap();
            let back = exponential(&scaled(&log, 2.0));
            // Rounding of the logarithm, times the slope of the exponential.
            let most = 1.0 + values[0];
            for (x, y) in back.iter().zip(&plus(&a, 1.0)) {
                assert!((x - y).abs() <= 16.0 * f64::EPSILON * most / (1.0 + values[2]), "{k} {seed}");
            }
        }
    }
}

#[test]
fn principal_values_of_a_diagonal_are_its_entries() {
    assert_eq!(principal(&[2.0, 2.0, 2.0, 0.0, 0.0, 0.0]), [2.0; 3]);
    for (found, expected) in principal(&[1.0, 3.0, 2.0, 0.0, 0.0, 0.0]).into_iter().zip([3.0, 2.0, 1.0]) {
        // A few roundings of numbers about 3.
        assert!((found - expected).abs() < 2e-15);
    }
    assert!(half_logarithm(&[-1.0, 0.0, 0.0, 0.0, 0.0, 0.0]).is_none());
}
