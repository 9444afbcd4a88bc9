//! Between sweeps: from sums over bonds to what the next sweep reads at both ends of a bond.

use crate::families::law::{COLUMNS, Held, SiteState};
use crate::families::{Law, LawKind, PmbTable};
use crate::law::freed::{Free, Freed};
use crate::law::{BondLaw, Moment, of_law};
use perigrain_base::par::{self, Shared};

/// What turns sums into columns.
pub struct Settling<'a> {
    /// The law.
    pub law: &'a Law,
    /// Coefficients: horizons.
    pub table: &'a PmbTable,
    /// What is the same for all bonds.
    pub moment: Moment,
    /// LAMMPS' forces where they differ.
    pub compat: bool,
    /// Keep what sites remember.
    pub advance: bool,
    /// Energies are wanted of this evaluation.
    pub tallied: bool,
    /// The heat of flowing is counted.
    pub counted: bool,
}

/// Moduli of a type as laws need them.
#[derive(Clone, Copy, Default)]
struct Stiffness {
    /// 3K.
    bulk: f64,
    /// 15G.
    shear: f64,
    /// Yield stress.
    yield_stress: f64,
    /// Twice the yield limit of LAMMPS, 25 σ²/(8π δ⁵).
    limit: f64,
    /// Share of the shear modulus that relaxes.
    lambda: f64,
    /// What is left of an element's stretch after the step, and of the step's own.
    left: (f64, f64),
}

/// The sites of a body: how many, how many unused entries columns have before the first, how far columns are apart,
/// and the type of each.
pub struct Sites<'a> {
    /// Their number.
    pub count: usize,
    /// Unused entries.
    pub pad: usize,
    /// Distance of columns.
    pub stride: usize,
    /// Particle of each; `u32::MAX` where vacant.
    pub particle: &'a [u32],
    /// Types of particles.
    pub kind: &'a [u16],
    /// The type of all of them, if they have but one.
    pub only: Option<u16>,
    /// Factors on how stiff they are; empty where all are 1.
    pub stiffness: &'a [f64],
}

impl Stiffness {
    /// 3K and 15G.
    fn moduli(&self) -> (f64, f64) {
        (self.bulk, self.shear)
    }
}

impl Settling<'_> {
    fn stiffness(&self) -> Vec<Stiffness> {
        let types = 1..=self.table.types() as u16;
        let of = |kind: u16| {
            let m = self.law.of(kind);
            let horizon = self.table.get(kind, kind).map_or(1.0, |c| c.horizon);
            let limit =
                2.0 * 25.0 * m.yield_stress * m.yield_stress / (8.0 * std::f64::consts::PI * horizon.powi(5));
            Stiffness {
                bulk: 3.0 * m.bulk,
                shear: 15.0 * m.shear,
                yield_stress: m.yield_stress,
                limit,
                lambda: m.lambda,
                left: left(m.tau, self.law.dt, self.advance),
            }
        };
        types.map(of).collect()
    }

    /// The share of a site's shear modulus that relaxes, and what is left of it after the step.
    fn relaxing(&self, own: &Stiffness) -> (f64, (f64, f64)) {
        match self.law.kind {
            LawKind::Ves => (self.moment.lambda, (self.moment.decay, self.moment.fresh)),
            _ => (own.lambda, own.left),
        }
    }

    /// Makes room for the heat that broken bonds make in this evaluation, where that is counted.
    fn forget_heat(&self, freed: &mut Freed) {
        freed.heat.clear();
        if self.counted {
            freed.heat.resize(freed.gone.len(), 0.0);
        }
    }

    /// Notes the form in which bonds remember from now on.
    pub fn held(&self, state: &mut SiteState) {
        if self.advance && self.law.kind == LawKind::Ves {
            state.held = self.moment.hold;
        }
    }

    /// From the sums of dilatations to columns.
    pub fn dilatations(&self, state: &mut SiteState, sites: &Sites) {
        let stiffness = self.stiffness();
        let kind = self.law.kind;
        if let (LawKind::Lps, Some(only)) = (kind, sites.only) {
            return elastic(&stiffness[usize::from(only) - 1], state, sites);
        }
        self.forget_heat(&mut state.freed);
        let SiteState { weighted, theta, before, unrelaxed, freed, columns, sums, .. } = state;
        let freeing = Freeing::new(freed);
        let (theta, columns) = (Shared::new(theta), Shared::new(columns));
        let (before, unrelaxed) = (Shared::new(before), Shared::new(unrelaxed));
        par::for_chunks(sites.count, |range| {
            for site in range {
                let (at, p) = (sites.pad + site, sites.particle[site]);
                let m = weighted[at];
                let (mut angle, mut row) = (0.0, [0.0; COLUMNS]);
                // SAFETY: each site is one task's.
                let (before, unrelaxed) =
                    unsafe { (&mut before.get(at..at + 1)[0], &mut unrelaxed.get(at..at + 1)[0]) };
                if p != u32::MAX && m > 0.0 {
                    let own = stiffness[usize::from(sites.kind[p as usize]) - 1];
                    let by_m = 1.0 / m;
                    angle = match freeing.of(at, m, own.moduli()) {
                        Some(free) if kind.relaxes() => {
                            let (lambda, left) = self.relaxing(&own);
                            let step = free.relax([freeing.sum(at), sums[at]], lambda, left);
                            if self.advance {
                                // What has broken since has changed θ at once, which is not relaxed.
                                *unrelaxed += step.before - *before;
                                *before = step.before;
                                // SAFETY: as above.
                                unsafe {
                                    freeing.put(at, step.slip, step.heat);
                                    freeing.advance(at, sums[at]);
                                }
                            }
                            step.theta
                        }
                        Some(free) => free.dilatation(sums[at]),
                        None => 3.0 * by_m * sums[at],
                    };
                    let shear = own.shear * by_m;
                    row = match kind {
                        LawKind::Ves | LawKind::VesApart => {
                            let (lambda, (decay, fresh)) = self.relaxing(&own);
                            let left = decay * *unrelaxed + fresh * (angle - *before);
                            let third = ((1.0 - lambda) * angle + lambda * left) / 3.0;
                            if self.advance {
                                (*before, *unrelaxed) = (angle, left);
                            }
                            let pressure = own.bulk * angle * by_m;
                            match self.compat {
                                _ if kind == LawKind::VesApart => {
                                    [pressure, shear, third, lambda, decay, fresh]
                                }
                                true => [pressure, shear, third, 0.0, 0.0, 0.0],
                                false => [pressure - shear * third, shear, 0.0, 0.0, 0.0, 0.0],
                            }
                        }
                        LawKind::ElasticPlastic if self.compat => {
                            // What LAMMPS' norm has in the place of 1/m; 1/m itself in 2026.
                            let share = if self.moment.mended { by_m } else { angle * by_m };
                            [share, shear, angle / 3.0, 1.0, 0.0, 0.0]
                        }
                        LawKind::ElasticPlastic => {
                            [own.bulk * angle * by_m, shear, angle / 3.0, 0.0, 0.0, 0.0]
                        }
                        _ => [(own.bulk - own.shear / 3.0) * angle * by_m, shear, 0.0, 0.0, 0.0, 0.0],
                    };
                }
                // SAFETY: as above.
                unsafe { theta.get(at..at + 1)[0] = angle };
                put(&columns, sites, at, &row, columns_of(kind, self.compat));
            }
        });
    }

    /// How stiff each site's half of its microelastic bonds is: ½, or with surfaces corrected ½ πδ⁴/Σ c w |xi| V/c; times its
    /// factor.
    pub fn stiffen(&self, state: &mut SiteState, sites: &Sites) {
        let SiteState { weighted, columns, .. } = state;
        let columns = Shared::new(columns);
        par::for_chunks(sites.count, |range| {
            for site in range {
                let (at, p) = (sites.pad + site, sites.particle[site]);
                let mut share = 0.5;
                if p == u32::MAX {
                    share = 0.0;
                } else if self.law.surface && weighted[at] > 0.0 {
                    let kind = sites.kind[p as usize];
                    let horizon = self.table.get(kind, kind).map_or(0.0, |c| c.horizon);
                    share *= std::f64::consts::PI * horizon.powi(4) / weighted[at];
                }
                share *= sites.stiffness.get(site).copied().unwrap_or(1.0);
                put(&columns, sites, at, &[0.0, share, 0.0, 0.0, 0.0, 0.0], 2);
            }
        });
    }

    /// From the sums of norms to how much of each site's trial state flows.
    pub fn flow(&self, state: &mut SiteState, sites: &Sites) {
        let stiffness = self.stiffness();
        let SiteState { weighted, spread, theta, plastic, freed, columns, sums, .. } = state;
        let freeing = Freeing::new(freed);
        let (theta, plastic, columns) = (Shared::new(theta), Shared::new(plastic), Shared::new(columns));
        par::for_chunks(sites.count, |range| {
            for site in range {
                let (at, p) = (sites.pad + site, sites.particle[site]);
                let m = weighted[at];
                if p == u32::MAX || m <= 0.0 {
                    continue;
                }
                let own = stiffness[usize::from(sites.kind[p as usize]) - 1];
                let shear = own.shear / m;
                // SAFETY: each site is one task's.
                let angle = unsafe { &mut theta.get(at..at + 1)[0] };
                let trial = *angle;
                let free = freeing.of(at, m, own.moduli());
                let sum = sums[at] + free.map_or(0.0, |free| free.rest(trial).powi(2) * freeing.spread(at));
                let (norm, limit) = match self.compat {
                    true => (own.shear * sum.sqrt(), own.limit.sqrt()),
                    // In shear of the yield stress, directions averaged: 5 σ² Σ ω² w |xi|² V/m²; whole families with
                    // ω = 1 have 2 · 25 σ²/(8π δ⁵) (Mitchell 2011).
                    false => (shear * sum.sqrt(), own.yield_stress * (5.0 * spread[at]).sqrt() / m),
                };
                let yields = self.advance && norm > limit;
                let (scale, more) = match yields {
                    true => (limit / norm, (norm / limit - 1.0) / shear),
                    false => (1.0, 0.0),
                };
                // SAFETY: each site is one task's.
                unsafe { plastic.get(at..at + 1)[0] += more };
                let mut pressure = own.bulk * trial / m;
                if let Some(free) = free.filter(|_| yields) {
                    let (slip, next, heat) = free.flow(trial, scale);
                    // SAFETY: each site is one task's.
                    unsafe { freeing.put(at, slip, heat) };
                    // Bonds flow under the dilatation of the trial state and pull under the one that is left.
                    pressure = own.bulk * next / m - shear * (next - trial) / 3.0;
                    *angle = next;
                }
                let row = match self.compat {
                    true => [pressure, shear, trial / 3.0, scale, more, 0.0],
                    false => [pressure, shear, trial / 3.0, 1.0 - scale, 0.0, 0.0],
                };
                put(&columns, sites, at, &row, columns_of(LawKind::ElasticPlastic, self.compat));
            }
        });
    }
}

/// Broken bonds of sites while many tasks settle each its own sites.
struct Freeing<'a> {
    gone: &'a [f64],
    spread: &'a [f64],
    slip: Shared<'a, f64>,
    sum: Shared<'a, f64>,
    heat: Shared<'a, f64>,
}

impl<'a> Freeing<'a> {
    fn new(freed: &'a mut Freed) -> Self {
        let Freed { gone, slip, spread, sum, heat } = freed;
        Self { gone, spread, slip: Shared::new(slip), sum: Shared::new(sum), heat: Shared::new(heat) }
    }

    /// The broken bonds of a site with this weighted volume and these moduli; `None` where all live.
    fn of(&self, at: usize, m: f64, (bulk, shear): (f64, f64)) -> Option<Free> {
        let gone = self.gone.get(at).copied().filter(|gone| *gone > 0.0)?;
        // SAFETY: each site is one task's.
        let slip = unsafe { self.slip.get(at..at + 1)[0] };
        Some(Free { m, gone: gone.min(m), slip, bulk, shear })
    }

    fn spread(&self, at: usize) -> f64 {
        self.spread.get(at).copied().unwrap_or(0.0)
    }

    /// Σ ω w |xi| e V over living bonds in the last step that advanced, of a site with broken bonds.
    fn sum(&self, at: usize) -> f64 {
        // SAFETY: each site is one task's.
        unsafe { self.sum.get(at..at + 1)[0] }
    }

    /// Keeps that sum.
    ///
    /// # Safety
    /// No other task may touch the site, which has broken bonds.
    unsafe fn advance(&self, at: usize, sum: f64) {
        // SAFETY: passed on to the caller.
        unsafe { self.sum.get(at..at + 1)[0] = sum };
    }

    /// Keeps S and adds to the heat, where that is counted.
    ///
    /// # Safety
    /// No other task may touch the site, which has broken bonds.
    unsafe fn put(&self, at: usize, slip: f64, heat: f64) {
        // SAFETY: passed on to the caller.
        unsafe {
            self.slip.get(at..at + 1)[0] = slip;
            if at < self.heat.len() {
                self.heat.get(at..at + 1)[0] += heat;
            }
        }
    }
}

/// [`Settling::dilatations`] of a linear elastic body of one material: nothing but arithmetic for each site.
fn elastic(own: &Stiffness, state: &mut SiteState, sites: &Sites) {
    let SiteState { weighted, theta, freed, columns, sums, .. } = state;
    let (theta, columns) = (Shared::new(theta), Shared::new(columns));
    let pressure = own.bulk - own.shear / 3.0;
    par::for_chunks(sites.count, |range| {
        let (lo, hi) = (sites.pad + range.start, sites.pad + range.end);
        // SAFETY: each site is one task's.
        let (theta, first, second) = unsafe {
            let second = columns.get(sites.stride + lo..sites.stride + hi);
            (theta.get(lo..hi), columns.get(lo..hi), second)
        };
        let known = sites.particle[range].iter().zip(&weighted[lo..hi]).zip(&sums[lo..hi]);
        let columns = theta.iter_mut().zip(first.iter_mut()).zip(second);
        for (((p, m), sum), ((theta, first), second)) in known.zip(columns) {
            let by_m = if *p != u32::MAX && *m > 0.0 { 1.0 / m } else { 0.0 };
            let angle = 3.0 * by_m * sum;
            (*theta, *first, *second) = (angle, pressure * angle * by_m, own.shear * by_m);
        }
        let damaged =
            freed.gone.get(lo..hi).unwrap_or(&[]).iter().enumerate().filter(|(_, gone)| **gone > 0.0);
        for (k, _) in damaged {
            let m = weighted[lo + k];
            let Some(free) = freed.of(lo + k, m, own.moduli()) else { continue };
            theta[k] = free.dilatation(sums[lo + k]);
            first[k] = pressure * theta[k] / m;
        }
    });
}

/// Columns that a law uses.
pub fn columns_of(kind: LawKind, compat: bool) -> usize {
    of_law!(kind, compat, W => <W as BondLaw>::COLUMNS)
}

fn put(columns: &Shared<f64>, sites: &Sites, at: usize, row: &[f64; COLUMNS], count: usize) {
    for (k, value) in row.iter().take(count).enumerate() {
        let place = k * sites.stride + at;
        // SAFETY: each site is one task's.
        unsafe { columns.get(place..place + 1)[0] = *value };
    }
}

/// The moment of an evaluation: a step of `dt` if it advances, else a look at what is. The form in which a body's bonds have
/// remembered is the body's own.
pub fn moment(law: &Law, advance: bool) -> Moment {
    // One law has one relaxation; where types relax differently, columns of sites tell how.
    let own = law.moduli.iter().find(|m| m.tau > 0.0).copied().unwrap_or_default();
    let (decay, fresh) = left(own.tau, law.dt, advance);
    let flow = if advance { 1.0 } else { 0.0 };
    Moment {
        decay,
        fresh,
        lambda: own.lambda,
        flow,
        held: Held::default(),
        hold: Held::for_steps(decay, fresh),
        lost: law.lost,
        mended: false,
    }
}

/// What is left of a Maxwell element's stretch after a step, and of the stretch that comes evenly during the step.
fn left(tau: f64, dt: f64, advance: bool) -> (f64, f64) {
    let steps = if dt > 0.0 { tau / dt } else { f64::INFINITY };
    if !advance || !steps.is_finite() || steps <= 0.0 {
        return (1.0, 1.0);
    }
    let decay = (-1.0 / steps).exp();
    (decay, steps * (1.0 - decay))
}
