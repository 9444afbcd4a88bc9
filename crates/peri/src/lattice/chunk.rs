//! Bonds of eight neighbouring cells of a lattice: their constants, stretches and forces handed back.

use crate::families::lattice::{CONSTANTS, Lead};
use crate::law::polynomials;
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::real::Real;

/// The constants of one stencil vector; see [`constant`].
pub type Constants = [f64; CONSTANTS];

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
    pub(crate) u: [*const f64; 3],
    /// Forces, added to.
    pub(crate) f: [*mut f64; 3],
    /// Alive bits of the chunk, one byte per stencil vector.
    pub(crate) alive: &'a [u8],
    /// Where the bonds lead.
    pub(crate) to: &'a [Lead],
    /// Constants.
    pub(crate) tables: &'a [f64],
    /// Per-cell data of bodies with mixed rows or various volumes.
    pub(crate) various: Option<Various<'a>>,
}

impl<'a> Chunk<'a> {
    /// A chunk with its displacements `u`, alive bits, leads and constants. Loops over it add to the sums at `f`, but those of energies.
    ///
    /// # Safety
    /// Where a byte of `alive` has bits, its lead must be to cells within seven of cells that exist in `u` and `f`, and to a table of
    /// constants; all memory between must be readable and, in `f`, writable and not touched by others as long as the chunk is there.
    pub unsafe fn new(
        (u, f): ([*const f64; 3], [*mut f64; 3]),
        (alive, to, tables): (&'a [u8], &'a [Lead], &'a [f64]),
        various: Option<Various<'a>>,
    ) -> Self {
        Self { u, f, alive, to, tables, various }
    }
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

/// Degree that stands for the closed form; higher ones are those of `wide`.
pub const CLOSED: usize = 8;

/// Displacements of some neighbouring cells, from the chunk's cell `here` on.
///
/// # Safety
/// See the loops of [`crate::lattice::kernels`]; so for all helpers below.
#[inline(always)]
pub unsafe fn place<const N: usize, V: Lanes<N>>(u: &[*const f64; 3], here: isize) -> [V; 3] {
    // SAFETY: the caller's promise.
    unsafe { xyz!(|k| V::read(u[k].offset(here))) }
}

/// One bond of each of some neighbouring cells.
#[derive(Clone, Copy)]
pub struct Bonds<R: Real> {
    /// xi + eta.
    pub y: [R; 3],
    /// |y|² − |xi|².
    pub q: R,
    /// Those stretched beyond the dead band, and living.
    pub live: R::Mask,
}

/// The bonds of a stencil vector from cells displaced by `own` to cells displaced by `far`; if `MASKED`, those with a bit live.
#[inline(always)]
pub fn bonds<const N: usize, V: Lanes<N>, const MASKED: bool>(
    own: &[V; 3],
    far: &[V; 3],
    c: &Constants,
    bits: u8,
) -> Bonds<V> {
    let eta = xyz!(|k| far[k] - own[k]);
    let y = xyz!(|k| eta[k] + c[constant::XI + k]);
    let twice = xyz!(|k| y[k] + c[constant::XI + k]);
    let q = eta[0].fma(twice[0], eta[1].fma(twice[1], eta[2] * twice[2]));
    Bonds { y, q, live: live::<N, V, MASKED>(q, c, bits) }
}

/// Bonds with this q stretched beyond the dead band; if `MASKED`, of those with a bit.
#[inline(always)]
pub fn live<const N: usize, V: Lanes<N>, const MASKED: bool>(q: V, c: &Constants, bits: u8) -> V::Mask {
    let stretched = q.abs().at_least(q.like(c[constant::DEAD]));
    if MASKED { V::both(stretched, q.mask(bits)) } else { stretched }
}

/// q times the series of a row of constants.
#[inline(always)]
pub fn series<R: Real, const DEGREE: usize>(q: R, c: &Constants) -> R {
    let mut h = q.like(c[constant::SERIES + DEGREE]);
    let mut k = DEGREE;
    while k > 0 {
        k -= 1;
        h = h.fma(q, q.like(c[constant::SERIES + k]));
    }
    h * q
}

/// Takes pulls along bonds from the forces at their far ends.
#[inline(always)]
pub unsafe fn take<const N: usize, V: Lanes<N>>(f: &[*mut f64; 3], other: isize, pull: V, y: &[V; 3]) {
    // SAFETY: the caller's promise.
    unsafe {
        let target = xyz!(|k| f[k].offset(other));
        let left = xyz!(|k| pull.fnma(y[k], V::read(target[k])));
        left[0].write(target[0]);
        left[1].write(target[1]);
        left[2].write(target[2]);
    }
}

/// Adds sums to the forces of a chunk's own cells.
#[inline(always)]
pub unsafe fn give<const N: usize, V: Lanes<N>>(f: &[*mut f64; 3], sum: &[[V; 3]; 2]) {
    // SAFETY: the caller's promise.
    unsafe {
        let mut v = 0;
        while v < CELLS / N {
            let target = xyz!(|k| f[k].add(N * v));
            let total = xyz!(|k| V::read(target[k]) + sum[v][k]);
            total[0].write(target[0]);
            total[1].write(target[1]);
            total[2].write(target[2]);
            v += 1;
        }
    }
}

/// The largest of all lanes of `high`, and of −`low`.
#[inline(always)]
pub fn extremes<const N: usize, V: Lanes<N>>(high: V, low: V) -> (f64, f64) {
    (high.numbers().into_iter().fold(0.0, f64::max), -low.numbers().into_iter().fold(0.0, f64::min))
}

/// Puts sums to the cells from `here` on.
#[inline(always)]
pub fn put_sums<const N: usize, V: Lanes<N>>(sum: &[V; SUMS], out: &mut [[f64; CELLS]; SUMS], here: usize) {
    for (sum, out) in sum.iter().zip(out) {
        out[here..here + N].copy_from_slice(&sum.numbers());
    }
}

/// Sums with a bond's energy and the virial of a pull along y.
#[inline(always)]
pub fn with_virial<R: Real>(sum: [R; SUMS], energy: R, pull: R, y: &[R; 3]) -> [R; SUMS] {
    let p = xyz!(|k| pull * y[k]);
    [
        sum[0] + energy,
        p[0].fma(y[0], sum[1]),
        p[1].fma(y[1], sum[2]),
        p[2].fma(y[2], sum[3]),
        p[0].fma(y[1], sum[4]),
        p[0].fma(y[2], sum[5]),
        p[1].fma(y[2], sum[6]),
    ]
}

/// Pulls times volumes, of microelastic bonds times micromoduli too, for bodies with various ones: at the cells from `here` on
/// and at their partners from `other` on.
#[inline(always)]
pub unsafe fn various<const N: usize, V: Lanes<N>, const MODULI: bool>(
    a: &Chunk,
    (near, far): (V, V),
    here: usize,
    other: isize,
) -> (V, V) {
    let Some(cells) = a.various else { return (near, far) };
    let (mut near, mut far) = (near, far);
    // SAFETY: per-cell data cover the cells that displacements cover.
    unsafe {
        if MODULI {
            let mut c = [0.0; N];
            for (lane, c) in c.iter_mut().enumerate() {
                let (i, j) = (*cells.kind.add(here + lane), *cells.kind.offset(other + lane as isize));
                *c = cells.pairs[usize::from(i) * cells.kinds + usize::from(j)][0];
            }
            let c = V::of(c);
            (near, far) = (near * c, far * c);
        }
        let (own, partner) = (V::read(cells.volume.add(here)), V::read(cells.volume.offset(other)));
        if cells.newton {
            let both = own * partner;
            return (near * both, far * both);
        }
        (near * partner, far * own)
    }
}

const _: () = assert!(constant::LIMIT < CONSTANTS && polynomials::FAR == 10 && polynomials::FARTHEST == 16);
