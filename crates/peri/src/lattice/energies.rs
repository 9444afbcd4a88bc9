//! Energies and virials of bonds on the lattice, eight neighbouring cells at a time.

use crate::families::lattice::Lead;
use crate::lattice::chunk::{
    CELLS, CLOSED, Chunk, Constants, SUMS, bonds, constant, place, put_sums, with_virial,
};
use crate::lattice::kernels::{Cells, read, recall, stretch};
use crate::law::formula::{Angles, BondLaw};
use crate::law::stretch::Ends;
use perigrain_base::math::lanes::Lanes;

/// What energies need besides.
#[derive(Clone, Copy)]
pub struct Looking<'a> {
    /// Dilatations of the chunk's cells.
    pub theta: *const f64,
    /// Dilatations at the last step that advanced.
    pub before: *const f64,
    /// What of those is not yet relaxed.
    pub unrelaxed: *const f64,
    /// Constants of dilatations.
    pub terms: &'a [f64],
    /// Share of the squares that counts for each end.
    pub half: f64,
    /// Both ends have 15G/m as column 1; else that is part of the constants.
    pub states: bool,
    /// The step has advanced: what bonds remember is of now.
    pub advanced: bool,
}

/// The dilatations of some neighbouring cells.
#[inline(always)]
unsafe fn angles<const N: usize, V: Lanes<N>>(look: &Looking, at: isize, relaxing: V) -> Angles<V> {
    // SAFETY: the caller's promise.
    unsafe {
        let now = V::read(look.theta.offset(at));
        let more = now - V::read(look.before.offset(at));
        Angles { now, unrelaxed: V::read(look.unrelaxed.offset(at)) + more, relaxing }
    }
}

/// Energy and virial of a chunk's bonds, each end of a bond counted, cell by cell: the law's squares times what they weigh, and
/// −Σ pull y_a y_b over the six products of y = xi + eta. The virial lacks the volume that densities need.
///
/// # Safety
/// As for [`pull`](crate::lattice::kernels::pull), without `f`; `look` must be readable where columns are.
#[inline(always)]
pub unsafe fn sums<const N: usize, V: Lanes<N>, W: BondLaw>(
    a: &Chunk,
    s: &Cells,
    look: &Looking,
) -> [[f64; CELLS]; SUMS] {
    // SAFETY: the caller's promise covers every address formed below.
    unsafe {
        let zero = V::all(0.0);
        let mut out = [[0.0; CELLS]; SUMS];
        let known = W::MEMORY > 0 && (!W::LAZY || *s.touched != 0);
        let mut v = 0;
        while v < CELLS / N {
            let here = N * v;
            let u: [V; 3] = place(&a.u, here as isize);
            let last = place(&s.last, here as isize);
            let own = read(s, W::COLUMNS, here as isize);
            let mut sum = [zero; SUMS];
            let mut lead = 0;
            while lead < a.to.len() {
                let Lead { to, table, e, .. } = *a.to.get_unchecked(lead);
                let vector = e as usize;
                let bits = *a.alive.get_unchecked(vector) >> here;
                lead += 1;
                if bits == 0 {
                    continue;
                }
                let c = &*a.tables.as_ptr().add(table as usize).cast::<Constants>();
                let other = here as isize + to as isize;
                let b = bonds::<N, V, true>(&u, &place(&a.u, other), c, bits);
                let mut now = stretch::<V, CLOSED>((b.q, b.live), c);
                if W::BACK && !look.advanced {
                    let last = bonds::<N, V, true>(&last, &place(&s.last, other), c, bits);
                    now.before = stretch::<V, CLOSED>((last.q, last.live), c).s;
                }
                if W::LIMITED {
                    now.limit = zero.like(c[constant::LIMIT]);
                }
                let ends: Ends<V> = [own, read(s, W::COLUMNS, other)];
                let mut memory = if known { recall(s, W::MEMORY, vector, here) } else { [zero; 2] };
                let omega = zero.like(c[constant::OMEGA]);
                let mut at = [Angles::none(zero); 2];
                if W::DILATED {
                    at[0] = angles(look, here as isize, W::relaxing(&ends[0], s.moment));
                    at[1] = angles(look, other, W::relaxing(&ends[1], s.moment));
                }
                let (mut near, mut far) = W::squares(&now, omega, &at, &memory, s.moment);
                if look.states {
                    (near, far) = (near * ends[0][1], far * ends[1][1]);
                }
                let lives = zero.mask(bits);
                let term = look.half * look.terms[table as usize + constant::FACTOR];
                let energy = ((near + far) * term).keep(lives);
                let (near, far) = W::pull(&now, omega, &ends, &mut memory, s.moment);
                let pull = ((near + far) * (-0.5 * c[constant::FACTOR])).keep(lives);
                sum = with_virial(sum, energy, pull, &b.y);
            }
            put_sums(&sum, &mut out, here);
            v += 1;
        }
        out
    }
}
