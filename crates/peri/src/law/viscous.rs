//! Bonds with a Maxwell element: a share of the deviatoric stretch relaxes.

use crate::families::law::{COLUMNS, Held};
use crate::law::{Angles, BondLaw, Ends, Moment, Stretch, deviatoric};
use perigrain_base::math::real::Real;

/// A Maxwell element beside a spring: the element's stretch D is remembered, in the form that [`Held`] tells. Columns:
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
}

/// Bonds whose ends relax differently, each with an element of its own whose stretch D is remembered as it is. Columns: 3Kθ/m, B,
/// Y/3, λ, and what of D and of the step's own stretch is left after the step. If `LAMMPS` each end takes its own λ, D and Y for those
/// of both.
pub struct ViscousApart<const LAMMPS: bool = false>;

impl<const LAMMPS: bool> BondLaw for ViscousApart<LAMMPS> {
    const COLUMNS: usize = 6;
    const MEMORY: usize = 2;
    const BACK: bool = true;
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
}
