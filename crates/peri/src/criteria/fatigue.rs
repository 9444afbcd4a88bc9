//! Bonds that tire under loads that repeat (Silling & Askari 2014).
//!
//! Each bond has a life λ, 1 at first, of which a cycle takes A ε^m; ε = (1 − R) max(s, 0) is the range of its stretch between the
//! lower load, R times the upper one, and the upper one. It breaks where nothing is left. Cracks are initiated by A₁, m₁ and what ε has
//! beyond E₁; near a site that has lost half of its family, a crack grows by A₂, m₂.

use super::candidate;
use crate::families::bond::Broken;
use crate::families::{Families, Moved, PeriView};
use crate::law::series::stretch;
use crate::shares::square;

/// Lives that end within this part of the same number of cycles end together: those of bonds that a symmetry maps to each other.
const TOGETHER: f64 = 1e-9;

/// How bonds tire.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fatigue {
    /// A₁, m₁ and E₁ of bonds away from cracks.
    pub init: [f64; 3],
    /// A₂ and m₂ of bonds near a crack.
    pub grow: [f64; 2],
    /// R, the lower load over the upper one.
    pub ratio: f64,
    /// A site of this damage is at the face of a crack.
    pub cracked: f64,
}

impl Fatigue {
    /// What a cycle takes from the life of a bond of a stretch, near a crack or not.
    fn rate(&self, s: f64, near: bool) -> f64 {
        let range = (1.0 - self.ratio) * s.max(0.0);
        let ([a, m], range) = match near {
            true => (self.grow, range),
            false => ([self.init[0], self.init[1]], (range - self.init[2]).max(0.0)),
        };
        if range > 0.0 { a * range.powf(m) } else { 0.0 }
    }
}

/// What some cycles have done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tired {
    /// How many cycles.
    pub cycles: f64,
    /// Bonds that broke.
    pub broken: usize,
    /// The largest stretch of a bond at the upper load.
    pub stretch: f64,
}

impl Families {
    /// Lets as many cycles pass as the bond that tires first bears, `most` at most, at the stretches of the last step that advanced. It
    /// breaks, with those that have no more than `batch` of their lives left by then.
    pub fn tire(&mut self, view: &PeriView, rules: &Fatigue, most: f64, batch: f64) -> Tired {
        let near = self.near_cracks(view, rules.cracked);
        let cell = self.cell_before();
        let mut rates = vec![];
        let mut tired = Tired { cycles: most, ..Tired::default() };
        self.each_living(|body, sites, bond, ends| {
            let [i, j] = sites;
            let (z, life, scatter) = match self.lattices.get(body) {
                Some(own) => (own.z(0, i, j, bond), own.life.get(own.place_of(i, bond)), &own.scatter),
                None => (self.list.z(true, i, j, &cell).0, self.list.life.get(bond), &self.list.scatter),
            };
            let s = stretch(z) - scatter.strain_between(sites);
            let spared = ends.iter().any(|p| self.lasting.get(*p as usize).copied().unwrap_or(false));
            let tip = ends.iter().any(|p| near.get(*p as usize).copied().unwrap_or(false));
            let rate = if spared { 0.0 } else { rules.rate(s, tip) };
            if rate > 0.0 {
                tired.cycles = tired.cycles.min(life.copied().unwrap_or(1.0) / rate);
            }
            tired.stretch = tired.stretch.max(s);
            rates.push(rate);
        });
        let mut ended = vec![];
        self.live(&rates, tired.cycles);
        let mut rates = rates.into_iter();
        self.each_living(|body, sites, bond, ends| {
            let rate = rates.next().unwrap_or(0.0);
            let left = match self.lattices.get(body) {
                Some(own) => own.life[own.place_of(sites[0], bond)],
                None => self.list.life[bond],
            };
            // What is left of a life that ends now is rounding of what the cycles have taken.
            if rate > 0.0 && left <= batch.max(TOGETHER * rate * tired.cycles) {
                let bond = candidate(sites, bond, 1.0);
                ended.push(Broken { body, bond, square: square(view, ends) });
            }
        });
        tired.broken = ended.len();
        self.tear(view, &cell, &ended, Moved::Before);
        if !ended.is_empty() {
            self.list.limits.least.clear();
            self.forget_near();
        }
        tired
    }

    /// Takes from the life of each living bond what so many cycles take at these rates.
    fn live(&mut self, rates: &[f64], cycles: f64) {
        let mut places = vec![];
        self.each_living(|body, sites, bond, _| {
            places.push((body, self.lattices.get(body).map_or(bond, |own| own.place_of(sites[0], bond))));
        });
        for body in &mut self.lattices {
            body.life.resize(body.alive.len() * crate::families::lattice::LANES, 1.0);
        }
        self.list.life.resize(self.list.partner.len(), 1.0);
        for ((body, place), rate) in places.into_iter().zip(rates) {
            let life = match self.lattices.get_mut(body) {
                Some(own) => &mut own.life[place],
                None => &mut self.list.life[place],
            };
            *life -= rate * cycles;
        }
    }

    /// Whether a particle or one that it was bonded to at the start is at the face of a crack.
    fn near_cracks(&self, view: &PeriView, cracked: f64) -> Vec<bool> {
        let mut damage = vec![0.0; view.x.len()];
        self.damage_all(view.volume, &mut damage);
        let mut near = vec![false; damage.len()];
        for (i, _) in damage.iter().enumerate().filter(|(_, d)| **d >= cracked) {
            near[i] = true;
            self.neighbours(i).iter().for_each(|n| near[n.partner as usize] = true);
        }
        near
    }
}
