//! The largest eigenvalue of a symmetric matrix given by its products, by Lanczos' method.

use super::rng::ParkMiller;
use crate::par;

/// Maximum number of products.
const MOST: usize = 300;
/// The search ends when ten more vectors raise the eigenvalue by less than this fraction: on lattices the
/// error is then below 5e-4.
const SETTLED: f64 = 1e-4;

/// The largest eigenvalue of the matrix whose product with a vector of `n` rows of N numbers is `times`: a
/// lower bound, with a relative accuracy of about 5e-4. It includes power iteration and is never worse.
/// `rounding`: relative error of `times`. `None` if the eigenvalue is not positive.
pub fn largest_eigenvalue<const N: usize>(
    n: usize,
    rounding: f64,
    mut times: impl FnMut(&[[f64; N]]) -> Vec<[f64; N]>,
) -> Option<f64> {
    let mut stream = ParkMiller::new(12345);
    let mut q: Vec<[f64; N]> = (0..n).map(|_| [0; N].map(|_| stream.uniform() - 0.5)).collect();
    normalize(&mut q);
    let mut before = vec![[0.0; N]; n];
    let (mut diagonal, mut beside, mut tops) = (vec![], Vec::<f64>::new(), Vec::<f64>::new());
    for _ in 0..MOST {
        let mut next = times(&q);
        let along = dot(&next, &q);
        let back = beside.last().copied().unwrap_or(0.0);
        combine(&mut next, &q, -along);
        combine(&mut next, &before, -back);
        diagonal.push(along);
        let top = largest(&diagonal, &beside);
        tops.push(top);
        let settled = tops.len() > 20 && top - tops[tops.len() - 11] < SETTLED * top;
        let size = normalize(&mut next);
        // Beyond this the space is exhausted: the rest is the error of the products.
        if settled || size <= rounding * top.abs() {
            break;
        }
        beside.push(size);
        before = std::mem::replace(&mut q, next);
    }
    tops.last().copied().filter(|top| *top > 0.0)
}

/// a · b, the same bits for any number of threads.
pub fn dot<const N: usize>(a: &[[f64; N]], b: &[[f64; N]]) -> f64 {
    par::sum(a.len(), |i| (1..N).fold(a[i][0] * b[i][0], |sum, d| sum + a[i][d] * b[i][d]))
}

/// a + s b.
fn combine<const N: usize>(a: &mut [[f64; N]], b: &[[f64; N]], s: f64) {
    a.iter_mut().zip(b).for_each(|(a, b)| (0..N).for_each(|d| a[d] += s * b[d]));
}

/// Normalizes a vector; returns its previous length.
fn normalize<const N: usize>(a: &mut [[f64; N]]) -> f64 {
    let size = dot(a, a).sqrt();
    if size > 0.0 {
        a.iter_mut().flatten().for_each(|x| *x /= size);
    }
    size
}

/// The largest eigenvalue of a symmetric tridiagonal matrix, by bisection on the signs of its minors.
fn largest(diagonal: &[f64], beside: &[f64]) -> f64 {
    let n = diagonal.len();
    let at = |k: usize| beside.get(k).map_or(0.0, |b| b.abs());
    let reach = |k: usize| at(k) + if k > 0 { at(k - 1) } else { 0.0 };
    let mut low = diagonal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut high = (0..n).map(|k| diagonal[k] + reach(k)).fold(f64::NEG_INFINITY, f64::max);
    let all_below = |x: f64| {
        let mut minor = diagonal[0] - x;
        (1..n).all(|k| {
            let below = minor < 0.0;
            minor = diagonal[k] - x - at(k - 1) * at(k - 1) / minor;
            below
        }) && minor < 0.0
    };
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if all_below(middle) { high = middle } else { low = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    // Frequencies of lattices are compared with Bloch waves in crates/peri/tests/families/limits.rs.
    #[test]
    fn the_top_of_a_chain() {
        // −1 2 −1: eigenvalues 2 − 2 cos(kπ/(n+1)).
        let top = largest(&[2.0; 9], &[1.0; 8]);
        assert!((top - (2.0 + 2.0 * (PI / 10.0).cos())).abs() < 1e-12, "{top}");
        assert_eq!(largest(&[3.0], &[]), 3.0);
        let chain = |q: &[[f64; 1]]| -> Vec<[f64; 1]> {
            let at = |k: usize| q.get(k).map_or(0.0, |q| q[0]);
            (0..q.len()).map(|k| [2.0 * at(k) - at(k + 1) - at(k.wrapping_sub(1))]).collect()
        };
        let found = largest_eigenvalue(9, 1e-12, chain).unwrap();
        // Nine vectors exhaust the space.
        assert!((found - top).abs() < 1e-12, "{found}");
    }
}
