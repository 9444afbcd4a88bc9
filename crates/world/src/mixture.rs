//! Mixtures of grains: kinds with their shares of the number, as `mixture` declares them.

use crate::Template;
use perigrain_base::math::body::{Quat, apply, matrix};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, add, length, sub};
use std::f64::consts::PI;
use std::sync::Arc;

/// A grain of several spheres.
#[derive(Clone, Debug, PartialEq)]
pub struct Clump {
    /// The name of its molecule template.
    pub name: String,
    /// Its spheres, whose masses sum to that of the grain.
    pub template: Template,
    /// The middle of its mass [length].
    pub centre: Vec3,
    /// Its volume, overlaps once [volume].
    pub volume: f64,
    /// Its mass [mass].
    pub mass: f64,
}

impl Clump {
    /// The places of its spheres when its centre lies at `at` and it is turned.
    pub fn places(&self, at: Vec3, q: Quat) -> Vec<Vec3> {
        let m = matrix(q);
        self.template.places.iter().map(|x| add(at, apply(&m, sub(*x, self.centre)))).collect()
    }

    /// The radius of the sphere about its centre that holds it [length].
    pub fn reach(&self) -> f64 {
        let each = self.template.places.iter().zip(&self.template.radii);
        each.map(|(x, r)| length(sub(*x, self.centre)) + r).fold(0.0, f64::max)
    }

    /// The density of its spheres: less than its own where they overlap, so that what they have in common counts once [density].
    pub fn density(&self) -> f64 {
        self.mass / self.template.radii.iter().map(|r| 4.0 / 3.0 * PI * r.powi(3)).sum::<f64>()
    }
}

/// One kind of grain in a mixture.
#[derive(Clone, Debug, PartialEq)]
pub struct Ingredient {
    /// The type; of several spheres that of the first.
    pub kind: u16,
    /// The radius; of several spheres that of the sphere which holds them [length].
    pub radius: f64,
    /// The density [density].
    pub density: f64,
    /// Its share of the number of grains.
    pub share: f64,
    /// The spheres, where it is not a single one.
    pub clump: Option<Arc<Clump>>,
}

impl Ingredient {
    /// The volume of a grain [volume].
    pub fn volume(&self) -> f64 {
        match &self.clump {
            Some(clump) => clump.volume,
            None => 4.0 / 3.0 * PI * self.radius.powi(3),
        }
    }

    /// The mass of a grain [mass].
    pub fn mass(&self) -> f64 {
        match &self.clump {
            Some(clump) => clump.mass,
            None => self.density * self.volume(),
        }
    }

    /// The radius of its largest sphere [length].
    pub fn largest(&self) -> f64 {
        let clump = self.clump.as_ref().map(|clump| clump.template.radii.iter().copied().fold(0.0, f64::max));
        clump.unwrap_or(self.radius)
    }
}

/// Kinds of grains, the largest first; their shares sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixture {
    /// The seed for what draws from it.
    pub seed: u32,
    /// The kinds.
    pub kinds: Vec<Ingredient>,
}

impl Mixture {
    /// Kinds with shares of the mass, or of the number, that need not sum to 1. A share of the mass is one of the number times the mass of
    /// a grain.
    pub fn new(seed: u32, mut kinds: Vec<Ingredient>, by_mass: bool) -> Self {
        for kind in &mut kinds {
            kind.share /= if by_mass { kind.mass() } else { 1.0 };
        }
        let sum: f64 = kinds.iter().map(|kind| kind.share).sum();
        kinds.iter_mut().for_each(|kind| kind.share /= sum);
        kinds.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        Self { seed, kinds }
    }

    /// The mean over the number of grains.
    fn mean(&self, of: impl Fn(&Ingredient) -> f64) -> f64 {
        self.kinds.iter().map(|kind| kind.share * of(kind)).sum()
    }

    /// The mean mass of a grain [mass].
    pub fn mean_mass(&self) -> f64 {
        self.mean(Ingredient::mass)
    }

    /// The mean volume of a grain [volume].
    pub fn mean_volume(&self) -> f64 {
        self.mean(Ingredient::volume)
    }

    /// The largest radius of a grain [length].
    pub fn widest(&self) -> f64 {
        self.kinds.first().map_or(0.0, |kind| kind.radius)
    }

    /// The largest radius of a sphere [length].
    pub fn largest(&self) -> f64 {
        self.kinds.iter().map(Ingredient::largest).fold(0.0, f64::max)
    }

    /// The grains of several spheres.
    pub fn clumps(&self) -> impl Iterator<Item = &Clump> {
        self.kinds.iter().filter_map(|kind| kind.clump.as_deref())
    }

    /// How many of each kind `n` grains are: `n` times its share rounded down, and the rest drawn by what was cut off, so that the mean
    /// over many draws is exact.
    pub fn counts(&self, n: u64, stream: &mut ParkMiller) -> Vec<u64> {
        let exact = self.kinds.iter().map(|kind| kind.share * n as f64);
        // A product such as 3 · (1/3) may be rounded to a little less than a whole number.
        let mut counts: Vec<u64> = exact.clone().map(|x| (x * (1.0 + 1e-12)) as u64).collect();
        let cut: Vec<f64> = exact.zip(&counts).map(|(x, n)| (x - *n as f64).max(0.0)).collect();
        let (all, rest) = (cut.iter().sum::<f64>(), n.saturating_sub(counts.iter().sum()));
        for _ in 0..rest {
            let mut left = stream.uniform() * all;
            let drawn = cut.iter().position(|part| {
                left -= part;
                left < 0.0
            });
            counts[drawn.unwrap_or(0)] += 1;
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(diameter: f64, share: f64) -> Ingredient {
        Ingredient { kind: 1, radius: 0.5 * diameter, density: 2500.0, share, clump: None }
    }

    // Mass shares 0.3 of 5 mm and 0.7 of 8 mm: number shares 0.3/m5 and 0.7/m8 over their sum; by number, mass shares likewise.
    #[test]
    fn shares_by_mass_and_number() {
        let m = Mixture::new(1, vec![kind(0.01, 0.3), kind(0.016, 0.7)], true);
        assert_eq!(m.kinds[0].radius, 0.008);
        assert!((m.kinds[1].share - 0.637_080_049_7).abs() < 1e-10);
        assert!((m.kinds[0].share - 0.362_919_950_3).abs() < 1e-10);
        let m = Mixture::new(1, vec![kind(0.01, 0.6), kind(0.016, 1.4)], false);
        let of_mass = |k: usize| m.kinds[k].share * m.kinds[k].mass() / m.mean_mass();
        assert!((of_mass(1) - 0.094_720_9).abs() < 1e-7 && (of_mass(0) - 0.905_279_1).abs() < 1e-7);
    }

    #[test]
    fn most_of_a_batch_is_not_drawn() {
        let m = Mixture::new(1, vec![kind(0.01, 0.3), kind(0.016, 0.7)], true);
        let mut stream = ParkMiller::new(4711);
        // 63.7 and 36.3 of 100.
        for _ in 0..50 {
            let counts = m.counts(100, &mut stream);
            assert!(counts == [36, 64] || counts == [37, 63], "{counts:?}");
        }
        // Of pairs the mean is that of the shares: 0.7258 large ones each, with a standard error of 0.004.
        let large: u64 = (0..10_000).map(|_| m.counts(2, &mut stream)[0]).sum();
        assert!((large as f64 / 1e4 - 0.7258).abs() < 0.02, "{large}");
        let thirds = Mixture::new(1, vec![kind(1.0, 1.0), kind(2.0, 1.0), kind(3.0, 1.0)], false);
        assert_eq!(thirds.counts(3, &mut stream), [1, 1, 1]);
        assert_eq!(thirds.counts(0, &mut stream), [0, 0, 0]);
    }
}
