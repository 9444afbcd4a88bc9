//! Rotation of rigid bodies: unit quaternions (w first), principal axes, Richardson's method.

use super::real::Real;
use super::vec3::{Vec3, add, cross, dot, length, scale};

/// A unit quaternion, the real part first.
pub type Quat<R = f64> = [R; 4];

/// The identity rotation.
pub const UNTURNED: Quat = [1.0, 0.0, 0.0, 0.0];

/// Three rows.
pub type Matrix<R = f64> = [Vec3<R>; 3];

/// Scales to |q| = 1.
#[inline(always)]
pub fn normalized<R: Real>(q: Quat<R>) -> Quat<R> {
    let norm = q[0].like(1.0) / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    [q[0] * norm, q[1] * norm, q[2] * norm, q[3] * norm]
}

/// The rotation b followed by a: a b.
#[inline(always)]
pub fn after<R: Real>(a: Quat<R>, b: Quat<R>) -> Quat<R> {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// The inverse rotation.
#[inline(always)]
pub fn back<R: Real>(q: Quat<R>) -> Quat<R> {
    [q[0], -q[1], -q[2], -q[3]]
}

/// A vector of the body frame in space, q v q*; exactly v for the identity.
#[inline(always)]
pub fn turned<R: Real>(q: Quat<R>, v: Vec3<R>) -> Vec3<R> {
    let axis = [q[1], q[2], q[3]];
    let half = cross(axis, v);
    let t = add(half, half);
    add(add(v, scale(q[0], t)), cross(axis, t))
}

/// The rotation by an angle [rad] about a unit axis.
pub fn turn(axis: Vec3, angle: f64) -> Quat {
    let half = 0.5 * angle;
    let s = half.sin();
    [half.cos(), axis[0] * s, axis[1] * s, axis[2] * s]
}

/// The rotation by a vector's length [rad] about its direction.
pub fn turn_by(vector: Vec3) -> Quat {
    let angle = length(vector);
    if angle > 0.0 { turn(scale(1.0 / angle, vector), angle) } else { UNTURNED }
}

/// The rotation matrix.
#[inline(always)]
pub fn matrix<R: Real>(q: Quat<R>) -> Matrix<R> {
    let [w, i, j, k] = q;
    let (w2, i2, j2, k2) = (w * w, i * i, j * j, k * k);
    let (ij, ik, jk) = (i * 2.0 * j, i * 2.0 * k, j * 2.0 * k);
    let (iw, jw, kw) = (i * 2.0 * w, j * 2.0 * w, k * 2.0 * w);
    [
        [w2 + i2 - j2 - k2, ij - kw, jw + ik],
        [ij + kw, w2 - i2 + j2 - k2, jk - iw],
        [ik - jw, jk + iw, w2 - i2 - j2 + k2],
    ]
}

/// Matrix times vector.
#[inline(always)]
pub fn apply<R: Real>(m: &Matrix<R>, v: Vec3<R>) -> Vec3<R> {
    [dot(m[0], v), dot(m[1], v), dot(m[2], v)]
}

/// Transposed matrix times vector.
#[inline(always)]
pub fn apply_transposed<R: Real>(m: &Matrix<R>, v: Vec3<R>) -> Vec3<R> {
    add(add(scale(v[0], m[0]), scale(v[1], m[1])), scale(v[2], m[2]))
}

/// The axes of a rotated body: the columns of its rotation matrix.
pub fn axes(q: Quat) -> Matrix {
    let m = matrix(q);
    [0, 1, 2].map(|k| [m[0][k], m[1][k], m[2][k]])
}

/// The quaternion of a right-handed frame of unit axes.
pub fn from_axes([x, y, z]: Matrix) -> Quat {
    let q0 = 0.25 * (x[0] + y[1] + z[2] + 1.0);
    let squares = [q0, q0 - 0.5 * (y[1] + z[2]), q0 - 0.5 * (x[0] + z[2]), q0 - 0.5 * (x[0] + y[1])];
    let mut q = [0.0; 4];
    // At least one square is a quarter or more: divides by that component.
    if squares[0] >= 0.25 {
        q[0] = squares[0].sqrt();
        q[1] = (y[2] - z[1]) / (4.0 * q[0]);
        q[2] = (z[0] - x[2]) / (4.0 * q[0]);
        q[3] = (x[1] - y[0]) / (4.0 * q[0]);
    } else if squares[1] >= 0.25 {
        q[1] = squares[1].sqrt();
        q[0] = (y[2] - z[1]) / (4.0 * q[1]);
        q[2] = (y[0] + x[1]) / (4.0 * q[1]);
        q[3] = (x[2] + z[0]) / (4.0 * q[1]);
    } else if squares[2] >= 0.25 {
        q[2] = squares[2].sqrt();
        q[0] = (z[0] - x[2]) / (4.0 * q[2]);
        q[1] = (y[0] + x[1]) / (4.0 * q[2]);
        q[3] = (z[1] + y[2]) / (4.0 * q[2]);
    } else {
        q[3] = squares[3].max(0.25).sqrt();
        q[0] = (x[1] - y[0]) / (4.0 * q[3]);
        q[1] = (z[0] + x[2]) / (4.0 * q[3]);
        q[2] = (z[1] + y[2]) / (4.0 * q[3]);
    }
    normalized(q)
}

/// ω × as a quaternion product: (0, ω) q.
#[inline(always)]
fn rate<R: Real>(w: Vec3<R>, q: Quat<R>) -> Quat<R> {
    [
        -w[0] * q[1] - w[1] * q[2] - w[2] * q[3],
        q[0] * w[0] + w[1] * q[3] - w[2] * q[2],
        q[0] * w[1] + w[2] * q[1] - w[0] * q[3],
        q[0] * w[2] + w[0] * q[2] - w[1] * q[1],
    ]
}

/// Angular velocity from angular momentum L, orientation and principal moments; zero about axes without
/// inertia.
#[inline(always)]
pub fn spin<R: Real>(momentum: Vec3<R>, q: Quat<R>, moments: Vec3<R>) -> Vec3<R> {
    let m = matrix(q);
    let inner = apply_transposed(&m, momentum);
    apply(&m, [part(inner[0], moments[0]), part(inner[1], moments[1]), part(inner[2], moments[2])])
}

/// a / b, zero if b is zero.
#[inline(always)]
fn part<R: Real>(a: R, b: R) -> R {
    let none = a.like(0.0);
    R::choose(b.abs().above(none), a / b, none)
}

/// q + h b, normalized.
#[inline(always)]
fn ahead<R: Real>(q: Quat<R>, b: Quat<R>, h: f64) -> Quat<R> {
    normalized([q[0] + b[0] * h, q[1] + b[1] * h, q[2] + b[2] * h, q[3] + b[3] * h])
}

/// A step of q̇ = ½ ω q at constant angular momentum, with `half` = Δt/2: one full step and two half steps,
/// extrapolated (Richardson). Returns the orientation after the step and the angular velocity at its middle.
#[inline(always)]
pub fn richardson<R: Real>(
    q: Quat<R>,
    momentum: Vec3<R>,
    omega: Vec3<R>,
    moments: Vec3<R>,
    half: f64,
) -> (Quat<R>, Vec3<R>) {
    let slope = rate(omega, q);
    let full = ahead(q, slope, half);
    let middle = ahead(q, slope, 0.5 * half);
    let omega = spin(momentum, middle, moments);
    (extrapolated(full, ahead(middle, rate(omega, middle), 0.5 * half)), omega)
}

/// A step of q̇ = ½ ω q at constant ω, with `half` = Δt/2, extrapolated as in [`richardson`]: the orientation
/// of a sphere after the step.
#[inline(always)]
pub fn rolled<R: Real>(q: Quat<R>, omega: Vec3<R>, half: f64) -> Quat<R> {
    let slope = rate(omega, q);
    let full = ahead(q, slope, half);
    let middle = ahead(q, slope, 0.5 * half);
    extrapolated(full, ahead(middle, rate(omega, middle), 0.5 * half))
}

/// Richardson extrapolation from one full step and two half steps.
#[inline(always)]
fn extrapolated<R: Real>(full: Quat<R>, two: Quat<R>) -> Quat<R> {
    normalized([
        two[0] * 2.0 - full[0],
        two[1] * 2.0 - full[1],
        two[2] * 2.0 - full[2],
        two[3] * 2.0 - full[3],
    ])
}

/// The orientation after a free step of `dt` as successive exact rotations about the principal axes
/// (NO_SQUISH: Miller et al., J. Chem. Phys. 116, 2002, 8649). The method is symplectic. The angular momentum
/// in space is not changed: a rotation about an axis at the rate L_k/I_k preserves L. L is therefore never
/// computed from the quaternion, whose length rounding would multiply into it (by 1 + 6 δ in a step for a
/// length of 1 + δ).
pub fn no_squish(q: Quat, momentum: Vec3, moments: Vec3, dt: f64) -> Quat {
    let mut q = q;
    let mut inner = apply_transposed(&matrix(q), momentum);
    // Moments ascend, and LAMMPS begins with the third axis.
    for (axis, time) in [(2, 0.5 * dt), (1, 0.5 * dt), (0, dt), (1, 0.5 * dt), (2, 0.5 * dt)] {
        let angle = time * part(inner[axis], moments[axis]);
        let (sin, cos) = (0.5 * angle).sin_cos();
        let side = permuted(q, axis);
        q = std::array::from_fn(|k| cos * q[k] + sin * side[k]);
        // In the body frame the momentum rotates the other way.
        let ((sin, cos), (a, b)) = (angle.sin_cos(), ((axis + 1) % 3, (axis + 2) % 3));
        (inner[a], inner[b]) = (cos * inner[a] + sin * inner[b], cos * inner[b] - sin * inner[a]);
    }
    normalized(q)
}

/// q times the unit quaternion of one axis: a column of S(q).
fn permuted(q: Quat, axis: usize) -> Quat {
    match axis {
        0 => [-q[1], q[0], q[3], -q[2]],
        1 => [-q[2], -q[3], q[0], q[1]],
        _ => [-q[3], q[2], -q[1], q[0]],
    }
}

/// Principal moments and axes of a symmetric tensor xx yy zz xy xz yz, by Jacobi rotations: the smallest
/// first, a right-handed frame. Moments below 1e-7 of the largest are set to zero.
pub fn principal([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> (Vec3, Matrix) {
    let mut a = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
    let mut v = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let size = a.iter().flatten().fold(0.0, |m: f64, b| m.max(b.abs()));
    for _ in 0..50 {
        let off = a[0][1].abs() + a[0][2].abs() + a[1][2].abs();
        if off <= size * 1e-300 || off == 0.0 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            rotate(&mut a, &mut v, p, q);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&j, &k| a[j][j].total_cmp(&a[k][k]));
    let mut moments = order.map(|k| a[k][k]);
    let largest = moments.iter().copied().fold(0.0, f64::max);
    for m in &mut moments {
        if *m < 1e-7 * largest {
            *m = 0.0;
        }
    }
    let mut axes = order.map(|k| [v[0][k], v[1][k], v[2][k]]);
    if dot(cross(axes[0], axes[1]), axes[2]) < 0.0 {
        axes[2] = scale(-1.0, axes[2]);
    }
    (moments, axes)
}

/// Makes the entry (p, q) of a symmetric matrix zero.
fn rotate(a: &mut [[f64; 3]; 3], v: &mut [[f64; 3]; 3], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    let t =
        if theta.is_finite() { theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt()) } else { 0.0 };
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    let apq = a[p][q];
    a[p][p] -= t * apq;
    a[q][q] += t * apq;
    (a[p][q], a[q][p]) = (0.0, 0.0);
    let r = 3 - p - q;
    let (arp, arq) = (a[r][p], a[r][q]);
    a[r][p] = c * arp - s * arq;
    a[r][q] = s * arp + c * arq;
    (a[p][r], a[q][r]) = (a[r][p], a[r][q]);
    for row in v.iter_mut() {
        let (vp, vq) = (row[p], row[q]);
        row[p] = c * vp - s * vq;
        row[q] = s * vp + c * vq;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_follow_each_other() {
        let (a, b) = (turn([0.6, 0.0, 0.8], 1.1), turn([0.0, 1.0, 0.0], -0.4));
        let v = [0.3, -2.0, 1.5];
        let (both, one_by_one) = (turned(after(a, b), v), turned(a, turned(b, v)));
        let by_matrix = apply(&matrix(a), turned(b, v));
        for k in 0..3 {
            assert!((both[k] - one_by_one[k]).abs() < 1e-15 && (both[k] - by_matrix[k]).abs() < 1e-15);
        }
        assert_eq!(turned(UNTURNED, v), v);
        let none = after(a, back(a));
        assert!((none[0] - 1.0).abs() < 1e-15 && none[1..].iter().all(|a| a.abs() < 1e-16));
    }
    use crate::math::vec3::SIX;

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-13, "{a} {b}"); // a few roundings of numbers about 1
    }

    #[test]
    fn frames_and_quaternions_are_the_same_turn() {
        for (axis, angle) in
            [([1.0, 0.0, 0.0], 0.3), ([0.0, 0.6, 0.8], 2.9), ([0.0, 0.0, 1.0], 3.1), ([0.6, -0.8, 0.0], 3.1)]
        {
            let q = turn(axis, angle);
            let back = from_axes(axes(q));
            let sign = (q[0] * back[0] + q[1] * back[1] + q[2] * back[2] + q[3] * back[3]).signum();
            (0..4).for_each(|k| close(back[k] * sign, q[k]));
            let m = matrix(q);
            let v = apply_transposed(&m, apply(&m, [1.0, 2.0, 3.0]));
            (0..3).for_each(|k| close(v[k], k as f64 + 1.0));
        }
        // A quarter turn about z maps x to y.
        let v = apply(&matrix(turn([0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2)), [1.0, 0.0, 0.0]);
        (0..3).for_each(|k| close(v[k], [0.0, 1.0, 0.0][k]));
    }

    #[test]
    fn principal_axes_rebuild_the_tensor() {
        let t = [3.0, 2.5, 1.5, 0.4, -0.3, 0.2];
        let (moments, axes) = principal(t);
        for (k, (a, b)) in SIX.into_iter().enumerate() {
            close((0..3).map(|n| moments[n] * axes[n][a] * axes[n][b]).sum(), t[k]);
        }
        close(dot(cross(axes[0], axes[1]), axes[2]), 1.0);
        assert_eq!(principal([1.0, 1.0, 1e-9, 0.0, 0.0, 0.0]).0, [0.0, 1.0, 1.0]);
        // For two equal moments the axes keep their order.
        assert_eq!(
            principal([1.0, 3.0, 3.0, 0.0, 0.0, 0.0]).1,
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        );
    }

    // An asymmetric top without torque conserves its energy: the error of Richardson's method is third order
    // per step.
    #[test]
    fn a_free_top_keeps_its_energy() {
        let (moments, momentum) = ([1.0, 2.0, 3.0], [1.0, 1.5, -0.5]);
        let energy = |q: Quat| 0.5 * dot(momentum, spin(momentum, q, moments));
        let mut q = turn([0.0, 0.6, 0.8], 0.4);
        let before = energy(q);
        for _ in 0..10_000 {
            let omega = spin(momentum, q, moments);
            q = richardson(q, momentum, omega, moments, 0.5 * 1e-3).0;
        }
        assert!((energy(q) / before - 1.0).abs() < 1e-7, "{}", energy(q) / before - 1.0);
    }

    /// The sum over particles of the body: R I Rᵀ ω, where each R contains the square of the quaternion's
    /// length.
    fn momentum_of(q: Quat, omega: Vec3, moments: Vec3) -> Vec3 {
        let m = matrix(q);
        let inner = apply_transposed(&m, omega);
        apply(&m, std::array::from_fn(|k| moments[k] * inner[k]))
    }

    // A million steps: a length of 1 + δ would act as 1 + 8 δ, and a length that rounding increases by ε per
    // step would change the momentum quadratically in the steps, by 3e-5 here (6e-4 in four million) if L
    // were computed from q and its conjugate momentum.
    #[test]
    fn exact_rotations_keep_length_and_angular_momentum() {
        for (moments, momentum) in [([0.2, 0.38, 0.38], [0.1, 0.3, 1.0]), ([1.0, 2.0, 3.0], [1.0, 1.5, -0.5])]
        {
            let mut q = turn([0.0, 0.6, 0.8], 0.4);
            for _ in 0..1_000_000 {
                q = no_squish(q, momentum, moments, 1e-3);
            }
            let found = momentum_of(q, spin(momentum, q, moments), moments);
            // A few roundings: no drift.
            (0..3).for_each(|k| assert!((found[k] - momentum[k]).abs() < 1e-14, "{found:?}"));
            assert!((q.iter().map(|a| a * a).sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }

    // A body with two equal moments precesses about L at |L|/I (Goldstein, Classical Mechanics, 5.6): after a
    // time t its axis is rotated by that rate times t, for any choice of the other principal axes.
    #[test]
    fn a_symmetric_top_precesses_at_its_rate() {
        let momentum = [0.0, 0.0, 2.0];
        for (moments, own) in [([0.2, 0.38, 0.38], 0), ([0.2, 0.2, 0.38], 2)] {
            let (start, steps, dt) = (turn([0.8, 0.6, 0.0], 0.7), 20_000, 1e-4);
            let rate = 2.0 / moments[1];
            let expected = turned(turn([0.0, 0.0, 1.0], rate * dt * f64::from(steps)), axes(start)[own]);
            let (mut exact, mut other) = (start, start);
            for _ in 0..steps {
                exact = no_squish(exact, momentum, moments, dt);
                other = richardson(other, momentum, spin(momentum, other, moments), moments, 0.5 * dt).0;
            }
            // The error of a step is below the cube of its largest angle over 6.
            let most = (2.0 / moments[0] * dt).powi(3) / 6.0 * f64::from(steps);
            for q in [exact, other] {
                let away = super::super::vec3::sub(axes(q)[own], expected);
                assert!(length(away) < most, "{moments:?} {}", length(away));
            }
        }
    }
}
