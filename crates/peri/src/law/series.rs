//! The prototype microelastic brittle bond as a function of one number.
//!
//! With reference bond xi, relative displacement eta and z = (2 xi·eta + eta·eta)/|xi|², the current length is
//! |xi| √(1 + z) and the stretch s = √(1 + z) − 1. The force density on one end is
//! c w V s (xi + eta)/|xi + eta| = (c w V/|xi|) z h(z) (xi + eta) with h(z) = 1/(1 + z + √(1 + z))
//! (Silling and Askari 2005). Written in z, small stretches lose no digits.

/// h(z) = Σ `SERIES[k]` z^k: the binomial series of (1 − (1 + z)^(−1/2))/z.
pub const SERIES: [f64; 8] = [
    1.0 / 2.0,
    -3.0 / 8.0,
    5.0 / 16.0,
    -35.0 / 128.0,
    63.0 / 256.0,
    -231.0 / 1024.0,
    429.0 / 2048.0,
    -6435.0 / 32768.0,
];

/// √(1 + z) − 1 = Σ `STRETCH[k]` z^(k + 1): the binomial series.
pub const STRETCH: [f64; 8] = [
    1.0 / 2.0,
    -1.0 / 8.0,
    1.0 / 16.0,
    -5.0 / 128.0,
    7.0 / 256.0,
    -21.0 / 1024.0,
    33.0 / 2048.0,
    -429.0 / 32768.0,
];

/// Largest |z| for which the series up to z^3 is exact to 1e-15: its next term over 1/2 is 0.49 z^4.
pub const UP_TO_3: f64 = 2e-4;
/// The same for z^5: 0.42 z^6.
pub const UP_TO_5: f64 = 3.5e-3;
/// The same for z^7: 0.37 z^8.
pub const UP_TO_7: f64 = 1.3e-2;

/// The stretch for a z.
pub fn stretch(z: f64) -> f64 {
    z / (1.0 + (1.0 + z).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::stretch::closed;

    #[test]
    fn series_is_exact_where_it_is_used() {
        for (degree, edge) in [(3, UP_TO_3), (5, UP_TO_5), (7, UP_TO_7)] {
            for z in [edge, -edge, 0.3 * edge] {
                let series = SERIES[..=degree].iter().rev().fold(0.0, |sum, a| sum * z + a);
                let closed = closed(z).share / z;
                // Truncation 1e-15 and a few roundings of 1e-16.
                assert!((series / closed - 1.0).abs() < 2e-15, "{degree} {z} {series} {closed}");
            }
        }
        // s (2 + s) = z.
        assert!((stretch(0.3) * (2.0 + stretch(0.3)) - 0.3).abs() < 1e-15);
    }
}
