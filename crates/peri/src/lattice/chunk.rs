//! Bonds of eight neighbouring cells of a lattice: their constants, stretches and forces handed back.

use crate::families::lattice::{CONSTANTS, Lead};
use crate::lanes::Lanes;
use crate::law::polynomials;

/// Places in a table of constants of one stencil vector.
pub mod constant {
    /// The reference bond, three components.
    pub const XI: usize = 0;
    /// |q| below which the bond counts as unstretched.
    pub const DEAD: usize = 3;
    /// [`SERIES`](crate::law::series::SERIES)`[k]`/|xi|^(2 k + 2), eight numbers, so that they give s/(1 + s); under laws whose
    /// pull is that alone ([`BondLaw::PLAIN`](crate::law::BondLaw::PLAIN)) times [`FACTOR`]. In the table of
    /// dilatations they give the whole term.
    pub const SERIES: usize = 4;
    /// 1/|xi|^2.
    pub const INVERSE: usize = 12;
    /// ω w V (c w V/|xi| of bond-based laws); in the table of dilatations ω w |xi|² V.
    pub const FACTOR: usize = 13;
    /// ω, or of bond-based laws the stretch at which bonds flow.
    pub const OMEGA: usize = 14;
    /// The pair's critical stretch; in the table of dilatations one over [`FACTOR`].
    pub const LIMIT: usize = 15;
}

/// An expression for each of the three components. Not a closure: closures do not inherit the instruction set
/// of the kernel around them.
macro_rules! xyz {
    (|$k:ident| $e:expr) => {
        [
            {
                let $k = 0usize;
                $e
            },
            {
                let $k = 1usize;
                $e
            },
            {
                let $k = 2usize;
                $e
            },
        ]
    };
}

/// What a chunk's loop needs; pointers are at the chunk's first cell.
#[derive(Clone, Copy)]
pub struct Chunk<'a> {
    /// Displacements.
    pub u: [*const f64; 3],
    /// Forces, added to.
    pub f: [*mut f64; 3],
    /// Alive bits of the chunk, one byte per stencil vector.
    pub alive: &'a [u8],
    /// Where the bonds lead.
    pub to: &'a [Lead],
    /// Constants.
    pub tables: &'a [f64],
    /// Per-cell data of bodies with mixed rows or various volumes.
    pub various: Option<Various<'a>>,
}

/// Per-cell data of bodies with mixed rows or various volumes; pointers at the chunk's first cell.
#[derive(Clone, Copy)]
pub struct Various<'a> {
    /// Local types.
    pub kind: *const u8,
    /// Volumes.
    pub volume: *const f64,
    /// Micromodulus, s00 and alpha of pairs of local types.
    pub pairs: &'a [[f64; 3]],
    /// Number of local types.
    pub kinds: usize,
    /// Whether both ends get V_i V_j.
    pub newton: bool,
}

/// Cells of a chunk: a byte of alive bits per stencil vector.
pub const CELLS: usize = 8;

/// Energy and the six components of the virial.
pub const SUMS: usize = 7;

/// Degree that stands for the closed form; higher ones are those of [`wide`].
pub const CLOSED: usize = 8;

/// Displacements of some neighbouring cells, from the chunk's cell `here` on.
///
/// # Safety
/// See the loops of [`crate::lattice::kernels`]; so for all helpers below.
#[inline(always)]
pub unsafe fn place<L: Lanes>(u: &[*const f64; 3], here: isize) -> [L; 3] {
    // SAFETY: the caller's promise.
    unsafe { xyz!(|k| L::load(u[k].offset(here))) }
}

/// One bond of each of some neighbouring cells.
#[derive(Clone, Copy)]
pub struct Bonds<L> {
    /// xi + eta.
    pub y: [L; 3],
    /// |y|² − |xi|².
    pub q: L,
    /// Mask of those stretched beyond the dead band, and living.
    pub live: L,
}

/// The bonds from cells displaced by `own` along the stencil vector with constants at `c`.
#[inline(always)]
pub unsafe fn bonds<L: Lanes, const MASKED: bool>(
    u: &[*const f64; 3],
    own: &[L; 3],
    other: isize,
    c: *const f64,
    bits: u8,
) -> Bonds<L> {
    // SAFETY: the caller's promise.
    unsafe {
        let xi = xyz!(|k| L::splat(*c.add(constant::XI + k)));
        let far = place::<L>(u, other);
        let eta = xyz!(|k| far[k].sub(own[k]));
        let y = xyz!(|k| eta[k].add(xi[k]));
        let twice = xyz!(|k| y[k].add(xi[k]));
        let q = eta[0].fma(twice[0], eta[1].fma(twice[1], eta[2].mul(twice[2])));
        let mut live = q.abs().ge(L::splat(*c.add(constant::DEAD)));
        if MASKED {
            live = live.keep(L::mask(bits));
        }
        Bonds { y, q, live }
    }
}

/// q times the series of a row of constants.
#[inline(always)]
pub unsafe fn series<L: Lanes, const DEGREE: usize>(q: L, c: *const f64) -> L {
    // SAFETY: the caller's promise.
    unsafe {
        let mut h = L::splat(*c.add(constant::SERIES + DEGREE));
        let mut k = DEGREE;
        while k > 0 {
            k -= 1;
            h = h.fma(q, L::splat(*c.add(constant::SERIES + k)));
        }
        h.mul(q)
    }
}

/// Takes pulls along bonds from the forces at their far ends.
#[inline(always)]
pub unsafe fn take<L: Lanes>(f: &[*mut f64; 3], other: isize, pull: L, y: &[L; 3]) {
    // SAFETY: the caller's promise.
    unsafe {
        let target = xyz!(|k| f[k].offset(other));
        let left = xyz!(|k| pull.fnma(y[k], L::load(target[k])));
        left[0].store(target[0]);
        left[1].store(target[1]);
        left[2].store(target[2]);
    }
}

/// Adds sums to the forces of a chunk's own cells.
#[inline(always)]
pub unsafe fn give<L: Lanes>(f: &[*mut f64; 3], sum: &[[L; 3]; 2]) {
    // SAFETY: the caller's promise.
    unsafe {
        let mut v = 0;
        while v < CELLS / L::WIDTH {
            let total = xyz!(|k| L::load(f[k].add(L::WIDTH * v)).add(sum[v][k]));
            total[0].store(f[0].add(L::WIDTH * v));
            total[1].store(f[1].add(L::WIDTH * v));
            total[2].store(f[2].add(L::WIDTH * v));
            v += 1;
        }
    }
}

/// The largest of all lanes of `high`, and of −`low`.
#[inline(always)]
pub unsafe fn extremes<L: Lanes>(high: L, low: L) -> (f64, f64) {
    let mut most = [[0.0f64; CELLS]; 2];
    // SAFETY: eight numbers, as many as the widest lanes.
    unsafe {
        high.store(most[0].as_mut_ptr());
        low.store(most[1].as_mut_ptr());
    }
    (most[0].iter().copied().fold(0.0, f64::max), -most[1].iter().copied().fold(0.0, f64::min))
}

/// Puts sums to the cells from `here` on.
///
/// # Safety
/// There must be cells for all lanes; the processor must have what the lanes need.
#[inline(always)]
pub unsafe fn put_sums<L: Lanes>(sum: &[L; SUMS], out: &mut [[f64; CELLS]; SUMS], here: usize) {
    // SAFETY: the caller's promise.
    unsafe {
        let mut k = 0;
        while k < SUMS {
            sum[k].store(out[k].as_mut_ptr().add(here));
            k += 1;
        }
    }
}

/// Sums with a bond's energy and the virial of a pull along y.
#[inline(always)]
pub unsafe fn with_virial<L: Lanes>(sum: [L; SUMS], energy: L, pull: L, y: &[L; 3]) -> [L; SUMS] {
    // SAFETY: plain arithmetic; the processor has it by the caller's promise.
    unsafe {
        let p = xyz!(|k| pull.mul(y[k]));
        [
            sum[0].add(energy),
            p[0].fma(y[0], sum[1]),
            p[1].fma(y[1], sum[2]),
            p[2].fma(y[2], sum[3]),
            p[0].fma(y[1], sum[4]),
            p[0].fma(y[2], sum[5]),
            p[1].fma(y[2], sum[6]),
        ]
    }
}

/// Pulls times volumes, of microelastic bonds times micromoduli too, for bodies with various ones: at the cells from `here` on
/// and at their partners from `other` on.
#[inline(always)]
pub unsafe fn various<L: Lanes, const MODULI: bool>(
    a: &Chunk,
    (near, far): (L, L),
    here: usize,
    other: isize,
) -> (L, L) {
    // SAFETY: per-cell data cover the cells that displacements cover.
    unsafe {
        let Some(cells) = a.various else { return (near, far) };
        let (mut near, mut far) = (near, far);
        if MODULI {
            let mut c = [0.0; CELLS];
            let mut lane = 0;
            while lane < L::WIDTH {
                let (i, j) = (*cells.kind.add(here + lane), *cells.kind.offset(other + lane as isize));
                c[lane] = cells.pairs[usize::from(i) * cells.kinds + usize::from(j)][0];
                lane += 1;
            }
            let c = L::load(c.as_ptr());
            (near, far) = (near.mul(c), far.mul(c));
        }
        let (own, partner) = (L::load(cells.volume.add(here)), L::load(cells.volume.offset(other)));
        if cells.newton {
            let both = own.mul(partner);
            return (near.mul(both), far.mul(both));
        }
        (near.mul(partner), far.mul(own))
    }
}

const _: () = assert!(constant::LIMIT < CONSTANTS && polynomials::FAR == 10 && polynomials::FARTHEST == 16);
