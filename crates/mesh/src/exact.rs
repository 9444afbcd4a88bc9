//! Exact orientation tests: adaptive predicates after Shewchuk (1997), "Adaptive precision floating-point
//! arithmetic and fast robust geometric predicates", Discrete & Computational Geometry 18, 305.

use perigrain_base::math::vec3::Vec3;

/// Half a unit in the last place of 1.
const EPS: f64 = f64::EPSILON / 2.0;
/// Rounding errors of the fast determinants, relative to the sums of their terms' sizes (Shewchuk's bounds A).
const BOUND_2: f64 = (3.0 + 16.0 * EPS) * EPS;
const BOUND_3: f64 = (7.0 + 56.0 * EPS) * EPS;

/// A sum of non-overlapping numbers, smallest first, that represents one number exactly.
type Sum = Vec<f64>;

/// 1 if a, b, c are counterclockwise, −1 if clockwise, 0 if collinear.
pub fn side2(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> i8 {
    let left = (a[0] - c[0]) * (b[1] - c[1]);
    let right = (a[1] - c[1]) * (b[0] - c[0]);
    let fast = left - right;
    if fast.abs() > BOUND_2 * (left.abs() + right.abs()) {
        return sign(fast);
    }
    let d = |p: [f64; 2], k: usize| difference(p[k], c[k]);
    sign_of(&minus(&times(&d(a, 0), &d(b, 1)), &times(&d(a, 1), &d(b, 0))))
}

/// 1 if d is below the plane of a, b, c, seen so that they are counterclockwise; −1 above, 0 on it.
pub fn side3(a: &Vec3, b: &Vec3, c: &Vec3, d: &Vec3) -> i8 {
    let [p, q, r] = [a, b, c].map(|v| [v[0] - d[0], v[1] - d[1], v[2] - d[2]]);
    let minors = [[q[0] * r[1], q[1] * r[0]], [r[0] * p[1], r[1] * p[0]], [p[0] * q[1], p[1] * q[0]]];
    let (mut fast, mut size) = (0.0, 0.0);
    for ([plus, less], z) in minors.iter().zip([p[2], q[2], r[2]]) {
        fast += z * (plus - less);
        size += z.abs() * (plus.abs() + less.abs());
    }
    if fast.abs() > BOUND_3 * size {
        return sign(fast);
    }
    let [p, q, r] = [a, b, c].map(|v| [0, 1, 2].map(|k| difference(v[k], d[k])));
    let minor = |u: &[Sum; 3], v: &[Sum; 3]| minus(&times(&u[0], &v[1]), &times(&u[1], &v[0]));
    let terms = [times(&p[2], &minor(&q, &r)), times(&q[2], &minor(&r, &p)), times(&r[2], &minor(&p, &q))];
    sign_of(&plus(&plus(&terms[0], &terms[1]), &terms[2]))
}

fn sign(x: f64) -> i8 {
    if x > 0.0 {
        1
    } else if x < 0.0 {
        -1
    } else {
        0
    }
}

fn sign_of(sum: &[f64]) -> i8 {
    sum.last().map_or(0, |x| sign(*x))
}

/// a + b and its rounding error.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let part = s - a;
    (s, (a - (s - part)) + (b - part))
}

fn difference(a: f64, b: f64) -> Sum {
    let (s, rest) = two_sum(a, -b);
    [rest, s].into_iter().filter(|x| *x != 0.0).collect()
}

/// Adds a number to a sum.
fn grow(sum: &mut Sum, mut more: f64) {
    let mut kept = 0;
    for k in 0..sum.len() {
        let (s, rest) = two_sum(more, sum[k]);
        more = s;
        if rest != 0.0 {
            sum[kept] = rest;
            kept += 1;
        }
    }
    sum.truncate(kept);
    if more != 0.0 {
        sum.push(more);
    }
}

fn plus(a: &Sum, b: &Sum) -> Sum {
    let mut sum = a.clone();
    b.iter().for_each(|x| grow(&mut sum, *x));
    sum
}

fn minus(a: &Sum, b: &Sum) -> Sum {
    plus(a, &b.iter().map(|x| -x).collect())
}

fn times(a: &Sum, b: &Sum) -> Sum {
    let mut product = vec![];
    for x in a {
        for y in b {
            let whole = x * y;
            grow(&mut product, x.mul_add(*y, -whole));
            grow(&mut product, whole);
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_by_hand() {
        assert_eq!(side2([0.0, 0.0], [1.0, 0.0], [0.5, 1.0]), 1);
        assert_eq!(side2([0.0, 0.0], [1.0, 0.0], [0.5, -1e-300]), -1);
        let [a, b, c] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(side3(&a, &b, &c, &[0.2, 0.2, -1e-300]), 1);
        assert_eq!(side3(&a, &b, &c, &[0.2, 0.2, 1.0]), -1);
        assert_eq!(side3(&a, &b, &c, &[5.0, 7.0, 0.0]), 0);
    }

    // Shewchuk's example: points a few units in the last place from the line through (12, 12) and (24, 24).
    // The oracle is integer arithmetic in units of 2⁻⁵³.
    #[test]
    fn next_to_a_line_the_side_is_that_of_whole_numbers() {
        let unit = 2f64.powi(-53);
        let whole = |x: f64| (x / unit) as i128;
        for i in 0..32 {
            for j in 0..32 {
                let p = [0.5 + f64::from(i) * unit, 0.5 + f64::from(j) * unit];
                let (ax, ay, bx, by) = (whole(12.0), whole(12.0), whole(24.0), whole(24.0));
                let (px, py) = (whole(p[0]), whole(p[1]));
                let exact = (ax - px) * (by - py) - (ay - py) * (bx - px);
                assert_eq!(i128::from(side2([12.0, 12.0], [24.0, 24.0], p)), exact.signum(), "{i} {j}");
                // The same in space, in the plane normal to it.
                let lift = |q: [f64; 2]| [q[0], q[1], 0.0];
                let up = [3.0, 3.0, 7.0];
                let space = side3(&lift([12.0, 12.0]), &lift([24.0, 24.0]), &up, &lift(p));
                assert_eq!(i128::from(space), exact.signum(), "{i} {j}");
            }
        }
    }
}
