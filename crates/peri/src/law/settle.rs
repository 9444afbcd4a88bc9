//! Between sweeps: from sums over bonds to what the next sweep reads at both ends of a bond.

use crate::law::formula::BondLaw;
use crate::law::freed::{Free, Freed};
use crate::law::moment::{COLUMNS, Moment};
use crate::law::site::{Site, Stiffness, Unrelaxed};
use crate::law::state::SiteState;
use perigrain_base::par;

/// What turns sums into columns.
pub struct Settling {
    /// Moduli by type − 1.
    pub stiffness: Vec<Stiffness>,
    /// Microelastic bonds are stiffer near surfaces.
    pub surface: bool,
    /// What is the same for all bonds.
    pub moment: Moment,
    /// LAMMPS' forces where they differ.
    pub compat: bool,
    /// What sites remember moves on.
    pub advance: bool,
    /// And is kept.
    pub keep: bool,
    /// Energies are wanted of this evaluation.
    pub tallied: bool,
    /// The heat of flowing is counted.
    pub counted: bool,
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
    /// Thermal strains; empty where there are none.
    pub strain: &'a [f64],
}

impl Sites<'_> {
    /// The part of a column that is of sites.
    fn own<'a>(&self, column: &'a mut [f64]) -> &'a mut [f64] {
        &mut column[self.pad..self.pad + self.count]
    }

    /// The same of what is kept of broken bonds, which is nothing where none has broken.
    fn some<'a>(&self, column: &'a mut [f64]) -> Option<&'a mut [f64]> {
        (!column.is_empty()).then(|| self.own(column))
    }

    /// The columns that kernels read.
    fn columns<'a>(&self, columns: &'a mut [f64]) -> Columns<'a> {
        let mut all = columns.chunks_exact_mut(self.stride).map(|column| self.own(column));
        let mut next = || all.next().unwrap_or_default();
        (next(), next(), next(), next(), next(), next())
    }
}

/// [`COLUMNS`] columns, of which parts are settled at the same time.
type Columns<'a> = (&'a mut [f64], &'a mut [f64], &'a mut [f64], &'a mut [f64], &'a mut [f64], &'a mut [f64]);

/// Puts the first numbers of a row to columns.
#[inline(always)]
fn put((a, b, c, d, e, f): &mut Columns, at: usize, row: &[f64; COLUMNS], count: usize) {
    for (column, number) in [a, b, c, d, e, f].into_iter().zip(row).take(count) {
        column[at] = *number;
    }
}

/// From the sums of dilatations to columns, under a law.
pub fn dilatations<W: BondLaw>(settling: &Settling, state: &mut SiteState, sites: &Sites) {
    if let (true, Some(only)) = (W::LINEAR, sites.only) {
        return linear(&settling.stiffness[usize::from(only) - 1], state, sites);
    }
    state.freed.heat.clear();
    if settling.counted {
        state.freed.heat.resize(state.freed.gone.len(), 0.0);
    }
    each::<W, false>(settling, state, sites, |site| {
        site.theta = W::dilatation(site);
        W::columns(site)
    });
}

/// From the sums of norms to how much of each site's trial state flows, under a law.
pub fn flow<W: BondLaw>(settling: &Settling, state: &mut SiteState, sites: &Sites) {
    each::<W, true>(settling, state, sites, W::flow);
}

/// Settles each site that has bonds; until they `FLOW`, others have no dilatation and zeros in their columns. What a law leaves as it is stays where
/// it is: bodies of many sites have these columns in slow memory.
fn each<W: BondLaw, const FLOW: bool>(
    settling: &Settling,
    state: &mut SiteState,
    sites: &Sites,
    settle: impl Fn(&mut Site) -> [f64; COLUMNS] + Sync,
) {
    let SiteState { weighted, spread, theta, before, unrelaxed, plastic, freed, columns, sums, .. } = state;
    let Freed { gone, slip, spread: gone_spread, sum: sum_before, heat } = freed;
    let of = |column: &[f64], at: usize| column.get(at).copied().unwrap_or(0.0);
    let relaxing = (!FLOW && W::RELAXES).then(|| (sites.own(before), sites.own(unrelaxed)));
    let numbers = (sites.own(theta), relaxing, FLOW.then(|| sites.own(plastic)));
    let broken = (sites.some(slip), sites.some(sum_before), sites.some(heat));
    let columns = sites.columns(columns);
    par::each(
        (numbers, broken, columns),
        |start, ((theta, mut relaxing, mut plastic), broken, mut columns)| {
            let (mut slip, mut sum_before, mut heat) = broken;
            for k in 0..theta.len() {
                let (at, p) = (sites.pad + start + k, sites.particle[start + k]);
                let m = weighted[at];
                if p == u32::MAX || m <= 0.0 {
                    if !FLOW {
                        theta[k] = 0.0;
                        put(&mut columns, k, &[0.0; COLUMNS], W::COLUMNS);
                    }
                    continue;
                }
                let own = settling.stiffness[usize::from(sites.kind[p as usize]) - 1];
                let lost = of(gone, at);
                let one = |column: &Option<&mut [f64]>| column.as_ref().map_or(0.0, |column| column[k]);
                let unrelaxed = relaxing.as_ref().map_or((0.0, 0.0), |(before, left)| (before[k], left[k]));
                let mut site = Site {
                    own,
                    weighted: m,
                    spread: if FLOW { spread[at] } else { 0.0 },
                    sum: sums[at],
                    theta: theta[k],
                    unrelaxed: Unrelaxed { before: unrelaxed.0, left: unrelaxed.1 },
                    plastic: one(&plastic),
                    free: (lost > 0.0).then(|| Free {
                        m,
                        gone: lost.min(m),
                        slip: one(&slip),
                        bulk: own.bulk,
                        shear: own.shear,
                    }),
                    gone_spread: of(gone_spread, at),
                    slip: one(&slip),
                    sum_before: one(&sum_before),
                    heat: one(&heat),
                    moment: &settling.moment,
                    advance: settling.advance,
                };
                put(&mut columns, k, &settle(&mut site), W::COLUMNS);
                theta[k] = site.theta;
                if !settling.keep {
                    continue;
                }
                if let Some((before, left)) = &mut relaxing {
                    (before[k], left[k]) = (site.unrelaxed.before, site.unrelaxed.left);
                }
                set(&mut plastic, k, site.plastic);
                if site.free.is_some() {
                    set(&mut slip, k, site.slip);
                    set(&mut sum_before, k, site.sum_before);
                    set(&mut heat, k, site.heat);
                }
            }
        },
    );
}

/// Puts a number to a column, if there is one.
#[inline(always)]
fn set(column: &mut Option<&mut [f64]>, at: usize, number: f64) {
    if let Some(column) = column {
        column[at] = number;
    }
}

/// [`dilatations`] of a linear elastic body of one material: nothing but arithmetic for each site.
fn linear(own: &Stiffness, state: &mut SiteState, sites: &Sites) {
    let SiteState { weighted, theta, freed, columns, sums, .. } = state;
    let pressure = own.bulk - own.shear / 3.0;
    let (first, second, ..) = sites.columns(columns);
    let (weighted, sums): (&[f64], &[f64]) = (sites.own(weighted), sites.own(sums));
    par::each((sites.own(theta), first, second, weighted, sums), |start, (theta, first, second, m, sum)| {
        let known = sites.particle[start..].iter().zip(m).zip(sum);
        let columns = theta.iter_mut().zip(first.iter_mut()).zip(second);
        for (((p, m), sum), ((theta, first), second)) in known.zip(columns) {
            let by_m = if *p != u32::MAX && *m > 0.0 { 1.0 / m } else { 0.0 };
            let angle = 3.0 * by_m * sum;
            (*theta, *first, *second) = (angle, pressure * angle * by_m, own.shear * by_m);
        }
        let (lo, hi) = (sites.pad + start, sites.pad + start + m.len());
        let damaged =
            freed.gone.get(lo..hi).unwrap_or(&[]).iter().enumerate().filter(|(_, gone)| **gone > 0.0);
        for (k, _) in damaged {
            let Some(free) = freed.of(lo + k, m[k], (own.bulk, own.shear)) else { continue };
            theta[k] = free.dilatation(sum[k]);
            first[k] = pressure * theta[k] / m[k];
        }
    });
}

/// Before dilatations are settled: takes the thermal strain ε from their sums, Σ ω w |xi| (e − ε |xi|) V over living bonds.
pub fn without_thermal_strain(state: &mut SiteState, sites: &Sites) {
    let SiteState { weighted, freed, sums, .. } = state;
    let lost = |at: usize| freed.gone.get(at).copied().unwrap_or(0.0);
    par::each((sites.own(sums), sites.strain), |start, (sums, strain): (&mut [f64], &[f64])| {
        for (k, (sum, strain)) in sums.iter_mut().zip(strain).enumerate() {
            let at = sites.pad + start + k;
            *sum -= strain * (weighted[at] - lost(at)).max(0.0);
        }
    });
}

/// Behind that: each end's force is that of the stretch less ε, A − B ε + B s. The dilatation kept is θ + 3ε, so that
/// s − θ/3 in energies is the deviatoric stretch without ε.
pub fn with_thermal_strain(state: &mut SiteState, sites: &Sites) {
    let SiteState { theta, columns, .. } = state;
    let (first, second, ..) = sites.columns(columns);
    let second: &[f64] = second;
    let columns = (sites.own(theta), first, second, sites.strain);
    par::each(columns, |_, (theta, first, second, strain): (&mut [f64], &mut [f64], &[f64], &[f64])| {
        for k in 0..strain.len() {
            first[k] -= second[k] * strain[k];
            theta[k] += 3.0 * strain[k];
        }
    });
}

/// How stiff each site's half of its microelastic bonds is: ½, or with surfaces corrected ½ πδ⁴/Σ c w |xi| V/c; times its
/// factor.
pub fn stiffen(settling: &Settling, state: &mut SiteState, sites: &Sites) {
    if !sites.strain.is_empty() {
        sites.own(&mut state.theta).fill(0.0);
    }
    let weighted = &state.weighted;
    par::each(sites.columns(&mut state.columns), |start, mut columns| {
        for k in 0..columns.0.len() {
            let (at, p) = (sites.pad + start + k, sites.particle[start + k]);
            let mut share = 0.5;
            if p == u32::MAX {
                share = 0.0;
            } else if settling.surface && weighted[at] > 0.0 {
                let horizon = settling.stiffness[usize::from(sites.kind[p as usize]) - 1].horizon;
                share *= std::f64::consts::PI * horizon.powi(4) / weighted[at];
            }
            share *= sites.stiffness.get(start + k).copied().unwrap_or(1.0);
            put(&mut columns, k, &[0.0, share, 0.0, 0.0, 0.0, 0.0], 2);
        }
    });
    if !sites.strain.is_empty() {
        with_thermal_strain(state, sites);
    }
}
