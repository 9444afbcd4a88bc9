//! Stretches of a chunk's bonds, eight cells at a time: which bonds may break, and the least of each family.

use super::chunk::{CELLS, Plain, constant};
#[cfg(target_arch = "x86_64")]
use super::chunk::{Wide, Widest};
use super::lanes::{Lanes, Portable};
use crate::world::families::lattice::Lead;

/// One bond of every cell of a chunk: to the partner ahead, or from the owner behind.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// How many cells further the other end is.
    pub to: i32,
    /// Place of the bond's constants.
    pub place: u32,
    /// Which cells' bonds count.
    pub bits: u8,
    /// Whether the other end owns the bond.
    pub behind: bool,
    /// The pair of local types.
    pub pair: u16,
}

/// The kernels of one instruction set.
pub trait StretchKernels: Sync {
    /// Appends the leads along which living bonds have a z of at least `floor`, and which cells' bonds
    /// have: stretches without the cost of a root.
    ///
    /// # Safety
    /// Where a byte of `alive` has bits, displacements `u` (at the chunk's first cell) must be readable at the
    /// partners of all eight cells; the processor must have the instruction set.
    unsafe fn over(
        u: [*const f64; 3],
        to: &[Lead],
        alive: &[u8],
        tables: &[f64],
        floor: f64,
        found: &mut Vec<(Lead, u8)>,
    );

    /// Per cell the smallest z of its bonds of a pair of types, 0 for bonds inside the dead band; infinite where
    /// there are none.
    ///
    /// # Safety
    /// Where a side has bits, displacements `u` (at the chunk's first cell) must be readable at its eight other
    /// ends; the processor must have the instruction set.
    unsafe fn least(u: [*const f64; 3], sides: &[Side], pair: u16, tables: &[f64]) -> [f64; CELLS];

    /// Keeps of each side's bits those with a stretch of at least s00 − alpha max(previous stretch, 0), and
    /// appends all stretches to `now`, a row per side. All sides lead ahead; `pairs` has s00 and alpha.
    ///
    /// # Safety
    /// As for `least`, for the present displacements and those `before`.
    unsafe fn strained(
        u: [*const f64; 3],
        before: [*const f64; 3],
        sides: &mut [Side],
        tables: &[f64],
        pairs: &[[f64; 3]],
        now: &mut Vec<[f64; CELLS]>,
    );
}

/// z |xi|² of the bonds from the cells from `here` on to those `to` cells further; `BEHIND`: of the bonds that
/// those own.
#[inline(always)]
unsafe fn q<L: Lanes, const BEHIND: bool>(u: [*const f64; 3], here: usize, to: i32, c: *const f64) -> L {
    // SAFETY: the caller's promise.
    unsafe {
        let other = here as isize + to as isize;
        let mut q = L::splat(0.0);
        let mut k = 0;
        while k < 3 {
            let xi = L::splat(*c.add(constant::XI + k));
            let (near, far) = (L::load(u[k].add(here)), L::load(u[k].offset(other)));
            let eta = if BEHIND { near.sub(far) } else { far.sub(near) };
            q = eta.fma(eta.add(xi).add(xi), q);
            k += 1;
        }
        q
    }
}

/// The stretch of a side's bonds from `here` on, 0 inside the dead band.
#[inline(always)]
unsafe fn stretch<L: Lanes>(u: [*const f64; 3], here: usize, side: &Side, tables: &[f64]) -> L {
    // SAFETY: the caller's promise; places lie within the tables.
    unsafe {
        let c = tables.as_ptr().add(side.place as usize);
        let q = q::<L, false>(u, here, side.to, c);
        let one = L::splat(1.0);
        let z = q.mul(L::splat(*c.add(constant::INVERSE)));
        let live = q.abs().ge(L::splat(*c.add(constant::DEAD)));
        z.div(one.add(one.add(z).sqrt())).keep(live)
    }
}

#[inline(always)]
unsafe fn over<L: Lanes>(
    u: [*const f64; 3],
    to: &[Lead],
    alive: &[u8],
    tables: &[f64],
    floor: f64,
    found: &mut Vec<(Lead, u8)>,
) {
    // SAFETY: the caller's promise; places lie within the tables.
    unsafe {
        let floor = L::splat(floor);
        for &Lead { to, table, e } in to {
            let bits = alive[e as usize];
            if bits == 0 {
                continue;
            }
            let c = tables.as_ptr().add(table as usize);
            let inverse = L::splat(*c.add(constant::INVERSE));
            let (mut over, mut here) = (0, 0);
            while here < CELLS {
                let z = q::<L, false>(u, here, to, c).mul(inverse);
                over |= z.ge(floor).bits() << here;
                here += L::WIDTH;
            }
            if over & bits != 0 {
                found.push((Lead { to, table, e }, over & bits));
            }
        }
    }
}

#[inline(always)]
unsafe fn least<L: Lanes>(u: [*const f64; 3], sides: &[Side], pair: u16, tables: &[f64]) -> [f64; CELLS] {
    // SAFETY: the caller's promise; places lie within the tables.
    unsafe {
        let mut out = [0.0; CELLS];
        let infinite = L::splat(f64::INFINITY);
        let mut here = 0;
        while here < CELLS {
            let mut least = infinite;
            for side in sides.iter().filter(|side| side.pair == pair) {
                let c = tables.as_ptr().add(side.place as usize);
                let q = match side.behind {
                    false => q::<L, false>(u, here, side.to, c),
                    true => q::<L, true>(u, here, side.to, c),
                };
                let live = q.abs().ge(L::splat(*c.add(constant::DEAD)));
                let z = q.mul(L::splat(*c.add(constant::INVERSE))).keep(live);
                let none = infinite.keep(L::mask(!side.bits >> here));
                least = z.keep(L::mask(side.bits >> here)).add(none).min(least);
            }
            least.store(out.as_mut_ptr().add(here));
            here += L::WIDTH;
        }
        out
    }
}

#[inline(always)]
unsafe fn strained<L: Lanes>(
    u: [*const f64; 3],
    before: [*const f64; 3],
    sides: &mut [Side],
    tables: &[f64],
    pairs: &[[f64; 3]],
    stretches: &mut Vec<[f64; CELLS]>,
) {
    // SAFETY: the caller's promise.
    unsafe {
        for side in sides {
            let [_, s00, alpha] = pairs[usize::from(side.pair)];
            let mut bits = 0;
            let mut row = [0.0; CELLS];
            let mut here = 0;
            while here < CELLS {
                let now = stretch::<L>(u, here, side, tables);
                now.store(row.as_mut_ptr().add(here));
                let last = stretch::<L>(before, here, side, tables).max(L::splat(0.0));
                let limit = L::splat(s00).sub(L::splat(alpha).mul(last));
                bits |= now.ge(limit).bits() << here;
                here += L::WIDTH;
            }
            side.bits &= bits;
            stretches.push(row);
        }
    }
}

/// Kernels of one instruction set from those for its lanes.
macro_rules! compiled_for {
    ($kernels:ty, $lanes:ty $(, $features:literal)?) => {
        impl StretchKernels for $kernels {
            unsafe fn over(
                u: [*const f64; 3],
                to: &[Lead],
                alive: &[u8],
                tables: &[f64],
                floor: f64,
                found: &mut Vec<(Lead, u8)>,
            ) {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner(
                    u: [*const f64; 3],
                    to: &[Lead],
                    alive: &[u8],
                    tables: &[f64],
                    floor: f64,
                    found: &mut Vec<(Lead, u8)>,
                ) {
                    // SAFETY: the caller's promise.
                    unsafe { over::<$lanes>(u, to, alive, tables, floor, found) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner(u, to, alive, tables, floor, found) }
            }
            unsafe fn least(u: [*const f64; 3], sides: &[Side], pair: u16, tables: &[f64]) -> [f64; CELLS] {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner(u: [*const f64; 3], sides: &[Side], pair: u16, tables: &[f64]) -> [f64; CELLS] {
                    // SAFETY: the caller's promise.
                    unsafe { least::<$lanes>(u, sides, pair, tables) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner(u, sides, pair, tables) }
            }
            unsafe fn strained(
                u: [*const f64; 3],
                before: [*const f64; 3],
                sides: &mut [Side],
                tables: &[f64],
                pairs: &[[f64; 3]],
                now: &mut Vec<[f64; CELLS]>,
            ) {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner(
                    u: [*const f64; 3],
                    before: [*const f64; 3],
                    sides: &mut [Side],
                    tables: &[f64],
                    pairs: &[[f64; 3]],
                    now: &mut Vec<[f64; CELLS]>,
                ) {
                    // SAFETY: the caller's promise.
                    unsafe { strained::<$lanes>(u, before, sides, tables, pairs, now) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner(u, before, sides, tables, pairs, now) }
            }
        }
    };
}

compiled_for!(Plain, Portable);
#[cfg(target_arch = "x86_64")]
compiled_for!(Wide, super::lanes::Avx2, "avx2,fma");
#[cfg(target_arch = "x86_64")]
compiled_for!(Widest, super::lanes512::Avx512, "avx512f,avx512dq,avx512vl,avx2,fma");
