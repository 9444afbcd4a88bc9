//! Logarithm and exponential of symmetric tensors, without principal axes.
//!
//! A function of a symmetric tensor A is the polynomial of degree two that has its values at the three principal values, with
//! divided differences (Newton's form). Where principal values nearly agree, first differences by `ln_1p` and `exp_m1` stay
//! exact to rounding, and an error of the second difference meets a small product. The closed form of principal values loses
//! half of the digits of their distance there. That does no harm: they still are zeros of the characteristic polynomial to
//! rounding, of which the error is a multiple.
//!
//! Source: N. J. Higham, Functions of Matrices (2008), section 1.2.2; O. K. Smith, Commun. ACM 4, 168 (1961) for the values.

use crate::tensor::{Sym3, determinant, deviator, plus, scaled, square, squared, trace};

/// Below this deviator (its norm over √6) all principal values are the same: its cube is no number any more.
const NO_DEVIATOR: f64 = 1e-100;

/// The principal values of a symmetric tensor, the largest first.
#[inline]
pub fn principal(a: &Sym3) -> [f64; 3] {
    let mean = trace(a) / 3.0;
    let dev = deviator(a);
    let p = (square(&dev) / 6.0).sqrt();
    if p < NO_DEVIATOR {
        return [mean; 3];
    }
    let ratio = 0.5 * determinant(&scaled(&dev, 1.0 / p));
    let (sin, cos) = (ratio.clamp(-1.0, 1.0).acos() / 3.0).sin_cos();
    // 2p cos of φ, φ − 2π/3 and φ + 2π/3, φ from 0 to π/3.
    let [wide, narrow] = [p * cos, p * 3f64.sqrt() * sin];
    [mean + 2.0 * wide, mean + (narrow - wide), mean - (narrow + wide)]
}

/// Half the logarithm of 1 + A, and its principal values: the logarithmic strain of b = 1 + A. `None` where 1 + A is not
/// positive.
#[inline]
pub fn half_logarithm(a: &Sym3) -> Option<(Sym3, [f64; 3])> {
    let values = principal(a);
    let [most, middle, least] = values;
    if !(1.0 + least > 0.0) {
        return None;
    }
    // (ln(1 + y) − ln(1 + x))/(y − x).
    let difference = |x: f64, y: f64| match y - x {
        0.0 => 1.0 / (1.0 + x),
        d => (d / (1.0 + x)).ln_1p() / d,
    };
    let first = [difference(middle, most), difference(least, middle)];
    // f″/2 at the mean, where the values agree.
    let same = -0.5 / ((1.0 + middle) * (1.0 + middle));
    let base = middle.ln_1p();
    let logs = [base + (most - middle) * first[0], base, base - (middle - least) * first[1]];
    let log = interpolated(a, values, base, first, same);
    Some((scaled(&log, 0.5), logs.map(|x| 0.5 * x)))
}

/// exp A of a tensor with these principal values, the largest first.
#[inline]
pub fn exponential(a: &Sym3, values: [f64; 3]) -> Sym3 {
    let [most, middle, least] = values;
    let base = middle.exp();
    // (eʸ − eˣ)/(y − x) with x at the middle.
    let difference = |y: f64| match y - middle {
        0.0 => base,
        d => base * d.exp_m1() / d,
    };
    interpolated(a, values, base, [difference(most), difference(least)], 0.5 * base)
}

/// f(A) from f at the middle principal value a₂, the divided differences from there to the largest and to the least, and f″/2
/// for where all three agree: f(A) = f(a₂) + f[a₂,a₁]B + f[a₁,a₂,a₃]B(B − (a₁ − a₂)) with B = A − a₂.
#[inline(always)]
fn interpolated(a: &Sym3, values: [f64; 3], base: f64, [up, down]: [f64; 2], same: f64) -> Sym3 {
    let [most, middle, least] = values;
    let [above, below] = [most - middle, middle - least];
    let spread = above + below;
    let (linear, quadratic) = match spread > 0.0 {
        true => ((down * above + up * below) / spread, (up - down) / spread),
        false => (up, same),
    };
    let b = plus(a, -middle);
    let b2 = squared(&b);
    plus(&std::array::from_fn(|k| linear * b[k] + quadratic * b2[k]), base)
}
