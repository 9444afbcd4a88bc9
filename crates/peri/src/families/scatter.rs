//! Factors of particles on what their bonds bear and on how stiff they are, and thermal strains.

/// The factors of a body's sites; where a list is empty all are 1.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Scatter {
    /// On critical stretches, by site.
    strength: Vec<f64>,
    /// The least of these.
    weakest: f64,
    /// On micro-moduli, by site.
    pub stiffness: Vec<f64>,
    /// Thermal strains, by site.
    #[serde(skip)]
    strain: Vec<f64>,
    /// The least of these.
    #[serde(skip)]
    coldest: f64,
}

impl Scatter {
    /// Those of the particles at some sites, of columns by particle that are empty where nothing is said.
    pub(crate) fn new(particle: &[u32], strength: &[f64], stiffness: &[f64]) -> Self {
        let at_sites = |column: &[f64]| match column.is_empty() {
            true => vec![],
            false => particle.iter().map(|&p| factor(column, p as usize)).collect(),
        };
        let strength: Vec<f64> = at_sites(strength);
        let weakest = strength.iter().copied().fold(f64::INFINITY, f64::min);
        Self { strength, weakest, stiffness: at_sites(stiffness), ..Self::default() }
    }

    /// Takes the thermal strains of the particles at some sites, of a column by particle that is empty where there are none.
    pub(crate) fn warm(&mut self, particle: &[u32], strain: &[f64]) {
        self.strain.clear();
        if !strain.is_empty() {
            self.strain.extend(particle.iter().map(|&p| strain.get(p as usize).copied().unwrap_or(0.0)));
        }
        self.coldest = self.strain.iter().copied().fold(0.0, f64::min);
    }

    /// Whether there are thermal strains.
    pub fn heated(&self) -> bool {
        !self.strain.is_empty()
    }

    /// Thermal strains by site; empty where there are none.
    pub fn strains(&self) -> &[f64] {
        &self.strain
    }

    /// The thermal strain of a site.
    #[inline]
    pub fn strain(&self, site: usize) -> f64 {
        self.strain.get(site).copied().unwrap_or(0.0)
    }

    /// The thermal strain of a bond, the mean of its ends'.
    #[inline]
    pub fn strain_between(&self, ends: [usize; 2]) -> f64 {
        match self.strain.is_empty() {
            true => 0.0,
            false => 0.5 * (self.strain[ends[0]] + self.strain[ends[1]]),
        }
    }

    /// The stretch at which a bond breaks that bears `s00` without factor and thermal strain.
    #[inline]
    pub fn limit(&self, s00: f64, ends: [usize; 2]) -> f64 {
        s00 * self.strength(ends) + self.strain_between(ends)
    }

    /// No bond breaks at less.
    pub fn lowest(&self, s00: f64) -> f64 {
        let lowest = s00 * self.weakest();
        match self.heated() && s00.is_finite() {
            // Less than what rounding to single numbers takes, above and below zero.
            true => lowest + self.coldest - 1e-5 * (lowest + self.coldest).abs(),
            false => lowest,
        }
    }

    /// Other factors on critical stretches, of the particles at the sites.
    pub(crate) fn set_strengths(&mut self, particle: &[u32], strength: &[f64]) {
        let stiffness = std::mem::take(&mut self.stiffness);
        *self = Self { stiffness, ..Self::new(particle, strength, &[]) };
    }

    /// Whether there is a factor for each site, or none.
    pub(super) fn fits(&self, sites: usize) -> bool {
        [&self.strength, &self.stiffness].into_iter().all(|list| list.is_empty() || list.len() == sites)
    }

    /// Whether bonds bear unlike stretches.
    pub fn uneven(&self) -> bool {
        !self.strength.is_empty() || self.heated()
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
