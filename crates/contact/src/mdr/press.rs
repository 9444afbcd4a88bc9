//! The loop over contacts among plastic grains, several at a time.

use super::deeds::{Deed, side};
use super::pairs::cut;
use super::side::{Side, WIDTH};
use super::state::Grain;
use super::{Manner, Material, PAIR, PRECOMPUTED};
use perigrain_base::math::form::InLanes;
use perigrain_base::math::lanes::{Lanes, load_rows, store_rows};
use perigrain_base::math::real::Real;
use perigrain_base::math::twice::Twice;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;

/// Geometry of a contact.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Contact {
    /// Indices of both grains.
    pub ends: [u32; 2],
    /// Unit vector from the second to the first.
    pub normal: Vec3,
    /// Overlap of the spheres [length].
    pub overlap: f64,
    /// Depth of the plane between them in each sphere [length].
    pub depths: [f64; 2],
    /// The fraction of the force that grains in between do not shield.
    pub open: f64,
}

/// Contacts with their inputs and outputs: one row per contact in each column.
pub(super) struct Press<'a> {
    pub m: &'a Material,
    pub manner: Manner,
    /// All grains.
    pub grains: &'a [Grain],
    pub seen: &'a [Contact],
    /// [`PAIR`] numbers of each contact.
    pub memory: &'a mut [f64],
    /// Results for the rest of the law: [`PRECOMPUTED`] numbers at the end of each row.
    pub precomputed: par::Rows<'a, f64>,
    pub deeds: &'a mut [[Deed; 2]],
}

/// Pointers to the data of the sides of some contacts.
struct Places<const N: usize> {
    grains: [[*mut f64; N]; 2],
    memory: [*mut f64; N],
    precomputed: [*mut f64; N],
    deeds: [*mut f64; N],
}

impl InLanes for Press<'_> {
    type Out = ();

    /// The columns must have one row per contact.
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self { m, manner, grains, seen, memory, precomputed, deeds } = self;
        let width = precomputed.width;
        assert!(memory.len() == seen.len() * PAIR && deeds.len() == seen.len());
        assert!(precomputed.data.len() == seen.len() * width && width >= PRECOMPUTED);
        let (memory, precomputed, deeds) =
            (memory.as_mut_ptr(), precomputed.data.as_mut_ptr(), deeds.as_mut_ptr());
        for first in (0..seen.len()).step_by(N) {
            let (null, mut at) = (std::ptr::null_mut(), [0; N]);
            let mut places = Places::<N> {
                grains: [[null; N]; 2],
                memory: [null; N],
                precomputed: [null; N],
                deeds: [null; N],
            };
            for lane in 0..N {
                // Lanes beyond the last contact repeat it and write identical values.
                let k = (first + lane).min(seen.len() - 1);
                at[lane] = k;
                for side in 0..2 {
                    // Grains are only read.
                    let grain = &raw const grains[seen[k].ends[side] as usize];
                    places.grains[side][lane] = grain.cast_mut().cast();
                }
                // SAFETY: these rows of column k exist, as checked above.
                unsafe {
                    places.memory[lane] = memory.add(k * PAIR);
                    places.precomputed[lane] = precomputed.add((k + 1) * width - PRECOMPUTED);
                    places.deeds[lane] = deeds.add(k).cast();
                }
            }
            let mut numbers = [[0.0; N]; 4];
            for lane in 0..N {
                let seen = &seen[at[lane]];
                let [a, b] = seen.depths;
                [numbers[0][lane], numbers[1][lane]] = [a, b];
                [numbers[2][lane], numbers[3][lane]] = [seen.overlap, seen.open];
            }
            // SAFETY: the caller's guarantee; the pointers are those of contacts and of their grains.
            unsafe {
                let [a, b, overlap, open] = numbers;
                press::<N, V>(m, manner, &places, [V::of(a), V::of(b)], V::of(overlap), V::of(open));
            }
        }
    }
}

/// Evaluates some contacts.
///
/// # Safety
/// The processor must support the lanes; the pointers must be those of grains and of rows of contacts, which
/// nothing else accesses.
#[inline(always)]
unsafe fn press<const N: usize, V: Lanes<N>>(
    m: &Material,
    manner: Manner,
    at: &Places<N>,
    depths: [V; 2],
    overlap: V,
    open: V,
) {
    // SAFETY: the caller's guarantee.
    unsafe {
        // Both sides interleaved: the operations of one side alone depend on each other and would stall.
        let grains = Grain::of(twice([&grain::<N, V>(&at.grains[0]), &grain::<N, V>(&at.grains[1])]));
        // The last number of the second side's rows is the largest overlap; the last number of the first
        // side's rows is the depth of the second, which is computed here.
        let rows = [numbers::<N, V>(&at.memory, 0), numbers::<N, V>(&at.memory, WIDTH)];
        let largest = rows[1][WIDTH].most(overlap);
        let mut sides = Side::of(twice([&rows[0], &rows[1]]));
        let (push, radius, deed) = side(m, &grains, Twice(depths), &mut sides, Twice([open; 2]), manner);
        let numbers = sides.numbers();
        for k in 0..2 {
            let [a, b, c, d, e, f, g, h, i, j, l] = of_side(&numbers, k);
            store_rows(&at.memory, k * WIDTH, [a, b, c, d]);
            store_rows(&at.memory, k * WIDTH + 4, [e, f, g, h]);
            store_rows(&at.memory, k * WIDTH + 8, [i, j, l, largest]);
            let [a, b, c, d, e, f, g, h] = of_side(&deed.numbers(), k);
            store_rows(&at.deeds, k * 8, [a, b, c, d]);
            store_rows(&at.deeds, k * 8 + 4, [e, f, g, h]);
        }
        let (force, contact) = (push.0[0] * 0.5 + push.0[1] * 0.5, radius.0[0] + radius.0[1]);
        let area = sides.area.0[0] * 0.5 + sides.area.0[1] * 0.5;
        let (plastic, energies) = (sides.plastic.0, deed.energy.0);
        let mut damped = contact * (2.0 * m.plane());
        if manner.takes_before() {
            damped = load_rows::<V, N>(&at.precomputed, 0)[1];
        }
        let mut energy = V::all(0.0);
        if manner.booked {
            energy = given_back(grains.radius.0, largest, plastic, energies);
        }
        store_rows(&at.precomputed, 0, [force, damped, area, energy]);
    }
}

/// The history of a side from `part` on, and the numbers behind it.
///
/// # Safety
/// These rows must exist.
#[inline(always)]
unsafe fn numbers<const N: usize, V: Lanes<N>>(rows: &[*mut f64; N], part: usize) -> [V; WIDTH + 1] {
    // SAFETY: the caller's guarantee.
    unsafe {
        let [a, b, c, d] = load_rows::<V, N>(rows, part);
        let [e, f, g, h] = load_rows::<V, N>(rows, part + 4);
        let [i, j, k, l] = load_rows::<V, N>(rows, part + 8);
        [a, b, c, d, e, f, g, h, i, j, k, l]
    }
}

/// The first numbers of both sides, interleaved.
#[inline(always)]
fn twice<V: Copy, const K: usize, const M: usize>(of: [&[V; K]; 2]) -> [Twice<V>; M] {
    let mut both = [Twice([of[0][0], of[1][0]]); M];
    for k in 1..M {
        both[k] = Twice([of[0][k], of[1][k]]);
    }
    both
}

/// The numbers of side `k`.
#[inline(always)]
fn of_side<V: Copy, const K: usize>(both: &[Twice<V>; K], k: usize) -> [V; K] {
    let mut own = [both[0].0[k]; K];
    for l in 1..K {
        own[l] = both[l].0[k];
    }
    own
}

/// The data of the grains at these pointers.
///
/// # Safety
/// They must point to grains.
#[inline(always)]
unsafe fn grain<const N: usize, V: Lanes<N>>(at: &[*mut f64; N]) -> [V; 6] {
    // SAFETY: the caller's guarantee; a grain is six numbers.
    let ([a, b, c, d], [_, _, e, f]) = unsafe { (load_rows::<V, N>(at, 0), load_rows::<V, N>(at, 2)) };
    [a, b, c, d, e, f]
}

/// The work of the mean force of both sides during unloading, where each side recedes by its part of the
/// overlap.
#[inline(always)]
fn given_back<R: Real>(radii: [R; 2], largest: R, plastic: [R; 2], energies: [R; 2]) -> R {
    let (most, way) = (cut(largest, radii), largest - plastic[0] - plastic[1]);
    let zero = largest.like(0.0);
    let mut sum = zero;
    for k in 0..2 {
        let own = most[k] - plastic[k];
        sum = sum + R::choose(own.above(zero), energies[k] * way / own, zero);
    }
    sum * 0.5
}
