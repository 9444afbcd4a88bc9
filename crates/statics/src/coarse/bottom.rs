//! Direct solution on the coarsest level.

use super::matrix::Matrix;
use crate::six::Six;

/// L D Lᵀ of a dense positive semidefinite matrix.
pub struct Bottom {
    /// L below its diagonal, row by row.
    l: Vec<f64>,
    /// 1/D, zero for components without resistance.
    over: Vec<f64>,
    /// Motions without resistance, orthonormal with respect to `weights`.
    idle: Vec<Vec<f64>>,
    /// Per row: the number of particles, times the square of a length for rotations.
    weights: Vec<f64>,
}

/// A row of which less than this fraction is left after elimination has no resistance.
const NOTHING: f64 = 1e-10;

impl Bottom {
    /// For a matrix between clusters with these numbers of particles; `arm` is the length that scales
    /// rotations relative to displacements [length].
    pub fn new(matrix: &Matrix, particles: &[f64], arm: f64) -> Self {
        let n = 6 * matrix.rows();
        let mut a = vec![0.0; n * n];
        for ([i, j], block) in matrix.blocks() {
            // By columns, which are the rows of the transpose.
            for (c, column) in block.iter().enumerate() {
                a[(6 * j + c) * n + 6 * i..][..6].copy_from_slice(column);
            }
        }
        let weight = |k: usize| particles[k / 6] * if k % 6 < 3 { 1.0 } else { arm * arm };
        Self::of((0..n).map(weight).collect(), a)
    }

    /// From n × n numbers; those above the diagonal are not used.
    fn of(weights: Vec<f64>, mut l: Vec<f64>) -> Self {
        let n = weights.len();
        let mut over = vec![0.0; n];
        for k in 0..n {
            let (before, row) = l.split_at_mut(k * n);
            let whole = row[k];
            // L D of this row, column by column; division by D gives L.
            for c in 0..k {
                row[c] -= inner(&row[..c], &before[c * n..][..c]);
            }
            let mut left = whole;
            for c in 0..k {
                let times_d = row[c];
                row[c] *= over[c];
                left -= row[c] * times_d;
            }
            over[k] = if left > NOTHING * whole { 1.0 / left } else { 0.0 };
        }
        let mut out = Self { l, over, idle: vec![], weights };
        for k in (0..n).filter(|k| out.over[*k] == 0.0) {
            // L D Lᵀ x = 0 for Lᵀ x = 1 in a row without D.
            let mut x = vec![0.0; n];
            x[k] = 1.0;
            out.back(&mut x);
            for idle in &out.idle {
                let part = out.along(idle, &x);
                take(&mut x, part, idle);
            }
            let length = out.along(&x, &x).sqrt();
            out.idle.push(x.iter().map(|x| x / length).collect());
        }
        out
    }

    /// a·W b.
    fn along(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.weights).map(|((a, b), w)| a * w * b).sum()
    }

    /// x = L⁻ᵀ x.
    fn back(&self, x: &mut [f64]) {
        let n = self.over.len();
        for k in (0..n).rev() {
            let (before, from) = x.split_at_mut(k);
            take(before, from[0], &self.l[k * n..][..k]);
        }
    }

    /// Q A⁻¹ Qᵀ r, without motions that have no resistance (Q = 1 − N Nᵀ W): they would not change the
    /// energy, but the body would rotate.
    pub fn solve(&self, r: &[Six]) -> Vec<Six> {
        let mut x: Vec<f64> = r.iter().flatten().copied().collect();
        for idle in &self.idle {
            let part = inner(idle, &x);
            x.iter_mut().zip(idle).zip(&self.weights).for_each(|((x, idle), w)| *x -= part * w * idle);
        }
        let n = self.over.len();
        for k in 0..n {
            x[k] -= inner(&self.l[k * n..][..k], &x[..k]);
            if self.over[k] == 0.0 {
                x[k] = 0.0;
            }
        }
        x.iter_mut().zip(&self.over).for_each(|(x, over)| *x *= over);
        self.back(&mut x);
        for idle in &self.idle {
            let part = self.along(idle, &x);
            take(&mut x, part, idle);
        }
        x.chunks_exact(6).map(|row| std::array::from_fn(|c| row[c])).collect()
    }
}

/// x −= part · a.
fn take(x: &mut [f64], part: f64, a: &[f64]) {
    x.iter_mut().zip(a).for_each(|(x, a)| *x -= part * a);
}

/// Eight sums at a time: one alone would wait for each addition, four times as long.
fn inner(a: &[f64], b: &[f64]) -> f64 {
    let ((a, rest), (b, last)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        (0..8).for_each(|k| sums[k] += a[k] * b[k]);
    }
    let tail: f64 = rest.iter().zip(last).map(|(a, b)| a * b).sum();
    let [p, q, r, s, t, u, v, w] = sums;
    ((p + q) + (r + s)) + ((t + u) + (v + w)) + tail
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::six::unit;

    /// Two nodes with a spring of 3 between their x, and 2 to the ground at y of the first: ten motions are
    /// free (x of both together, y of the second, z and rotations).
    #[test]
    fn what_is_free_is_left_alone() {
        let mut a = vec![0.0; 144];
        for (i, j, k) in [(0, 0, 3.0), (6, 6, 3.0), (0, 6, -3.0), (6, 0, -3.0), (1, 1, 2.0)] {
            a[12 * i + j] = k;
        }
        // The second node is three times as heavy; 0.5 is the square of a length.
        let weights = (0..12).map(|k| [1.0, 3.0][k / 6] * if k % 6 < 3 { 1.0 } else { 0.5 }).collect();
        let bottom = Bottom::of(weights, a);
        assert_eq!(bottom.idle.len(), 10);
        let apart = bottom.solve(&[unit(0).map(|a| -a), unit(0)]);
        // 1/3 apart, with the centre of mass unchanged.
        assert!((apart[0][0] + 0.25).abs() < 1e-15 && (apart[1][0] - 1.0 / 12.0).abs() < 1e-15, "{apart:?}");
        assert!((bottom.solve(&[unit(1), [0.0; 6]])[0][1] - 0.5).abs() < 1e-15);
        // A force on both moves nothing, because it is not in equilibrium; nor does a torque without
        // resistance.
        for load in [[unit(0), unit(0).map(|a| 3.0 * a)], [unit(4), [0.0; 6]]] {
            assert!(bottom.solve(&load).iter().flatten().all(|x| x.abs() < 1e-15));
        }
    }
}
