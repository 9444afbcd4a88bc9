//! Bonds with a Maxwell element: a share of the deviatoric stretch relaxes.

use crate::families::law::{COLUMNS, Held};
use crate::lanes::Lanes;
use crate::law::{Angles, BondLaw, Ends, Moment, Stretch, deviatoric};

/// A Maxwell element beside a spring: the element's stretch D is remembered, in the form that [`Held`] tells. Columns:
/// A = (3Kθ − 5GY)/m with Y = (1 − λ)θ + λ times the unrelaxed dilatation, B = 15G/m. The form that looks `BACK` serves for
/// any moment, the other for one that is [`Moment::steady`]. If `LAMMPS` each end takes its own dilatation for that of both, so
/// that ends pull unequally; columns are then 3Kθ/m, B, Y/3.
pub struct Viscous<const BACK: bool = true, const LAMMPS: bool = false>;

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

/// (1 − λ)(s − θ/3)² + λ(D − unrelaxed/3)² of both ends, each with its own λ and D.
#[inline(always)]
unsafe fn relaxed_squares<L: Lanes>(bond: &Stretch<L>, ends: &[Angles<L>; 2], elements: &[L; 2]) -> (L, L) {
    // SAFETY: passed on to the caller.
    unsafe {
        let none = [L::splat(0.0); 2];
        let left =
            [Angles { now: ends[0].unrelaxed, ..ends[0] }, Angles { now: ends[1].unrelaxed, ..ends[1] }];
        // What has come since is not relaxed at all.
        let since = bond.s.sub(bond.before);
        let whole = deviatoric(bond.s, ends, &none);
        let part = (
            deviatoric(elements[0].add(since), &left, &none).0,
            deviatoric(elements[1].add(since), &left, &none).1,
        );
        let one = L::splat(1.0);
        let both = |whole: L, part: L, share: L| whole.mul(one.sub(share)).add(part.mul(share));
        (both(whole.0, part.0, ends[0].relaxing), both(whole.1, part.1, ends[1].relaxing))
    }
}

impl<const BACK: bool, const LAMMPS: bool> BondLaw for Viscous<BACK, LAMMPS> {
    const COLUMNS: usize = if LAMMPS { 3 } else { 2 };
    const MEMORY: usize = 1;
    const BACK: bool = BACK;
    // The form that looks back is that of a run's first steps.
    const ALL_FORMS: bool = !BACK;
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
            if LAMMPS {
                let (near, far) = (b.fnma(own[2], a), b.fnma(far[2], a));
                return (near.fma(bond.inverse, pull), far.fma(bond.inverse, pull));
            }
            let pull = a.fma(bond.inverse, pull);
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
        unsafe {
            let element = element(bond.before, memory[0], &moment.held);
            relaxed_squares(bond, ends, &[element; 2])
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
    const ALL_FORMS: bool = false;
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
            let (one, flow) = (L::splat(1.0), L::splat(moment.flow));
            let step = bond.s.sub(bond.before);
            let volumetric = own[0].add(far[0]);
            // What is left of the deviatoric stretch at each end.
            let mut left = [volumetric; 2];
            let mut end = 0;
            while end < 2 {
                let this = if end == 0 { own } else { far };
                // A look at what is lets nothing relax.
                let (decay, fresh) = (this[4].sub(one).fma(flow, one), this[5].sub(one).fma(flow, one));
                memory[end] = decay.mul(memory[end]).add(fresh.mul(step));
                let kept = one.sub(this[3]).mul(bond.s);
                left[end] = this[3].fma(memory[end], kept).sub(this[2]);
                end += 1;
            }
            let (near, away) = if LAMMPS {
                let stiff = own[1].add(far[1]);
                (stiff.fma(left[0], volumetric), stiff.fma(left[1], volumetric))
            } else {
                let pull = own[1].fma(left[0], far[1].fma(left[1], volumetric));
                (pull, pull)
            };
            (near.mul(bond.inverse), away.mul(bond.inverse))
        }
    }
    #[inline(always)]
    unsafe fn squares<L: Lanes>(
        bond: &Stretch<L>,
        _: L,
        ends: &[Angles<L>; 2],
        memory: &[L; 2],
        _: &Moment,
    ) -> (L, L) {
        // SAFETY: passed on to the caller.
        unsafe { relaxed_squares(bond, ends, memory) }
    }
    #[inline(always)]
    unsafe fn relaxing<L: Lanes>(end: &[L; COLUMNS], _: &Moment) -> L {
        end[3]
    }
}
