//! The innermost loop of the lattice layout: all bonds of eight neighbouring cells.

use super::lanes::{Lanes, Portable};
use super::pmb::closed;
use super::wide;
use crate::families::lattice::{CONSTANTS, Lead};

/// Places in a table of constants of one stencil vector.
pub mod constant {
    /// The reference bond, three components.
    pub const XI: usize = 0;
    /// |q| below which the bond counts as unstretched.
    pub const DEAD: usize = 3;
    /// c w V/|xi| SERIES[k]/|xi|^(2 k + 2), eight numbers.
    pub const SERIES: usize = 4;
    /// 1/|xi|^2.
    pub const INVERSE: usize = 12;
    /// c w V/|xi|.
    pub const FACTOR: usize = 13;
    /// w |xi| c V/2: energy density of one end per squared stretch, twice.
    pub const ENERGY: usize = 14;
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
/// See [`force`]; so for all helpers below.
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

/// Adds the forces of a chunk's bonds to both ends. Returns the largest z and the largest −z if `TRACK`.
/// Without `MASKED` all bonds of all eight cells must live.
///
/// # Safety
/// Live bonds must lead to cells within seven of cells that exist in `u` and `f`, all memory between readable
/// and, in `f`, writable and not touched by others; the processor must have what `L` needs.
#[inline(always)]
pub unsafe fn force<
    L: Lanes,
    const DEGREE: usize,
    const MASKED: bool,
    const TRACK: bool,
    const VARIOUS: bool,
>(
    a: &Chunk,
) -> (f64, f64) {
    // SAFETY: the caller's promise covers every address formed below.
    unsafe {
        let zero = L::splat(0.0);
        // Two vectors of four cells, or one of eight (the second then stays unused).
        let half = CELLS - L::WIDTH;
        let u = [place::<L>(&a.u, 0), place::<L>(&a.u, half as isize)];
        let mut sum = [[zero; 3]; 2];
        let (mut high, mut low) = (zero, zero);
        let mut lead = 0;
        while lead < a.to.len() {
            let Lead { to, table, e } = *a.to.get_unchecked(lead);
            let bits = *a.alive.get_unchecked(e as usize);
            lead += 1;
            if MASKED && bits == 0 {
                continue;
            }
            let to = to as isize;
            let c = a.tables.as_ptr().add(table as usize);
            let mut v = 0;
            while v < CELLS / L::WIDTH {
                let here = L::WIDTH * v;
                let other = to + here as isize;
                let b = bonds::<L, MASKED>(&a.u, &u[v], other, c, bits >> here);
                let factor = if DEGREE == CLOSED {
                    let z = b.q.mul(L::splat(*c.add(constant::INVERSE)));
                    z.mul(closed(z)).mul(L::splat(*c.add(constant::FACTOR)))
                } else if DEGREE > CLOSED {
                    let z = b.q.mul(L::splat(*c.add(constant::INVERSE)));
                    z.mul(wide::share::<L, DEGREE>(z)).mul(L::splat(*c.add(constant::FACTOR)))
                } else {
                    series::<L, DEGREE>(b.q, c)
                };
                let factor = factor.keep(b.live);
                if TRACK {
                    let z = b.q.mul(L::splat(*c.add(constant::INVERSE))).keep(b.live);
                    high = z.max(high);
                    low = z.min(low);
                }
                let (own, back) = if VARIOUS { various::<L>(a, factor, to, v) } else { (factor, factor) };
                sum[v] = xyz!(|k| own.fma(b.y[k], sum[v][k]));
                take::<L>(&a.f, other, back, &b.y);
                v += 1;
            }
        }
        give::<L>(&a.f, &sum);
        if TRACK { extremes::<L>(high, low) } else { (0.0, 0.0) }
    }
}

/// Energy and virial of a chunk's bonds, each end of a bond counted: Σ ½ c w V s² |xi| and
/// −Σ (c w V/|xi|) z h(z) y_a y_b over the six products of y = xi + eta, cell by cell. The virial lacks the
/// volume that densities need.
///
/// # Safety
/// As for [`force`], without `f`; the chunk has no per-cell data.
#[inline(always)]
pub unsafe fn sums<L: Lanes>(a: &Chunk) -> [[f64; CELLS]; SUMS] {
    // SAFETY: the caller's promise covers every address formed below.
    unsafe {
        let mut out = [[0.0; CELLS]; SUMS];
        let mut v = 0;
        while v < CELLS / L::WIDTH {
            let here = L::WIDTH * v;
            let u = place::<L>(&a.u, here as isize);
            let mut sum = [L::splat(0.0); SUMS];
            let mut lead = 0;
            while lead < a.to.len() {
                let Lead { to, table, e } = *a.to.get_unchecked(lead);
                let bits = *a.alive.get_unchecked(e as usize);
                lead += 1;
                if bits == 0 {
                    continue;
                }
                let c = a.tables.as_ptr().add(table as usize);
                let b = bonds::<L, true>(&a.u, &u, here as isize + to as isize, c, bits >> here);
                let z = b.q.mul(L::splat(*c.add(constant::INVERSE)));
                let one = L::splat(1.0);
                let root = one.add(z).sqrt();
                // z h(z) = s/(1 + s), and s times that root is s: one division.
                let share = z.div(root.fma(root, root)).keep(b.live);
                let stretch = share.mul(root);
                let energy = stretch.mul(stretch).mul(L::splat(0.5 * *c.add(constant::ENERGY)));
                let pull = share.mul(L::splat(-*c.add(constant::FACTOR)));
                sum = with_virial(sum, energy, pull, &b.y);
            }
            put_sums(&sum, &mut out, here);
            v += 1;
        }
        out
    }
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

/// The factor times micromodulus and volumes, for the two ends.
#[inline(always)]
unsafe fn various<L: Lanes>(a: &Chunk, factor: L, to: isize, v: usize) -> (L, L) {
    // SAFETY: per-cell data cover the cells that displacements cover.
    unsafe {
        let Some(cells) = a.various else { return (factor, factor) };
        let mut c = [0.0; CELLS];
        let mut lane = 0;
        while lane < L::WIDTH {
            let at = (L::WIDTH * v + lane) as isize;
            let (i, j) = (*cells.kind.offset(at), *cells.kind.offset(at + to));
            c[lane] = cells.pairs[usize::from(i) * cells.kinds + usize::from(j)][0];
            lane += 1;
        }
        let factor = factor.mul(L::load(c.as_ptr()));
        let own = L::load(cells.volume.add(L::WIDTH * v));
        let other = L::load(cells.volume.offset(to).add(L::WIDTH * v));
        if cells.newton {
            let both = factor.mul(own.mul(other));
            return (both, both);
        }
        (factor.mul(other), factor.mul(own))
    }
}

/// The kernels of one instruction set, chosen once per sweep.
pub trait Kernels: Sync {
    /// Whether there are forms without root and division for small stretches, and those without masks and tracking. Where
    /// processors have AVX2, the portable kernels are there to compare with, and one form does.
    const ALL_FORMS: bool = true;
    /// [`force`] for this instruction set.
    ///
    /// # Safety
    /// As for [`force`].
    unsafe fn force<const DEGREE: usize, const MASKED: bool, const TRACK: bool, const VARIOUS: bool>(
        a: &Chunk,
    ) -> (f64, f64);
    /// [`sums`] for this instruction set.
    ///
    /// # Safety
    /// As for [`sums`].
    unsafe fn sums(a: &Chunk) -> [[f64; CELLS]; SUMS];
}

/// Any processor.
pub struct Plain;

impl Kernels for Plain {
    const ALL_FORMS: bool = !cfg!(target_arch = "x86_64");
    unsafe fn force<const DEGREE: usize, const MASKED: bool, const TRACK: bool, const VARIOUS: bool>(
        a: &Chunk,
    ) -> (f64, f64) {
        // SAFETY: the caller's promise.
        unsafe { force::<Portable, DEGREE, MASKED, TRACK, VARIOUS>(a) }
    }
    unsafe fn sums(a: &Chunk) -> [[f64; CELLS]; SUMS] {
        // SAFETY: the caller's promise.
        unsafe { sums::<Portable>(a) }
    }
}

/// Processors with AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
pub struct Wide;

#[cfg(target_arch = "x86_64")]
impl Kernels for Wide {
    unsafe fn force<const DEGREE: usize, const MASKED: bool, const TRACK: bool, const VARIOUS: bool>(
        a: &Chunk,
    ) -> (f64, f64) {
        #[target_feature(enable = "avx2,fma")]
        unsafe fn wide<const DEGREE: usize, const MASKED: bool, const TRACK: bool, const VARIOUS: bool>(
            a: &Chunk,
        ) -> (f64, f64) {
            // SAFETY: the caller's promise.
            unsafe { force::<super::lanes::Avx2, DEGREE, MASKED, TRACK, VARIOUS>(a) }
        }
        // SAFETY: the caller's promise includes the instruction set.
        unsafe { wide::<DEGREE, MASKED, TRACK, VARIOUS>(a) }
    }
    unsafe fn sums(a: &Chunk) -> [[f64; CELLS]; SUMS] {
        #[target_feature(enable = "avx2,fma")]
        unsafe fn wide(a: &Chunk) -> [[f64; CELLS]; SUMS] {
            // SAFETY: the caller's promise.
            unsafe { sums::<super::lanes::Avx2>(a) }
        }
        // SAFETY: the caller's promise includes the instruction set.
        unsafe { wide(a) }
    }
}

/// Processors with AVX-512: the same bits as [`Wide`], eight cells at once.
#[cfg(target_arch = "x86_64")]
pub struct Widest;

#[cfg(target_arch = "x86_64")]
impl Kernels for Widest {
    unsafe fn force<const DEGREE: usize, const MASKED: bool, const TRACK: bool, const VARIOUS: bool>(
        a: &Chunk,
    ) -> (f64, f64) {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
        unsafe fn widest<const DEGREE: usize, const MASKED: bool, const TRACK: bool, const VARIOUS: bool>(
            a: &Chunk,
        ) -> (f64, f64) {
            // SAFETY: the caller's promise.
            unsafe { force::<super::lanes512::Avx512, DEGREE, MASKED, TRACK, VARIOUS>(a) }
        }
        // SAFETY: the caller's promise includes the instruction set.
        unsafe { widest::<DEGREE, MASKED, TRACK, VARIOUS>(a) }
    }
    unsafe fn sums(a: &Chunk) -> [[f64; CELLS]; SUMS] {
        #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma")]
        unsafe fn widest(a: &Chunk) -> [[f64; CELLS]; SUMS] {
            // SAFETY: the caller's promise.
            unsafe { sums::<super::lanes512::Avx512>(a) }
        }
        // SAFETY: the caller's promise includes the instruction set.
        unsafe { widest(a) }
    }
}

/// Runs the kernel for a degree and the other choices.
///
/// # Safety
/// As for [`force`].
#[inline]
pub unsafe fn run<K: Kernels>(a: &Chunk, degree: usize, masked: bool, track: bool) -> (f64, f64) {
    macro_rules! pick {
        ($($degree:literal)*) => {
            match (degree, masked, track, a.various.is_some()) {
                $(
                    ($degree, false, false, false) => K::force::<$degree, false, false, false>(a),
                    ($degree, false, true, false) => K::force::<$degree, false, true, false>(a),
                    ($degree, true, false, false) => K::force::<$degree, true, false, false>(a),
                    ($degree, true, true, false) => K::force::<$degree, true, true, false>(a),
                    ($degree, _, _, true) => K::force::<$degree, true, true, true>(a),
                )*
                (_, _, _, false) => K::force::<CLOSED, true, true, false>(a),
                (_, _, _, true) => K::force::<CLOSED, true, true, true>(a),
            }
        };
    }
    // SAFETY: the caller's promise.
    unsafe {
        if const { !K::ALL_FORMS } {
            return match a.various.is_some() {
                false => K::force::<CLOSED, true, true, false>(a),
                true => K::force::<CLOSED, true, true, true>(a),
            };
        }
        pick!(3 5 7 10 16)
    }
}

const _: () = assert!(constant::ENERGY < CONSTANTS && wide::FAR == 10 && wide::FARTHEST == 16);
