//! Bond laws over the bonds in hand: forces, sums of both ends, energies.

use crate::families::list::GROUP;
use crate::lattice::chunk::SUMS;
use crate::law::formula::{Angles, BondLaw};
use crate::law::moment::COLUMNS;
use crate::law::moment::Moment;
use crate::law::stretch::{Ends, Stretch, closed};
use crate::law::terms::Term;
use crate::list::kernel::{Block, Row, partners, scatter, steps, stretch};
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::lanes::{Lanes, load_rows};
use perigrain_base::math::real::Real;
use perigrain_base::math::vec3::SIX;
use std::marker::PhantomData;
use std::ptr::null_mut;

/// What laws need besides the bonds in hand.
pub struct Acting<'a> {
    /// What ends have: [`Acting::stride`] numbers for each record.
    pub ends: &'a [f64],
    /// Memory of all bonds; see [`crate::families::list::ListBody::state`].
    pub memory: *mut f64,
    /// Whether the bonds of this record remember anything but zeros.
    pub known: bool,
    /// Bonds remember from now on what they have come to.
    pub keep: bool,
    /// The least measures of families are kept, as fourth numbers of rows.
    pub least: bool,
    /// What is the same for all bonds.
    pub moment: Moment,
}

// SAFETY: memory is reached by kernels only, whose callers promise that a bond is in the hands of one thread.
unsafe impl Sync for Acting<'_> {}

impl Acting<'_> {
    /// How many numbers each end has for a law of so many columns.
    pub fn stride(columns: usize) -> usize {
        columns.next_multiple_of(4)
    }
}

/// The first `count` numbers of the ends of some bonds, of which each record has them in a row.
#[inline(always)]
unsafe fn far<const N: usize, V: Lanes<N>>(ends: &[f64], count: usize, target: *const u32) -> [V; COLUMNS] {
    // SAFETY: partners are records, and rows are filled up to four numbers.
    unsafe {
        let mut columns = [V::all(0.0); COLUMNS];
        let stride = Acting::stride(count);
        let mut first = 0;
        while first < count {
            let ends = ends.as_ptr().cast_mut();
            let rows = partners!(N, null_mut(), |k| ends.add(stride * *target.add(k) as usize));
            let four: [V; 4] = load_rows(&rows, first);
            let mut k = first;
            while k < count && k < first + 4 {
                columns[k] = four[k - first];
                k += 1;
            }
            first += 4;
        }
        columns
    }
}

/// The same of the record itself, in all lanes.
#[inline(always)]
fn near<R: Real>(zero: R, ends: &[f64], count: usize, record: usize) -> [R; COLUMNS] {
    let mut columns = [zero; COLUMNS];
    let mut k = 0;
    while k < count {
        columns[k] = zero.like(ends[Acting::stride(count) * record + k]);
        k += 1;
    }
    columns
}

/// Where number `k` of `numbers` is that the bonds at a place remember.
#[inline(always)]
fn memory(a: &Acting, place: usize, numbers: usize, k: usize) -> *mut f64 {
    a.memory.wrapping_add((place / GROUP * numbers + k) * GROUP + place % GROUP)
}

#[inline(always)]
unsafe fn recall<const N: usize, V: Lanes<N>>(a: &Acting, place: usize, numbers: usize) -> [V; 2] {
    // SAFETY: places are those of bonds, each with `numbers` numbers.
    unsafe {
        let mut out = [V::all(0.0); 2];
        if a.known {
            let mut k = 0;
            while k < numbers {
                out[k] = V::read(memory(a, place, numbers, k));
                k += 1;
            }
        }
        out
    }
}

/// The stretch of some of the bonds in hand.
#[inline(always)]
fn stretched<const N: usize, V: Lanes<N>>(
    zero: V,
    b: &Block,
    at: usize,
    [s, back, limited]: [bool; 3],
) -> Stretch<V> {
    let share = zero.like_column(&b.share, at);
    let s = if s { zero.like_column(&b.s, at) } else { share };
    let before = if back { closed(zero.like_column(&b.before, at)).s } else { s };
    let limit = if limited { zero.like_column(&b.limit, at) } else { s };
    Stretch { s, share, inverse: zero.like(1.0) - share, before, limit }
}

/// Sums of eight lanes, in the same order whatever their width.
#[derive(Clone, Copy)]
pub(crate) struct Sum<V>(pub(crate) [V; 2]);

impl<V> Sum<V> {
    /// Adds `a b` of the bonds at a place.
    #[inline(always)]
    pub(crate) fn add<const N: usize>(&mut self, at: usize, a: V, b: V)
    where
        V: Lanes<N>,
    {
        let half = at % GROUP / N;
        self.0[half] = a.fma(b, self.0[half]);
    }

    /// The sum of all lanes.
    #[inline(always)]
    pub(crate) fn total<const N: usize>(&self) -> f64
    where
        V: Lanes<N>,
    {
        let mut f = [0.0; GROUP];
        self.0[0].to_column(&mut f, 0);
        if N < GROUP {
            self.0[1].to_column(&mut f, N);
        }
        let four = [f[0] + f[4], f[1] + f[5], f[2] + f[6], f[3] + f[7]];
        (four[0] + four[1]) + (four[2] + four[3])
    }
}

/// Bonds in hand, with what laws need of them.
pub struct Hand<'a, 'b, 'c> {
    pub(crate) row: &'a Row<'b>,
    pub(crate) acting: &'a Acting<'c>,
    pub(crate) block: &'a mut Block,
    pub(crate) window: *mut f64,
}

impl<'a, 'b, 'c> Hand<'a, 'b, 'c> {
    /// The bonds of a record that are in a block.
    ///
    /// # Safety
    /// Every partner must lie in the `window` of rows of four numbers, of one number where terms are added up; of energies nothing is put there.
    /// Nothing else may touch the window and what these bonds remember as long as this is there.
    pub unsafe fn new(
        (row, acting): (&'a Row<'b>, &'a Acting<'c>),
        block: &'a mut Block,
        window: *mut f64,
    ) -> Self {
        Self { row, acting, block, window }
    }
}

/// Adds the forces of the bonds in hand times the volumes of both ends; true if bonds remember something that had nothing to remember before.
pub fn pull<W: BondLaw>(form: Form, hand: Hand) -> bool {
    // SAFETY: the bonds in hand answer for memory.
    unsafe { form.run(Pull::<W>(hand, PhantomData)) }
}

/// Adds a term of the bonds in hand to the sums of both ends.
pub fn add_up<T: Term>(form: Form, hand: Hand) {
    // SAFETY: the bonds in hand answer for memory.
    unsafe { form.run(AddUp::<T>(hand, PhantomData)) }
}

/// Energy and virial of the bonds in hand. What comes out of each: the energies of both ends, and the pull along y times both
/// volumes, which makes the virial (force density times the one volume of it, or the force itself).
pub fn energies<W: BondLaw>(form: Form, hand: Hand, look: &Looking) -> [f64; SUMS] {
    // SAFETY: the bonds in hand answer for memory.
    unsafe { form.run(Energies::<W>(hand, look, PhantomData)) }
}

/// See [`pull`].
struct Pull<'a, 'b, 'c, W>(Hand<'a, 'b, 'c>, PhantomData<W>);

impl<W: BondLaw> InLanes for Pull<'_, '_, '_, W> {
    type Out = bool;
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> bool {
        let Self(Hand { row, acting: a, block: b, window: force }, _) = self;
        // SAFETY: the processor has what the lanes need; partners are records, and the bonds in hand answer for memory.
        unsafe {
            let zero = V::all(0.0);
            stretch::<N, V, false>(zero, b);
            if W::STRETCHED {
                stretch::<N, V, true>(zero, b);
            }
            let partner = row.body.partner.as_ptr();
            let volume = zero.like(row.body.record[row.i].volume);
            let own = near(zero, a.ends, W::COLUMNS, row.i);
            let mut sum = [Sum([zero; 2]); 3];
            let mut woken = false;
            for at in steps::<N>(b.count) {
                let place = b.place(at);
                let s = stretched(zero, b, at, [W::STRETCHED, W::BACK, W::LIMITED]);
                let ends: Ends<V> = [own, far(a.ends, W::COLUMNS, partner.add(place))];
                let before: [V; 2] = recall(a, place, W::MEMORY);
                let mut now = before;
                let omega = zero.like_column(&b.omega, at);
                let (near, far) = W::pull(&s, omega, &ends, &mut now, &a.moment);
                if W::MEMORY > 0 && a.keep && (a.known || V::any(W::flows(&ends))) {
                    woken = true;
                    let alive = zero.mask(*row.body.alive.get_unchecked(place / GROUP) >> (place % GROUP));
                    let mut k = 0;
                    while k < W::MEMORY {
                        V::choose(alive, now[k], before[k]).write(memory(a, place, W::MEMORY, k));
                        k += 1;
                    }
                }
                let weight = zero.like_column(&b.weight, at);
                let factor = weight * (volume * zero.like_column(&b.volume, at));
                let (near, far) = (near * factor, far * factor);
                let mut d = 0;
                while d < 3 {
                    let y = zero.like_column(&b.y[d], at);
                    sum[d].add(at, near, y);
                    (far * y).to_column(&mut b.out[d], at);
                    d += 1;
                }
            }
            let own = force.wrapping_add(4 * row.i);
            if a.least {
                let least = scatter::<N, V, true>(b, force);
                *own.add(3) = least.min(*own.add(3));
            } else {
                scatter::<N, V, false>(b, force);
            }
            *own += sum[0].total();
            *own.add(1) += sum[1].total();
            *own.add(2) += sum[2].total();
            woken
        }
    }
}

/// See [`add_up`].
struct AddUp<'a, 'b, 'c, T>(Hand<'a, 'b, 'c>, PhantomData<T>);

impl<T: Term> InLanes for AddUp<'_, '_, '_, T> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self(Hand { row, acting: a, block: b, window: sums }, _) = self;
        // SAFETY: the processor has what the lanes need; partners are records, and the bonds in hand answer for memory.
        unsafe {
            let zero = V::all(0.0);
            stretch::<N, V, true>(zero, b);
            let partner = row.body.partner.as_ptr();
            let volume = zero.like(row.body.record[row.i].volume);
            let own = near(zero, a.ends, T::COLUMNS, row.i);
            let mut sum = Sum([zero; 2]);
            for at in steps::<N>(b.count) {
                let place = b.place(at);
                let s = zero.like_column(&b.s, at);
                let s = Stretch { s, share: s, inverse: s, before: s, limit: s };
                let ends: Ends<V> = [own, far(a.ends, T::COLUMNS, partner.add(place))];
                let memory = recall(a, place, T::MEMORY);
                let (near, far) = T::terms(&s, zero.like_column(&b.omega, at), &ends, &memory);
                let one = zero.like_column(&b.weight, at) * zero.like_column(&b.square, at);
                sum.add(at, one * zero.like_column(&b.volume, at), near);
                (one * volume * far).to_column(&mut b.out[0], at);
            }
            for (target, out) in b.target[..b.count].iter().zip(&b.out[0]) {
                *sums.wrapping_add(*target as usize) += out;
            }
            *sums.wrapping_add(row.i) += sum.total();
        }
    }
}

/// What energies need besides.
pub struct Looking<'a> {
    /// θ and its unrelaxed part of each record, in rows of four; none where energies do not depend on them.
    pub angles: &'a [f64],
    /// Both ends have 15G/m as column 1; else that is part of the weight.
    pub states: bool,
    /// Share of the squares that counts for each end.
    pub half: f64,
    /// True forces: energies, not their densities.
    pub newton: bool,
}

/// See [`energies`].
struct Energies<'a, 'b, 'c, W>(Hand<'a, 'b, 'c>, &'a Looking<'a>, PhantomData<W>);

impl<W: BondLaw> InLanes for Energies<'_, '_, '_, W> {
    type Out = [f64; SUMS];
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> [f64; SUMS] {
        let Self(Hand { row, acting: a, block: b, .. }, look, _) = self;
        // SAFETY: the processor has what the lanes need; partners are records, and the bonds in hand answer for memory.
        unsafe {
            let zero = V::all(0.0);
            stretch::<N, V, false>(zero, b);
            stretch::<N, V, true>(zero, b);
            let partner = row.body.partner.as_ptr();
            let volume = zero.like(row.body.record[row.i].volume);
            let own = near(zero, a.ends, W::COLUMNS, row.i);
            let turned = if look.angles.is_empty() { 0 } else { 2 };
            let own_angles = near(zero, look.angles, turned, row.i);
            let mut sum = [Sum([zero; 2]); SUMS];
            for at in steps::<N>(b.count) {
                let place = b.place(at);
                let s = stretched(zero, b, at, [true, W::BACK, W::LIMITED]);
                let ends: Ends<V> = [own, far(a.ends, W::COLUMNS, partner.add(place))];
                let other = far(look.angles, turned, partner.add(place));
                let relaxing = [W::relaxing(&ends[0], &a.moment), W::relaxing(&ends[1], &a.moment)];
                let angles = [
                    Angles { now: own_angles[0], unrelaxed: own_angles[1], relaxing: relaxing[0] },
                    Angles { now: other[0], unrelaxed: other[1], relaxing: relaxing[1] },
                ];
                let mut memory = recall(a, place, W::MEMORY);
                let omega = zero.like_column(&b.omega, at);
                let weight = zero.like_column(&b.weight, at);
                let partner_volume = zero.like_column(&b.volume, at);
                let both = volume * partner_volume;
                let (mut near, mut far) = W::squares(&s, omega, &angles, &memory, &a.moment);
                if look.states {
                    (near, far) = (near * ends[0][1], far * ends[1][1]);
                }
                let one = weight * zero.like_column(&b.square, at) * look.half;
                (near, far) = match look.newton {
                    true => (near * one * both, far * one * both),
                    false => (near * one * partner_volume, far * one * volume),
                };
                near.to_column(&mut b.out[0], at);
                far.to_column(&mut b.out[1], at);
                sum[0].add(at, near + far, zero.like(1.0));
                let (near, far) = W::pull(&s, omega, &ends, &mut memory, &a.moment);
                let pull = (near + far) * weight * -0.5 * both;
                // Of particles each end has what it feels, which differs in LAMMPS' laws.
                let push = weight * -1.0;
                (near * push * both).to_column(&mut b.out[2], at);
                (far * push * both).to_column(&mut b.out[3], at);
                let y = [
                    zero.like_column(&b.y[0], at),
                    zero.like_column(&b.y[1], at),
                    zero.like_column(&b.y[2], at),
                ];
                let p = [pull * y[0], pull * y[1], pull * y[2]];
                let mut k = 0;
                while k < SIX.len() {
                    sum[1 + k].add(at, p[SIX[k].0], y[SIX[k].1]);
                    k += 1;
                }
            }
            let mut totals = [0.0; SUMS];
            let mut k = 0;
            while k < SUMS {
                totals[k] = sum[k].total();
                k += 1;
            }
            totals
        }
    }
}
