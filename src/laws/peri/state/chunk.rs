//! The innermost loops of state-based laws on the lattice: all bonds of eight neighbouring cells.

use super::super::chunk::{CELLS, CLOSED, Chunk, Plain, constant};
#[cfg(target_arch = "x86_64")]
use super::super::chunk::{Wide, Widest};
use super::super::lanes::{Lanes, Portable};
use super::law::{BondLaw, Ends, Moment, Stretch, Term, closed};
use crate::world::families::law::COLUMNS;

/// Places in the tables of state-based laws, beside those of [`constant`]: there [`constant::SERIES`] is scaled so that
/// it gives s/(1 + s) in the table of forces, and the whole term in that of dilatations; [`constant::FACTOR`] is ω w V
/// in the former, ω w |xi|² V in the latter.
pub const OMEGA: usize = constant::ENERGY;

/// What a chunk's loop needs besides; pointers at the chunk's first cell.
#[derive(Clone, Copy)]
pub struct Cells<'a> {
    /// The first column; the others follow a stride apart.
    pub columns: *const f64,
    /// See `columns`.
    pub stride: usize,
    /// What the chunk's bonds remember, [`CELLS`] of each number for each stencil vector.
    pub memory: *mut f64,
    /// What is the same for all bonds.
    pub moment: &'a Moment,
    /// Keep what bonds remember from this evaluation.
    pub keep: bool,
}

/// One bond of each of some neighbouring cells.
struct Bonds<L> {
    /// xi + eta.
    y: [L; 3],
    /// z.
    z: L,
    /// Stretched beyond the dead band, and living.
    live: L,
    stretch: Stretch<L>,
}

/// The bonds from the cells from `here` on, along the stencil vector with constants at `c`.
#[inline(always)]
unsafe fn bonds<L: Lanes, const DEGREE: usize, const MASKED: bool>(
    u: &[*const f64; 3],
    own: &[L; 3],
    other: isize,
    c: *const f64,
    bits: u8,
) -> Bonds<L> {
    // SAFETY: the caller's promise.
    unsafe {
        let (x, y, z) = (L::splat(*c), L::splat(*c.add(1)), L::splat(*c.add(2)));
        let ex = L::load(u[0].offset(other)).sub(own[0]);
        let ey = L::load(u[1].offset(other)).sub(own[1]);
        let ez = L::load(u[2].offset(other)).sub(own[2]);
        let (bx, by, bz) = (ex.add(x), ey.add(y), ez.add(z));
        let q = ex.fma(bx.add(x), ey.fma(by.add(y), ez.mul(bz.add(z))));
        let mut live = q.abs().ge(L::splat(*c.add(constant::DEAD)));
        if MASKED {
            live = live.keep(L::mask(bits));
        }
        let z = q.mul(L::splat(*c.add(constant::INVERSE)));
        let stretch = if DEGREE == CLOSED {
            let s = closed(z);
            Stretch { s: s.s.keep(live), share: s.share.keep(live), inverse: s.inverse }
        } else {
            let mut h = L::splat(*c.add(constant::SERIES + DEGREE));
            let mut k = DEGREE;
            while k > 0 {
                k -= 1;
                h = h.fma(q, L::splat(*c.add(constant::SERIES + k)));
            }
            let share = h.mul(q).keep(live);
            Stretch { s: share, share, inverse: share }
        };
        Bonds { y: [bx, by, bz], z, live, stretch }
    }
}

/// The displacements of some neighbouring cells.
#[inline(always)]
unsafe fn place<L: Lanes>(u: &[*const f64; 3], here: usize) -> [L; 3] {
    // SAFETY: the caller's promise.
    unsafe { [L::load(u[0].add(here)), L::load(u[1].add(here)), L::load(u[2].add(here))] }
}

/// The columns of some neighbouring cells.
#[inline(always)]
unsafe fn read<L: Lanes>(s: &Cells, count: usize, at: isize) -> [L; COLUMNS] {
    // SAFETY: the caller's promise.
    unsafe {
        let mut columns = [L::splat(0.0); COLUMNS];
        let mut k = 0;
        while k < count {
            columns[k] = L::load(s.columns.add(k * s.stride).offset(at));
            k += 1;
        }
        columns
    }
}

/// Where the numbers of a stencil vector's bonds are.
#[inline(always)]
unsafe fn remembered(s: &Cells, numbers: usize, e: usize, number: usize, here: usize) -> *mut f64 {
    // SAFETY: within the chunk's memory by the caller's promise.
    unsafe { s.memory.add((e * numbers + number) * CELLS + here) }
}

#[inline(always)]
unsafe fn recall<L: Lanes>(s: &Cells, numbers: usize, e: usize, here: usize) -> [L; 2] {
    // SAFETY: passed on to the caller.
    unsafe {
        let mut memory = [L::splat(0.0); 2];
        let mut k = 0;
        while k < numbers {
            memory[k] = L::load(remembered(s, numbers, e, k, here));
            k += 1;
        }
        memory
    }
}

/// Adds the forces of a chunk's bonds to both ends. Returns the largest z and the largest −z if `TRACK`.
///
/// # Safety
/// As for `chunk::force`; columns must be readable where displacements are, and `memory` writable for all bonds of the
/// chunk if the law remembers.
#[inline(always)]
unsafe fn pull<
    L: Lanes,
    W: BondLaw,
    const DEGREE: usize,
    const MASKED: bool,
    const TRACK: bool,
    const VARIOUS: bool,
>(
    a: &Chunk,
    s: &Cells,
) -> (f64, f64) {
    // SAFETY: the caller's promise covers every address formed below.
    unsafe {
        let zero = L::splat(0.0);
        let (mut high, mut low) = (zero, zero);
        // Two vectors of four cells, or one of eight (the second then stays unused).
        let half = CELLS - L::WIDTH;
        let u = [place(&a.u, 0), place(&a.u, half)];
        let own = [read::<L>(s, W::COLUMNS, 0), read::<L>(s, W::COLUMNS, half as isize)];
        let mut sum = [[zero; 3]; 2];
        let mut e = 0;
        while e < a.to.len() {
            let (to, constants) = *a.to.get_unchecked(e);
            let bits = *a.alive.get_unchecked(e);
            let vector = e;
            e += 1;
            if MASKED && bits == 0 {
                continue;
            }
            let c = a.tables.as_ptr().add(constants as usize);
            let mut v = 0;
            while v < CELLS / L::WIDTH {
                let here = L::WIDTH * v;
                let (other, bits) = (here as isize + to as isize, bits >> here);
                let b = bonds::<L, DEGREE, MASKED>(&a.u, &u[v], other, c, bits);
                let ends: Ends<L> = [own[v], read::<L>(s, W::COLUMNS, other)];
                let mut memory = recall::<L>(s, W::MEMORY, vector, here);
                let omega = L::splat(*c.add(OMEGA));
                let (mut near, mut far) = W::pull(&b.stretch, omega, &ends, &mut memory, s.moment);
                if s.keep {
                    let mut k = 0;
                    while k < W::MEMORY {
                        memory[k].store(remembered(s, W::MEMORY, vector, k, here));
                        k += 1;
                    }
                }
                let mut factor = L::splat(*c.add(constant::FACTOR));
                if MASKED {
                    factor = factor.keep(L::mask(bits));
                }
                (near, far) = (near.mul(factor), far.mul(factor));
                if VARIOUS {
                    (near, far) = volumes(a, near, far, here, other);
                }
                if TRACK {
                    let z = b.z.keep(b.live);
                    high = z.max(high);
                    low = z.min(low);
                }
                let mut k = 0;
                while k < 3 {
                    sum[v][k] = near.fma(b.y[k], sum[v][k]);
                    let target = a.f[k].offset(other);
                    far.fnma(b.y[k], L::load(target)).store(target);
                    k += 1;
                }
                v += 1;
            }
        }
        let mut v = 0;
        while v < CELLS / L::WIDTH {
            let mut k = 0;
            while k < 3 {
                let target = a.f[k].add(L::WIDTH * v);
                L::load(target).add(sum[v][k]).store(target);
                k += 1;
            }
            v += 1;
        }
        if !TRACK {
            return (0.0, 0.0);
        }
        let mut most = [[0.0f64; CELLS]; 2];
        high.store(most[0].as_mut_ptr());
        low.store(most[1].as_mut_ptr());
        (most[0].iter().copied().fold(0.0, f64::max), -most[1].iter().copied().fold(0.0, f64::min))
    }
}

/// Adds a term of a chunk's bonds to the sums of both ends, in `f[0]` of the chunk.
///
/// # Safety
/// As for [`pull`]; only the first component of `f` is touched.
#[inline(always)]
unsafe fn add_up<L: Lanes, T: Term, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool>(
    a: &Chunk,
    s: &Cells,
) {
    // SAFETY: the caller's promise covers every address formed below.
    unsafe {
        let half = CELLS - L::WIDTH;
        let u = [place(&a.u, 0), place(&a.u, half)];
        let own = [read::<L>(s, T::COLUMNS, 0), read::<L>(s, T::COLUMNS, half as isize)];
        let mut sum = [L::splat(0.0); 2];
        let mut e = 0;
        while e < a.to.len() {
            let (to, constants) = *a.to.get_unchecked(e);
            let bits = *a.alive.get_unchecked(e);
            let vector = e;
            e += 1;
            if MASKED && bits == 0 {
                continue;
            }
            let c = a.tables.as_ptr().add(constants as usize);
            let mut v = 0;
            while v < CELLS / L::WIDTH {
                let here = L::WIDTH * v;
                let (other, bits) = (here as isize + to as isize, bits >> here);
                let b = bonds::<L, DEGREE, MASKED>(&a.u, &u[v], other, c, bits);
                let (mut near, mut far) = if DEGREE != CLOSED {
                    // The series is the term itself.
                    (b.stretch.s, b.stretch.s)
                } else {
                    let ends: Ends<L> = [own[v], read::<L>(s, T::COLUMNS, other)];
                    let memory = recall::<L>(s, T::MEMORY, vector, here);
                    let (near, far) = T::terms(&b.stretch, L::splat(*c.add(OMEGA)), &ends, &memory);
                    let mut factor = L::splat(*c.add(constant::FACTOR));
                    if MASKED {
                        factor = factor.keep(L::mask(bits));
                    }
                    (near.mul(factor), far.mul(factor))
                };
                if VARIOUS && let Some(cells) = a.various {
                    near = near.mul(L::load(cells.volume.offset(other)));
                    far = far.mul(L::load(cells.volume.add(here)));
                }
                sum[v] = sum[v].add(near);
                let target = a.f[0].offset(other);
                L::load(target).add(far).store(target);
                v += 1;
            }
        }
        let mut v = 0;
        while v < CELLS / L::WIDTH {
            let target = a.f[0].add(L::WIDTH * v);
            L::load(target).add(sum[v]).store(target);
            v += 1;
        }
    }
}

/// Pulls times volumes, for bodies with various ones.
#[inline(always)]
unsafe fn volumes<L: Lanes>(a: &Chunk, near: L, far: L, here: usize, other: isize) -> (L, L) {
    // SAFETY: per-cell data cover the cells that displacements cover.
    unsafe {
        let Some(cells) = a.various else { return (near, far) };
        let (own, partner) = (L::load(cells.volume.add(here)), L::load(cells.volume.offset(other)));
        if cells.newton {
            let both = own.mul(partner);
            return (near.mul(both), far.mul(both));
        }
        (near.mul(partner), far.mul(own))
    }
}

/// The kernels of one instruction set.
pub trait StateKernels: Sync {
    /// Adds forces; see `pull` above.
    ///
    /// # Safety
    /// As for `pull`.
    unsafe fn pull<
        W: BondLaw,
        const DEGREE: usize,
        const MASKED: bool,
        const TRACK: bool,
        const VARIOUS: bool,
    >(
        a: &Chunk,
        s: &Cells,
    ) -> (f64, f64);
    /// Adds up a term; see `add_up` above.
    ///
    /// # Safety
    /// As for `add_up`.
    unsafe fn add_up<T: Term, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool>(
        a: &Chunk,
        s: &Cells,
    );
}

/// Kernels of one instruction set from those for its lanes.
macro_rules! compiled_for {
    ($kernels:ty, $lanes:ty $(, $features:literal)?) => {
        impl StateKernels for $kernels {
            unsafe fn pull<
                W: BondLaw,
                const DEGREE: usize,
                const MASKED: bool,
                const TRACK: bool,
                const VARIOUS: bool,
            >(
                a: &Chunk,
                s: &Cells,
            ) -> (f64, f64) {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner<
                    W: BondLaw,
                    const DEGREE: usize,
                    const MASKED: bool,
                    const TRACK: bool,
                    const VARIOUS: bool,
                >(
                    a: &Chunk,
                    s: &Cells,
                ) -> (f64, f64) {
                    // SAFETY: the caller's promise.
                    unsafe { pull::<$lanes, W, DEGREE, MASKED, TRACK, VARIOUS>(a, s) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner::<W, DEGREE, MASKED, TRACK, VARIOUS>(a, s) }
            }
            unsafe fn add_up<T: Term, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool>(
                a: &Chunk,
                s: &Cells,
            ) {
                $(#[target_feature(enable = $features)])?
                unsafe fn inner<T: Term, const DEGREE: usize, const MASKED: bool, const VARIOUS: bool>(
                    a: &Chunk,
                    s: &Cells,
                ) {
                    // SAFETY: the caller's promise.
                    unsafe { add_up::<$lanes, T, DEGREE, MASKED, VARIOUS>(a, s) }
                }
                // SAFETY: the caller's promise includes the instruction set.
                unsafe { inner::<T, DEGREE, MASKED, VARIOUS>(a, s) }
            }
        }
    };
}

compiled_for!(Plain, Portable);
#[cfg(target_arch = "x86_64")]
compiled_for!(Wide, super::super::lanes::Avx2, "avx2,fma");
#[cfg(target_arch = "x86_64")]
compiled_for!(Widest, super::super::lanes512::Avx512, "avx512f,avx512dq,avx512vl,avx2,fma");

/// Adds forces with the kernel for a degree and the other choices.
///
/// # Safety
/// As for `pull`.
#[inline]
pub unsafe fn run<K: StateKernels, W: BondLaw>(
    a: &Chunk,
    s: &Cells,
    degree: usize,
    masked: bool,
    track: bool,
) -> (f64, f64) {
    // SAFETY: the caller's promise.
    unsafe {
        if a.various.is_some() {
            return K::pull::<W, CLOSED, true, true, true>(a, s);
        }
        if !W::SERIES {
            return K::pull::<W, CLOSED, true, true, false>(a, s);
        }
        match (degree, masked, track) {
            (3, false, false) => K::pull::<W, 3, false, false, false>(a, s),
            (3, false, true) => K::pull::<W, 3, false, true, false>(a, s),
            (3, true, false) => K::pull::<W, 3, true, false, false>(a, s),
            (3, true, true) => K::pull::<W, 3, true, true, false>(a, s),
            (5 | 7, false, false) => K::pull::<W, 7, false, false, false>(a, s),
            (5 | 7, _, _) => K::pull::<W, 7, true, true, false>(a, s),
            _ => K::pull::<W, CLOSED, true, true, false>(a, s),
        }
    }
}

/// Adds up a term with the kernel for a degree.
///
/// # Safety
/// As for `add_up`.
#[inline]
pub unsafe fn run_term<K: StateKernels, T: Term>(a: &Chunk, s: &Cells, degree: usize, masked: bool) {
    // SAFETY: the caller's promise.
    unsafe {
        if a.various.is_some() {
            return K::add_up::<T, CLOSED, true, true>(a, s);
        }
        if !T::STRETCH {
            return K::add_up::<T, CLOSED, true, false>(a, s);
        }
        match (degree, masked) {
            (3, false) => K::add_up::<T, 3, false, false>(a, s),
            (3, true) => K::add_up::<T, 3, true, false>(a, s),
            (5 | 7, false) => K::add_up::<T, 7, false, false>(a, s),
            (5 | 7, true) => K::add_up::<T, 7, true, false>(a, s),
            _ => K::add_up::<T, CLOSED, true, false>(a, s),
        }
    }
}
