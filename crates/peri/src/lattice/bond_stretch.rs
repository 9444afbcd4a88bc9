//! Stretches of a chunk's bonds, eight cells at a time: which bonds may break, and the least of each family.

use crate::families::lattice::Lead;
use crate::lanes::Lanes;
use crate::lanes::isa::{Isa, Kernel};
use crate::lattice::chunk::{CELLS, constant};

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

impl Kernel for FindStrained<'_, '_> {
    type Out = ();
    #[inline(always)]
    unsafe fn run<L: Isa>(self) {
        // SAFETY: the caller's promise.
        unsafe { strained::<L>(self.0, self.1) }
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

impl Kernel for FindLeast<'_> {
    type Out = Least;
    #[inline(always)]
    unsafe fn run<L: Isa>(self) -> Least {
        // SAFETY: the caller's promise.
        unsafe { least::<L>(self.u, self.sides, self.pair, self.tables) }
    }
}

/// z |xi|² of the bonds from the cells from `here` on to those `to` cells further; `BEHIND`: of the bonds that
/// those own.
#[inline(always)]
unsafe fn q<L: Lanes, const BEHIND: bool>(u: [*const f64; 3], here: usize, to: i32, c: *const f64) -> L {
    // SAFETY: the caller's promise.
    unsafe {
        let other = here as isize + to as isize;
        let mut q = L::splat(0.0);
        let mut k = 0;
        while k < 3 {
            let xi = L::splat(*c.add(constant::XI + k));
            let (near, far) = (L::load(u[k].add(here)), L::load(u[k].offset(other)));
            let eta = if BEHIND { near.sub(far) } else { far.sub(near) };
            q = eta.fma(eta.add(xi).add(xi), q);
            k += 1;
        }
        q
    }
}

#[inline(always)]
unsafe fn strained<L: Lanes>(a: &Watched, found: &mut Vec<Strained>) {
    // SAFETY: the caller's promise; places lie within the tables.
    unsafe {
        let (zero, one, half) = (L::splat(0.0), L::splat(1.0), L::splat(0.5));
        let floor = L::splat(a.floor);
        for lead in a.to {
            let alive = a.alive[lead.e as usize];
            if alive == 0 {
                continue;
            }
            let c = a.tables.as_ptr().add(lead.table as usize);
            let inverse = L::splat(*c.add(constant::INVERSE));
            let (mut z, mut over) = ([zero; 2], 0);
            let mut v = 0;
            while v < CELLS / L::WIDTH {
                z[v] = q::<L, false>(a.now, L::WIDTH * v, lead.to, c).mul(inverse);
                over |= z[v].ge(floor).bits() << (L::WIDTH * v);
                v += 1;
            }
            if over & alive == 0 {
                continue;
            }
            let pair = if a.pairs.len() > 1 { lead.table as usize / a.table } else { 0 };
            let [_, s00, alpha] = a.pairs[pair];
            let mut limit = [zero; 2];
            let (mut bits, mut v) = (0, 0);
            while v < CELLS / L::WIDTH {
                let here = L::WIDTH * v;
                let q = q::<L, false>(a.before, here, lead.to, c);
                let live = q.abs().ge(L::splat(*c.add(constant::DEAD)));
                // s ≤ z/2: the limits that follow are no higher than the true ones, and rounding takes far less than 1e-12.
                let own = q.mul(inverse).mul(half).keep(live).max(zero);
                let far = L::load(a.least.offset(here as isize + lead.to as isize));
                let known = L::load(a.least.add(here)).max(far);
                let strict = L::splat(s00).sub(L::splat(alpha).mul(known.min(own)));
                limit[v] = strict.sub(strict.abs().mul(L::splat(1e-12)));
                bits |= z[v].mul(half).ge(limit[v]).bits() << here;
                v += 1;
            }
            bits &= over & alive;
            if bits == 0 {
                continue;
            }
            let (mut stretch, mut exact) = ([0.0; CELLS], 0);
            let mut v = 0;
            while v < CELLS / L::WIDTH {
                let here = L::WIDTH * v;
                let live = z[v].abs().ge(L::splat(*c.add(constant::DEAD)).mul(inverse));
                let s = z[v].div(one.add(one.add(z[v]).sqrt())).keep(live);
                s.store(stretch.as_mut_ptr().add(here));
                exact |= s.ge(limit[v]).bits() << here;
                v += 1;
            }
            if bits & exact != 0 {
                found.push(Strained { lead: *lead, pair: pair as u16, bits: bits & exact, stretch });
            }
        }
    }
}

#[inline(always)]
unsafe fn least<L: Lanes>(u: [*const f64; 3], sides: &[Side], pair: u16, tables: &[f64]) -> Least {
    // SAFETY: the caller's promise; places lie within the tables.
    unsafe {
        let mut out = Least { z: [0.0; CELLS], side: [0.0; CELLS] };
        let infinite = L::splat(f64::INFINITY);
        let mut here = 0;
        while here < CELLS {
            let (mut least, mut whose) = (infinite, L::splat(0.0));
            for (k, side) in sides.iter().enumerate().filter(|(_, side)| side.pair == pair) {
                let c = tables.as_ptr().add(side.place as usize);
                let q = match side.behind {
                    false => q::<L, false>(u, here, side.to, c),
                    true => q::<L, true>(u, here, side.to, c),
                };
                let live = q.abs().ge(L::splat(*c.add(constant::DEAD)));
                let z = q.mul(L::splat(*c.add(constant::INVERSE))).keep(live);
                let none = infinite.keep(L::mask(!side.bits >> here));
                let z = z.keep(L::mask(side.bits >> here)).add(none);
                let others = whose.keep(z.ge(least));
                least = z.min(least);
                // Whose it is: the last of those that are the least.
                whose = others.max(L::splat(k as f64).keep(least.ge(z)));
            }
            least.store(out.z.as_mut_ptr().add(here));
            whose.store(out.side.as_mut_ptr().add(here));
            here += L::WIDTH;
        }
        out
    }
}
