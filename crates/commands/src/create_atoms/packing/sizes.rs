//! Diameters of spheres: all alike, of several sizes, or drawn from a distribution.

use perigrain_base::math::rng::ParkMiller;
use perigrain_base::stop;
use std::f64::consts::PI;

/// Numbers of a normal distribution farther from its mean than so many deviations are drawn again.
const TAIL: f64 = 2.5;

/// A distribution of diameters.
#[derive(Clone, Debug, PartialEq)]
pub enum Sizes {
    /// All alike [length].
    Mono(f64),
    /// Anything between two diameters, by number [length].
    Uniform(f64, f64),
    /// The logarithm is normal: the median [length] and the deviation of the logarithm, cut at 2.5 deviations.
    Lognormal(f64, f64),
    /// Some diameters [length] with the share of all spheres that each has by number; shares add up to 1.
    Mix(Vec<(f64, f64)>),
}

/// How much there is to be of spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// All together fill this volume [length³].
    Volume(f64),
    /// So many.
    Number(usize),
}

/// The volume of a sphere of this diameter [length³].
fn volume_of(d: f64) -> f64 {
    PI / 6.0 * d.powi(3)
}

impl Sizes {
    /// Diameters with their shares of the mass, spheres being of one density, however these add up.
    pub fn by_mass(parts: &[(f64, f64)]) -> Self {
        Self::by_number(&parts.iter().map(|(d, share)| (*d, share / d.powi(3))).collect::<Vec<_>>())
    }

    /// Diameters with their shares of the number, however these add up.
    pub fn by_number(parts: &[(f64, f64)]) -> Self {
        let sum: f64 = parts.iter().map(|(_, share)| share).sum();
        Self::Mix(parts.iter().map(|(d, share)| (*d, share / sum)).collect())
    }

    /// The mean volume of a sphere [length³]; that of a lognormal distribution as if it were not cut.
    pub fn mean_volume(&self) -> f64 {
        match self {
            Sizes::Mono(d) => volume_of(*d),
            Sizes::Uniform(a, b) => PI / 6.0 * ((a + b) * (a * a + b * b) / 4.0),
            Sizes::Lognormal(d, s) => PI / 6.0 * (d.powi(3) * (4.5 * s * s).exp()),
            Sizes::Mix(parts) => parts.iter().map(|(d, share)| share * volume_of(*d)).sum(),
        }
    }

    /// The largest diameter there may be [length].
    pub fn largest(&self) -> f64 {
        match self {
            Sizes::Mono(d) => *d,
            Sizes::Uniform(a, b) => a.max(*b),
            Sizes::Lognormal(d, s) => d * (TAIL * s).exp(),
            Sizes::Mix(parts) => parts.iter().map(|(d, _)| *d).fold(0.0, f64::max),
        }
    }

    /// The place of the size that a diameter is nearest to: always the first but in a mixture.
    pub fn kind_of(&self, diameter: f64) -> usize {
        let Sizes::Mix(parts) = self else { return 0 };
        let off = |k: &usize| (parts[*k].0 - diameter).abs();
        (0..parts.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
    }

    /// Radii of that much of spheres, as nearly as whole ones can.
    pub fn radii(&self, amount: Amount, stream: &mut ParkMiller) -> Vec<f64> {
        match (self, amount) {
            (Sizes::Mono(d), Amount::Volume(v)) => vec![0.5 * d; (v / self.mean_volume()).round() as usize],
            (Sizes::Mono(d), Amount::Number(n)) => vec![0.5 * d; n],
            (Sizes::Mix(parts), Amount::Volume(v)) => {
                let n = v / self.mean_volume();
                some_of_each(parts, parts.iter().map(|(_, share)| (share * n).round() as usize))
            }
            (Sizes::Mix(parts), Amount::Number(n)) => some_of_each(parts, whole(parts, n)),
            (_, Amount::Number(n)) => {
                (0..n).take_while(|k| !stop::cuts_at(*k)).map(|_| 0.5 * self.draw(stream)).collect()
            }
            (_, Amount::Volume(mut left)) => {
                let mut radii = vec![];
                while left > 0.0 && !stop::cuts_at(radii.len()) {
                    let d = self.draw(stream);
                    let own = volume_of(d);
                    if left < 0.5 * own {
                        break;
                    }
                    radii.push(0.5 * d);
                    left -= own;
                }
                radii
            }
        }
    }

    fn draw(&self, stream: &mut ParkMiller) -> f64 {
        match *self {
            Sizes::Mono(d) => d,
            Sizes::Uniform(a, b) => a + (b - a) * stream.uniform(),
            Sizes::Lognormal(d, s) => loop {
                let z = stream.gaussian();
                if z.abs() <= TAIL {
                    break d * (s * z).exp();
                }
            },
            // Counted out, not drawn.
            Sizes::Mix(ref parts) => parts.first().map_or(0.0, |(d, _)| *d),
        }
    }
}

/// Whole numbers near the shares of `n` that add up to it: what is left over goes to the largest remainders.
fn whole(parts: &[(f64, f64)], n: usize) -> impl Iterator<Item = usize> {
    let mut counts: Vec<usize> = parts.iter().map(|(_, share)| (share * n as f64) as usize).collect();
    let rest = |k: usize| parts[k].1 * n as f64 - (parts[k].1 * n as f64).floor();
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|a, b| rest(*b).total_cmp(&rest(*a)));
    let missing = n.saturating_sub(counts.iter().sum());
    order.into_iter().cycle().take(missing).for_each(|k| counts[k] += 1);
    counts.into_iter()
}

fn some_of_each(parts: &[(f64, f64)], counts: impl Iterator<Item = usize>) -> Vec<f64> {
    parts.iter().zip(counts).flat_map(|((d, _), n)| std::iter::repeat_n(0.5 * d, n)).collect()
}
