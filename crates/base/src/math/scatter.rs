//! Random factors with mean 1: determined by a seed and a particle or position, independent of the order of
//! evaluation.

use std::f64::consts::{PI, SQRT_2, TAU};

/// Distributions with mean 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Distribution {
    /// Weibull, with modulus m: the fraction (1 − exp(−(Γ(1 + 1/m) f)^m)) is below f.
    Weibull(f64),
    /// Normal, with this standard deviation; truncated to three standard deviations.
    Normal(f64),
}

impl Distribution {
    /// The factor with the same quantile as the standard normal number `g`.
    pub fn factor(self, g: f64) -> f64 {
        match self {
            Self::Weibull(m) => {
                // −ln of the fraction above; if that is close to 1, computed from the fraction below.
                let log = if g < 0.0 { -(-below(g)).ln_1p() } else { -below(-g).ln() };
                log.powf(1.0 / m) / gamma(1.0 + 1.0 / m)
            }
            Self::Normal(deviation) => 1.0 + deviation * g.clamp(-3.0, 3.0),
        }
    }
}

/// Hash of an integer: G. Steele, D. Lea, C. Flood, Proc. OOPSLA 2014 (splitmix64).
pub fn mixed(z: u64) -> u64 {
    let z = z.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number strictly between 0 and 1, determined by a seed and another integer.
pub fn uniform(seed: u64, of: u64) -> f64 {
    ((mixed(mixed(seed) ^ of) >> 12) as f64 + 0.5) / (1u64 << 52) as f64
}

/// A standard normal number, determined by a seed and another integer below 2⁶³ (Box and Muller 1958).
pub fn gaussian(seed: u64, of: u64) -> f64 {
    let [a, b] = [0, 1].map(|k| uniform(seed, 2 * of + k));
    (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
}

/// Number of waves in a field.
const WAVES: u64 = 256;

/// A random field, standard normal at each position, with correlation exp(−r²/2L²) at distance r: a sum of
/// waves with wave vectors drawn from its spectrum (Shinozuka and Deodatis, Appl. Mech. Rev. 44, 191 (1991)).
#[derive(Clone, Debug)]
pub struct Field {
    /// Wave vectors and phases.
    waves: Vec<([f64; 3], f64)>,
}

impl Field {
    /// The field of a seed and a correlation length, periodic with the finite `periods`.
    pub fn new(seed: u64, length: f64, periods: [f64; 3]) -> Self {
        let wave = |n: u64| {
            let k = [0, 1, 2].map(|d| {
                let k = gaussian(seed, 4 * n + d as u64) / length;
                let least = TAU / periods[d];
                if least > 0.0 { (k / least).round() * least } else { k }
            });
            (k, TAU * uniform(seed, 8 * n + 6))
        };
        Self { waves: (0..WAVES).map(wave).collect() }
    }

    /// Its value at a position.
    pub fn at(&self, x: [f64; 3]) -> f64 {
        let wave = |(k, phase): &([f64; 3], f64)| (k[0] * x[0] + k[1] * x[1] + k[2] * x[2] + phase).cos();
        SQRT_2 / (WAVES as f64).sqrt() * self.waves.iter().map(wave).sum::<f64>()
    }
}

/// The standard normal distribution function: near 0 by the series of Marsaglia (J. Stat. Softw. 11, 4
/// (2004)), far below by Laplace's continued fraction; accurate to 12 digits.
pub fn below(x: f64) -> f64 {
    let density = (-0.5 * x * x).exp() / TAU.sqrt();
    if x < -3.0 {
        let far = (1..=60).rev().fold(-x, |rest, k| -x + f64::from(k) / rest);
        return density / far;
    }
    if x > 3.0 {
        return 1.0 - below(-x);
    }
    let (mut term, mut sum, mut k) = (x, x, 3.0);
    while term.abs() > 1e-17 * sum.abs() {
        term *= x * x / k;
        sum += term;
        k += 2.0;
    }
    0.5 + density * sum
}

/// Γ(x) for x ≥ 1, by Stirling's series beyond 10 and the recurrence from there; accurate to 13 digits.
pub fn gamma(x: f64) -> f64 {
    let (mut z, mut divisor) = (x, 1.0);
    while z < 10.0 {
        divisor *= z;
        z += 1.0;
    }
    let w = 1.0 / (z * z);
    let series =
        (1.0 / 12.0 + w * (-1.0 / 360.0 + w * (1.0 / 1260.0 + w * (-1.0 / 1680.0 + w / 1188.0)))) / z;
    ((z - 0.5) * z.ln() - z + 0.5 * (2.0 * PI).ln() + series).exp() / divisor
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gamma_function() {
        for (x, y) in [(1.0, 1.0), (1.5, 0.5 * PI.sqrt()), (5.0, 24.0), (1.1, 0.951_350_769_866_873_2)] {
            assert!((gamma(x) - y).abs() < 1e-13 * y, "{x} {}", gamma(x));
        }
    }

    // Abramowitz and Stegun, tables 26.1 and 26.2.
    #[test]
    fn the_normal_distribution() {
        for (x, y) in [
            (0.0, 0.5),
            (-1.0, 0.158_655_253_931_457_05),
            (-2.9, 1.865_813_300_384_04e-3),
            (-3.0, 1.349_898_031_630_094_6e-3),
            (-3.1, 9.676_032_132_183_56e-4),
            (-6.0, 9.865_876_450_376_98e-10),
        ] {
            assert!((below(x) / y - 1.0).abs() < 1e-11, "{x} {}", below(x));
            assert!((below(-x) - (1.0 - y)).abs() < 1e-14);
        }
    }

    /// The largest distance between the distribution function of some numbers and the expected one.
    fn distance(mut all: Vec<f64>, below: impl Fn(f64) -> f64) -> f64 {
        all.sort_unstable_by(f64::total_cmp);
        let n = all.len() as f64;
        let off = |(k, f): (usize, &f64)| {
            let (k, p) = (k as f64, below(*f));
            (p - k / n).max((k + 1.0) / n - p)
        };
        all.iter().enumerate().map(off).fold(0.0, f64::max)
    }

    /// Kolmogorov and Smirnov: one seed in twenty deviates by more than 1.36/√n. The mean has a standard
    /// error of σ/√n; the tolerance is three of these.
    #[test]
    fn factors_are_those_of_the_distributions() {
        let n = 10_000;
        let drawn = |of: Distribution| (1..=n).map(|tag| of.factor(gaussian(4711, tag))).collect::<Vec<_>>();
        let limit = 1.36 / (n as f64).sqrt();
        for m in [1.0, 3.0, 10.0] {
            let (all, scale) = (drawn(Distribution::Weibull(m)), gamma(1.0 + 1.0 / m));
            let (mean, deviation) =
                (all.iter().sum::<f64>() / n as f64, gamma(1.0 + 2.0 / m) / scale / scale - 1.0);
            assert!((mean - 1.0).abs() < 3.0 * (deviation / n as f64).sqrt(), "{m} {mean}");
            let off = distance(all, |f| 1.0 - (-(scale * f).powf(m)).exp());
            assert!(off < limit, "{m} {off}");
        }
        let all = drawn(Distribution::Normal(0.2));
        let mean = all.iter().sum::<f64>() / n as f64;
        assert!((mean - 1.0).abs() < 3.0 * 0.2 / (n as f64).sqrt());
        assert!(distance(all, |f| below((f - 1.0) / 0.2)) < limit);
    }

    /// Many fields at two positions: means, variances and products have standard errors of 1/√n, √(2/n) and
    /// at most √(2/n); the tolerance is four of these.
    #[test]
    fn fields_are_correlated_as_far_as_their_length() {
        let (n, length) = (2_000, 0.5);
        for apart in [0.25, 0.5, 1.5] {
            let [mut mean, mut square, mut product] = [0.0; 3];
            for seed in 1..=n {
                let field = Field::new(seed, length, [f64::INFINITY; 3]);
                let place = [0.3, 0.1, -2.0];
                let (a, b) = (field.at(place), field.at([0.3, 0.1 + 0.6 * apart, -2.0 - 0.8 * apart]));
                mean += a / n as f64;
                square += a * a / n as f64;
                product += a * b / n as f64;
            }
            let (error, exact) = ((2.0 / n as f64).sqrt(), (-0.5 * (apart / length).powi(2)).exp());
            assert!(mean.abs() < 4.0 * error && (square - 1.0).abs() < 4.0 * error, "{mean} {square}");
            assert!((product - exact).abs() < 4.0 * error, "{apart} {product} {exact}");
        }
    }

    #[test]
    fn fields_repeat_with_the_box() {
        let field = Field::new(9, 0.5, [4.0, f64::INFINITY, 3.0]);
        let (a, b) = (field.at([0.2, 1.0, 2.5]), field.at([4.2, 1.0, -0.5]));
        assert!((a - b).abs() < 1e-12 && (a - field.at([0.2, 5.0, 2.5])).abs() > 1e-3);
    }
}
