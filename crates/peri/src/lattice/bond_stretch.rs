//! Stretches of a chunk's bonds, eight cells at a time: which bonds may break, and the least of each family.

use crate::families::lattice::Lead;
use crate::lattice::chunk::{CELLS, Constants, constant, place};
use perigrain_base::math::form::InLanes;
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::real::Real;

/// One bond of every cell of a chunk: to the partner ahead, or from the owner behind.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// How many cells further the other end is.
    pub to: i32,
    /// Place of the bond's constants.
    pub place: u32,
    /// The stencil vector.
    pub e: u16,
    /// The pair of local types.
    pub pair: u16,
    /// Which cells' bonds count.
    pub bits: u8,
    /// Whether the other end owns the bond.
    pub behind: bool,
}

/// A chunk as breaking sees it; pointers are at its first cell.
#[derive(Clone, Copy)]
pub struct Watched<'a> {
    /// Displacements of this step.
    pub now: [*const f64; 3],
    /// Those of the step before.
    pub before: [*const f64; 3],
    /// No less than the least stretch of each cell's family in the step before.
    pub least: *const f64,
    /// Where bonds lead.
    pub to: &'a [Lead],
    /// Alive bits by stencil vector.
    pub alive: &'a [u8],
    /// Constants.
    pub tables: &'a [f64],
    /// How many constants a pair of local types has.
    pub table: usize,
    /// Micromodulus, s00 and alpha of pairs.
    pub pairs: &'a [[f64; 3]],
    /// No bond breaks below this z.
    pub floor: f64,
}

/// Bonds of a chunk along one stencil vector that may break.
#[derive(Clone, Copy, Debug)]
pub struct Strained {
    /// Where they lead.
    pub lead: Lead,
    /// The pair of local types.
    pub pair: u16,
    /// Which cells'.
    pub bits: u8,
    /// Stretches of the bonds of all eight.
    pub stretch: [f64; CELLS],
}

/// The least of a chunk's families: z by cell, and by which side; the place in the list of sides as a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Least {
    /// z.
    pub z: [f64; CELLS],
    /// Which side.
    pub side: [f64; CELLS],
}

/// Appends the living bonds stretched by at least s00 − alpha m. m is no less than the smallest stretch in the families of
/// both ends in the step before, one of them being the bond's own: neither than its own (or 0), nor than what is known of both.
///
/// Where a byte of `alive` has bits, columns must be readable at the partners of all eight cells.
pub struct FindStrained<'a, 'b>(pub &'a Watched<'b>, pub &'a mut Vec<Strained>);

impl InLanes for FindStrained<'_, '_> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self(a, found) = self;
        // SAFETY: the caller's promise; places lie within the tables.
        unsafe {
            let zero = V::all(0.0);
            let (one, floor) = (zero.like(1.0), zero.like(a.floor));
            for lead in a.to {
                let alive = a.alive[lead.e as usize];
                if alive == 0 {
                    continue;
                }
                let c = &*a.tables.as_ptr().add(lead.table as usize).cast::<Constants>();
                let inverse = c[constant::INVERSE];
                let (mut z, mut over) = ([zero; 2], 0);
                let mut v = 0;
                while v < CELLS / N {
                    z[v] = between::<N, V, false>(&a.now, N * v, lead.to, c) * inverse;
                    over |= V::mask_bits(z[v].at_least(floor)) << (N * v);
                    v += 1;
                }
                if over & alive == 0 {
                    continue;
                }
                let pair = if a.pairs.len() > 1 { lead.table as usize / a.table } else { 0 };
                let [_, s00, alpha] = a.pairs[pair];
                let mut limit = [zero; 2];
                let (mut bits, mut v) = (0, 0);
                while v < CELLS / N {
                    let here = N * v;
                    let q = between::<N, V, false>(&a.before, here, lead.to, c);
                    let live = q.abs().at_least(zero.like(c[constant::DEAD]));
                    // s ≤ z/2: the limits that follow are no higher than the true ones, and rounding takes far less than 1e-12.
                    let own = (q * inverse * 0.5).keep(live).most(zero);
                    let far = V::read(a.least.offset(here as isize + lead.to as isize));
                    let known = V::read(a.least.add(here)).most(far);
                    let strict = zero.like(s00) - zero.like(alpha) * known.least(own);
                    limit[v] = strict - strict.abs() * 1e-12;
                    bits |= V::mask_bits((z[v] * 0.5).at_least(limit[v])) << here;
                    v += 1;
                }
                bits &= over & alive;
                if bits == 0 {
                    continue;
                }
                let (mut stretch, mut exact) = ([0.0; CELLS], 0);
                let mut v = 0;
                while v < CELLS / N {
                    let here = N * v;
                    let live = z[v].abs().at_least(zero.like(c[constant::DEAD]) * inverse);
                    let s = (z[v] / (one + (one + z[v]).sqrt())).keep(live);
                    stretch[here..here + N].copy_from_slice(&s.numbers());
                    exact |= V::mask_bits(s.at_least(limit[v])) << here;
                    v += 1;
                }
                if bits & exact != 0 {
                    found.push(Strained { lead: *lead, pair: pair as u16, bits: bits & exact, stretch });
                }
            }
        }
    }
}

/// Per cell the smallest z of its bonds of a pair of types, 0 for bonds inside the dead band, and whose that is; infinite
/// where there are none.
///
/// Where a side has bits, displacements `u` (at the chunk's first cell) must be readable at its eight other ends.
pub struct FindLeast<'a> {
    /// Displacements.
    pub u: [*const f64; 3],
    /// Where the bonds lead.
    pub sides: &'a [Side],
    /// The pair of types.
    pub pair: u16,
    /// Constants.
    pub tables: &'a [f64],
}

impl InLanes for FindLeast<'_> {
    type Out = Least;
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) -> Least {
        let Self { u, sides, pair, tables } = self;
        // SAFETY: the caller's promise; places lie within the tables.
        unsafe {
            let mut out = Least { z: [0.0; CELLS], side: [0.0; CELLS] };
            let zero = V::all(0.0);
            let infinite = zero.like(f64::INFINITY);
            let mut here = 0;
            while here < CELLS {
                let (mut least, mut whose) = (infinite, zero);
                for (k, side) in sides.iter().enumerate().filter(|(_, side)| side.pair == pair) {
                    let c = &*tables.as_ptr().add(side.place as usize).cast::<Constants>();
                    let q = match side.behind {
                        false => between::<N, V, false>(&u, here, side.to, c),
                        true => between::<N, V, true>(&u, here, side.to, c),
                    };
                    let live = q.abs().at_least(zero.like(c[constant::DEAD]));
                    let z = (q * c[constant::INVERSE]).keep(live);
                    let z = V::choose(zero.mask(side.bits >> here), z, infinite);
                    let others = whose.keep(z.at_least(least));
                    least = z.least(least);
                    // Whose it is: the last of those that are the least.
                    whose = others.most(zero.like(k as f64).keep(least.at_least(z)));
                }
                out.z[here..here + N].copy_from_slice(&least.numbers());
                out.side[here..here + N].copy_from_slice(&whose.numbers());
                here += N;
            }
            out
        }
    }
}

/// z |xi|² of bonds between displaced ends; `BEHIND`: of those that the far end owns.
#[inline(always)]
fn q<R: Real, const BEHIND: bool>(near: &[R; 3], far: &[R; 3], c: &Constants) -> R {
    let mut q = near[0].like(0.0);
    let mut k = 0;
    while k < 3 {
        let xi = c[constant::XI + k];
        let eta = if BEHIND { near[k] - far[k] } else { far[k] - near[k] };
        q = eta.fma(eta + xi + xi, q);
        k += 1;
    }
    q
}

/// [`q`] of the bonds between the cells from `here` on and those `to` cells further.
#[inline(always)]
unsafe fn between<const N: usize, V: Lanes<N>, const BEHIND: bool>(
    u: &[*const f64; 3],
    here: usize,
    to: i32,
    c: &Constants,
) -> V {
    // SAFETY: the caller's promise.
    unsafe { q::<V, BEHIND>(&place(u, here as isize), &place(u, here as isize + to as isize), c) }
}
