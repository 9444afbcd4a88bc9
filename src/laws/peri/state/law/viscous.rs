//! Bonds with a Maxwell element: a share of the deviatoric stretch relaxes.

use super::super::super::lanes::Lanes;
use super::{Angles, BondLaw, Ends, Moment, Stretch, deviatoric};
use crate::world::families::law::Held;

/// A Maxwell element beside a spring: the element's stretch D is remembered, in the form that [`Held`] tells. Columns:
/// A = (3Kθ − 5GY)/m with Y = (1 − λ)θ + λ times the unrelaxed dilatation, B = 15G/m. The form that looks `BACK` serves for
/// any moment, the other for one that is [`Moment::steady`].
pub struct Viscous<const BACK: bool = true>;

/// The pull of the effective stretch (1 − λ)s + λD over B, without A; brings what is remembered up to date.
#[inline(always)]
unsafe fn relaxed<L: Lanes, const BACK: bool>(bond: &Stretch<L>, memory: &mut [L; 2], moment: &Moment) -> L {
    // SAFETY: passed on to the caller.
    unsafe {
        let (decay, fresh) = (moment.decay, moment.fresh);
        // What of D does not come from this step's stretch.
        let mut left = memory[0];
        if BACK {
            left = element(bond.before, left, &moment.held).mul(L::splat(decay));
            left = bond.before.fnma(L::splat(fresh), left);
            let hold = moment.hold;
            let new = left.mul(L::splat(hold.decay));
            memory[0] = bond.s.fma(L::splat(hold.decay * fresh - hold.fresh), new);
        } else {
            memory[0] = bond.s.fma(L::splat(fresh * (decay - 1.0)), left.mul(L::splat(decay)));
        }
        let own = bond.share.mul(L::splat(moment.lambda.mul_add(fresh - 1.0, 1.0)));
        left.mul(L::splat(moment.lambda)).fma(bond.inverse, own)
    }
}

/// D from what is remembered and the stretch at that time.
#[inline(always)]
unsafe fn element<L: Lanes>(s: L, remembered: L, held: &Held) -> L {
    // SAFETY: passed on to the caller.
    unsafe { s.fma(L::splat(held.fresh), remembered).mul(L::splat(1.0 / held.decay)) }
}

/// (1 − λ)(s − θ/3)² + λ(D − unrelaxed/3)² of both ends.
#[inline(always)]
unsafe fn relaxed_squares<L: Lanes>(
    bond: &Stretch<L>,
    ends: &[Angles<L>; 2],
    memory: &[L; 2],
    moment: &Moment,
) -> (L, L) {
    // SAFETY: passed on to the caller.
    unsafe {
        let none = [L::splat(0.0); 2];
        let left =
            [Angles { now: ends[0].unrelaxed, ..ends[0] }, Angles { now: ends[1].unrelaxed, ..ends[1] }];
        // What has come since is not relaxed at all.
        let since = bond.s.sub(bond.before);
        let element = element(bond.before, memory[0], &moment.held).add(since);
        let (whole, part) = (deviatoric(bond.s, ends, &none), deviatoric(element, &left, &none));
        let (kept, relaxing) = (L::splat(1.0 - moment.lambda), L::splat(moment.lambda));
        (whole.0.mul(kept).add(part.0.mul(relaxing)), whole.1.mul(kept).add(part.1.mul(relaxing)))
    }
}

impl<const BACK: bool> BondLaw for Viscous<BACK> {
    const COLUMNS: usize = 2;
    const MEMORY: usize = 1;
    const BACK: bool = BACK;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        [own, far]: &Ends<L>,
        memory: &mut [L; 2],
        moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let (a, b) = (own[0].add(far[0]), own[1].add(far[1]));
            let pull = a.fma(bond.inverse, b.mul(relaxed::<L, BACK>(bond, memory, moment)));
            (pull, pull)
        }
    }
    #[inline(always)]
    unsafe fn squares<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        ends: &[Angles<L>; 2],
        memory: &[L; 2],
        moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe { relaxed_squares(bond, ends, memory, moment) }
    }
}

/// The same with LAMMPS' forces: each end takes its own dilatation for that of both, so that ends pull unequally.
/// Columns: 3Kθ/m, B, Y/3.
pub struct ViscousLammps<const BACK: bool = true>;

impl<const BACK: bool> BondLaw for ViscousLammps<BACK> {
    const COLUMNS: usize = 3;
    const MEMORY: usize = 1;
    const BACK: bool = BACK;
    #[inline(always)]
    unsafe fn pull<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        [own, far]: &Ends<L>,
        memory: &mut [L; 2],
        moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let (a, b) = (own[0].add(far[0]), own[1].add(far[1]));
            let pull = b.mul(relaxed::<L, BACK>(bond, memory, moment));
            let (near, far) = (b.fnma(own[2], a), b.fnma(far[2], a));
            (near.fma(bond.inverse, pull), far.fma(bond.inverse, pull))
        }
    }
    #[inline(always)]
    unsafe fn squares<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        ends: &[Angles<L>; 2],
        memory: &[L; 2],
        moment: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe { relaxed_squares(bond, ends, memory, moment) }
    }
}
