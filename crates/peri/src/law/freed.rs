//! What broken bonds leave at the sites of state-based bodies: breaking sets energy free and never makes any.
//!
//! The energy of a site is a quadratic form of the extensions e of its bonds. To sum living bonds alone over the weighted volume m of
//! the whole family deletes cross terms of that form, and the rest can be larger than the whole: where K > 5G/3, or where bonds have
//! flowed. Instead the extension of a broken bond is free: it takes the value at which the energy is least, which is where the bond
//! bears nothing, t = ω (3Kθ|xi|/m + 15G/m (e − θ|xi|/3 − e_p)) = 0. Freedom cannot raise a minimum.
//!
//! With φ = Σ ω w |xi|² V/m over living bonds, the share 1 − φ over broken ones, and S = Σ ω w |xi| e_p V over broken ones,
//!
//! ```text
//! D = φ + (1 − φ) 3K/(5G)        θ = (3/m) (Σ ω w |xi| e V + S)/D, the sum over living bonds
//! Ψ = ½Kθ² + ½ (15G/m) [Σ ω w (e − θ|xi|/3 − e_p)² V over living bonds + (Kθ/5G)² m (1 − φ)]
//! ```
//!
//! and the forces of living bonds, by the same formula as before, are exact gradients of Ψ. At K = 5G/3 (ν = ¼) without flow D is 1.

/// Columns of sites, with as many unused entries before the first as the others have; empty until a bond breaks.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Freed {
    /// Σ ω w |xi|² V over broken bonds, m (1 − φ).
    pub gone: Vec<f64>,
    /// S: the same with the stretch by which each bond had flowed or relaxed at this end, and what it has flowed by since.
    pub slip: Vec<f64>,
    /// Σ ω² w |xi|² V over broken bonds: their share of the norm that flows.
    pub spread: Vec<f64>,
    /// Σ ω w |xi| e V over living bonds in the last step that advanced.
    pub sum: Vec<f64>,
    /// What the last step that advanced turned into heat besides what living bonds lost, over the volume of the site.
    #[serde(skip)]
    pub heat: Vec<f64>,
}

/// What one end of a bond loses as it breaks.
#[derive(Clone, Copy, Debug)]
pub struct Loss {
    /// ω w |xi|² V of the partner.
    pub weight: f64,
    /// ω.
    pub omega: f64,
    /// By what stretch the end had flowed or relaxed.
    pub slip: f64,
    /// The stretch in the last step that advanced.
    pub stretch: f64,
}

impl Freed {
    /// Whether no bond has broken.
    pub fn is_empty(&self) -> bool {
        self.gone.is_empty()
    }

    /// Adds a broken bond to an entry of columns of so many; `whole` is the sum of the site's family while all of it lives.
    pub fn add(&mut self, (at, entries): (usize, usize), whole: f64, loss: Loss) {
        for column in [&mut self.gone, &mut self.slip, &mut self.spread, &mut self.sum] {
            column.resize(entries, 0.0);
        }
        if self.gone[at] == 0.0 {
            self.sum[at] = whole;
        }
        self.sum[at] -= loss.weight * loss.stretch;
        self.gone[at] += loss.weight;
        self.slip[at] += loss.weight * loss.slip;
        self.spread[at] += loss.weight * loss.omega;
    }

    /// The broken bonds of a site with the weighted volume `m` and the moduli 3K and 15G; `None` where all live.
    pub fn of(&self, at: usize, m: f64, (bulk, shear): (f64, f64)) -> Option<Free> {
        let gone = self.gone.get(at).copied().filter(|gone| *gone > 0.0)?;
        Some(Free { m, gone: gone.min(m), slip: self.slip[at], bulk, shear })
    }

    /// Numbers held.
    pub fn numbers(&self) -> usize {
        self.gone.len() + self.slip.len() + self.spread.len() + self.sum.len() + self.heat.len()
    }
}

/// The broken bonds of one site.
#[derive(Clone, Copy, Debug)]
pub struct Free {
    /// m.
    pub m: f64,
    /// m (1 − φ).
    pub gone: f64,
    /// S.
    pub slip: f64,
    /// 3K.
    pub bulk: f64,
    /// 15G.
    pub shear: f64,
}

/// Families of which no more than this share lives have no dilatation: what is left is rounding.
const NONE_LEFT: f64 = 1e-12;

impl Free {
    /// (1 − φ) 3K/(5G).
    fn lent(&self) -> f64 {
        self.gone / self.m * 3.0 * self.bulk / self.shear
    }

    /// φ.
    fn living(&self) -> f64 {
        1.0 - self.gone / self.m
    }

    /// D.
    fn ease(&self) -> f64 {
        self.living() + self.lent()
    }

    /// θ from Σ ω w |xi| e V over living bonds and from so much of S.
    fn angle(&self, sum: f64, slip: f64) -> f64 {
        // Bonds that give way without shear (G = 0) leave no dilatation.
        if self.living() <= NONE_LEFT { 0.0 } else { 3.0 / self.m * (sum + slip) / self.ease() }
    }

    /// θ of elastic and plastic bonds.
    pub fn dilatation(&self, sum: f64) -> f64 {
        self.angle(sum, self.slip)
    }

    /// Kθ/(5G): the elastic deviatoric stretch that broken bonds have, but for its sign.
    pub fn rest(&self, theta: f64) -> f64 {
        if self.shear > 0.0 { self.bulk * theta / self.shear } else { 0.0 }
    }

    /// What broken bonds have of the energy of a site, over its volume: ½ (15G/m) (Kθ/5G)² m (1 − φ).
    pub fn energy(&self, theta: f64) -> f64 {
        0.5 * self.shear / self.m * self.rest(theta).powi(2) * self.gone
    }

    /// Lets the share 1 − `scale` of the elastic deviatoric stretch flow at a site with the dilatation `theta`; returns S, θ, and the
    /// heat besides that of living bonds taken at the new θ.
    pub fn flow(&self, theta: f64, scale: f64) -> (f64, f64, f64) {
        let by = (1.0 - scale) * self.rest(theta) * self.gone;
        if self.living() <= NONE_LEFT {
            return (self.slip - by, theta, 0.0);
        }
        let next = theta - 3.0 / self.m * by / self.ease();
        // Ψ at the old θ less Ψ at the new one before bonds flow; ∂Ψ/∂θ = (K + 5G/3) D θ − (5G/3) D θ_old.
        let (half_bulk, shear) = (self.bulk / 6.0, self.shear / 18.0);
        let heat = self.ease() * (theta - next) * (half_bulk * (theta + next) - shear * (theta - next));
        (self.slip - by, next, heat)
    }

    /// A step of viscous bonds, of whose shear modulus the share `lambda` relaxes; `decay` and `fresh` are left of what was stretched
    /// before the step and in it. `sums` are Σ ω w |xi| e V over the bonds that live now, before the step and after it.
    ///
    /// θ follows from the sum and λS, S being what dashpots have given way by. Those of broken bonds do so under what their springs
    /// bear: with X = λS − (Kθ/5G) m (1 − φ) for Σ ω w |xi| e_d V, X' − S' = decay (X − S) + fresh (X' − X), as of any bond.
    pub fn relax(&self, sums: [f64; 2], lambda: f64, (decay, fresh): (f64, f64)) -> Relaxed {
        let [before, trial] = sums.map(|sum| self.angle(sum, lambda * self.slip));
        let still = Relaxed { slip: self.slip, before, theta: trial, heat: 0.0 };
        if self.living() <= NONE_LEFT || decay >= 1.0 || self.shear <= 0.0 {
            return still;
        }
        let bears = self.lent() / self.ease();
        let kept = lambda * (1.0 - bears);
        let x = lambda * self.slip - self.rest(before) * self.gone;
        let new = fresh * x - decay * (x - self.slip) - (1.0 - fresh) * bears * sums[1];
        let slip = new / (1.0 - kept * (1.0 - fresh));
        let theta = self.angle(sums[1], lambda * slip);
        // Where nothing moves the energy goes as ½ K D θ².
        let heat = self.bulk / 6.0 * self.ease() * (trial * trial - theta * theta);
        Relaxed { slip, theta, heat, ..still }
    }
}

/// What a step has made of the broken bonds of a viscous site.
#[derive(Clone, Copy, Debug)]
pub struct Relaxed {
    /// S.
    pub slip: f64,
    /// θ before the step, without the bonds that have broken since it was found.
    pub before: f64,
    /// θ.
    pub theta: f64,
    /// The heat of broken bonds, over the volume of the site.
    pub heat: f64,
}

#[cfg(test)]
mod tests;
