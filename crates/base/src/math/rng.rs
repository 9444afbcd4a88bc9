//! LAMMPS' two random number generators, bit for bit: Park–Miller for particles and velocities, Marsaglia for
//! formulas.

/// 2³¹ − 1, the modulus of the Park–Miller generator.
const MODULUS: u64 = 2_147_483_647;

/// The Park–Miller "minimal standard" generator (Comm. ACM 31, 1192 (1988)): s ← 16807 s mod (2³¹ − 1).
///
/// LAMMPS draws created particles and velocities from it; the same seed gives the same numbers here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParkMiller {
    state: u64,
    /// The second number of the last Gaussian pair, if unused.
    spare: Option<f64>,
}

impl ParkMiller {
    /// A stream from a positive seed.
    pub fn new(seed: u32) -> Self {
        Self { state: u64::from(seed), spare: None }
    }

    /// The state of the stream, for [`Self::resumed`]: the generator's state, and an unused Gaussian number
    /// (NaN for none).
    pub fn stand(&self) -> [f64; 2] {
        [self.state as f64, self.spare.unwrap_or(f64::NAN)]
    }

    /// The stream with this state.
    pub fn resumed([state, spare]: [f64; 2]) -> Self {
        Self { state: state as u64, spare: (!spare.is_nan()).then_some(spare) }
    }

    /// Restarts the stream; an unused Gaussian number is discarded.
    pub fn reset(&mut self, seed: u32) {
        *self = Self::new(seed);
    }

    /// Restarts the stream for a position: seed and bytes of the coordinates, hashed by Jenkins'
    /// one-at-a-time function over *signed* bytes, reduced to 27 bits; then five numbers are skipped.
    pub fn reset_at(&mut self, seed: u32, place: [f64; 3]) {
        let mut bytes = [0u8; 28];
        bytes[..4].copy_from_slice(&seed.to_le_bytes());
        for (chunk, x) in bytes[4..].chunks_exact_mut(8).zip(place) {
            chunk.copy_from_slice(&x.to_le_bytes());
        }
        let hash = jenkins_signed(&bytes) & 0x07ff_ffff;
        self.reset(hash.max(1));
        self.skip(5);
    }

    /// Skips `n` uniform numbers.
    pub fn skip(&mut self, n: usize) {
        for _ in 0..n {
            self.uniform();
        }
    }

    /// The next number, uniform in (0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.state = 16_807 * self.state % MODULUS;
        (1.0 / MODULUS as f64) * self.state as f64
    }

    /// The next number of a normal distribution (mean 0, variance 1), by the polar method.
    pub fn gaussian(&mut self) -> f64 {
        if let Some(second) = self.spare.take() {
            return second;
        }
        let (first, second) = polar_pair(|| self.uniform());
        self.spare = Some(second);
        first
    }
}

/// Jenkins' one-at-a-time hash, with the bytes taken as signed numbers.
fn jenkins_signed(bytes: &[u8]) -> u32 {
    let mut h = 0u32;
    for &b in bytes {
        h = h.wrapping_add(b as i8 as u32);
        h = h.wrapping_add(h << 10);
        h ^= h >> 6;
    }
    h = h.wrapping_add(h << 3);
    h ^= h >> 11;
    h.wrapping_add(h << 15)
}

/// Two independent normal numbers from a uniform stream (Marsaglia's polar method).
fn polar_pair(mut uniform: impl FnMut() -> f64) -> (f64, f64) {
    loop {
        let a = 2.0 * uniform() - 1.0;
        let b = 2.0 * uniform() - 1.0;
        let square = a * a + b * b;
        if square > 0.0 && square < 1.0 {
            let scale = (-2.0 * square.ln() / square).sqrt();
            return (b * scale, a * scale);
        }
    }
}

/// Marsaglia, Zaman and Tsang's "universal" generator (Stat. Prob. Lett. 9, 35 (1990)): a lagged Fibonacci
/// sequence minus an arithmetic one, 24 bits each.
///
/// LAMMPS draws `random(…)` and `normal(…)` of formulas from it, after skipping the first number.
#[derive(Clone, Debug, PartialEq)]
pub struct Marsaglia {
    table: [f64; 97],
    /// Indices of the two lags.
    at: (usize, usize),
    weyl: f64,
    spare: Option<f64>,
}

/// 2⁻²⁴, the resolution of Marsaglia's numbers.
const GRAIN: f64 = 1.0 / 16_777_216.0;

impl Marsaglia {
    /// The largest seed that the generator distinguishes.
    pub const MAX_SEED: u32 = 900_000_000;

    /// LAMMPS' stream for this seed (1 … [`Self::MAX_SEED`]).
    pub fn new(seed: u32) -> Self {
        let s = seed.clamp(1, Self::MAX_SEED) - 1;
        let (ij, kl) = (s / 30_082, s % 30_082);
        let (mut i, mut j) = ((ij / 177) % 177 + 2, ij % 177 + 2);
        let (mut k, mut l) = ((kl / 169) % 178 + 1, kl % 169);
        let table = std::array::from_fn(|_| {
            let (mut sum, mut bit) = (0.0, 0.5);
            for _ in 0..24 {
                (i, j, k) = (j, k, i * j % 179 * k % 179);
                l = (53 * l + 1) % 169;
                if l * k % 64 >= 32 {
                    sum += bit;
                }
                bit *= 0.5;
            }
            sum
        });
        let mut stream = Self { table, at: (96, 32), weyl: 362_436.0 * GRAIN, spare: None };
        stream.uniform();
        stream
    }

    /// The state of the stream, for [`Self::resumed`].
    pub fn stand(&self) -> Vec<f64> {
        let (a, b) = self.at;
        let head = [a as f64, b as f64, self.weyl, self.spare.unwrap_or(f64::NAN)];
        head.into_iter().chain(self.table).collect()
    }

    /// The stream with this state; `None` if the numbers are not a valid state.
    pub fn resumed(stand: &[f64]) -> Option<Self> {
        let (&[a, b, weyl, spare], table) = stand.split_first_chunk()?;
        let at = ((a as usize).min(96), (b as usize).min(96));
        Some(Self { table: table.try_into().ok()?, at, weyl, spare: (!spare.is_nan()).then_some(spare) })
    }

    /// The next number, uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        let (a, b) = self.at;
        let lagged = wrapped(self.table[a] - self.table[b], 1.0);
        self.table[a] = lagged;
        self.at = (a.checked_sub(1).unwrap_or(96), b.checked_sub(1).unwrap_or(96));
        self.weyl = wrapped(self.weyl - 7_654_321.0 * GRAIN, 16_777_213.0 * GRAIN);
        wrapped(lagged - self.weyl, 1.0)
    }

    /// The next number of a normal distribution (mean 0, variance 1), by the polar method.
    pub fn gaussian(&mut self) -> f64 {
        if let Some(second) = self.spare.take() {
            return second;
        }
        let (first, second) = polar_pair(|| self.uniform());
        self.spare = Some(second);
        first
    }
}

/// `x`, or `x + period` when negative.
fn wrapped(x: f64, period: f64) -> f64 {
    if x < 0.0 { x + period } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Oracle: box 0..3, `create_atoms 1 random 4 9281 NULL`, which skips 30 numbers first.
    #[test]
    fn uniform_is_lammps_stream() {
        let mut r = ParkMiller::new(9281);
        r.skip(30);
        let x: Vec<f64> = (0..6).map(|_| r.uniform() * 3.0).collect();
        let oracle = [
            2.0628833235534296,
            2.8800189624913122,
            2.4787025914893963,
            1.5544551622841765,
            1.7279125101528656,
            1.0255581392094297,
        ];
        assert_eq!(x, oracle);
    }

    // Oracle: `velocity all create 1.5 4928 loop geom mom no dist gaussian` at the positions above; all
    // speeds share one temperature factor, so ratios are compared (two roundings each: 4 ulp).
    #[test]
    fn stream_of_a_place_is_lammps_stream() {
        let places = [
            [2.0628833235534296, 2.8800189624913122, 2.4787025914893963],
            [1.5544551622841765, 1.7279125101528656, 1.0255581392094297],
            [1.5556456928866196, 0.73716034541705633, 2.4539254244668061],
        ];
        let oracle = [
            [0.74748094108626961, 0.86416933834450105, -1.8668364711870882],
            [0.35544220677470345, 0.14422697473953475, 1.2816816274738945],
            [-4.0714043988569744, 1.173012725510244, 0.35606077420698329],
        ];
        let mut r = ParkMiller::new(1);
        let mut factor = None;
        for (place, v) in places.into_iter().zip(oracle) {
            r.reset_at(4928, place);
            for v in v {
                let ratio = v / r.gaussian();
                let f = *factor.get_or_insert(ratio);
                assert!((ratio / f - 1.0).abs() < 4.0 * f64::EPSILON, "{ratio} {f}");
            }
        }
    }

    // Oracle: `velocity all create 1.5 4928 loop local mom no dist gaussian`, with 100 numbers skipped first.
    #[test]
    fn gaussian_pairs_come_in_lammps_order() {
        let oracle = [2.3828890888091903, -0.936122761996113, -1.9465882516016164, 0.1619934845072834];
        let mut r = ParkMiller::new(4928);
        r.skip(100);
        let factor = oracle[0] / r.gaussian();
        for v in &oracle[1..] {
            assert!((v / r.gaussian() / factor - 1.0).abs() < 4.0 * f64::EPSILON);
        }
    }

    // Oracle: formulas random(0,1,12345) and normal(0,1,12345), which LAMMPS prints with 15 digits; the last
    // number was printed as normal(…)*1e6 - 1.17517e6 = 4.0271174591034704.
    #[test]
    fn marsaglia_is_lammps_formula_stream() {
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} {b}");
        let mut r = Marsaglia::new(12345);
        for oracle in [0.86995309591293302, 0.0104259252548218, 0.29356783628463701] {
            close(r.uniform(), oracle);
        }
        assert_eq!(Marsaglia::resumed(&r.stand()), Some(r));
        assert_eq!(Marsaglia::resumed(&[0.0; 100]), None);
        let mut r = Marsaglia::new(12345);
        for oracle in [-0.220607254486375, -0.47322402546230702, 1.1751740271174591] {
            close(r.gaussian(), oracle);
        }
    }
}
