//! How long short lists stay valid: displacements since they were made, per list and relative to each other.
//!
//! Two grains approach by the difference of their displacements. In a flow, the grains of a tile and of its
//! neighbours move nearly alike, and lists stay valid for many steps in which all of them move far.

use super::has_avx2;
use super::lists::List;
use super::search::{Part, Watched};
use crate::driver::Grains;
use perigrain_base::math::four::{Four, Plain};
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::{Vec3, add, length, sub};
use perigrain_base::par;
use perigrain_neigh::tiles::{HERE, shift_of};
use perigrain_world::Seen;

/// Fraction of the thin skin that the grains of a list may use up before the list is remade at the next
/// check.
const WORN: f64 = 0.5;

/// Below this number of grains, a loop ends before other threads could start.
const FEW: usize = 1024;

/// Position and radius when a list was made.
type Place = [f64; 4];

/// The state of grains at the time their short lists were made.
#[derive(Clone, Debug, Default)]
pub(super) struct ListValidity {
    /// Places of each list, row by row.
    then: Vec<Vec<Place>>,
    /// The box when each list was made.
    listed: Vec<Periods>,
    /// The box at the last check, and whether it has changed since lists were made.
    looked: Periods,
    changed: bool,
    /// Rows of lists whose grains have been wrapped, and by how many periods since the lists were made.
    turned: Vec<([usize; 2], [f64; 3])>,
    /// The largest relative displacement in any list at the last check.
    since: Seen,
    /// Number of times that all grains were checked.
    pub looks: usize,
    /// Largest possible approach of two grains, per list.
    nearer: Vec<f64>,
}

/// Bounds of displacements [length], and of the growth of radii.
#[derive(Clone, Copy, Debug)]
struct Ways {
    least: [f64; 3],
    most: [f64; 3],
    grown: f64,
}

impl Ways {
    const NONE: Self = Self { least: [f64::INFINITY; 3], most: [f64::NEG_INFINITY; 3], grown: 0.0 };

    fn join(self, other: Self) -> Self {
        let mut all = self;
        for d in 0..3 {
            all.least[d] = all.least[d].min(other.least[d]);
            all.most[d] = all.most[d].max(other.most[d]);
        }
        all.grown = all.grown.max(other.grown);
        all
    }

    /// The bounds for images that have moved by `moved`.
    fn seen_from(self, moved: Vec3) -> Self {
        Self { least: add(self.least, moved), most: add(self.most, moved), ..self }
    }

    /// The largest possible approach of two surfaces [length].
    fn closer(self) -> f64 {
        let square: f64 = (0..3).map(|d| (self.most[d] - self.least[d]).max(0.0).powi(2)).sum();
        square.sqrt() + 2.0 * self.grown
    }
}

/// Displacement of an image between two times.
fn moved(image: u32, now: &Periods, then: &Periods) -> Vec3 {
    let by = shift_of(image);
    sub(now.shift(by), then.shift(by))
}

/// The largest displacement of any image between two times [length].
fn farthest(now: &Periods, then: &Periods) -> f64 {
    if now == then {
        return 0.0;
    }
    (0..27).map(|image| length(moved(image, now, then))).fold(0.0, f64::max)
}

/// [`Ways`] while they are collected, vector by vector.
struct Span<F> {
    least: F,
    most: F,
    /// Zero, unless a displacement was NaN, which minimum and maximum would miss.
    bad: F,
    grown: f64,
}

impl<F: Four> Span<F> {
    /// # Safety
    /// The processor must support the form.
    #[inline(always)]
    unsafe fn new() -> Self {
        // SAFETY: the caller's guarantee.
        unsafe {
            let (least, most) = (F::splat(f64::INFINITY), F::splat(f64::NEG_INFINITY));
            Self { least, most, bad: F::splat(0.0), grown: 0.0 }
        }
    }

    #[inline(always)]
    fn take(&mut self, now: F, radius: f64, seen: &Place) {
        // SAFETY: an array of four numbers. The radius in the last lane is ignored.
        let way = now - unsafe { F::load(seen.as_ptr()) };
        (self.least, self.most) = (way.least(self.least), way.most(self.most));
        self.bad = self.bad + way * 0.0;
        let change = (radius - seen[3]).abs();
        self.grown = if change > self.grown { change } else { self.grown };
    }

    #[inline(always)]
    fn ways(self) -> Ways {
        let ([a, b, c, _], [p, q, r, _]) = (self.least.numbers(), self.most.numbers());
        let p = if self.bad.numbers()[..3] == [0.0; 3] { p } else { f64::INFINITY };
        Ways { least: [a, b, c], most: [p, q, r], grown: self.grown }
    }
}

impl ListValidity {
    /// Discards all grains.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Begins with this many new lists, all of which must be made.
    pub fn begin(&mut self, lists: usize) {
        let mut then = std::mem::take(&mut self.then);
        then.resize(lists, vec![]);
        *self = Self { then, listed: vec![Periods::default(); lists], ..Self::default() };
    }

    /// Records that grains have been wrapped by `turns` periods since lists were made, of which `more` are
    /// new: this is not a displacement.
    pub fn turn(&mut self, lists: &[List], turns: &[[i8; 3]], more: &[[i16; 3]], period: &Periods) {
        self.turned.clear();
        for (k, (list, then)) in lists.iter().zip(&mut self.then).enumerate() {
            for (at, (grain, place)) in list.watched.grains.iter().zip(then).enumerate() {
                let grain = *grain as usize;
                if more[grain] != [0; 3] {
                    shift(place, period.shift(more[grain].map(f64::from)));
                }
                if let Some(turns) = turns.get(grain).filter(|turns| **turns != [0; 3]) {
                    self.turned.push(([k, at], turns.map(f64::from)));
                }
            }
        }
    }

    /// Records a change of the box: grains that have been wrapped are elsewhere in it.
    pub fn follow(&mut self, before: &Periods, now: &Periods) {
        self.changed = true;
        for ([list, at], turns) in &self.turned {
            shift(&mut self.then[*list][*at], sub(now.shift(*turns), before.shift(*turns)));
        }
    }

    /// The lists whose grains may have approached by `thin`, or `all`, and lists close to that; they count as
    /// remade from the current positions.
    pub fn strayed(&mut self, lists: &[List], grains: &Grains, thin: f64, all: bool) -> Vec<usize> {
        if lists.is_empty() {
            return vec![];
        }
        if thin == f64::INFINITY {
            // Lists that are identical to the long ones lose no pairs.
            return if all { (0..lists.len()).collect() } else { vec![] };
        }
        // In any motion, two grains approach by at most twice the displacement, plus the displacement of
        // images.
        let moved = if self.changed { farthest(&grains.period, &self.looked) } else { 0.0 };
        if !all && self.since.within(grains.travel, 0.5 * (thin - moved)) {
            // The bounding box of all displacements may be longer than the two longest of them.
            let limit = 3.0_f64.sqrt() * thin;
            debug_assert!(
                self.closer(lists, grains).iter().all(|c| *c < limit),
                "an op moves grains without reporting it"
            );
            return vec![];
        }
        let worn: Vec<usize> = if all {
            self.nearer.clear();
            (0..lists.len()).collect()
        } else {
            self.looks += 1;
            let nearer = self.closer(lists, grains);
            (0..nearer.len()).filter(|&k| nearer[k] >= WORN * thin).collect()
        };
        self.renew(lists, grains, &worn);
        self.looked = grains.period;
        let left = self.nearer.iter().copied().filter(|c| *c < WORN * thin).fold(0.0, f64::max);
        self.since = Seen::measured(grains.travel, 0.5 * left);
        worn
    }

    /// Marks these short lists as remade from the current positions.
    pub fn renew(&mut self, lists: &[List], grains: &Grains, which: &[usize]) {
        let place = |i: usize| [grains.x[i][0], grains.x[i][1], grains.x[i][2], grains.radius[i]];
        which.iter().for_each(|&k| self.listed[k] = grains.period);
        let then = par::Shared::new(&mut self.then);
        par::for_rows_if(grains.x.len() > FEW, which.len(), |at| {
            let k = which[at];
            // SAFETY: each part writes the data of its own list.
            let then = unsafe { &mut then.get(k..k + 1)[0] };
            then.clear();
            then.extend(lists[k].watched.grains.iter().map(|i| place(*i as usize)));
        });
    }

    /// The largest possible approach of two grains, per list [length].
    fn closer(&mut self, lists: &[List], grains: &Grains) -> &[f64] {
        let mut nearer = std::mem::take(&mut self.nearer);
        nearer.clear();
        nearer.resize(lists.len(), 0.0);
        let (this, shared) = (&*self, par::Shared::new(&mut nearer));
        par::for_rows_if(grains.x.len() > FEW, lists.len(), |k| {
            // SAFETY: each part writes its own number.
            unsafe { shared.get(k..k + 1)[0] = this.closer_in(&lists[k].watched, k, grains) };
        });
        self.nearer = nearer;
        &self.nearer
    }

    /// The largest possible approach in list `k`: pairs lie in one layer or in two successive ones.
    fn closer_in(&self, watched: &Watched, k: usize, grains: &Grains) -> f64 {
        let (now, then) = (&grains.period, &self.listed[k]);
        let mut from = 0;
        let mut of_part = |part: &Part| {
            let of = from..part.end as usize;
            from = of.end;
            let ways = ways(grains, &watched.grains[of.clone()], &self.then[k][of]);
            // Images move with the box.
            let still = part.image == HERE || now == then;
            if still { ways } else { ways.seen_from(moved(part.image, now, then)) }
        };
        let (mut most, mut below) = (0.0_f64, None);
        for layer in watched.parts.chunk_by(|a, b| a.layer == b.layer) {
            let number = layer[0].layer;
            let here = layer.iter().map(&mut of_part).fold(Ways::NONE, Ways::join);
            let both = match below {
                Some((last, below)) if last + 1 == number => here.join(below),
                _ => here,
            };
            most = most.max(both.closer());
            below = Some((number, here));
        }
        most
    }
}

fn shift(place: &mut Place, by: Vec3) {
    (0..3).for_each(|d| place[d] += by[d]);
}

/// Displacements of these grains since they were at these places.
fn ways(grains: &Grains, rows: &[u32], then: &[Place]) -> Ways {
    assert_eq!(rows.len(), then.len());
    // SAFETY: the processor's support was checked; rows are grains.
    unsafe {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            return ways_avx2(grains, rows, then);
        }
        ways_in::<Plain>(grains, rows, then)
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn ways_avx2(grains: &Grains, rows: &[u32], then: &[Place]) -> Ways {
    // SAFETY: the caller's guarantee.
    unsafe { ways_in::<perigrain_base::math::four::Avx2>(grains, rows, then) }
}

#[inline(always)]
unsafe fn ways_in<F: Four>(grains: &Grains, rows: &[u32], then: &[Place]) -> Ways {
    // SAFETY: the caller's guarantee.
    unsafe {
        let mut span = Span::<F>::new();
        for (i, then) in rows.iter().zip(then) {
            let i = *i as usize;
            let now = F::load3(grains.x.get_unchecked(i).as_ptr());
            span.take(now, *grains.radius.get_unchecked(i), then);
        }
        span.ways()
    }
}

#[cfg(test)]
mod tests;
