//! The innermost loops on the lattice, whatever the law: all bonds of eight neighbouring cells.

use crate::families::lattice::Lead;
use crate::lattice::chunk::{
    CELLS, CLOSED, Chunk, Constants, bonds, constant, extremes, give, live, place, series, take, various,
};
use crate::law::formula::BondLaw;
use crate::law::moment::COLUMNS;
use crate::law::moment::Moment;
use crate::law::polynomials;
use crate::law::stretch::{Ends, Stretch, closed};
use crate::law::terms::Term;
use perigrain_base::math::lanes::{Lanes, prefetch};
use perigrain_base::math::real::Real;

/// In the table of dilatations: one over [`constant::FACTOR`].
pub const FROM_TERM: usize = constant::LIMIT;
/// In the table of dilatations: twice the reference bond, three components.
pub const TWICE_XI: usize = constant::XI;

/// What a chunk's loop needs besides; pointers at the chunk's first cell.
#[derive(Clone, Copy)]
pub struct Cells<'a> {
    /// The first column; the others follow a stride apart.
    pub(crate) columns: *const f64,
    /// See `columns`.
    pub(crate) stride: usize,
    /// Displacements at the last step that advanced.
    pub(super) last: [*const f64; 3],
    /// What the chunk's bonds remember, [`CELLS`] of each number for each stencil vector.
    memory: *mut f64,
    /// Whether that is anything but zeros.
    pub(super) touched: *mut u8,
    /// What is the same for all bonds.
    pub(super) moment: &'a Moment,
    /// Keep what bonds remember from this evaluation.
    keep: bool,
    /// The second half of the cells is vacant.
    pub(super) half: bool,
}

impl<'a> Cells<'a> {
    /// What the sites and bonds of a chunk have: the first of `columns` that are a stride apart, displacements at the `last` step that advanced,
    /// what bonds remember and whether that is anything. `keep` is whether what they remember moves on, `half` whether the second half of
    /// the cells is vacant.
    ///
    /// # Safety
    /// As many columns as the law reads must be readable where displacements are, and `last` with them; if the law remembers, memory must be
    /// readable, and writable if they `keep` it, for all bonds of the chunk and not touched by others as long as this is there.
    pub unsafe fn new(
        (columns, stride): (*const f64, usize),
        last: [*const f64; 3],
        (memory, touched): (*mut f64, *mut u8),
        moment: &'a Moment,
        [keep, half]: [bool; 2],
    ) -> Self {
        Self { columns, stride, last, memory, touched, moment, keep, half }
    }
}

/// How many numbers ahead memory of bonds is fetched: it is read but once in a sweep, and processors do not follow it from
/// page to page by themselves.
const AHEAD: usize = 16 * CELLS;

/// q of some bonds as [`bonds`] has it: where nothing else of y is needed, and the constants hold 2 xi.
#[inline(always)]
fn lengthened<R: Real>(own: &[R; 3], far: &[R; 3], c: &Constants) -> R {
    let eta = [far[0] - own[0], far[1] - own[1], far[2] - own[2]];
    let first = eta[2] * (eta[2] + c[TWICE_XI + 2]);
    let second = eta[1].fma(eta[1] + c[TWICE_XI + 1], first);
    eta[0].fma(eta[0] + c[TWICE_XI], second)
}

/// Stretches of bonds, their `before` the same. Where series give s/(1 + s) times the weight of a bond, so is all that comes out.
#[inline(always)]
pub fn stretch<R: Real, const DEGREE: usize>((q, live): (R, R::Mask), c: &Constants) -> Stretch<R> {
    if DEGREE == CLOSED {
        let of = closed(q * c[constant::INVERSE]);
        let s = of.s.keep(live);
        return Stretch { s, share: of.share.keep(live), inverse: of.inverse, before: s, limit: s };
    }
    let one = q.like(1.0);
    if DEGREE > CLOSED {
        let z = q * c[constant::INVERSE];
        let share = (z * polynomials::share::<R, DEGREE>(z)).keep(live);
        let s = (z * polynomials::stretch::<R, DEGREE>(z)).keep(live);
        return Stretch { s, share, inverse: one - share, before: s, limit: s };
    }
    let share = series::<R, DEGREE>(q, c).keep(live);
    // s = p/(1 − p) for p = s/(1 + s): below the first term left out, p^(DEGREE + 2), is 1e-16 of p.
    let mut s = one;
    let mut k = 0;
    while k < DEGREE {
        s = s.fma(share, one);
        k += 1;
    }
    let s = s * share;
    Stretch { s, share, inverse: one - share, before: s, limit: s }
}

/// The columns of some neighbouring cells.
#[inline(always)]
pub unsafe fn read<const N: usize, V: Lanes<N>>(s: &Cells, count: usize, at: isize) -> [V; COLUMNS] {
    // SAFETY: the caller's promise.
    unsafe {
        let mut columns = [V::all(0.0); COLUMNS];
        let mut k = 0;
        while k < count {
            columns[k] = V::read(s.columns.add(k * s.stride).offset(at));
            k += 1;
        }
        columns
    }
}

/// Where the numbers of a stencil vector's bonds are: within the chunk's memory if the law remembers so many.
#[inline(always)]
fn remembered(s: &Cells, numbers: usize, e: usize, number: usize, here: usize) -> *mut f64 {
    s.memory.wrapping_add((e * numbers + number) * CELLS + here)
}

#[inline(always)]
pub unsafe fn recall<const N: usize, V: Lanes<N>>(
    s: &Cells,
    numbers: usize,
    e: usize,
    here: usize,
) -> [V; 2] {
    // SAFETY: passed on to the caller.
    unsafe {
        let mut memory = [V::all(0.0); 2];
        let mut k = 0;
        while k < numbers {
            memory[k] = V::read(remembered(s, numbers, e, k, here));
            k += 1;
        }
        memory
    }
}

/// The vectors that a chunk's cells fill.
const fn vectors<const N: usize>(half: bool) -> usize {
    if half { CELLS / 2 / N } else { CELLS / N }
}

/// Adds the forces of a chunk's bonds to both ends. Returns the largest z and the largest −z if `TRACK`. With `HALF` the
/// second half of its cells is vacant and left out.
///
/// Without `MASKED` all bonds of all eight cells must live.
///
/// # Safety
/// The processor must have what `V` needs; for memory, chunks and cells answer.
#[inline(always)]
pub(crate) unsafe fn pull<
    const N: usize,
    V: Lanes<N>,
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
        let zero = V::all(0.0);
        let (mut high, mut low) = (zero, zero);
        // Two vectors of four cells, or one of eight (the second then stays unused).
        let half = (CELLS - N) as isize;
        let u: [[V; 3]; 2] = [place(&a.u, 0), place(&a.u, half)];
        let back = if W::BACK { [place(&s.last, 0), place(&s.last, half)] } else { u };
        let own: Ends<V> = [read(s, W::COLUMNS, 0), read(s, W::COLUMNS, half)];
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
            let c = &*a.tables.as_ptr().add(table as usize).cast::<Constants>();
            let mut v = 0;
            while v < vectors::<N>(HALF) {
                let here = N * v;
                let (other, bits) = (here as isize + to as isize, bits >> here);
                let b = bonds::<N, V, MASKED>(&u[v], &place(&a.u, other), c, bits);
                let mut now = stretch::<V, DEGREE>((b.q, b.live), c);
                if W::BACK {
                    let last = bonds::<N, V, MASKED>(&back[v], &place(&s.last, other), c, bits);
                    now.before = stretch::<V, DEGREE>((last.q, last.live), c).s;
                }
                if W::LIMITED {
                    now.limit = zero.like(c[constant::LIMIT]);
                }
                let ends: Ends<V> = [own[v], read(s, W::COLUMNS, other)];
                let mut memory = if known { recall(s, W::MEMORY, vector, here) } else { [zero; 2] };
                if known {
                    prefetch(remembered(s, W::MEMORY, vector, 0, here).wrapping_add(AHEAD));
                }
                let omega = zero.like(c[constant::OMEGA]);
                let (mut near, mut far) = W::pull(&now, omega, &ends, &mut memory, &moment);
                if W::MEMORY > 0 && s.keep && (known || V::any(W::flows(&ends))) {
                    woken = true;
                    let mut k = 0;
                    while k < W::MEMORY {
                        memory[k].write(remembered(s, W::MEMORY, vector, k, here));
                        k += 1;
                    }
                }
                if !W::PLAIN || DEGREE >= CLOSED {
                    let mut factor = zero.like(c[constant::FACTOR]);
                    if MASKED && !W::PLAIN {
                        factor = factor.keep(factor.mask(bits));
                    }
                    (near, far) = (near * factor, far * factor);
                }
                if VARIOUS {
                    (near, far) = match W::PLAIN {
                        true => various::<N, V, true>(a, (near, far), here, other),
                        false => various::<N, V, false>(a, (near, far), here, other),
                    };
                }
                if TRACK {
                    let z = (b.q * c[constant::INVERSE]).keep(b.live);
                    high = z.most(high);
                    low = z.least(low);
                }
                let mut k = 0;
                while k < 3 {
                    sum[v][k] = near.fma(b.y[k], sum[v][k]);
                    k += 1;
                }
                take(&a.f, here as isize + due as isize, far, &b.y);
                v += 1;
            }
        }
        if W::LAZY && woken {
            *s.touched = 1;
        }
        give(&a.f, &sum);
        if TRACK { extremes(high, low) } else { (0.0, 0.0) }
    }
}

/// Adds a term of a chunk's bonds to the sums of both ends, in `f[0]` of the chunk.
///
/// # Safety
/// As for [`pull`]; only the first component of `f` is touched.
#[inline(always)]
pub(crate) unsafe fn add_up<
    const N: usize,
    V: Lanes<N>,
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
        let zero = V::all(0.0);
        let half = (CELLS - N) as isize;
        let u: [[V; 3]; 2] = [place(&a.u, 0), place(&a.u, half)];
        let own: Ends<V> = [read(s, T::COLUMNS, 0), read(s, T::COLUMNS, half)];
        let known = T::MEMORY > 0 && *s.touched != 0;
        let mut sum = [zero; 2];
        let mut lead = 0;
        while lead < a.to.len() {
            let Lead { to, due, table, e } = *a.to.get_unchecked(lead);
            let vector = e as usize;
            let bits = *a.alive.get_unchecked(vector);
            lead += 1;
            if MASKED && bits == 0 {
                continue;
            }
            let c = &*a.tables.as_ptr().add(table as usize).cast::<Constants>();
            let mut v = 0;
            while v < vectors::<N>(HALF) {
                let here = N * v;
                let (other, bits) = (here as isize + to as isize, bits >> here);
                let q = lengthened(&u[v], &place(&a.u, other), c);
                let live = live::<N, V, MASKED>(q, c, bits);
                let (mut near, mut far) = if DEGREE < CLOSED && T::STRETCH {
                    // The series is the term itself.
                    let term = series::<V, DEGREE>(q, c).keep(live);
                    (term, term)
                } else {
                    let ends: Ends<V> = [own[v], read(s, T::COLUMNS, other)];
                    let memory = if known { recall(s, T::MEMORY, vector, here) } else { [zero; 2] };
                    let (near, far) = term_of::<V, T, DEGREE>((q, live), c, &ends, &memory);
                    let mut factor = zero.like(c[constant::FACTOR]);
                    if MASKED {
                        factor = factor.keep(factor.mask(bits));
                    }
                    (near * factor, far * factor)
                };
                if VARIOUS && let Some(cells) = a.various {
                    near = near * V::read(cells.volume.offset(other));
                    far = far * V::read(cells.volume.add(here));
                }
                sum[v] = sum[v] + near;
                let target = a.f[0].offset(here as isize + due as isize);
                (V::read(target) + far).write(target);
                v += 1;
            }
        }
        let mut v = 0;
        while v < vectors::<N>(HALF) {
            let target = a.f[0].add(N * v);
            (V::read(target) + sum[v]).write(target);
            v += 1;
        }
    }
}

/// The terms of some bonds at both ends, over ω w |xi|² V.
#[inline(always)]
fn term_of<R: Real, T: Term, const DEGREE: usize>(
    (q, live): (R, R::Mask),
    c: &Constants,
    ends: &Ends<R>,
    memory: &[R; 2],
) -> (R, R) {
    let stretch = if DEGREE >= CLOSED {
        stretch::<R, DEGREE>((q, live), c)
    } else {
        let s = series::<R, DEGREE>(q, c).keep(live) * c[FROM_TERM];
        Stretch { s, share: s, inverse: s, before: s, limit: s }
    };
    T::terms(&stretch, q.like(c[constant::OMEGA]), ends, memory)
}
