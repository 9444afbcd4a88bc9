//! Bonds of a record in lanes, whatever their law: gathered, stretched, and what they give handed to the other ends.
//!
//! A record's bonds are taken [`MOST`] at a time, in steps that leave their results in a [`Block`]: the processor then has
//! many independent bonds to work on, polynomials are chosen once for all of them, and a law is a short loop of its own.

use std::ptr::null_mut;

use crate::families::list::{GROUP, ListBody};
use crate::families::{BoxStrain, Cell, FamilyOptions, Influence};
use crate::law::polynomials::{self, FAR, FARTHEST, UP_TO_FAR, UP_TO_FARTHEST};
use crate::law::series::{SERIES, STRETCH, UP_TO_3, UP_TO_5, UP_TO_7};
use crate::law::stretch::closed;
use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::four::Four;
use perigrain_base::math::lanes::{Lanes, load_rows};
use perigrain_base::math::real::Real;

/// An expression for the partner of each lane; see `chunk::xyz` for why this is no closure.
macro_rules! partners {
    ($lanes:ident, $none:expr, |$k:ident| $e:expr) => {{
        let mut all = [$none; $lanes];
        for $k in 0..$lanes {
            all[$k] = $e;
        }
        all
    }};
}
pub(crate) use partners;

/// What [`Row::shape`] finds: z at the last step that advanced, and measures.
pub const LAST: u8 = 0;
/// What it takes to pull microelastic bonds.
pub const PLAIN: u8 = 1;
/// Everything.
pub const FULL: u8 = 2;
/// What it takes to pull microelastic bonds, and displacements apart from reference bonds.
pub const APART: u8 = 3;

/// So many bonds are in hand at once.
pub const MOST: usize = 64;

/// Bonds in hand: columns of which the first `count` numbers are in use; each begins a cache line.
#[repr(C, align(64))]
pub struct Block {
    /// z = |y|²/|xi|² − 1; 0 inside the dead band, and where no bond lives.
    pub z: [f64; MOST],
    /// The same at the last step that advanced.
    pub before: [f64; MOST],
    /// What the least of a family is kept of: z of living bonds, infinite where none lives.
    pub measure: [f64; MOST],
    /// s.
    pub s: [f64; MOST],
    /// s/(1 + s).
    pub share: [f64; MOST],
    /// y = xi + eta.
    pub y: [[f64; MOST]; 3],
    /// |xi|².
    pub square: [f64; MOST],
    /// ω, or the stretch at which bonds flow.
    pub omega: [f64; MOST],
    /// The critical stretch, of softening bonds; 0 where none lives.
    pub limit: [f64; MOST],
    /// ω w, of microelastic bonds c w/|xi|; 0 where no bond lives.
    pub weight: [f64; MOST],
    /// The partner's volume.
    pub volume: [f64; MOST],
    /// What comes out.
    pub out: [[f64; MOST]; 4],
    /// Places of partners in the window.
    pub target: [u32; MOST],
    /// Places of the first bonds of groups, among all bonds.
    pub place: [u32; MOST / GROUP],
    /// Places in use, with those where no bond lives.
    pub count: usize,
    /// The largest z, or 0.
    pub high: f64,
    /// The smallest z, or 0.
    pub low: f64,
    /// eta, the difference of displacements.
    pub eta: [[f64; MOST]; 3],
}

impl Block {
    /// Nothing in hand.
    pub fn new() -> Self {
        let none = [0.0; MOST];
        Self {
            z: none,
            before: none,
            measure: none,
            s: none,
            share: none,
            y: [none; 3],
            square: none,
            omega: none,
            limit: none,
            weight: none,
            volume: none,
            out: [none; 4],
            target: [0; MOST],
            place: [0; MOST / GROUP],
            count: 0,
            high: 0.0,
            low: 0.0,
            eta: [none; 3],
        }
    }
}

/// How images are sought: not at all, along the axes, along edges that lean.
const NONE: u8 = 0;
const UPRIGHT: u8 = 1;
const LEANING: u8 = 2;

/// How bonds count under a law.
#[derive(Clone, Copy)]
pub struct Counting {
    /// For their length.
    pub influence: Influence,
    /// They are microelastic and count c times their shape over |xi|.
    pub microelastic: bool,
    /// The law needs critical stretches.
    pub limited: bool,
}

/// What is the same for all bonds.
#[derive(Clone, Copy)]
pub struct Rules {
    /// Lengths of the box; infinite where it is open.
    length: [f64; 3],
    /// Edges that lean, from that of z on, and whether some do.
    edges: [[f64; 3]; 3],
    images: u8,
    /// Whether the box is no longer as it was when bonds were found, and how it is strained now and was in the last step.
    strained: bool,
    strain: [BoxStrain; 2],
    /// |z| below which there is no force: the first number plus the second over |xi|.
    dead: [f64; 2],
    counting: Counting,
    /// Measures are wanted beside forces.
    pub measures: bool,
}

impl Rules {
    /// Those of a scene.
    pub fn new(cell: &Cell, options: &FamilyOptions, counting: Counting) -> Self {
        let period = cell.birth;
        let band = options.dead_band(1.0);
        let length = period.length.map(|l| if l > 0.0 { l } else { f64::INFINITY });
        let images = match period.length {
            [0.0, 0.0, 0.0] => NONE,
            _ if period.tilted() => LEANING,
            _ => UPRIGHT,
        };
        let dead = if options.compat_lammps { [0.0, band] } else { [band, 0.0] };
        Self {
            length,
            edges: period.vectors(),
            strained: cell.strained(),
            strain: cell.strain,
            images,
            dead,
            counting,
            measures: false,
        }
    }
}

/// A record's own bonds, as kernels see them.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    /// The bonds.
    pub body: &'a ListBody,
    /// The record.
    pub i: usize,
    /// Records before this one come after all others: they close a ring.
    pub first: usize,
    /// See [`Rules`].
    pub rules: &'a Rules,
}

impl Row<'_> {
    /// The record's first group.
    pub fn start(&self) -> usize {
        self.body.start[self.i] as usize
    }

    /// Takes the next groups in which bonds live in hand, from group `next` on; false if there are none.
    #[inline]
    pub fn fill(&self, next: &mut usize, b: &mut Block) -> bool {
        let end = self.body.start[self.i + 1] as usize;
        b.count = 0;
        while *next < end && b.count < MOST {
            if self.body.alive[*next] != 0 {
                b.place[b.count / GROUP] = (GROUP * *next) as u32;
                b.count += GROUP;
            }
            *next += 1;
        }
        b.count > 0
    }

    /// Finds lengths, stretches and weights of the bonds in hand; as much as `WHAT` says.
    #[inline]
    pub fn shape<const WHAT: u8>(&self, form: Form, b: &mut Block) {
        // SAFETY: records, groups and partners are those of the body, in blocks of no more than `MOST` bonds.
        unsafe {
            match self.rules.images {
                NONE => form.run(Shapes::<NONE, WHAT>(self, b)),
                UPRIGHT => form.run(Shapes::<UPRIGHT, WHAT>(self, b)),
                _ => form.run(Shapes::<LEANING, WHAT>(self, b)),
            }
        }
    }
}

impl Block {
    /// The place of a bond in hand among all bonds.
    #[inline(always)]
    pub fn place(&self, at: usize) -> usize {
        self.place[at / GROUP] as usize + at % GROUP
    }
}

/// The most of eight numbers, those of lanes and this one where there are fewer lanes, in three steps.
#[inline(always)]
fn most<const N: usize, V: Lanes<N>>(lanes: V, other: f64, of: impl Fn(f64, f64) -> f64) -> f64 {
    let mut l = [other; GROUP];
    lanes.to_column(&mut l, 0);
    let four = [of(l[0], l[4]), of(l[1], l[5]), of(l[2], l[6]), of(l[3], l[7])];
    of(of(four[0], four[2]), of(four[1], four[3]))
}

/// The shortest image of a difference.
#[inline(always)]
pub(crate) fn nearest<R: Real>(d: R, period: f64) -> R {
    let (half, full) = (d.like(0.5 * period), d.like(period));
    let d = d - full.keep(d.at_least(half));
    d + full.keep((d.like(0.0) - half).at_least(d))
}

/// The same where edges lean: along z, then y, then x.
#[inline(always)]
fn nearest_leaning<R: Real>(mut d: [R; 3], rules: &Rules) -> [R; 3] {
    let zero = d[0].like(0.0);
    for k in [2, 1, 0] {
        let half = zero.like(0.5 * rules.length[k]);
        let (over, under) = (d[k].at_least(half), (zero - half).at_least(d[k]));
        for j in 0..=k {
            let edge = zero.like(rules.edges[k][j]);
            d[j] = d[j] - edge.keep(over) + edge.keep(under);
        }
    }
    d
}

/// Places of bonds in hand, as many at a time as there are lanes; all of them within the columns of a [`Block`].
#[inline(always)]
pub fn steps<const N: usize>(count: usize) -> impl Iterator<Item = usize> {
    (0..count).step_by(N).map(|at| at & (MOST - N))
}

/// Fills in s/(1 + s), or s with `S`, by the cheapest way that is exact for all bonds in hand.
#[inline(always)]
pub fn stretch<const N: usize, V: Lanes<N>, const S: bool>(zero: V, b: &mut Block) {
    let (z, count) = (&b.z, b.count);
    let out = if S { &mut b.s } else { &mut b.share };
    macro_rules! fill {
        (|$z:ident| $e:expr) => {{
            for at in steps::<N>(count) {
                let $z = zero.like_column(z, at);
                $e.to_column(out, at);
            }
        }};
    }
    macro_rules! series {
        ($terms:literal) => {{
            const TERMS: [[f64; $terms]; 2] = [first(&SERIES), first(&STRETCH)];
            fill!(|z| z * polynomials::polynomial::<V, $terms>(z, &TERMS[S as usize]))
        }};
    }
    macro_rules! far {
        ($degree:expr) => {
            fill!(|z| z * if S {
                polynomials::stretch::<V, $degree>(z)
            } else {
                polynomials::share::<V, $degree>(z)
            })
        };
    }
    match b.high.max(-b.low) {
        size if size < UP_TO_3 => series!(4),
        size if size < UP_TO_5 => series!(6),
        size if size < UP_TO_7 => series!(8),
        size if size < UP_TO_FAR => far!(FAR),
        size if size < UP_TO_FARTHEST => far!(FARTHEST),
        _ if S => fill!(|z| closed(z).s),
        _ => fill!(|z| closed(z).share),
    }
}

/// The first terms of a series.
const fn first<const N: usize>(terms: &[f64; 8]) -> [f64; N] {
    let mut some = [0.0; N];
    let mut k = 0;
    while k < N {
        some[k] = terms[k];
        k += 1;
    }
    some
}

/// Subtracts what comes out from the window's rows of four, which begin at `force`; with `LEAST` their fourth numbers are the
/// least measures. The least measure in hand.
///
/// # Safety
/// Partners must lie in the window; the processor must have what `V` needs.
#[inline(always)]
pub unsafe fn scatter<const N: usize, V: Lanes<N>, const LEAST: bool>(b: &Block, force: *mut f64) -> f64 {
    // SAFETY: the caller's promise; partners of living bonds differ, and others change nothing.
    unsafe {
        let zero = V::all(0.0);
        let fourth = V::Row::splat(0.0).with_bits(0b1000);
        let mut least = zero.like(f64::INFINITY);
        for at in steps::<N>(b.count) {
            let out = [
                zero.like_column(&b.out[0], at),
                zero.like_column(&b.out[1], at),
                zero.like_column(&b.out[2], at),
                if LEAST { zero.like_column(&b.measure, at) } else { zero },
            ];
            let rows = V::to_rows(out);
            for lane in 0..N {
                let row = force.wrapping_add(4 * *b.target.get_unchecked(at + lane) as usize);
                let there = V::Row::load(row);
                let mut new = there - rows[lane];
                if LEAST {
                    new = V::Row::choose(fourth, there.least(rows[lane]), new);
                }
                new.store(row);
            }
            if LEAST {
                least = out[3].least(least);
            }
        }
        most(least, f64::INFINITY, |a, b| if b < a { b } else { a })
    }
}

/// See [`Row::shape`].
struct Shapes<'a, 'b, const IMAGES: u8, const WHAT: u8>(&'a Row<'b>, &'a mut Block);

impl<const IMAGES: u8, const WHAT: u8> InLanes for Shapes<'_, '_, IMAGES, WHAT> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self(row, b) = self;
        // SAFETY: groups, records and pairs are those of the body, blocks of no more than `MOST` bonds.
        unsafe {
            let (body, rules) = (row.body, row.rules);
            let (record, last) = (body.record.as_ptr(), body.last.as_ptr());
            let own = &*record.add(row.i);
            let zero = V::all(0.0);
            let [x, u] = [own.reference, if WHAT == LAST { *last.add(row.i) } else { own.u }];
            let pairs =
                body.pairs.as_ptr().add(usize::from(*body.kind.get_unchecked(row.i)) * body.kinds.len());
            let one = zero.like(1.0);
            let owned = !body.own_weight.is_empty();
            let dead = [zero.like(rules.dead[0]), zero.like(rules.dead[1])];
            let (mut high, mut low) = (zero, zero);
            let mut first = 0;
            while first < b.count {
                let group = *b.place.get_unchecked(first / GROUP) as usize / GROUP;
                let pair = &*pairs.add(usize::from(*body.group_kind.get_unchecked(group)));
                let bits = *body.alive.get_unchecked(group);
                let mut v = 0;
                while v < GROUP {
                    let at = first + v;
                    let place = GROUP * group + v;
                    let partner = body.partner.as_ptr().add(place);
                    let rows = partners!(N, null_mut(), |k| record
                        .add(*partner.add(k) as usize)
                        .cast::<f64>()
                        .cast_mut());
                    let [xj, yj, zj, volume]: [V; 4] = load_rows(&rows, 0);
                    let to = if WHAT == LAST {
                        let mut u = [[0.0; N]; 3];
                        for k in 0..N {
                            let far = &*last.add(*partner.add(k) as usize);
                            (u[0][k], u[1][k], u[2][k]) = (far[0], far[1], far[2]);
                        }
                        [V::of(u[0]), V::of(u[1]), V::of(u[2])]
                    } else {
                        let [u, v, w, _] = load_rows(&rows, 4);
                        [u, v, w]
                    };
                    let apart = [xj - x[0], yj - x[1], zj - x[2]];
                    let mut xi = apart;
                    if IMAGES == UPRIGHT {
                        xi[0] = nearest(xi[0], rules.length[0]);
                        xi[1] = nearest(xi[1], rules.length[1]);
                        xi[2] = nearest(xi[2], rules.length[2]);
                    }
                    if IMAGES == LEANING {
                        xi = nearest_leaning(xi, rules);
                    }
                    let mut eta = [to[0] - u[0], to[1] - u[1], to[2] - u[2]];
                    if IMAGES != NONE && rules.strained {
                        let away = [apart[0] - xi[0], apart[1] - xi[1], apart[2] - xi[2]];
                        let strain = &rules.strain[(WHAT == LAST) as usize];
                        let mut d = 0;
                        while d < 3 {
                            let mut k = d;
                            while k < 3 {
                                eta[d] = away[k].fnma(zero.like(strain[d][k]), eta[d]);
                                k += 1;
                            }
                            d += 1;
                        }
                    }
                    let y = [xi[0] + eta[0], xi[1] + eta[1], xi[2] + eta[2]];
                    let square = xi[0].fma(xi[0], xi[1].fma(xi[1], xi[2] * xi[2]));
                    let q = eta[1].fma(y[1] + xi[1], eta[2] * (y[2] + xi[2]));
                    let q = eta[0].fma(y[0] + xi[0], q);
                    let inverse = V::read(body.inverse.as_ptr().add(place));
                    let length = square * inverse;
                    let alive = zero.mask(bits >> v);
                    let z = q * (inverse * inverse);
                    let z = z.keep(z.abs().at_least(inverse.fma(dead[1], dead[0]))).keep(alive);
                    if rules.measures || WHAT == LAST {
                        let measure = V::choose(alive, z, zero.like(f64::INFINITY));
                        measure.write(b.measure.as_mut_ptr().add(at));
                    }
                    v += N;
                    if WHAT == LAST {
                        z.write(b.before.as_mut_ptr().add(at));
                        continue;
                    }
                    (high, low) = (z.most(high), z.least(low));
                    let weight = match owned {
                        true => V::read(body.own_weight.as_ptr().add(place)),
                        false => zero.like(pair.weight[1]).fnma(length, zero.like(pair.weight[0])).least(one),
                    };
                    let shape = match rules.counting.influence {
                        Influence::Inverse => inverse,
                        Influence::One => one,
                        Influence::Gaussian => V::read(body.influence.as_ptr().add(place)),
                    };
                    let (omega, weight) = if rules.counting.microelastic {
                        (zero.like(pair.yields), zero.like(pair.shape) * shape * weight * inverse)
                    } else {
                        (shape, shape * weight)
                    };
                    z.write(b.z.as_mut_ptr().add(at));
                    y[0].write(b.y[0].as_mut_ptr().add(at));
                    y[1].write(b.y[1].as_mut_ptr().add(at));
                    y[2].write(b.y[2].as_mut_ptr().add(at));
                    weight.keep(alive).write(b.weight.as_mut_ptr().add(at));
                    volume.write(b.volume.as_mut_ptr().add(at));
                    if WHAT == APART {
                        let mut d = 0;
                        while d < 3 {
                            eta[d].write(b.eta[d].as_mut_ptr().add(at));
                            d += 1;
                        }
                    }
                    if WHAT == FULL {
                        square.write(b.square.as_mut_ptr().add(at));
                        omega.keep(alive).write(b.omega.as_mut_ptr().add(at));
                        if rules.counting.limited {
                            let mut limit = zero.like(pair.s00);
                            if body.scatter.uneven() {
                                let ends = |k: usize| [row.i, *partner.add(k) as usize];
                                limit = limit * V::of(partners!(N, 1.0, |k| body.scatter.strength(ends(k))));
                            }
                            limit.keep(alive).write(b.limit.as_mut_ptr().add(at));
                        }
                    }
                }
                let target = b.target.as_mut_ptr().add(first);
                body.partner.as_ptr().add(GROUP * group).copy_to_nonoverlapping(target, GROUP);
                first += GROUP;
            }
            (b.high, b.low) = (
                most(high, 0.0, |a, b| if b > a { b } else { a }),
                most(low, 0.0, |a, b| if b < a { b } else { a }),
            );
            if row.first > 0 {
                for target in &mut b.target[..b.count] {
                    if (*target as usize) < row.first {
                        *target += body.record.len() as u32;
                    }
                }
            }
        }
    }
}
