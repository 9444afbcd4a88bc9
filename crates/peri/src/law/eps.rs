//! `eps`, the elastic, perfectly plastic solid: state-based, flows at a yield stress (Mitchell 2011).

use crate::law::formula::BondLaw;
use crate::law::moment::{COLUMNS, Held, Moment};
use crate::law::site::{Site, Unrelaxed};
use crate::law::stretch::{Ends, Stretch};
use crate::law::style::{Bound, Kernels, Losses, Number, Style};
use crate::law::terms::Sum;
use perigrain_base::math::real::Real;

/// The law of decks.
pub static EPS: Style = Style {
    of_bonds: true,
    losses: Losses::Flow,
    numbers: &[Number {
        keyword: "yield",
        what: ["the yield stress"; 2],
        bound: Bound::Positive,
        of: |m| &mut m.yield_stress,
    }],
    lammps: Kernels::of::<PlasticLammps>(),
    ..Style::of::<Plastic>("eps", 3)
};

/// Elastic, perfectly plastic: each end has flowed by its own plastic stretch. Columns: 3Kθ/m, B, θ/3, and the share
/// 1 − σ of the elastic deviatoric stretch that flows, σ being the yield limit over the trial state's norm.
pub struct Plastic;

impl BondLaw for Plastic {
    const COLUMNS: usize = 4;
    const MEMORY: usize = 2;
    const LAZY: bool = true;
    const NORM: Option<Sum> = Some(Sum::Norm);
    #[inline(always)]
    fn pull<R: Real>(
        bond: &Stretch<R>,
        _: R,
        ends: &Ends<R>,
        memory: &mut [R; 2],
        moment: &Moment,
    ) -> (R, R) {
        let mut pull = ends[0][0] + ends[1][0];
        for ([_, b, third, flowing, ..], flowed) in ends.iter().zip(memory) {
            let trial = bond.s - *third;
            *flowed = (*flowing * moment.flow).fma(trial - *flowed, *flowed);
            pull = b.fma(trial - *flowed, pull);
        }
        let pull = pull * bond.inverse;
        (pull, pull)
    }
    #[inline(always)]
    fn flows<R: Real>([own, far]: &Ends<R>) -> R::Mask {
        own[3].most(far[3]).at_least(own[3].like(f64::MIN_POSITIVE))
    }
    #[inline]
    fn slips(_: f64, memory: [f64; 2], _: Held, _: [Unrelaxed; 2]) -> [f64; 2] {
        memory
    }
    #[inline(always)]
    fn columns(site: &mut Site) -> [f64; COLUMNS] {
        let (own, by_m) = (site.own, 1.0 / site.weighted);
        [own.bulk * site.theta * by_m, own.shear * by_m, site.theta / 3.0, 0.0, 0.0, 0.0]
    }
    #[inline(always)]
    fn flow(site: &mut Site) -> [f64; COLUMNS] {
        let shear = site.own.shear / site.weighted;
        // In shear of the yield stress, directions averaged: 5 σ² Σ ω² w |xi|² V/m²; whole families with ω = 1 have
        // 2 · 25 σ²/(8π δ⁵) (Mitchell 2011).
        let limit = site.own.yield_stress * (5.0 * site.spread).sqrt() / site.weighted;
        let Return { pressure, third, scale, .. } = returned(site, shear * norm(site).sqrt(), limit);
        [pressure, shear, third, 1.0 - scale, 0.0, 0.0]
    }
}

/// LAMMPS' forces and its flow, which forgets the plastic stretch of what is elastic again. Columns: 3Kθ/m, B, θ/3, the
/// scale σ of the trial state, and the step of the plastic multiplier (0 where elastic). A bond flows by the multiplier
/// times ω times its deviatoric pull, in 2026 by half of their product without ω: (1 + m_i/m_j)/2 of what would return it to
/// the yield surface.
pub struct PlasticLammps;

impl BondLaw for PlasticLammps {
    const COLUMNS: usize = 5;
    const MEMORY: usize = 2;
    const LAZY: bool = true;
    const NORM: Option<Sum> = Some(Sum::NormLammps);
    #[inline(always)]
    fn pull<R: Real>(
        bond: &Stretch<R>,
        omega: R,
        ends: &Ends<R>,
        memory: &mut [R; 2],
        moment: &Moment,
    ) -> (R, R) {
        let gain = if moment.mended { omega.like(0.5) } else { omega };
        let (a, b) = (ends[0][0] + ends[1][0], ends[0][1] + ends[1][1]);
        let (one, zero, flow) = (omega.like(1.0), omega.like(0.0), omega.like(moment.flow));
        let mut pulls = [a, a];
        for (([_, _, third, scale, more, _], flowed), pull) in ends.iter().zip(memory).zip(&mut pulls) {
            let part = b * (bond.s - *third - *flowed) * *scale;
            *pull = (a + part) * bond.inverse;
            let next = R::choose(scale.at_least(one), zero, gain * part * *more + *flowed);
            *flowed = (next - *flowed).fma(flow, *flowed);
        }
        (pulls[0], pulls[1])
    }
    #[inline(always)]
    fn flows<R: Real>([own, far]: &Ends<R>) -> R::Mask {
        own[4].most(far[4]).at_least(own[4].like(f64::MIN_POSITIVE))
    }
    #[inline]
    fn slips(_: f64, memory: [f64; 2], _: Held, _: [Unrelaxed; 2]) -> [f64; 2] {
        memory
    }
    #[inline(always)]
    fn columns(site: &mut Site) -> [f64; COLUMNS] {
        let by_m = 1.0 / site.weighted;
        // What LAMMPS' norm has in the place of 1/m; 1/m itself in 2026.
        let share = if site.moment.mended { by_m } else { site.theta * by_m };
        [share, site.own.shear * by_m, site.theta / 3.0, 1.0, 0.0, 0.0]
    }
    #[inline(always)]
    fn flow(site: &mut Site) -> [f64; COLUMNS] {
        let shear = site.own.shear / site.weighted;
        let found = site.own.shear * norm(site).sqrt();
        let Return { pressure, third, scale, more } = returned(site, found, site.own.limit.sqrt());
        [pressure, shear, third, scale, more, 0.0]
    }
}

/// The squared norm of a site's trial state, with the share of its broken bonds.
#[inline(always)]
fn norm(site: &Site) -> f64 {
    site.sum + site.free.map_or(0.0, |free| free.rest(site.theta).powi(2) * site.gone_spread)
}

/// A site after its return to the yield surface.
struct Return {
    /// 3Kθ/m.
    pressure: f64,
    /// θ/3 of the trial state.
    third: f64,
    /// σ.
    scale: f64,
    /// The step of the plastic multiplier.
    more: f64,
}

/// Scales a trial state of this norm back to the limit, and lets the broken bonds of the site flow with the others.
#[inline(always)]
fn returned(site: &mut Site, norm: f64, limit: f64) -> Return {
    let (own, m, trial) = (site.own, site.weighted, site.theta);
    let shear = own.shear / m;
    let yields = site.advance && norm > limit;
    let (scale, more) = match yields {
        true => (limit / norm, (norm / limit - 1.0) / shear),
        false => (1.0, 0.0),
    };
    site.plastic += more;
    let mut pressure = own.bulk * trial / m;
    if let Some(free) = site.free.filter(|_| yields) {
        let (slip, next, heat) = free.flow(trial, scale);
        (site.slip, site.theta) = (slip, next);
        site.heat += heat;
        // Bonds flow under the dilatation of the trial state and pull under the one that is left.
        pressure = own.bulk * next / m - shear * (next - trial) / 3.0;
    }
    Return { pressure, third: trial / 3.0, scale, more }
}
