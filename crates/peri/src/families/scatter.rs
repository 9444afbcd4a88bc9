//! Factors of particles on what their bonds bear and on how stiff they are.

use super::Families;

/// The factors of a body's sites; where a list is empty all are 1.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Scatter {
    /// On critical stretches, by site.
    strength: Vec<f64>,
    /// The least of these.
    weakest: f64,
    /// On micro-moduli, by site.
    pub stiffness: Vec<f64>,
}

impl Scatter {
    /// Those of the particles at some sites, of columns by particle that are empty where nothing is said.
    fn new(particle: &[u32], strength: &[f64], stiffness: &[f64]) -> Self {
        let at_sites = |column: &[f64]| match column.is_empty() {
            true => vec![],
            false => particle.iter().map(|&p| factor(column, p as usize)).collect(),
        };
        let strength: Vec<f64> = at_sites(strength);
        let weakest = strength.iter().copied().fold(f64::INFINITY, f64::min);
        Self { strength, weakest, stiffness: at_sites(stiffness) }
    }

    /// Whether there is a factor for each site, or none.
    pub(super) fn fits(&self, sites: usize) -> bool {
        [&self.strength, &self.stiffness].into_iter().all(|list| list.is_empty() || list.len() == sites)
    }

    /// Whether bonds bear unlike stretches.
    pub fn uneven(&self) -> bool {
        !self.strength.is_empty()
    }

    /// The factor on the critical stretch of the bond between two sites: that of its weaker end (a chain is as strong as its
    /// weakest link; Weibull 1939).
    #[inline]
    pub fn strength(&self, ends: [usize; 2]) -> f64 {
        match self.strength.is_empty() {
            true => 1.0,
            false => self.strength[ends[0]].min(self.strength[ends[1]]),
        }
    }

    /// No bond's factor is less.
    pub fn weakest(&self) -> f64 {
        if self.strength.is_empty() { 1.0 } else { self.weakest }
    }

    /// The factor on the stiffness of a site's half of its bonds.
    #[inline]
    pub fn stiffness(&self, site: usize) -> f64 {
        self.stiffness.get(site).copied().unwrap_or(1.0)
    }
}

/// A particle's factor: particles that nothing was said of have 0 in their column, or no place in it.
fn factor(column: &[f64], particle: usize) -> f64 {
    match column.get(particle) {
        Some(&own) if own > 0.0 => own,
        _ => 1.0,
    }
}

impl Families {
    /// Gives particles factors on the critical stretches and on the micro-moduli of their bonds, in columns that are empty where
    /// there are none. A bond has the smaller strength of its ends and the mean of their stiffnesses, which only
    /// [`super::LawKind::Shaped`] asks for. To be said anew after [`Families::refresh`].
    pub fn scatter(&mut self, strength: &[f64], stiffness: &[f64]) {
        for body in &mut self.lattices {
            body.scatter = Scatter::new(&body.particle, strength, stiffness);
        }
        self.list.scatter = Scatter::new(&self.list.particle, strength, stiffness);
    }

    /// The factor on how stiff the bonds of a particle are.
    pub(crate) fn stiffness_of(&self, i: usize) -> f64 {
        let Some(place) = self.place.get(i).copied().filter(|place| *place != u32::MAX) else { return 1.0 };
        let body = self.lattices.partition_point(|b| b.first_place + b.particle.len() as u32 <= place);
        match self.lattices.get(body) {
            Some(body) => body.scatter.stiffness((place - body.first_place) as usize),
            None => self.list.scatter.stiffness((place - self.list.first_place) as usize),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::families::{
        Bounds, Families, FamilyOptions, Law, LawKind, Layout, PeriView, PmbCoeff, PmbTable,
    };
    use perigrain_base::math::rng::ParkMiller;
    use perigrain_base::math::scatter::{Distribution, gaussian};

    const BOUNDS: Bounds = Bounds { lo: [-50.0; 3], hi: [50.0; 3], periodic: [false; 3], tilt: [0.0; 3] };

    /// Bonds that live, and vectors of particles.
    type Shaken = (Vec<[u32; 2]>, Vec<[f64; 3]>, Vec<[f64; 3]>);

    /// A brick that is drawn and shaken in so many steps: bonds that live, by their ends, and the last forces.
    fn shaken(
        (layout, alpha): (Layout, f64),
        law: &Law,
        [strength, stiffness]: [&[f64]; 2],
        steps: usize,
    ) -> Shaken {
        let x0: Vec<[f64; 3]> =
            (0..540).map(|i| [f64::from(i % 18), f64::from(i / 18 % 6), f64::from(i / 108)]).collect();
        let (kind, volume) = (vec![1; x0.len()], vec![1.0; x0.len()]);
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 1.0, horizon: 3.01, s00: 0.01, alpha }).unwrap();
        let options = FamilyOptions { layout, ..FamilyOptions::new(1.0) };
        let mut x = x0.clone();
        macro_rules! view {
            () => {
                PeriView { x: &x, x0: &x0, kind: &kind, volume: &volume, bounds: BOUNDS, excluded: None }
            };
        }
        let mut families = Families::build_of(&view!(), &table, options, law.clone()).unwrap();
        families.scatter(strength, stiffness);
        let (mut random, mut f) = (ParkMiller::new(7), vec![]);
        for step in 0..steps {
            for (x, x0) in x.iter_mut().zip(&x0) {
                x[0] += 2e-4 * (step as f64 - 2.0) * (x0[0] - 9.0);
                *x = x.map(|a| a + 0.004 * (random.uniform() - 0.5));
            }
            f = vec![[0.0; 3]; x.len()];
            families.force(&view!(), &mut f, true, None);
        }
        let mut living = vec![];
        for (i, j) in (0..540).flat_map(|j| (0..j).map(move |i| (i, j))) {
            if families.bonded(i, j) {
                living.push([i, j]);
            }
        }
        (living, f, x)
    }

    fn drawn(of: Distribution, seed: u64) -> Vec<f64> {
        (0..540).map(|tag| of.factor(gaussian(seed, tag))).collect()
    }

    #[test]
    fn factors_of_one_change_no_bit() {
        let (shaped, ones) = (Law { kind: LawKind::Shaped, ..Law::default() }, [1.0; 540]);
        for layout in [Layout::Auto, Layout::List] {
            for law in [&Law::default(), &shaped] {
                let plain = shaken((layout, 0.25), law, [&[], &[]], 20);
                assert!(plain.0.len() < 20_000, "some break: {}", plain.0.len());
                assert!(plain == shaken((layout, 0.25), law, [&ones, &ones], 20));
            }
        }
    }

    /// Two steps, of which the second breaks bonds: those that live are those that bear their stretch.
    #[test]
    fn bonds_break_at_the_strength_of_their_weaker_end() {
        let factors = drawn(Distribution::Weibull(1.5), 4711);
        for layout in [Layout::Auto, Layout::List] {
            let (whole, ..) = shaken((layout, 0.0), &Law::default(), [&factors, &[]], 1);
            let (living, _, x) = shaken((layout, 0.0), &Law::default(), [&factors, &[]], 2);
            let bears = |ends: &&[u32; 2]| {
                let [i, j] = ends.map(|i| i as usize);
                let place = |i: usize| [i % 18, i / 18 % 6, i / 108].map(|a| a as f64);
                let length =
                    |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
                let stretch = length(x[i], x[j]) / length(place(i), place(j)) - 1.0;
                stretch <= 0.01 * factors[i].min(factors[j])
            };
            let expected: Vec<[u32; 2]> = whole.iter().filter(bears).copied().collect();
            assert!(expected.len() + 20 < whole.len(), "{} of {}", expected.len(), whole.len());
            assert_eq!(living, expected);
        }
    }

    /// Sums are rounded in another order on lattices: forces agree to some of their last digits.
    #[test]
    fn lattices_and_lists_agree() {
        let strength = drawn(Distribution::Weibull(4.0), 4711);
        let stiffness = drawn(Distribution::Normal(0.2), 12);
        let shaped = Law { kind: LawKind::Shaped, ..Law::default() };
        for law in [&Law::default(), &shaped] {
            let [a, b] = [Layout::Auto, Layout::List]
                .map(|layout| shaken((layout, 0.25), law, [&strength, &stiffness], 20));
            assert_eq!(a.0, b.0);
            let most = a.1.iter().flatten().fold(0.0f64, |m, f| m.max(f.abs()));
            let off = a.1.iter().flatten().zip(b.1.iter().flatten()).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-12 * most);
        }
    }

    /// A bond of two particles pulls with the mean of their factors, times c s V².
    #[test]
    fn stiffness_is_the_mean_of_both_ends() {
        let x0 = [[0.0; 3], [1.0, 0.0, 0.0]];
        let mut table = PmbTable::new(1);
        table.set(1, 1, PmbCoeff { c: 1.0, horizon: 1.4, s00: 1.0, alpha: 0.0 }).unwrap();
        let drawn = [[0.0; 3], [1.01, 0.0, 0.0]];
        let view =
            |x| PeriView { x, x0: &x0, kind: &[1; 2], volume: &[1.0; 2], bounds: BOUNDS, excluded: None };
        for layout in [Layout::Auto, Layout::List] {
            let options = FamilyOptions { layout, ..FamilyOptions::new(1.0) };
            let law =
                Law { kind: LawKind::Shaped, influence: crate::families::Influence::One, ..Law::default() };
            let mut families = Families::build_of(&view(&x0), &table, options, law).unwrap();
            families.scatter(&[], &[0.5, 1.1]);
            let mut f = [[0.0; 3]; 2];
            families.force(&view(&drawn), &mut f, false, None);
            // The weight of partial volumes is (1.4 + 0.5 − 1)/1.
            assert!((f[0][0] / (0.8 * 0.9 * 0.01) - 1.0).abs() < 1e-12, "{}", f[0][0]);
        }
    }
}
