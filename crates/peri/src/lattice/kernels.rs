//! The innermost loops on the lattice, whatever the law: all bonds of eight neighbouring cells.

use crate::families::lattice::Lead;
use crate::families::law::COLUMNS;
use crate::lanes::Lanes;
use crate::lattice::chunk::{
    CELLS, CLOSED, Chunk, bonds, constant, extremes, give, place, series, take, various,
};
use crate::law::polynomials;
use crate::law::terms::Term;
use crate::law::{BondLaw, Ends, Moment, Stretch, closed};

/// In the table of dilatations: one over [`constant::FACTOR`].
pub const FROM_TERM: usize = constant::LIMIT;
/// In the table of dilatations: twice the reference bond, three components.
pub const TWICE_XI: usize = constant::XI;

/// What a chunk's loop needs besides; pointers at the chunk's first cell.
#[derive(Clone, Copy)]
pub struct Cells<'a> {
    /// The first column; the others follow a stride apart.
    pub columns: *const f64,
    /// See `columns`.
    pub stride: usize,
    /// Displacements at the last step that advanced.
    pub last: [*const f64; 3],
    /// What the chunk's bonds remember, [`CELLS`] of each number for each stencil vector.
    pub memory: *mut f64,
    /// Whether that is anything but zeros.
    pub touched: *mut u8,
    /// What is the same for all bonds.
    pub moment: &'a Moment,
    /// Keep what bonds remember from this evaluation.
    pub keep: bool,
    /// The second half of the cells is vacant.
    pub half: bool,
}

/// How many numbers ahead memory of bonds is fetched: it is read but once in a sweep, and processors do not follow it from
/// page to page by themselves.
const AHEAD: usize = 16 * CELLS;

/// q of some bonds as [`bonds`] has it, and which count: where nothing else of y is needed, and the constants hold 2 xi.
#[inline(always)]
unsafe fn lengthened<L: Lanes, const MASKED: bool>(
    u: &[*const f64; 3],
    own: &[L; 3],
    other: isize,
    c: *const f64,
    bits: u8,
) -> (L, L) {
    // SAFETY: the caller's promise.
    unsafe {
        let far = place::<L>(u, other);
        let twice = |k: usize| *c.add(TWICE_XI + k);
        let eta = [far[0].sub(own[0]), far[1].sub(own[1]), far[2].sub(own[2])];
        let first = eta[2].mul(eta[2].add(L::splat(twice(2))));
        let second = eta[1].fma(eta[1].add(L::splat(twice(1))), first);
        let q = eta[0].fma(eta[0].add(L::splat(twice(0))), second);
        let mut live = q.abs().ge(L::splat(*c.add(constant::DEAD)));
        if MASKED {
            live = live.keep(L::mask(bits));
        }
        (q, live)
    }
}

/// Stretches of bonds, their `before` the same. Where series give s/(1 + s) times the weight of a bond, so is all that comes out.
#[inline(always)]
pub unsafe fn stretch<L: Lanes, const DEGREE: usize>((q, live): (L, L), c: *const f64) -> Stretch<L> {
    // SAFETY: the caller's promise.
    unsafe {
        if DEGREE == CLOSED {
            let s = closed(q.mul(L::splat(*c.add(constant::INVERSE))));
            let stretch = s.s.keep(live);
            return Stretch {
                s: stretch,
                share: s.share.keep(live),
                inverse: s.inverse,
                before: stretch,
                limit: stretch,
            };
        }
        if DEGREE > CLOSED {
            let z = q.mul(L::splat(*c.add(constant::INVERSE)));
            let share = z.mul(polynomials::share::<L, DEGREE>(z)).keep(live);
            let s = z.mul(polynomials::stretch::<L, DEGREE>(z)).keep(live);
            return Stretch { s, share, inverse: L::splat(1.0).sub(share), before: s, limit: s };
        }
        let share = series::<L, DEGREE>(q, c).keep(live);
        // s = p/(1 − p) for p = s/(1 + s): below the first term left out, p^(DEGREE + 2), is 1e-16 of p.
        let one = L::splat(1.0);
        let mut s = one;
        let mut k = 0;
        while k < DEGREE {
            s = s.fma(share, one);
            k += 1;
        }
        let s = s.mul(share);
        Stretch { s, share, inverse: one.sub(share), before: s, limit: s }
    }
}

/// The columns of some neighbouring cells.
#[inline(always)]
pub unsafe fn read<L: Lanes>(s: &Cells, count: usize, at: isize) -> [L; COLUMNS] {
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
pub unsafe fn recall<L: Lanes>(s: &Cells, numbers: usize, e: usize, here: usize) -> [L; 2] {
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

/// The vectors that a chunk's cells fill.
const fn vectors<L: Lanes>(half: bool) -> usize {
    if half { CELLS / 2 / L::WIDTH } else { CELLS / L::WIDTH }
}

/// Adds the forces of a chunk's bonds to both ends. Returns the largest z and the largest −z if `TRACK`. With `HALF` the
/// second half of its cells is vacant and left out.
///
/// Without `MASKED` all bonds of all eight cells must live.
///
/// # Safety
/// Live bonds must lead to cells within seven of cells that exist in `u` and `f`, all memory between readable and, in `f`,
/// writable and not touched by others; columns must be readable where displacements are, and `memory` writable for all bonds
/// of the chunk if the law remembers; the processor must have what `L` needs.
#[inline(always)]
pub(crate) unsafe fn pull<
    L: Lanes,
    W: BondLaw,
    const DEGREE: usize,
    const MASKED: bool,
    const TRACK: bool,
    const VARIOUS: bool,
    const HALF: bool,
>(
    a: &Chunk,
    s: &Cells,
) -> (f64, f64) {
    // SAFETY: the caller's promise covers every address formed below.
    unsafe {
        let zero = L::splat(0.0);
        let (mut high, mut low) = (zero, zero);
        // Two vectors of four cells, or one of eight (the second then stays unused).
        let half = (CELLS - L::WIDTH) as isize;
        let u = [place::<L>(&a.u, 0), place::<L>(&a.u, half)];
        let back = if W::BACK { [place::<L>(&s.last, 0), place::<L>(&s.last, half)] } else { u };
        let own = [read::<L>(s, W::COLUMNS, 0), read::<L>(s, W::COLUMNS, half)];
        let known = W::MEMORY > 0 && (!W::LAZY || *s.touched != 0);
        let mut woken = false;
        // A copy of its own: nothing that is stored can change it.
        let moment = *s.moment;
        let mut sum = [[zero; 3]; 2];
        let mut lead = 0;
        while lead < a.to.len() {
            let Lead { to, due, table, e } = *a.to.get_unchecked(lead);
            let vector = e as usize;
            let bits = *a.alive.get_unchecked(vector);
            lead += 1;
            if MASKED && bits == 0 {
                continue;
            }
            let c = a.tables.as_ptr().add(table as usize);
            let mut v = 0;
            while v < vectors::<L>(HALF) {
                let here = L::WIDTH * v;
                let (other, bits) = (here as isize + to as isize, bits >> here);
                let b = bonds::<L, MASKED>(&a.u, &u[v], other, c, bits);
                let mut now = stretch::<L, DEGREE>((b.q, b.live), c);
                if W::BACK {
                    let last = bonds::<L, MASKED>(&s.last, &back[v], other, c, bits);
                    now.before = stretch::<L, DEGREE>((last.q, last.live), c).s;
                }
                if W::LIMITED {
                    now.limit = L::splat(*c.add(constant::LIMIT));
                }
                let ends: Ends<L> = [own[v], read::<L>(s, W::COLUMNS, other)];
                let mut memory = if known { recall::<L>(s, W::MEMORY, vector, here) } else { [zero; 2] };
                if known {
                    L::fetch(remembered(s, W::MEMORY, vector, 0, here).wrapping_add(AHEAD));
                }
                let omega = L::splat(*c.add(constant::OMEGA));
                let (mut near, mut far) = W::pull(&now, omega, &ends, &mut memory, &moment);
                if W::MEMORY > 0 && s.keep && (known || W::flows(&ends).bits() != 0) {
                    woken = true;
                    let mut k = 0;
                    while k < W::MEMORY {
                        memory[k].store(remembered(s, W::MEMORY, vector, k, here));
                        k += 1;
                    }
                }
                if !W::PLAIN || DEGREE >= CLOSED {
                    let mut factor = L::splat(*c.add(constant::FACTOR));
                    if MASKED && !W::PLAIN {
                        factor = factor.keep(L::mask(bits));
                    }
                    (near, far) = (near.mul(factor), far.mul(factor));
                }
                if VARIOUS {
                    (near, far) = match W::PLAIN {
                        true => various::<L, true>(a, (near, far), here, other),
                        false => various::<L, false>(a, (near, far), here, other),
                    };
                }
                if TRACK {
                    let z = b.q.mul(L::splat(*c.add(constant::INVERSE))).keep(b.live);
                    high = z.max(high);
                    low = z.min(low);
                }
                let mut k = 0;
                while k < 3 {
                    sum[v][k] = near.fma(b.y[k], sum[v][k]);
                    k += 1;
                }
                take::<L>(&a.f, here as isize + due as isize, far, &b.y);
                v += 1;
            }
        }
        if W::LAZY && woken {
            *s.touched = 1;
        }
        give::<L>(&a.f, &sum);
        if TRACK { extremes::<L>(high, low) } else { (0.0, 0.0) }
    }
}

/// Adds a term of a chunk's bonds to the sums of both ends, in `f[0]` of the chunk.
///
/// # Safety
/// As for [`pull`]; only the first component of `f` is touched.
#[inline(always)]
pub(crate) unsafe fn add_up<
    L: Lanes,
    T: Term,
    const DEGREE: usize,
    const MASKED: bool,
    const VARIOUS: bool,
    const HALF: bool,
>(
    a: &Chunk,
    s: &Cells,
) {
    // SAFETY: the caller's promise covers every address formed below.
    unsafe {
        let half = (CELLS - L::WIDTH) as isize;
        let u = [place::<L>(&a.u, 0), place::<L>(&a.u, half)];
        let own = [read::<L>(s, T::COLUMNS, 0), read::<L>(s, T::COLUMNS, half)];
        let known = T::MEMORY > 0 && *s.touched != 0;
        let mut sum = [L::splat(0.0); 2];
        let mut lead = 0;
        while lead < a.to.len() {
            let Lead { to, due, table, e } = *a.to.get_unchecked(lead);
            let vector = e as usize;
            let bits = *a.alive.get_unchecked(vector);
            lead += 1;
            if MASKED && bits == 0 {
                continue;
            }
            let c = a.tables.as_ptr().add(table as usize);
            let mut v = 0;
            while v < vectors::<L>(HALF) {
                let here = L::WIDTH * v;
                let (other, bits) = (here as isize + to as isize, bits >> here);
                let (q, live) = lengthened::<L, MASKED>(&a.u, &u[v], other, c, bits);
                let (mut near, mut far) = if DEGREE < CLOSED && T::STRETCH {
                    // The series is the term itself.
                    let term = series::<L, DEGREE>(q, c).keep(live);
                    (term, term)
                } else {
                    term_of::<L, T, DEGREE, MASKED>(
                        s,
                        (q, live),
                        c,
                        (&own[v], other, bits),
                        (vector, here, known),
                    )
                };
                if VARIOUS && let Some(cells) = a.various {
                    near = near.mul(L::load(cells.volume.offset(other)));
                    far = far.mul(L::load(cells.volume.add(here)));
                }
                sum[v] = sum[v].add(near);
                let target = a.f[0].offset(here as isize + due as isize);
                L::load(target).add(far).store(target);
                v += 1;
            }
        }
        let mut v = 0;
        while v < vectors::<L>(HALF) {
            let target = a.f[0].add(L::WIDTH * v);
            L::load(target).add(sum[v]).store(target);
            v += 1;
        }
    }
}

/// The terms of some bonds at both ends.
#[inline(always)]
unsafe fn term_of<L: Lanes, T: Term, const DEGREE: usize, const MASKED: bool>(
    s: &Cells,
    (q, live): (L, L),
    c: *const f64,
    (own, other, bits): (&[L; COLUMNS], isize, u8),
    (vector, here, known): (usize, usize, bool),
) -> (L, L) {
    // SAFETY: the caller's promise.
    unsafe {
        let s_of = if DEGREE >= CLOSED {
            stretch::<L, DEGREE>((q, live), c)
        } else {
            let s = series::<L, DEGREE>(q, c).keep(live).mul(L::splat(*c.add(FROM_TERM)));
            Stretch { s, share: s, inverse: s, before: s, limit: s }
        };
        let ends: Ends<L> = [*own, read::<L>(s, T::COLUMNS, other)];
        let memory = if known { recall::<L>(s, T::MEMORY, vector, here) } else { [L::splat(0.0); 2] };
        let (near, far) = T::terms(&s_of, L::splat(*c.add(constant::OMEGA)), &ends, &memory);
        let mut factor = L::splat(*c.add(constant::FACTOR));
        if MASKED {
            factor = factor.keep(L::mask(bits));
        }
        (near.mul(factor), far.mul(factor))
    }
}
