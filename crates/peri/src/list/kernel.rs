//! Bonds of a record in lanes, whatever their law: gathered, stretched, and what they give handed to the other ends.
//!
//! A record's bonds are taken [`MOST`] at a time, in steps that leave their results in a [`Block`]: the processor then has
//! many independent bonds to work on, polynomials are chosen once for all of them, and a law is a short loop of its own.

use std::ptr::{null, null_mut};

use crate::families::list::{GROUP, ListBody};
use crate::families::{BoxStrain, Cell, FamilyOptions, Influence, Law};
use crate::lanes::Lanes;
use crate::lanes::isa::{Isa, Kernel};
use crate::lanes::rows::{self, Rows};
use crate::lattice::constants::STRETCH;
use crate::law::closed;
use crate::law::polynomials::{self, FAR, FARTHEST, UP_TO_FAR, UP_TO_FARTHEST};
use crate::law::series::{SERIES, UP_TO_3, UP_TO_5, UP_TO_7};

/// An expression for each partner that there is a lane for, else `$none`; see `chunk::xyz` for why this is no
/// closure.
macro_rules! partners {
    ($lanes:ty, $none:expr, |$k:ident| $e:expr) => {
        [
            partners!(@ $lanes, $none, 0, $k, $e),
            partners!(@ $lanes, $none, 1, $k, $e),
            partners!(@ $lanes, $none, 2, $k, $e),
            partners!(@ $lanes, $none, 3, $k, $e),
            partners!(@ $lanes, $none, 4, $k, $e),
            partners!(@ $lanes, $none, 5, $k, $e),
            partners!(@ $lanes, $none, 6, $k, $e),
            partners!(@ $lanes, $none, 7, $k, $e),
        ]
    };
    (@ $lanes:ty, $none:expr, $n:literal, $k:ident, $e:expr) => {
        if $n < <$lanes>::WIDTH {
            let $k = $n as usize;
            $e
        } else {
            $none
        }
    };
}
pub(crate) use partners;

/// What [`Row::shape`] finds: z at the last step that advanced, and measures.
pub const LAST: u8 = 0;
/// What it takes to pull microelastic bonds.
pub const PLAIN: u8 = 1;
/// Everything.
pub const FULL: u8 = 2;

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
        }
    }
}

/// How images are sought: not at all, along the axes, along edges that lean.
const NONE: u8 = 0;
const UPRIGHT: u8 = 1;
const LEANING: u8 = 2;

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
    influence: Influence,
    /// Bonds are microelastic and count c times their shape over |xi|.
    microelastic: bool,
    /// Laws ask for critical stretches.
    limited: bool,
    /// Measures are wanted beside forces.
    pub measures: bool,
}

impl Rules {
    /// Those of a scene.
    pub fn new(cell: &Cell, options: &FamilyOptions, law: &Law) -> Self {
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
            influence: law.shape(),
            microelastic: law.kind.bond_based(),
            limited: law.kind.softens(),
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

    /// Finds what is to know of the bonds in hand; as much as `WHAT` says.
    ///
    /// # Safety
    /// The processor must have what `K` needs.
    #[inline]
    pub unsafe fn shape<K: Isa, const WHAT: u8>(&self, b: &mut Block) {
        // SAFETY: passed on to the caller.
        unsafe {
            match self.rules.images {
                NONE => K::call(Shapes::<NONE, WHAT>(self, b)),
                UPRIGHT => K::call(Shapes::<UPRIGHT, WHAT>(self, b)),
                _ => K::call(Shapes::<LEANING, WHAT>(self, b)),
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

#[inline(always)]
unsafe fn shapes<L: Rows, const IMAGES: u8, const WHAT: u8>(row: &Row, b: &mut Block) {
    // SAFETY: groups, records and pairs are those of the body, blocks of no more than `MOST` bonds.
    unsafe {
        let (body, rules) = (row.body, row.rules);
        let (record, last) = (body.record.as_ptr(), body.last.as_ptr());
        let own = &*record.add(row.i);
        let [x, u] = [own.reference, if WHAT == LAST { *last.add(row.i) } else { own.u }];
        let [x, u] = [x, u].map(|a| [L::splat(a[0]), L::splat(a[1]), L::splat(a[2])]);
        let pairs = body.pairs.as_ptr().add(usize::from(*body.kind.get_unchecked(row.i)) * body.kinds.len());
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        let owned = !body.own_weight.is_empty();
        let dead = rules.dead.map(|a| L::splat(a));
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
                let rows = partners!(L, null(), |k| record.add(*partner.add(k) as usize).cast::<f64>());
                let [xj, yj, zj, volume] = L::quads(&rows);
                let to = if WHAT == LAST {
                    let u = |d: usize| partners!(L, 0.0, |k| (*last.add(*partner.add(k) as usize))[d]);
                    let [x, y, z] = [u(0), u(1), u(2)];
                    [L::load(x.as_ptr()), L::load(y.as_ptr()), L::load(z.as_ptr())]
                } else {
                    let rows = partners!(L, null(), |k| rows[k].add(4));
                    let [u, v, w, _] = L::quads(&rows);
                    [u, v, w]
                };
                let apart = [xj.sub(x[0]), yj.sub(x[1]), zj.sub(x[2])];
                let mut xi = apart;
                if IMAGES == UPRIGHT {
                    xi[0] = nearest(xi[0], rules.length[0]);
                    xi[1] = nearest(xi[1], rules.length[1]);
                    xi[2] = nearest(xi[2], rules.length[2]);
                }
                if IMAGES == LEANING {
                    xi = nearest_leaning(xi, rules);
                }
                let mut eta = [to[0].sub(u[0]), to[1].sub(u[1]), to[2].sub(u[2])];
                if IMAGES != NONE && rules.strained {
                    let away = [apart[0].sub(xi[0]), apart[1].sub(xi[1]), apart[2].sub(xi[2])];
                    let strain = &rules.strain[(WHAT == LAST) as usize];
                    let mut d = 0;
                    while d < 3 {
                        let mut k = d;
                        while k < 3 {
                            eta[d] = away[k].fnma(L::splat(strain[d][k]), eta[d]);
                            k += 1;
                        }
                        d += 1;
                    }
                }
                let y = [xi[0].add(eta[0]), xi[1].add(eta[1]), xi[2].add(eta[2])];
                let square = xi[0].fma(xi[0], xi[1].fma(xi[1], xi[2].mul(xi[2])));
                let q = eta[1].fma(y[1].add(xi[1]), eta[2].mul(y[2].add(xi[2])));
                let q = eta[0].fma(y[0].add(xi[0]), q);
                let inverse = L::load(body.inverse.as_ptr().add(place));
                let length = square.mul(inverse);
                let alive = L::mask(bits >> v);
                let z = q.mul(inverse.mul(inverse));
                let z = z.keep(z.abs().ge(inverse.fma(dead[1], dead[0]))).keep(alive);
                if rules.measures || WHAT == LAST {
                    let none = L::splat(f64::INFINITY).keep(L::mask(!bits >> v));
                    z.add(none).store(b.measure.as_mut_ptr().add(at));
                }
                v += L::WIDTH;
                if WHAT == LAST {
                    z.store(b.before.as_mut_ptr().add(at));
                    continue;
                }
                (high, low) = (z.max(high), z.min(low));
                let weight = match owned {
                    true => L::load(body.own_weight.as_ptr().add(place)),
                    false => L::splat(pair.weight[1]).fnma(length, L::splat(pair.weight[0])).min(one),
                };
                let shape = match rules.influence {
                    Influence::Inverse => inverse,
                    Influence::One => one,
                    Influence::Gaussian => L::load(body.influence.as_ptr().add(place)),
                };
                let (omega, weight) = if rules.microelastic {
                    (L::splat(pair.yields), L::splat(pair.shape).mul(shape).mul(weight).mul(inverse))
                } else {
                    (shape, shape.mul(weight))
                };
                z.store(b.z.as_mut_ptr().add(at));
                y[0].store(b.y[0].as_mut_ptr().add(at));
                y[1].store(b.y[1].as_mut_ptr().add(at));
                y[2].store(b.y[2].as_mut_ptr().add(at));
                weight.keep(alive).store(b.weight.as_mut_ptr().add(at));
                volume.store(b.volume.as_mut_ptr().add(at));
                if WHAT == FULL {
                    square.store(b.square.as_mut_ptr().add(at));
                    omega.keep(alive).store(b.omega.as_mut_ptr().add(at));
                    if rules.limited {
                        let limit = if body.scatter.uneven() {
                            let strengths = partners!(L, 1.0, |k| body
                                .scatter
                                .strength([row.i, *partner.add(k) as usize]));
                            L::splat(pair.s00).mul(L::load(strengths.as_ptr()))
                        } else {
                            L::splat(pair.s00)
                        };
                        limit.keep(alive).store(b.limit.as_mut_ptr().add(at));
                    }
                }
            }
            let target = b.target.as_mut_ptr().add(first);
            body.partner.as_ptr().add(GROUP * group).copy_to_nonoverlapping(target, GROUP);
            first += GROUP;
        }
        let mut ends = [[0.0f64; rows::MOST]; 2];
        high.store(ends[0].as_mut_ptr());
        low.store(ends[1].as_mut_ptr());
        (b.high, b.low) = (
            most(&ends[0], |a, b| if b > a { b } else { a }),
            most(&ends[1], |a, b| if b < a { b } else { a }),
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

/// The most of eight numbers, in three steps.
#[inline(always)]
fn most(l: &[f64; rows::MOST], of: impl Fn(f64, f64) -> f64) -> f64 {
    let four = [of(l[0], l[4]), of(l[1], l[5]), of(l[2], l[6]), of(l[3], l[7])];
    of(of(four[0], four[2]), of(four[1], four[3]))
}

/// The shortest image of a difference.
#[inline(always)]
pub(crate) unsafe fn nearest<L: Lanes>(d: L, period: f64) -> L {
    // SAFETY: passed on to the caller.
    unsafe {
        let half = L::splat(0.5 * period);
        let full = L::splat(period);
        let d = d.sub(full.keep(d.ge(half)));
        d.add(full.keep(L::splat(0.0).sub(half).ge(d)))
    }
}

/// The same where edges lean: along z, then y, then x.
#[inline(always)]
unsafe fn nearest_leaning<L: Lanes>(mut d: [L; 3], rules: &Rules) -> [L; 3] {
    // SAFETY: passed on to the caller.
    unsafe {
        let zero = L::splat(0.0);
        for k in [2, 1, 0] {
            let half = L::splat(0.5 * rules.length[k]);
            let (over, under) = (d[k].ge(half), zero.sub(half).ge(d[k]));
            for j in 0..=k {
                let edge = L::splat(rules.edges[k][j]);
                d[j] = d[j].sub(edge.keep(over)).add(edge.keep(under));
            }
        }
        d
    }
}

/// Fills in s/(1 + s), or s with `S`, by the cheapest way that is exact for all bonds in hand.
#[inline(always)]
pub unsafe fn stretch<L: Lanes, const S: bool>(b: &mut Block) {
    // SAFETY: columns hold `count` numbers, a multiple of the lanes.
    unsafe {
        let (z, count) = (b.z.as_ptr(), b.count);
        let out = if S { b.s.as_mut_ptr() } else { b.share.as_mut_ptr() };
        macro_rules! fill {
            (|$z:ident| $e:expr) => {{
                let mut at = 0;
                while at < count {
                    let $z = L::load(z.add(at));
                    $e.store(out.add(at));
                    at += L::WIDTH;
                }
            }};
        }
        macro_rules! series {
            ($terms:literal) => {{
                let terms = if S { &STRETCH } else { &SERIES };
                fill!(|z| z
                    .mul(polynomials::polynomial::<L, $terms>(z, terms.first_chunk().unwrap_unchecked())))
            }};
        }
        macro_rules! far {
            ($degree:expr) => {
                fill!(|z| z.mul(if S {
                    polynomials::stretch::<L, $degree>(z)
                } else {
                    polynomials::share::<L, $degree>(z)
                }))
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
}

/// Subtracts what comes out from the window's rows of four, which begin at `force`; with `LEAST` their fourth numbers are the
/// least measures. The least measure in hand.
#[inline(always)]
pub unsafe fn scatter<L: Rows, const LEAST: bool>(b: &Block, force: *mut f64) -> f64 {
    // SAFETY: partners lie in the window by the caller's promise.
    unsafe {
        let mut least = L::splat(f64::INFINITY);
        let mut at = 0;
        while at < b.count {
            let target = b.target.as_ptr().add(at);
            let rows = partners!(L, null_mut(), |k| force.wrapping_add(4 * *target.add(k) as usize));
            let out = [
                L::load(b.out[0].as_ptr().add(at)),
                L::load(b.out[1].as_ptr().add(at)),
                L::load(b.out[2].as_ptr().add(at)),
                if LEAST { L::load(b.measure.as_ptr().add(at)) } else { L::splat(0.0) },
            ];
            L::hand_over::<LEAST>(out, &rows);
            if LEAST {
                least = out[3].min(least);
            }
            at += L::WIDTH;
        }
        let mut lanes = [f64::INFINITY; rows::MOST];
        if LEAST {
            least.store(lanes.as_mut_ptr());
        }
        most(&lanes, |a, b| if b < a { b } else { a })
    }
}

/// See [`Row::shape`].
struct Shapes<'a, 'b, const IMAGES: u8, const WHAT: u8>(&'a Row<'b>, &'a mut Block);

impl<const IMAGES: u8, const WHAT: u8> Kernel for Shapes<'_, '_, IMAGES, WHAT> {
    type Out = ();
    #[inline(always)]
    unsafe fn run<L: Isa>(self) {
        // SAFETY: the caller's promise.
        unsafe { shapes::<L, IMAGES, WHAT>(self.0, self.1) }
    }
}
