//! Diameters of spheres, all alike or drawn from a distribution.

use perigrain_base::math::rng::ParkMiller;
use perigrain_base::stop;
use std::f64::consts::PI;

/// Numbers of a normal distribution farther from its mean than so many deviations are drawn again.
const TAIL: f64 = 2.5;

/// A distribution of diameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sizes {
    /// All alike [length].
    Mono(f64),
    /// Anything between two diameters, by number [length].
    Uniform(f64, f64),
    /// The logarithm is normal: the median [length] and the deviation of the logarithm, cut at 2.5 deviations.
    Lognormal(f64, f64),
}

impl Sizes {
    /// The mean volume of a sphere [length³]; that of a lognormal distribution as if it were not cut.
    pub fn mean_volume(&self) -> f64 {
        PI / 6.0
            * match *self {
                Sizes::Mono(d) => d.powi(3),
                Sizes::Uniform(a, b) => (a + b) * (a * a + b * b) / 4.0,
                Sizes::Lognormal(d, s) => d.powi(3) * (4.5 * s * s).exp(),
            }
    }

    /// The largest diameter there may be [length].
    pub fn largest(&self) -> f64 {
        match *self {
            Sizes::Mono(d) => d,
            Sizes::Uniform(a, b) => a.max(b),
            Sizes::Lognormal(d, s) => d * (TAIL * s).exp(),
        }
    }

    /// Radii of spheres that have this volume together, as nearly as whole ones can.
    pub fn radii(&self, volume: f64, stream: &mut ParkMiller) -> Vec<f64> {
        if let Sizes::Mono(d) = *self {
            return vec![0.5 * d; (volume / self.mean_volume()).round() as usize];
        }
        let (mut radii, mut left) = (vec![], volume);
        while left > 0.0 && !stop::cuts_at(radii.len()) {
            let d = self.draw(stream);
            let own = PI / 6.0 * d.powi(3);
            if left < 0.5 * own {
                break;
            }
            radii.push(0.5 * d);
            left -= own;
        }
        radii
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
        }
    }
}
