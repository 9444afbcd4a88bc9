//! Algebra of 3×3 matrices and of symmetric tensors.

/// A matrix by rows.
pub type Mat3 = [[f64; 3]; 3];

/// A symmetric tensor: xx yy zz yz xz xy.
pub type Sym3 = [f64; 6];

/// The unit tensor.
pub const UNIT: Sym3 = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0];

/// Where the entries of a matrix stand in a symmetric tensor.
const PLACE: [[usize; 3]; 3] = [[0, 5, 4], [5, 1, 3], [4, 3, 2]];

/// Whether no entry is infinite or no number.
#[inline(always)]
pub fn is_finite(a: &Mat3) -> bool {
    a.iter().flatten().all(|x| x.is_finite())
}

/// det A and A⁻ᵀ: cofactors over the determinant. For det A = 0 the matrix is not finite.
#[inline(always)]
pub fn inverse_transposed(a: &Mat3) -> (f64, Mat3) {
    let cofactor = |i: usize, j: usize| {
        let ([p, q], [r, s]) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
        a[p][r] * a[q][s] - a[p][s] * a[q][r]
    };
    let c: Mat3 = std::array::from_fn(|i| std::array::from_fn(|j| cofactor(i, j)));
    let determinant = a[0][0] * c[0][0] + a[0][1] * c[0][1] + a[0][2] * c[0][2];
    let inverse = 1.0 / determinant;
    (determinant, c.map(|row| row.map(|x| x * inverse)))
}

/// A S Aᵀ.
#[inline(always)]
pub fn carried(a: &Mat3, s: &Sym3) -> Sym3 {
    let rows = product(a, s);
    let entry = |i: usize, j: usize| (0..3).map(|k| rows[i][k] * a[j][k]).sum();
    [entry(0, 0), entry(1, 1), entry(2, 2), entry(1, 2), entry(0, 2), entry(0, 1)]
}

/// Aᵀ S A.
#[inline(always)]
pub fn carried_back(a: &Mat3, s: &Sym3) -> Sym3 {
    carried(&std::array::from_fn(|i| std::array::from_fn(|j| a[j][i])), s)
}

/// A S.
#[inline(always)]
pub fn product(a: &Mat3, s: &Sym3) -> Mat3 {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * s[PLACE[k][j]]).sum()))
}

/// S A.
#[inline(always)]
pub fn product_left(s: &Sym3, a: &Mat3) -> Mat3 {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| s[PLACE[i][k]] * a[k][j]).sum()))
}

/// ½(A + Aᵀ) − c 1.
#[inline(always)]
pub fn symmetric_minus(a: &Mat3, c: f64) -> Sym3 {
    let mean = |i: usize, j: usize| 0.5 * (a[i][j] + a[j][i]);
    [a[0][0] - c, a[1][1] - c, a[2][2] - c, mean(1, 2), mean(0, 2), mean(0, 1)]
}

/// The symmetric tensor as a matrix.
#[inline(always)]
pub fn matrix(s: &Sym3) -> Mat3 {
    PLACE.map(|row| row.map(|k| s[k]))
}

/// tr S.
#[inline(always)]
pub fn trace(s: &Sym3) -> f64 {
    s[0] + s[1] + s[2]
}

/// S + c 1.
#[inline(always)]
pub fn plus(s: &Sym3, c: f64) -> Sym3 {
    [s[0] + c, s[1] + c, s[2] + c, s[3], s[4], s[5]]
}

/// c S.
#[inline(always)]
pub fn scaled(s: &Sym3, c: f64) -> Sym3 {
    s.map(|x| c * x)
}

/// dev S = S − ⅓ tr S.
#[inline(always)]
pub fn deviator(s: &Sym3) -> Sym3 {
    plus(s, -trace(s) / 3.0)
}

/// S:S.
#[inline(always)]
pub fn square(s: &Sym3) -> f64 {
    s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])
}

/// det S.
#[inline(always)]
pub fn determinant(s: &Sym3) -> f64 {
    let [xx, yy, zz, yz, xz, xy] = *s;
    xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
}

/// S S.
#[inline(always)]
pub fn squared(s: &Sym3) -> Sym3 {
    let [xx, yy, zz, yz, xz, xy] = *s;
    [
        xx * xx + xy * xy + xz * xz,
        xy * xy + yy * yy + yz * yz,
        xz * xz + yz * yz + zz * zz,
        xy * xz + yy * yz + yz * zz,
        xx * xz + xy * yz + xz * zz,
        xx * xy + xy * yy + xz * yz,
    ]
}
