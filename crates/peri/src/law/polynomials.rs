//! Bonds stretched by more than a few thousandths: polynomials in place of a root and a division.
//!
//! z = |y|²/|xi|² − 1 = s (2 + s). The binomial series of s and s/(1 + s) converge too slowly where |z| is a tenth; polynomials
//! through the zeros of a Chebyshev polynomial of the same degree are exact to 5e-16 over a whole range. Eight bonds' root
//! and division take some 40 cycles, the longer of these polynomials 8.

use perigrain_base::math::real::Real;

/// The degree of the shorter polynomials.
pub const FAR: usize = 10;
/// Largest |z| for which they are exact.
pub const UP_TO_FAR: f64 = 0.08;
/// The degree of the longer ones.
pub const FARTHEST: usize = 16;
/// Largest |z| for which they are exact.
pub const UP_TO_FARTHEST: f64 = 0.25;

/// s/(1 + s) over z.
#[inline(always)]
pub fn share<R: Real, const DEGREE: usize>(z: R) -> R {
    match DEGREE {
        FAR => polynomial(z, &SHARE_10),
        _ => polynomial(z, &SHARE_16),
    }
}

/// s over z.
#[inline(always)]
pub fn stretch<R: Real, const DEGREE: usize>(z: R) -> R {
    match DEGREE {
        FAR => polynomial(z, &STRETCH_10),
        _ => polynomial(z, &STRETCH_16),
    }
}

/// Σ `terms[k]` z^k.
#[inline(always)]
pub fn polynomial<R: Real, const N: usize>(z: R, terms: &[f64; N]) -> R {
    let mut sum = z.like(terms[N - 1]);
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = sum.fma(z, z.like(terms[k]));
    }
    sum
}

const SHARE_10: [f64; 11] = [
    0.5,
    -0.37500000000001893,
    0.3125000000000596,
    -0.27343749994091426,
    0.2460937498914008,
    -0.22558598914558747,
    0.20947272856755086,
    -0.19636220271860297,
    0.18544883000137555,
    -0.17906392880974142,
    0.17119769922790626,
];
const STRETCH_10: [f64; 11] = [
    0.5,
    -0.12500000000000083,
    0.06250000000000237,
    -0.03906249999743747,
    0.0273437499956669,
    -0.02050781474019808,
    0.01611328413591572,
    -0.01309124214010687,
    0.010909165953098746,
    -0.009397980698045288,
    0.008129152339876754,
];
const SHARE_16: [f64; 17] = [
    0.5,
    -0.3749999999999895,
    0.31249999999995076,
    -0.27343750000800515,
    0.24609375002092232,
    -0.22558593571649901,
    0.20947265283258432,
    -0.1963807933224237,
    0.18547086014975522,
    -0.17618764844075743,
    0.16817532942445754,
    -0.16146054219662256,
    0.1553222321679687,
    -0.1447347458819927,
    0.1392037883676976,
    -0.18093574307100352,
    0.1784411609662972,
];
const STRETCH_16: [f64; 17] = [
    0.5,
    -0.12499999999999971,
    0.0624999999999987,
    -0.03906250000022247,
    0.027343750000550008,
    -0.0205078124504076,
    0.01611328116011357,
    -0.013092045971168385,
    0.01091004152588316,
    -0.009273267121915932,
    0.008008620559905267,
    -0.007015656189730369,
    0.006208244476842797,
    -0.005403282634855557,
    0.004842372178280904,
    -0.005666478678366776,
    0.005248923448763122,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Both polynomials over the closed forms, at many places of a range.
    fn compare<const DEGREE: usize>(edge: f64) {
        for k in -1000..=1000 {
            let z = edge * f64::from(k) / 1000.0;
            let root = (1.0 + z).sqrt();
            let (share, stretch) = (share::<_, DEGREE>(z), stretch::<_, DEGREE>(z));
            // Truncation below 5e-16 and a few roundings of 1e-16.
            assert!((share * (root * (1.0 + root)) - 1.0).abs() < 1.5e-15, "{DEGREE} {z}");
            assert!((stretch * (1.0 + root) - 1.0).abs() < 1.5e-15, "{DEGREE} {z}");
        }
    }

    #[test]
    fn polynomials_are_exact_where_they_are_used() {
        compare::<FAR>(UP_TO_FAR);
        compare::<FARTHEST>(UP_TO_FARTHEST);
    }
}
