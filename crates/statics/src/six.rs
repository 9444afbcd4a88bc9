//! Symmetric 6 × 6 matrices: packed as rows of the lower triangle, factorized and inverted.

/// Three displacements [length] and three rotations [rad], or three forces and three torques: one row per
/// particle.
pub type Six = [f64; 6];

/// A symmetric 6 × 6 matrix: 00, 10 11, 20 21 22 …
pub type Packed = [f64; 21];

/// A full 6 × 6 matrix.
pub type Matrix6 = [[f64; 6]; 6];

/// A pivot below this fraction of the largest one of its kind counts as zero: some motion has no resistance.
pub const PIVOT: f64 = 1e-12;

/// Index of an element in a packed matrix.
#[inline(always)]
pub fn at(row: usize, column: usize) -> usize {
    let (row, column) = if row < column { (column, row) } else { (row, column) };
    row * (row + 1) / 2 + column
}

/// The unit vector of a component.
#[inline(always)]
pub fn unit(component: usize) -> Six {
    std::array::from_fn(|c| f64::from(u8::from(c == component)))
}

/// The lower triangle of a symmetric matrix.
pub fn packed(m: &Matrix6) -> Packed {
    let mut out = [0.0; 21];
    for row in 0..6 {
        for column in 0..=row {
            out[at(row, column)] = m[row][column];
        }
    }
    out
}

/// The full matrix of a packed one.
pub fn full(m: &Packed) -> Matrix6 {
    std::array::from_fn(|row| std::array::from_fn(|column| m[at(row, column)]))
}

/// An inverse, with the rows it omits.
pub struct Inverse {
    /// Inverse of the matrix without the omitted rows and columns, in which it is zero.
    pub inverse: Packed,
    /// Rows without a pivot, one bit each.
    pub without: u8,
    /// Whether some pivot was negative: the matrix is not a stiffness.
    pub negative: bool,
}

/// Cholesky's decomposition in the form L D Lᵀ.
pub struct Factors {
    /// L, below its unit diagonal.
    pub l: Matrix6,
    /// D, zero for omitted rows.
    pub d: Six,
    /// Rows without a pivot, one bit each.
    pub without: u8,
    /// Whether some pivot was negative: the matrix is not a stiffness.
    pub negative: bool,
}

/// Factorizes a positive semidefinite matrix without the rows `held` (one bit each), and without rows that
/// vanish once the earlier ones are eliminated. Rows 0 to 2 and 3 to 5 have different units and are compared
/// among themselves.
pub fn factor(m: &Matrix6, held: u8) -> Factors {
    let largest = |rows: std::ops::Range<usize>| rows.fold(0.0, |most: f64, r| most.max(m[r][r].abs()));
    let least = [PIVOT * largest(0..3), PIVOT * largest(3..6)];
    let (mut l, mut d) = (*m, [0.0; 6]);
    let (mut without, mut negative) = (0, false);
    for k in 0..6 {
        d[k] = l[k][k];
        negative |= held >> k & 1 == 0 && d[k] < -least[k / 3];
        if held >> k & 1 == 0 && d[k] <= least[k / 3] {
            without |= 1 << k;
        }
        if (held | without) >> k & 1 != 0 {
            d[k] = 0.0;
            for r in k + 1..6 {
                l[r][k] = 0.0;
            }
            continue;
        }
        for r in k + 1..6 {
            let factor = l[r][k] / d[k];
            for c in k + 1..=r {
                l[r][c] -= factor * l[c][k];
            }
        }
        // Only now: the loop above needs the old values of the column.
        for r in k + 1..6 {
            l[r][k] /= d[k];
        }
    }
    Factors { l, d, without, negative }
}

/// The inverse of a positive semidefinite matrix without the rows that [`factor`] omits, column by column.
pub fn invert(m: &Matrix6, held: u8) -> Inverse {
    let Factors { l, d, without, negative } = factor(m, held);
    let mut out = Inverse { inverse: [0.0; 21], without, negative };
    for column in (0..6).filter(|c| d[*c] != 0.0) {
        let mut v = [0.0; 6];
        v[column] = 1.0;
        for row in 0..6 {
            for c in 0..row {
                v[row] -= l[row][c] * v[c];
            }
        }
        for row in (0..6).rev() {
            v[row] = if d[row] == 0.0 { 0.0 } else { v[row] / d[row] };
            for r in row + 1..6 {
                v[row] -= l[r][row] * v[r];
            }
            if d[row] == 0.0 {
                v[row] = 0.0;
            }
        }
        for row in column..6 {
            out.inverse[at(row, column)] = v[row];
        }
    }
    out
}

/// The largest eigenvalue of a symmetric matrix, by Jacobi's rotations.
pub fn largest(m: &Matrix6) -> f64 {
    let mut a = *m;
    // Sweeps converge quadratically: four or five are enough.
    for _ in 0..20 {
        let beside: f64 =
            (0..6).flat_map(|r| (0..r).map(move |c| (r, c))).map(|(r, c)| a[r][c] * a[r][c]).sum();
        let size: f64 = (0..6).map(|k| a[k][k] * a[k][k]).sum();
        if beside <= 1e-30 * size {
            break;
        }
        for (p, q) in (1..6).flat_map(|q| (0..q).map(move |p| (p, q))) {
            rotate(&mut a, p, q);
        }
    }
    (0..6).fold(f64::NEG_INFINITY, |most, k| most.max(a[k][k]))
}

/// Rotates rows and columns p and q so that their common element vanishes.
fn rotate(a: &mut Matrix6, p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for row in a.iter_mut() {
        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
    }
    for k in 0..6 {
        (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A Aᵀ + 1 for a matrix of small integers: positive definite, with condition number about 100.
    fn positive() -> Matrix6 {
        let a: Matrix6 =
            std::array::from_fn(|r| std::array::from_fn(|c| ((3 * r + 5 * c * c) % 7) as f64 - 3.0));
        std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                (0..6).map(|k| a[r][k] * a[c][k]).sum::<f64>() + f64::from(u8::from(r == c))
            })
        })
    }

    /// m v.
    fn times(m: &Packed, v: &Six) -> Six {
        std::array::from_fn(|row| (0..6).map(|c| m[at(row, c)] * v[c]).sum())
    }

    #[test]
    fn inverse_times_matrix_is_one() {
        let m = positive();
        let found = invert(&m, 0);
        assert!(found.without == 0 && !found.negative);
        for c in 0..6 {
            let column = times(&found.inverse, &std::array::from_fn(|r| m[r][c]));
            for r in 0..6 {
                // Rounding times condition number.
                assert!((column[r] - f64::from(u8::from(r == c))).abs() < 1e-12, "{column:?}");
            }
        }
        assert_eq!(full(&packed(&m)), m);
    }

    #[test]
    fn held_rows_are_left_out() {
        let m = positive();
        let found = full(&invert(&m, 0b010010).inverse);
        let mut without = m;
        for k in [1, 4] {
            for other in 0..6 {
                (without[k][other], without[other][k]) = (0.0, 0.0);
            }
            without[k][k] = 1.0;
        }
        let wanted = full(&invert(&without, 0).inverse);
        for (r, c) in (0..36).map(|k| (k / 6, k % 6)) {
            let wanted = if [1, 4].contains(&r) || [1, 4].contains(&c) { 0.0 } else { wanted[r][c] };
            assert!((found[r][c] - wanted).abs() < 1e-12);
        }
    }

    #[test]
    fn motions_without_resistance_are_reported() {
        // n nᵀ resists along n alone: of three pivots two are missing; no rotation resists.
        let n = [0.6, 0.48, 0.64];
        let m: Matrix6 = std::array::from_fn(|r| {
            std::array::from_fn(|c| if r < 3 && c < 3 { 1e7 * n[r] * n[c] } else { 0.0 })
        });
        let found = invert(&m, 0);
        assert_eq!(found.without, 0b111110);
        assert!((found.inverse[0] - 1.0 / (1e7 * 0.36)).abs() < 1e-20 && !found.negative);
        assert!(invert(&m.map(|row| row.map(|a| -a)), 0).negative);
    }

    #[test]
    fn the_largest_eigenvalue_is_found() {
        // A rotation of the diagonal 1 … 6 about (1, 1, 1, 1, 1, 1)/√6: H = 1 − 2 n nᵀ.
        let h: Matrix6 =
            std::array::from_fn(|r| std::array::from_fn(|c| f64::from(u8::from(r == c)) - 1.0 / 3.0));
        let m: Matrix6 = std::array::from_fn(|r| {
            std::array::from_fn(|c| (0..6).map(|k| h[r][k] * (k as f64 + 1.0) * h[k][c]).sum())
        });
        assert!((largest(&m) - 6.0).abs() < 1e-13);
        assert_eq!(largest(&[[0.0; 6]; 6]), 0.0);
        // One block of a bond: s, and s h² + k, coupled by s h.
        let mut m = [[0.0; 6]; 6];
        (m[1][1], m[5][5], m[1][5], m[5][1]) = (2.0, 3.0, 1.0, 1.0);
        assert!((largest(&m) - (2.5 + 1.25f64.sqrt())).abs() < 1e-14);
    }
}
