//! Logarithm and exponential of symmetric tensors, without principal axes.
//!
//! A function of a symmetric tensor A is a polynomial of degree two in A. Two ways lead to its coefficients:
//!
//! - Near a multiple of the unit tensor, where metals are, the power series of the deviator X, reduced by X³ = J₂X + J₃ (Cayley
//!   and Hamilton) with J₂ = ½ tr X², J₃ = det X.
//! - Elsewhere the polynomial that has the values of the function at the three principal values, in Newton's form with divided
//!   differences. Where principal values nearly agree, first differences by `ln_1p` and `exp_m1` stay exact to rounding, and an
//!   error of the second difference meets a small product. The closed form of principal values loses half of the digits of
//!   their distance there. That does no harm: they still are zeros of the characteristic polynomial to rounding, of which the
//!   error is a multiple.
//!
//! Source: N. J. Higham, Functions of Matrices (2008), section 1.2.2; O. K. Smith, Commun. ACM 4, 168 (1961) for the values.

use crate::tensor::{Sym3, determinant, deviator, plus, scaled, square, squared, trace};

/// Below this deviator (its norm over √6) all principal values are the same: its cube is no number any more.
const NO_DEVIATOR: f64 = 1e-100;

/// Largest J₂ for the series of the logarithm: principal values of X are below √(4J₂/3) = 0.05, and the first term left out,
/// 0.05¹³/14 of the sum, is below rounding.
const NEAR: f64 = 0.75 * 0.05 * 0.05;

/// Coefficients of ln(1 + x).
const LOGARITHM: [f64; 14] = {
    let mut c = [0.0; 14];
    let mut n = 1;
    while n < 14 {
        c[n] = if n % 2 == 1 { 1.0 } else { -1.0 } / n as f64;
        n += 1;
    }
    c
};

/// Largest J₂ for the series of the exponential: principal values are below 0.2, and 0.2¹³/13! is below rounding.
const NEAR_EXPONENTIAL: f64 = 0.75 * 0.2 * 0.2;

/// Coefficients of eˣ.
const EXPONENTIAL: [f64; 13] = {
    let mut c = [1.0; 13];
    let mut n = 1;
    while n < 13 {
        c[n] = c[n - 1] / n as f64;
        n += 1;
    }
    c
};

/// Half the logarithm of 1 + A: the logarithmic strain of b = 1 + A. `None` where 1 + A is not positive.
#[inline]
pub fn half_logarithm(a: &Sym3) -> Option<Sym3> {
    let mean = trace(a) / 3.0;
    if mean <= -1.0 {
        return None;
    }
    // 1 + A = (1 + mean)(1 + X) with a deviator X.
    let x = scaled(&plus(a, -mean), 1.0 / (1.0 + mean));
    if 0.5 * square(&x) <= NEAR {
        let log = polynomial(&x, &LOGARITHM);
        return Some(scaled(&plus(&log, mean.ln_1p()), 0.5));
    }
    far_logarithm(a).map(|log| scaled(&log, 0.5))
}

/// ln(1 + A) from principal values.
#[cold]
fn far_logarithm(a: &Sym3) -> Option<Sym3> {
    let values = principal(a);
    let [most, middle, least] = values;
    if least <= -1.0 {
        return None;
    }
    // (ln(1 + y) − ln(1 + x))/(y − x).
    let difference = |x: f64, y: f64| match y - x {
        0.0 => 1.0 / (1.0 + x),
        d => (d / (1.0 + x)).ln_1p() / d,
    };
    let first = [difference(middle, most), difference(least, middle)];
    Some(interpolated(a, values, middle.ln_1p(), first, -0.5 / (1.0 + middle).powi(2)))
}

/// exp A.
#[inline]
pub fn exponential(a: &Sym3) -> Sym3 {
    let mean = trace(a) / 3.0;
    let x = plus(a, -mean);
    match 0.5 * square(&x) <= NEAR_EXPONENTIAL {
        true => scaled(&polynomial(&x, &EXPONENTIAL), mean.exp()),
        false => far_exponential(a),
    }
}

/// exp A from principal values.
#[cold]
fn far_exponential(a: &Sym3) -> Sym3 {
    let values = principal(a);
    let [most, middle, least] = values;
    let base = middle.exp();
    // (eʸ − eˣ)/(y − x) with x at the middle.
    let difference = |y: f64| match y - middle {
        0.0 => base,
        d => base * d.exp_m1() / d,
    };
    interpolated(a, values, base, [difference(most), difference(least)], 0.5 * base)
}

/// Σ cₙXⁿ of a deviator X, by Horner's rule on r₀ + r₁X + r₂X².
#[inline(always)]
fn polynomial<const N: usize>(x: &Sym3, c: &[f64; N]) -> Sym3 {
    let x2 = squared(x);
    let [j2, j3] = [0.5 * trace(&x2), determinant(x)];
    let mut r = [0.0; 3];
    for c in c.iter().rev() {
        r = [c + j3 * r[2], r[0] + j2 * r[2], r[1]];
    }
    plus(&std::array::from_fn(|k| r[1] * x[k] + r[2] * x2[k]), r[0])
}

/// The principal values of a symmetric tensor, the largest first.
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

/// f(A) from f at the middle principal value a₂, the divided differences from there to the largest and to the least, and f″/2
/// for where all three agree: f(A) = f(a₂) + f[a₂,a₁]B + f[a₁,a₂,a₃]B(B − (a₁ − a₂)) with B = A − a₂.
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
