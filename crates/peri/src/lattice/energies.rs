//! Energies and virials of bonds on the lattice, eight neighbouring cells at a time.

use crate::families::lattice::Lead;
use crate::lanes::Lanes;
use crate::lattice::chunk::{CELLS, CLOSED, Chunk, SUMS, bonds, constant, place, put_sums, with_virial};
use crate::lattice::kernels::{Cells, read, recall, stretch};
use crate::law::{Angles, BondLaw, Ends};

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
unsafe fn angles<L: Lanes>(look: &Looking, at: isize, relaxing: L) -> Angles<L> {
    // SAFETY: the caller's promise.
    unsafe {
        let now = L::load(look.theta.offset(at));
        let more = now.sub(L::load(look.before.offset(at)));
        Angles { now, unrelaxed: L::load(look.unrelaxed.offset(at)).add(more), relaxing }
    }
}

/// Energy and virial of a chunk's bonds, each end of a bond counted, cell by cell: the law's squares times what they weigh, and
/// −Σ pull y_a y_b over the six products of y = xi + eta. The virial lacks the volume that densities need.
///
/// # Safety
/// As for [`pull`], without `f`; `look` must be readable where columns are.
#[inline(always)]
pub unsafe fn sums<L: Lanes, W: BondLaw>(a: &Chunk, s: &Cells, look: &Looking) -> [[f64; CELLS]; SUMS] {
    // SAFETY: the caller's promise covers every address formed below.
    unsafe {
        let mut out = [[0.0; CELLS]; SUMS];
        let known = W::MEMORY > 0 && (!W::LAZY || *s.touched != 0);
        let mut v = 0;
        while v < CELLS / L::WIDTH {
            let here = L::WIDTH * v;
            let u = place::<L>(&a.u, here as isize);
            let last = place::<L>(&s.last, here as isize);
            let own = read::<L>(s, W::COLUMNS, here as isize);
            let mut sum = [L::splat(0.0); SUMS];
            let mut lead = 0;
            while lead < a.to.len() {
                let Lead { to, table, e, .. } = *a.to.get_unchecked(lead);
                let vector = e as usize;
                let bits = *a.alive.get_unchecked(vector) >> here;
                lead += 1;
                if bits == 0 {
                    continue;
                }
                let c = a.tables.as_ptr().add(table as usize);
                let other = here as isize + to as isize;
                let b = bonds::<L, true>(&a.u, &u, other, c, bits);
                let mut now = stretch::<L, CLOSED>((b.q, b.live), c);
                if W::BACK && !look.advanced {
                    let last = bonds::<L, true>(&s.last, &last, other, c, bits);
                    now.before = stretch::<L, CLOSED>((last.q, last.live), c).s;
                }
                if W::LIMITED {
                    now.limit = L::splat(*c.add(constant::LIMIT));
                }
                let ends: Ends<L> = [own, read::<L>(s, W::COLUMNS, other)];
                let mut memory =
                    if known { recall::<L>(s, W::MEMORY, vector, here) } else { [L::splat(0.0); 2] };
                let omega = L::splat(*c.add(constant::OMEGA));
                let mut at = [Angles::<L>::none(); 2];
                if W::DILATED {
                    at[0] = angles(look, here as isize, W::relaxing(&ends[0], s.moment));
                    at[1] = angles(look, other, W::relaxing(&ends[1], s.moment));
                }
                let (mut near, mut far) = W::squares(&now, omega, &at, &memory, s.moment);
                if look.states {
                    (near, far) = (near.mul(ends[0][1]), far.mul(ends[1][1]));
                }
                let lives = L::mask(bits);
                let term = L::splat(look.half * look.terms[table as usize + constant::FACTOR]);
                let energy = near.add(far).mul(term).keep(lives);
                let (near, far) = W::pull(&now, omega, &ends, &mut memory, s.moment);
                let pull = near.add(far).mul(L::splat(-0.5 * *c.add(constant::FACTOR))).keep(lives);
                sum = with_virial(sum, energy, pull, &b.y);
            }
            put_sums(&sum, &mut out, here);
            v += 1;
        }
        out
    }
}
