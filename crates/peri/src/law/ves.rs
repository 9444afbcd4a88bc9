//! `ves`, the viscoelastic solid: bonds with a Maxwell element, a share of whose deviatoric stretch relaxes (Mitchell 2011).

use crate::law::formula::{Angles, BondLaw, deviatoric};
use crate::law::moment::{COLUMNS, Held, Moment};
use crate::law::site::{Site, Unrelaxed};
use crate::law::stretch::{Ends, Stretch};
use crate::law::style::{Bound, Kernels, Losses, Number, Style};
use perigrain_base::math::real::Real;

/// The law of decks.
pub static VES: Style = Style {
    of_bonds: true,
    losses: Losses::Relaxation,
    numbers: NUMBERS,
    lammps: Kernels::of::<Viscous<true, true>>(),
    steady: Some([Kernels::of::<Viscous<false>>(), Kernels::of::<Viscous<false, true>>()]),
    apart: Some("ves/apart"),
    ..Style::of::<Viscous>("ves", 2)
};

/// The same where types relax differently: each end of a bond remembers its own stretch.
pub static VES_APART: Style = Style {
    losses: Losses::RelaxationApart,
    numbers: NUMBERS,
    lammps: Kernels::of::<ViscousApart<true>>(),
    ..Style::of::<ViscousApart>("ves/apart", 7)
};

const NUMBERS: &[Number] = &[
    Number {
        keyword: "lambda",
        what: ["the relaxing share lambda", "lambda"],
        bound: Bound::Share("lambda is the share of G that relaxes: from 0 to 1"),
        of: |m| &mut m.lambda,
    },
    Number {
        keyword: "tau",
        what: ["the relaxation time tau", "tau"],
        bound: Bound::Positive,
        of: |m| &mut m.tau,
    },
];

/// A Maxwell element beside a spring: the element's stretch D is remembered, in the form of [`Held`]. Columns:
/// A = (3Kθ − 5GY)/m with Y = (1 − λ)θ + λ times the unrelaxed dilatation, B = 15G/m. The form that looks `BACK` serves for
/// any moment, the other for one that is [`Moment::steady`]. If `LAMMPS` each end takes its own dilatation for that of both, so
/// that ends pull unequally; columns are then 3Kθ/m, B, Y/3.
pub struct Viscous<const BACK: bool = true, const LAMMPS: bool = false>;

/// The pull of the effective stretch (1 − λ)s + λD over B, without A; brings what is remembered up to date.
#[inline(always)]
fn relaxed<R: Real, const BACK: bool>(bond: &Stretch<R>, memory: &mut [R; 2], moment: &Moment) -> R {
    let (decay, fresh) = (moment.decay, moment.fresh);
    // What of D does not come from this step's stretch.
    let mut left = memory[0];
    if BACK {
        left = element(bond.before, left, &moment.held) * decay;
        left = bond.before.fnma(bond.s.like(fresh), left);
        let hold = moment.hold;
        memory[0] = bond.s.fma(bond.s.like(hold.decay * fresh - hold.fresh), left * hold.decay);
    } else {
        memory[0] = bond.s.fma(bond.s.like(fresh * (decay - 1.0)), left * decay);
    }
    let own = bond.share * moment.lambda.mul_add(fresh - 1.0, 1.0);
    (left * moment.lambda).fma(bond.inverse, own)
}

/// D from what is remembered and the stretch at that time.
#[inline(always)]
fn element<R: Real>(s: R, remembered: R, held: &Held) -> R {
    s.fma(s.like(held.fresh), remembered) * (1.0 / held.decay)
}

/// (1 − λ)(s − θ/3)² + λ(D − unrelaxed/3)² of both ends, each with its own λ and D.
#[inline(always)]
fn relaxed_squares<R: Real>(bond: &Stretch<R>, ends: &[Angles<R>; 2], elements: &[R; 2]) -> (R, R) {
    let none = [bond.s.like(0.0); 2];
    let left = [Angles { now: ends[0].unrelaxed, ..ends[0] }, Angles { now: ends[1].unrelaxed, ..ends[1] }];
    // What has come since is not relaxed at all.
    let since = bond.s - bond.before;
    let whole = deviatoric(bond.s, ends, &none);
    let near = deviatoric(elements[0] + since, &left, &none).0;
    let far = deviatoric(elements[1] + since, &left, &none).1;
    (shared(whole.0, near, ends[0].relaxing), shared(whole.1, far, ends[1].relaxing))
}

/// (1 − λ) of the whole and λ of the part.
#[inline(always)]
fn shared<R: Real>(whole: R, part: R, lambda: R) -> R {
    whole * (lambda.like(1.0) - lambda) + part * lambda
}

impl<const BACK: bool, const LAMMPS: bool> BondLaw for Viscous<BACK, LAMMPS> {
    const COLUMNS: usize = if LAMMPS { 3 } else { 2 };
    const MEMORY: usize = 1;
    const BACK: bool = BACK;
    const RELAXES: bool = true;
    // The form that looks back is that of a run's first steps.
    const ALL_FORMS: bool = !BACK;
    #[inline(always)]
    fn pull<R: Real>(
        bond: &Stretch<R>,
        _: R,
        [own, far]: &Ends<R>,
        memory: &mut [R; 2],
        moment: &Moment,
    ) -> (R, R) {
        let (a, b) = (own[0] + far[0], own[1] + far[1]);
        let pull = b * relaxed::<R, BACK>(bond, memory, moment);
        if LAMMPS {
            let (near, far) = (b.fnma(own[2], a), b.fnma(far[2], a));
            return (near.fma(bond.inverse, pull), far.fma(bond.inverse, pull));
        }
        let pull = a.fma(bond.inverse, pull);
        (pull, pull)
    }
    #[inline(always)]
    fn squares<R: Real>(
        bond: &Stretch<R>,
        _: R,
        ends: &[Angles<R>; 2],
        memory: &[R; 2],
        moment: &Moment,
    ) -> (R, R) {
        let element = element(bond.before, memory[0], &moment.held);
        relaxed_squares(bond, ends, &[element; 2])
    }
    #[inline]
    fn slips(s: f64, memory: [f64; 2], held: Held, ends: [Unrelaxed; 2]) -> [f64; 2] {
        let element = (memory[0] + held.fresh * s) / held.decay;
        ends.map(|end| slip(s, element, end))
    }
    #[inline(always)]
    fn dilatation(site: &mut Site) -> f64 {
        relaxed_dilatation(site, site.moment.lambda, (site.moment.decay, site.moment.fresh))
    }
    #[inline(always)]
    fn columns(site: &mut Site) -> [f64; COLUMNS] {
        let (own, by_m) = (site.own, 1.0 / site.weighted);
        let (pressure, shear) = (own.bulk * site.theta * by_m, own.shear * by_m);
        let third = relaxed_third(site, site.moment.lambda, (site.moment.decay, site.moment.fresh));
        match LAMMPS {
            true => [pressure, shear, third, 0.0, 0.0, 0.0],
            false => [pressure - shear * third, shear, 0.0, 0.0, 0.0, 0.0],
        }
    }
}

/// Bonds whose ends relax differently, each with an element of its own whose stretch D is remembered as it is. Columns: 3Kθ/m, B,
/// Y/3, λ, and what of D and of the step's own stretch is left after the step. If `LAMMPS` each end takes its own λ, D and Y for those
/// of both.
pub struct ViscousApart<const LAMMPS: bool = false>;

impl<const LAMMPS: bool> BondLaw for ViscousApart<LAMMPS> {
    const COLUMNS: usize = 6;
    const MEMORY: usize = 2;
    const BACK: bool = true;
    const RELAXES: bool = true;
    const ALL_FORMS: bool = false;
    #[inline(always)]
    fn pull<R: Real>(
        bond: &Stretch<R>,
        _: R,
        [own, far]: &Ends<R>,
        memory: &mut [R; 2],
        moment: &Moment,
    ) -> (R, R) {
        let (one, flow) = (bond.s.like(1.0), bond.s.like(moment.flow));
        let step = bond.s - bond.before;
        let volumetric = own[0] + far[0];
        // What is left of the deviatoric stretch at each end.
        let mut left = [volumetric; 2];
        for (([_, _, third, lambda, decay, fresh], element), left) in
            [own, far].into_iter().zip(memory).zip(&mut left)
        {
            // A look at what is lets nothing relax.
            let (decay, fresh) = ((*decay - one).fma(flow, one), (*fresh - one).fma(flow, one));
            *element = decay * *element + fresh * step;
            *left = lambda.fma(*element, (one - *lambda) * bond.s) - *third;
        }
        let (near, away) = if LAMMPS {
            let stiff = own[1] + far[1];
            (stiff.fma(left[0], volumetric), stiff.fma(left[1], volumetric))
        } else {
            let pull = own[1].fma(left[0], far[1].fma(left[1], volumetric));
            (pull, pull)
        };
        (near * bond.inverse, away * bond.inverse)
    }
    #[inline(always)]
    fn squares<R: Real>(
        bond: &Stretch<R>,
        _: R,
        ends: &[Angles<R>; 2],
        memory: &[R; 2],
        _: &Moment,
    ) -> (R, R) {
        relaxed_squares(bond, ends, memory)
    }
    #[inline(always)]
    fn relaxing<R: Real>(end: &[R; COLUMNS], _: &Moment) -> R {
        end[3]
    }
    #[inline]
    fn slips(s: f64, memory: [f64; 2], _: Held, ends: [Unrelaxed; 2]) -> [f64; 2] {
        [slip(s, memory[0], ends[0]), slip(s, memory[1], ends[1])]
    }
    #[inline(always)]
    fn dilatation(site: &mut Site) -> f64 {
        relaxed_dilatation(site, site.own.lambda, site.own.left)
    }
    #[inline(always)]
    fn columns(site: &mut Site) -> [f64; COLUMNS] {
        let (own, by_m) = (site.own, 1.0 / site.weighted);
        let (lambda, (decay, fresh)) = (own.lambda, own.left);
        let third = relaxed_third(site, lambda, (decay, fresh));
        [own.bulk * site.theta * by_m, own.shear * by_m, third, lambda, decay, fresh]
    }
}

/// Of a Maxwell element what its spring does not bear; the dilatation relaxes with the others.
fn slip(s: f64, element: f64, end: Unrelaxed) -> f64 {
    s - element - (end.before - end.left) / 3.0
}

/// θ of a site of whose shear modulus the share `lambda` relaxes; `left` of its elements' stretch and of the step's own is left after the
/// step.
#[inline(always)]
fn relaxed_dilatation(site: &mut Site, lambda: f64, left: (f64, f64)) -> f64 {
    let Some(free) = site.free else { return site.dilatation() };
    let step = free.relax([site.sum_before, site.sum], lambda, left);
    if site.advance {
        // What has broken since has changed θ at once, which is not relaxed.
        site.unrelaxed.left += step.before - site.unrelaxed.before;
        site.unrelaxed.before = step.before;
        (site.slip, site.sum_before) = (step.slip, site.sum);
        site.heat += step.heat;
    }
    step.theta
}

/// Y/3.
#[inline(always)]
fn relaxed_third(site: &mut Site, lambda: f64, (decay, fresh): (f64, f64)) -> f64 {
    let left = decay * site.unrelaxed.left + fresh * (site.theta - site.unrelaxed.before);
    if site.advance {
        site.unrelaxed = Unrelaxed { before: site.theta, left };
    }
    ((1.0 - lambda) * site.theta + lambda * left) / 3.0
}
