//! Bond laws over the bonds in hand: forces, sums of both ends, energies.

use crate::families::law::COLUMNS;
use crate::families::list::GROUP;
use crate::lanes::Lanes;
use crate::lanes::isa::{Isa, Kernel};
use crate::lanes::rows::Rows;
use crate::lattice::chunk::SUMS;
use crate::law::terms::Term;
use crate::law::{Angles, BondLaw, Ends, Moment, Stretch, closed};
use crate::list::kernel::{Block, Row, partners, scatter, stretch};
use perigrain_base::math::vec3::SIX;
use std::marker::PhantomData;
use std::ptr::null;

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
unsafe fn far<L: Rows>(ends: &[f64], count: usize, target: *const u32) -> [L; COLUMNS] {
    // SAFETY: partners are records, and rows are filled up to four numbers.
    unsafe {
        let mut columns = [L::splat(0.0); COLUMNS];
        let stride = Acting::stride(count);
        let mut first = 0;
        while first < count {
            let ends = ends.as_ptr().add(first);
            let rows = partners!(L, null(), |k| ends.add(stride * *target.add(k) as usize));
            let four = L::quads(&rows);
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
unsafe fn near<L: Lanes>(ends: &[f64], count: usize, record: usize) -> [L; COLUMNS] {
    // SAFETY: passed on to the caller.
    unsafe {
        let mut columns = [L::splat(0.0); COLUMNS];
        let mut k = 0;
        while k < count {
            columns[k] = L::splat(*ends.get_unchecked(Acting::stride(count) * record + k));
            k += 1;
        }
        columns
    }
}

/// Where number `k` of `numbers` is that the bonds at a place remember.
#[inline(always)]
fn memory(a: &Acting, place: usize, numbers: usize, k: usize) -> *mut f64 {
    a.memory.wrapping_add((place / GROUP * numbers + k) * GROUP + place % GROUP)
}

#[inline(always)]
unsafe fn recall<L: Lanes>(a: &Acting, place: usize, numbers: usize) -> [L; 2] {
    // SAFETY: places are those of bonds, each with `numbers` numbers.
    unsafe {
        let mut out = [L::splat(0.0); 2];
        if a.known {
            let mut k = 0;
            while k < numbers {
                out[k] = L::load(memory(a, place, numbers, k));
                k += 1;
            }
        }
        out
    }
}

/// The stretch of some of the bonds in hand.
#[inline(always)]
unsafe fn stretched<L: Lanes>(b: &Block, at: usize, s: bool, back: bool, limited: bool) -> Stretch<L> {
    // SAFETY: columns hold numbers at `at` and beyond.
    unsafe {
        let share = L::load(b.share.as_ptr().add(at));
        let s = if s { L::load(b.s.as_ptr().add(at)) } else { share };
        let before = if back { closed(L::load(b.before.as_ptr().add(at))).s } else { s };
        let limit = if limited { L::load(b.limit.as_ptr().add(at)) } else { s };
        Stretch { s, share, inverse: L::splat(1.0).sub(share), before, limit }
    }
}

/// Sums of eight lanes, in the same order whatever their width.
#[derive(Clone, Copy)]
struct Sum<L>([L; 2]);

impl<L: Lanes> Sum<L> {
    #[inline(always)]
    unsafe fn none() -> Self {
        // SAFETY: passed on to the caller.
        Self([unsafe { L::splat(0.0) }; 2])
    }

    /// Adds `a b` of the bonds at a place.
    #[inline(always)]
    unsafe fn add(&mut self, at: usize, a: L, b: L) {
        // SAFETY: passed on to the caller.
        unsafe {
            let half = at % GROUP / L::WIDTH;
            self.0[half] = a.fma(b, self.0[half]);
        }
    }

    #[inline(always)]
    unsafe fn total(&self) -> f64 {
        // SAFETY: lanes fill eight places, or four each.
        unsafe {
            let mut f = [0.0; GROUP];
            self.0[0].store(f.as_mut_ptr());
            if L::WIDTH < GROUP {
                self.0[1].store(f.as_mut_ptr().add(L::WIDTH));
            }
            let four = [f[0] + f[4], f[1] + f[5], f[2] + f[6], f[3] + f[7]];
            (four[0] + four[1]) + (four[2] + four[3])
        }
    }
}

/// What laws do to the bonds in hand.
pub struct Hand<'a, 'b, 'c, W> {
    /// The record.
    pub row: &'a Row<'b>,
    /// What laws need besides.
    pub acting: &'a Acting<'c>,
    /// The bonds.
    pub block: &'a mut Block,
    /// The law.
    pub law: PhantomData<W>,
}

/// Adds the forces of the bonds in hand times the volumes of both
/// ends; true if bonds remember something that had nothing to remember before.
///
/// Every partner must lie in the window of rows of four at `force`, untouched by others.
pub struct Pull<'a, 'b, 'c, W>(pub Hand<'a, 'b, 'c, W>, pub *mut f64);

impl<W: BondLaw> Kernel for Pull<'_, '_, '_, W> {
    type Out = bool;
    #[inline(always)]
    unsafe fn run<L: Isa>(self) -> bool {
        // SAFETY: the caller's promise.
        unsafe { pull::<L, W>(self.0.row, self.0.acting, self.0.block, self.1) }
    }
}

/// Adds a term of the bonds in hand to the sums of both ends.
///
/// As for [`Pull`], with one number of each record at the window.
pub struct AddUp<'a, 'b, 'c, T>(pub Hand<'a, 'b, 'c, T>, pub *mut f64);

impl<T: Term> Kernel for AddUp<'_, '_, '_, T> {
    type Out = ();
    #[inline(always)]
    unsafe fn run<L: Isa>(self) {
        // SAFETY: the caller's promise.
        unsafe { add_up::<L, T>(self.0.row, self.0.acting, self.0.block, self.1) }
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

/// Energy and virial of the bonds in hand. What comes out of each: the energies of both ends, and the pull along y times both
/// volumes, which makes the virial (force density times the one volume of it, or the force itself).
pub struct Energies<'a, 'b, 'c, W>(pub Hand<'a, 'b, 'c, W>, pub &'a Looking<'a>);

impl<W: BondLaw> Kernel for Energies<'_, '_, '_, W> {
    type Out = [f64; SUMS];
    #[inline(always)]
    unsafe fn run<L: Isa>(self) -> [f64; SUMS] {
        // SAFETY: the caller's promise.
        unsafe { energies::<L, W>(self.0.row, self.0.acting, self.1, self.0.block) }
    }
}

#[inline(always)]
unsafe fn pull<L: Rows, W: BondLaw>(row: &Row, a: &Acting, b: &mut Block, force: *mut f64) -> bool {
    // SAFETY: the caller's promise.
    unsafe {
        stretch::<L, false>(b);
        if W::STRETCHED {
            stretch::<L, true>(b);
        }
        let partner = row.body.partner.as_ptr();
        let volume = L::splat(row.body.record.get_unchecked(row.i).volume);
        let own = near::<L>(a.ends, W::COLUMNS, row.i);
        let mut sum = [Sum::<L>::none(); 3];
        let mut woken = false;
        let mut at = 0;
        while at < b.count {
            let place = b.place(at);
            let s = stretched::<L>(b, at, W::STRETCHED, W::BACK, W::LIMITED);
            let ends: Ends<L> = [own, far(a.ends, W::COLUMNS, partner.add(place))];
            let before = recall::<L>(a, place, W::MEMORY);
            let mut now = before;
            let omega = L::load(b.omega.as_ptr().add(at));
            let (near, far) = W::pull(&s, omega, &ends, &mut now, &a.moment);
            if W::MEMORY > 0 && a.keep && (a.known || W::flows(&ends).bits() != 0) {
                woken = true;
                let bits = *row.body.alive.get_unchecked(place / GROUP) >> (place % GROUP);
                let (alive, dead) = (L::mask(bits), L::mask(!bits));
                let mut k = 0;
                while k < W::MEMORY {
                    let now = now[k].keep(alive).add(before[k].keep(dead));
                    now.store(memory(a, place, W::MEMORY, k));
                    k += 1;
                }
            }
            let weight = L::load(b.weight.as_ptr().add(at));
            let factor = weight.mul(volume.mul(L::load(b.volume.as_ptr().add(at))));
            let (near, far) = (near.mul(factor), far.mul(factor));
            let mut d = 0;
            while d < 3 {
                let y = L::load(b.y[d].as_ptr().add(at));
                sum[d].add(at, near, y);
                far.mul(y).store(b.out[d].as_mut_ptr().add(at));
                d += 1;
            }
            at += L::WIDTH;
        }
        let own = force.wrapping_add(4 * row.i);
        if a.least {
            let least = scatter::<L, true>(b, force);
            *own.add(3) = least.min(*own.add(3));
        } else {
            scatter::<L, false>(b, force);
        }
        *own += sum[0].total();
        *own.add(1) += sum[1].total();
        *own.add(2) += sum[2].total();
        woken
    }
}

#[inline(always)]
unsafe fn add_up<L: Rows, T: Term>(row: &Row, a: &Acting, b: &mut Block, sums: *mut f64) {
    // SAFETY: the caller's promise.
    unsafe {
        stretch::<L, true>(b);
        let partner = row.body.partner.as_ptr();
        let volume = L::splat(row.body.record.get_unchecked(row.i).volume);
        let own = near::<L>(a.ends, T::COLUMNS, row.i);
        let mut sum = Sum::<L>::none();
        let mut at = 0;
        while at < b.count {
            let place = b.place(at);
            let s = L::load(b.s.as_ptr().add(at));
            let s = Stretch { s, share: s, inverse: s, before: s, limit: s };
            let ends: Ends<L> = [own, far(a.ends, T::COLUMNS, partner.add(place))];
            let memory = recall::<L>(a, place, T::MEMORY);
            let (near, far) = T::terms(&s, L::load(b.omega.as_ptr().add(at)), &ends, &memory);
            let one = L::load(b.weight.as_ptr().add(at)).mul(L::load(b.square.as_ptr().add(at)));
            sum.add(at, one.mul(L::load(b.volume.as_ptr().add(at))), near);
            one.mul(volume).mul(far).store(b.out[0].as_mut_ptr().add(at));
            at += L::WIDTH;
        }
        for (target, out) in b.target[..b.count].iter().zip(&b.out[0]) {
            *sums.wrapping_add(*target as usize) += out;
        }
        *sums.wrapping_add(row.i) += sum.total();
    }
}

#[inline(always)]
unsafe fn energies<L: Rows, W: BondLaw>(row: &Row, a: &Acting, look: &Looking, b: &mut Block) -> [f64; SUMS] {
    // SAFETY: the caller's promise.
    unsafe {
        stretch::<L, false>(b);
        stretch::<L, true>(b);
        let partner = row.body.partner.as_ptr();
        let volume = L::splat(row.body.record.get_unchecked(row.i).volume);
        let own = near::<L>(a.ends, W::COLUMNS, row.i);
        let turned = if look.angles.is_empty() { 0 } else { 2 };
        let own_angles = near::<L>(look.angles, turned, row.i);
        let mut sum = [Sum::<L>::none(); SUMS];
        let mut at = 0;
        while at < b.count {
            let place = b.place(at);
            let s = stretched::<L>(b, at, true, W::BACK, W::LIMITED);
            let ends: Ends<L> = [own, far(a.ends, W::COLUMNS, partner.add(place))];
            let other = far::<L>(look.angles, turned, partner.add(place));
            let angles = [
                Angles {
                    now: own_angles[0],
                    unrelaxed: own_angles[1],
                    relaxing: W::relaxing(&ends[0], &a.moment),
                },
                Angles { now: other[0], unrelaxed: other[1], relaxing: W::relaxing(&ends[1], &a.moment) },
            ];
            let mut memory = recall::<L>(a, place, W::MEMORY);
            let omega = L::load(b.omega.as_ptr().add(at));
            let weight = L::load(b.weight.as_ptr().add(at));
            let partner_volume = L::load(b.volume.as_ptr().add(at));
            let both = volume.mul(partner_volume);
            let (mut near, mut far) = W::squares(&s, omega, &angles, &memory, &a.moment);
            if look.states {
                (near, far) = (near.mul(ends[0][1]), far.mul(ends[1][1]));
            }
            let one = weight.mul(L::load(b.square.as_ptr().add(at))).mul(L::splat(look.half));
            (near, far) = match look.newton {
                true => (near.mul(one).mul(both), far.mul(one).mul(both)),
                false => (near.mul(one).mul(partner_volume), far.mul(one).mul(volume)),
            };
            near.store(b.out[0].as_mut_ptr().add(at));
            far.store(b.out[1].as_mut_ptr().add(at));
            sum[0].add(at, near.add(far), L::splat(1.0));
            let (near, far) = W::pull(&s, omega, &ends, &mut memory, &a.moment);
            let pull = near.add(far).mul(weight).mul(L::splat(-0.5)).mul(both);
            // Of particles each end has what it feels, which differs in LAMMPS' laws.
            let push = weight.mul(L::splat(-1.0));
            near.mul(push).mul(both).store(b.out[2].as_mut_ptr().add(at));
            far.mul(push).mul(both).store(b.out[3].as_mut_ptr().add(at));
            let y = [
                L::load(b.y[0].as_ptr().add(at)),
                L::load(b.y[1].as_ptr().add(at)),
                L::load(b.y[2].as_ptr().add(at)),
            ];
            let p = [pull.mul(y[0]), pull.mul(y[1]), pull.mul(y[2])];
            let mut k = 0;
            while k < SIX.len() {
                sum[1 + k].add(at, p[SIX[k].0], y[SIX[k].1]);
                k += 1;
            }
            at += L::WIDTH;
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
