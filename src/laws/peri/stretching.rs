//! Stretches of a chunk's bonds, eight cells at a time: which bonds may break, and the extremes of families.

use super::chunk::{CELLS, Plain, constant};
#[cfg(target_arch = "x86_64")]
use super::chunk::{Wide, Widest};
use super::lanes::{Lanes, Portable};

/// One bond of every cell of a chunk: to the partner ahead, or from the owner behind.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// How many cells further the other end is.
    pub to: i32,
    /// Place of the bond's constants.
    pub place: u32,
    /// Which cells' bonds count.
    pub bits: u8,
    /// 1 ahead, −1 behind: the reference bond's direction.
    pub sign: f64,
    /// Critical stretch.
    pub s00: f64,
    /// Its rise under compression.
    pub alpha: f64,
}

/// The kernels of one instruction set.
pub trait StretchKernels: Sync {
    /// Per cell the smallest stretch and the largest s00 − alpha s of its bonds (Silling and Askari 2005, eq. 29).
    ///
    /// # Safety
    /// Where a side has bits, displacements `u` (at the chunk's first cell) must be readable at its eight other
    /// ends; the processor must have the instruction set.
    unsafe fn extremes(u: [*const f64; 3], sides: &[Side], tables: &[f64]) -> [[f64; CELLS]; 2];

    /// Keeps of each side's bits those with a stretch of at least s00 − alpha max(previous stretch, 0), and
    /// appends all stretches to `now`, a row per side.
    ///
    /// # Safety
    /// As for `extremes`, for the present displacements and those `before`.
    unsafe fn strained(
        u: [*const f64; 3],
        before: [*const f64; 3],
        sides: &mut [Side],
        tables: &[f64],
        now: &mut Vec<[f64; CELLS]>,
    );
}

/// The stretch of a side's bonds from `here` on, 0 inside the dead band.
#[inline(always)]
unsafe fn stretch<L: Lanes>(u: [*const f64; 3], here: usize, side: &Side, tables: &[f64]) -> L {
    // SAFETY: the caller's promise; places lie within the tables.
    unsafe {
        let c = tables.as_ptr().add(side.place as usize);
        let other = here as isize + side.to as isize;
        let mut q = L::splat(0.0);
        let mut k = 0;
        while k < 3 {
            let xi = L::splat(side.sign * *c.add(constant::XI + k));
            let eta = L::load(u[k].offset(other)).sub(L::load(u[k].add(here)));
            q = eta.fma(eta.add(xi).add(xi), q);
            k += 1;
        }
        let one = L::splat(1.0);
        let z = q.mul(L::splat(*c.add(constant::INVERSE)));
        let live = q.abs().ge(L::splat(*c.add(constant::DEAD)));
        z.div(one.add(one.add(z).sqrt())).keep(live)
    }
}

#[inline(always)]
unsafe fn extremes<L: Lanes>(u: [*const f64; 3], sides: &[Side], tables: &[f64]) -> [[f64; CELLS]; 2] {
    // SAFETY: the caller's promise.
    unsafe {
        let mut out = [[0.0; CELLS]; 2];
        let infinite = L::splat(f64::INFINITY);
        let mut here = 0;
        while here < CELLS {
            let (mut least, mut most) = (infinite, L::splat(f64::NEG_INFINITY));
            for side in sides {
                let s = stretch::<L>(u, here, side, tables);
                let yes = L::mask(side.bits >> here);
                let none = infinite.keep(L::mask(!side.bits >> here));
                least = s.keep(yes).add(none).min(least);
                let limit = L::splat(side.s00).sub(L::splat(side.alpha).mul(s));
                most = limit.keep(yes).sub(none).max(most);
            }
            least.store(out[0].as_mut_ptr().add(here));
            most.store(out[1].as_mut_ptr().add(here));
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
    stretches: &mut Vec<[f64; CELLS]>,
) {
    // SAFETY: the caller's promise.
    unsafe {
        for side in sides {
            let mut bits = 0;
            let mut row = [0.0; CELLS];
            let mut here = 0;
            while here < CELLS {
                let now = stretch::<L>(u, here, side, tables);
                now.store(row.as_mut_ptr().add(here));
                let last = stretch::<L>(before, here, side, tables).max(L::splat(0.0));
                let limit = L::splat(side.s00).sub(L::splat(side.alpha).mul(last));
                let over = now.ge(limit);
                if over.any() {
                    let mut lanes = [0.0; CELLS];
                    over.store(lanes.as_mut_ptr());
                    for (lane, yes) in lanes[..L::WIDTH].iter().enumerate() {
                        bits |= u8::from(yes.to_bits() != 0) << (here + lane);
                    }
                }
                here += L::WIDTH;
            }
            side.bits &= bits;
            stretches.push(row);
        }
    }
}

impl StretchKernels for Plain {
    unsafe fn extremes(u: [*const f64; 3], sides: &[Side], tables: &[f64]) -> [[f64; CELLS]; 2] {
        // SAFETY: the caller's promise.
        unsafe { extremes::<Portable>(u, sides, tables) }
    }
    unsafe fn strained(
        u: [*const f64; 3],
        before: [*const f64; 3],
        sides: &mut [Side],
        tables: &[f64],
        now: &mut Vec<[f64; CELLS]>,
    ) {
        // SAFETY: the caller's promise.
        unsafe { strained::<Portable>(u, before, sides, tables, now) }
    }
}

#[cfg(target_arch = "x86_64")]
macro_rules! compiled_for {
    ($kernels:ty, $features:literal, $lanes:ty) => {
        impl StretchKernels for $kernels {
            unsafe fn extremes(u: [*const f64; 3], sides: &[Side], tables: &[f64]) -> [[f64; CELLS]; 2] {
                #[target_feature(enable = $features)]
                unsafe fn inner(u: [*const f64; 3], sides: &[Side], tables: &[f64]) -> [[f64; CELLS]; 2] {
                    // SAFETY: the caller's promise.
                    unsafe { extremes::<$lanes>(u, sides, tables) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner(u, sides, tables) }
            }
            unsafe fn strained(
                u: [*const f64; 3],
                before: [*const f64; 3],
                sides: &mut [Side],
                tables: &[f64],
                now: &mut Vec<[f64; CELLS]>,
            ) {
                #[target_feature(enable = $features)]
                unsafe fn inner(
                    u: [*const f64; 3],
                    before: [*const f64; 3],
                    sides: &mut [Side],
                    tables: &[f64],
                    now: &mut Vec<[f64; CELLS]>,
                ) {
                    // SAFETY: the caller's promise.
                    unsafe { strained::<$lanes>(u, before, sides, tables, now) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner(u, before, sides, tables, now) }
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
compiled_for!(Wide, "avx2,fma", super::lanes::Avx2);
#[cfg(target_arch = "x86_64")]
compiled_for!(Widest, "avx512f,avx512dq,avx512vl,avx2,fma", super::lanes512::Avx512);
