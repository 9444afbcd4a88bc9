//! How long short lists stay valid: how far grains have gone since, slab by slab, and only relative to each other.
//!
//! Two grains come closer by what their ways differ. In a flow all grains of a slab and the next go nearly the same way, and
//! lists outlast many steps in which everybody goes far.

use super::has_avx2;
use crate::driver::Grains;
use perigrain_base::math::four::{Four, Plain};
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::{Vec3, add, length, sub};
use perigrain_base::par;
use perigrain_neigh::slabs::{Slabs, shift_of};
use perigrain_world::Seen;
use std::ops::Range;

/// The part of the thin skin that grains of a slab may use up before it gets a new list at the next look.
const WORN: f64 = 0.5;

/// So few grains are looked at before another thread has seen that there is work.
const FEW: usize = 1024;

/// Positions and radii where a slab's list was made.
type Place = [f64; 4];

/// Where grains were when the short lists that they are in were made.
#[derive(Clone, Debug, Default)]
pub(super) struct ListValidity {
    /// Places of the order, list by list.
    members: Vec<Range<usize>>,
    /// The slab that each one reaches into, if it is a slab's list.
    next: Vec<Option<usize>>,
    /// Fast, middle and slow axis of slabs; none where pairs of a list may be seen in any image.
    axes: Option<[usize; 3]>,
    /// The box in which each list was made.
    listed: Vec<Periods>,
    /// The box at the last look, and whether it has changed since lists were made.
    looked: Periods,
    changed: bool,
    /// Places of grains that have been moved around the box, and by how many periods since lists were made.
    turned: Vec<(usize, [f64; 3])>,
    /// The grain at each place; none where it is the place itself.
    order: Vec<u32>,
    /// Who is at each place, when the list of its own slab was made.
    own: Vec<Place>,
    /// And when that of the slab before was made, into which it reaches.
    before: Vec<Place>,
    /// How far, at the last look, grains of a slab and the next had strayed from each other at most.
    since: Seen,
    /// How often all grains were looked at.
    pub looks: usize,
    /// Room for a look: ways of slabs, and how much closer grains of each can have come.
    ways: Vec<[Ways; 2]>,
    nearer: Vec<f64>,
}

/// Bounds of ways [length], and of what radii have grown.
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

    /// Those of images that have moved by so much.
    fn seen_from(self, moved: Vec3) -> Self {
        Self { least: add(self.least, moved), most: add(self.most, moved), ..self }
    }

    /// By how much two surfaces can have come closer at most [length].
    fn closer(self) -> f64 {
        let square: f64 = (0..3).map(|d| (self.most[d] - self.least[d]).max(0.0).powi(2)).sum();
        square.sqrt() + 2.0 * self.grown
    }
}

/// How far an edge of the box has moved between two times.
fn edge_moved(edge: usize, now: &Periods, then: &Periods) -> Vec3 {
    sub(now.vectors()[edge], then.vectors()[edge])
}

/// How far images have moved between two times, at most [length].
fn farthest(now: &Periods, then: &Periods) -> f64 {
    if now == then {
        return 0.0;
    }
    let way = |image: u32| length(sub(now.shift(shift_of(image)), then.shift(shift_of(image))));
    (0..27).map(way).fold(0.0, f64::max)
}

/// [`Ways`] as they are gathered, vector by vector.
struct Span<F> {
    least: F,
    most: F,
    /// Zero, but where a way was no number: that is neither the least nor the most.
    bad: F,
    grown: f64,
}

impl<F: Four> Span<F> {
    /// # Safety
    /// The processor must have what the form needs.
    #[inline(always)]
    unsafe fn new() -> Self {
        // SAFETY: passed on.
        unsafe {
            let (least, most) = (F::splat(f64::INFINITY), F::splat(f64::NEG_INFINITY));
            Self { least, most, bad: F::splat(0.0), grown: 0.0 }
        }
    }

    #[inline(always)]
    fn take(&mut self, now: F, radius: f64, seen: &Place) {
        // SAFETY: an array of four numbers. The radius in the last lane is not looked at.
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
    /// Forgets all grains.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// How many lists.
    pub fn lists(&self) -> usize {
        self.members.len()
    }

    /// Whether every grain stands at its place.
    pub fn stand_in_order(&self) -> bool {
        self.order.is_empty()
    }

    /// The slab that the list of this one reaches into, if there is one.
    pub fn next(&self, slab: usize) -> Option<usize> {
        self.next[slab]
    }

    /// The places of a slab.
    pub fn members(&self, slab: usize) -> Range<usize> {
        self.members[slab].clone()
    }

    /// Grains have been moved by so many periods since lists were made, by `more` of them now: that is not a way.
    pub fn turn(&mut self, turns: &[[i8; 3]], more: &[[i16; 3]], period: &Periods) {
        self.turned.clear();
        for at in 0..self.own.len() {
            let grain = self.grain(at);
            if more[grain] != [0; 3] {
                self.shift(at, period.shift(more[grain].map(f64::from)));
            }
            if let Some(turns) = turns.get(grain).filter(|turns| **turns != [0; 3]) {
                self.turned.push((at, turns.map(f64::from)));
            }
        }
    }

    /// The box has changed: who has been moved around it would be elsewhere.
    pub fn follow(&mut self, before: &Periods, now: &Periods) {
        self.changed = true;
        let turned = std::mem::take(&mut self.turned);
        for (at, turns) in &turned {
            self.shift(*at, sub(now.shift(*turns), before.shift(*turns)));
        }
        self.turned = turned;
    }

    fn shift(&mut self, at: usize, by: Vec3) {
        for place in [&mut self.own[at], &mut self.before[at]] {
            (0..3).for_each(|d| place[d] += by[d]);
        }
    }

    /// Takes up new slabs; all their lists have to be made.
    pub fn divide(&mut self, slabs: &Slabs) {
        let near = slabs.near();
        self.members = (0..near.count()).map(|k| near.members(k)).collect();
        self.next = (0..near.count()).map(|k| near.next(k)).collect();
        self.axes = Some(slabs.axes());
        let same = slabs.order.iter().zip(0..).all(|(grain, place)| *grain == place);
        self.order = if same { vec![] } else { slabs.order.clone() };
        self.make_room(slabs.order.len());
    }

    /// Takes up lists in which these grains are, each of them once; all have to be made.
    pub fn take(&mut self, lists: &[Vec<u32>]) {
        let end_of = |k: usize| lists[..k].iter().map(Vec::len).sum();
        self.members = (0..lists.len()).map(|k| end_of(k)..end_of(k + 1)).collect();
        self.next = vec![None; lists.len()];
        self.axes = None;
        self.order = lists.concat();
        self.make_room(self.order.len());
    }

    fn make_room(&mut self, places: usize) {
        self.own.resize(places, [0.0; 4]);
        self.before.resize(places, [0.0; 4]);
        self.listed.resize(self.members.len(), Periods::default());
    }

    /// The grain at a place.
    fn grain(&self, place: usize) -> usize {
        if self.order.is_empty() { place } else { self.order[place] as usize }
    }

    /// The slabs whose grains may have come closer by `thin`, or `all`, and some that are near that; their lists are taken to be made
    /// from the present positions.
    pub fn strayed(&mut self, grains: &Grains, thin: f64, all: bool) -> Vec<usize> {
        if self.members.is_empty() {
            return vec![];
        }
        if thin == f64::INFINITY {
            // Nobody gets out of lists that are the long ones.
            return if all { (0..self.members.len()).collect() } else { vec![] };
        }
        // Whatever way two grains have gone since, they came closer by twice that at most, and by what images have moved.
        let moved = if self.changed { farthest(&grains.period, &self.looked) } else { 0.0 };
        if !all && self.since.within(grains.travel, 0.5 * (thin - moved)) {
            // The box around all ways may be longer than the two longest of them.
            let limit = 3.0_f64.sqrt() * thin;
            debug_assert!(
                self.closer(grains).iter().all(|c| *c < limit),
                "somebody moves grains without a word"
            );
            return vec![];
        }
        let worn: Vec<usize> = if all {
            self.nearer.clear();
            (0..self.members.len()).collect()
        } else {
            self.looks += 1;
            let nearer = self.closer(grains);
            (0..nearer.len()).filter(|&k| nearer[k] >= WORN * thin).collect()
        };
        for &k in &worn {
            self.see(grains, k);
        }
        self.looked = grains.period;
        let left = self.nearer.iter().copied().filter(|c| *c < WORN * thin).fold(0.0, f64::max);
        self.since = Seen::now(grains.travel, 0.5 * left);
        worn
    }

    /// Takes the short lists of these slabs to be made from the present positions.
    pub fn renew(&mut self, grains: &Grains, which: &[usize]) {
        which.iter().for_each(|&k| self.see(grains, k));
    }

    /// How much closer two grains of a list can have come, for each slab [length].
    fn closer(&mut self, grains: &Grains) -> &[f64] {
        let mut ways = std::mem::take(&mut self.ways);
        ways.clear();
        ways.resize(self.members.len(), [Ways::NONE; 2]);
        let (this, shared) = (&*self, par::Shared::new(&mut ways));
        par::for_rows_if(this.own.len() > FEW, this.members.len(), |k| {
            let ways = this.ways(grains, k);
            // SAFETY: each part writes its own slab.
            unsafe { shared.get(k..k + 1)[0] = ways };
        });
        let closer = |k: usize| {
            let (own, now, then) = (ways[k][0], &grains.period, &self.listed[k]);
            let Some(axes) = self.axes else { return own.closer() + farthest(now, then) };
            let [fast, middle, slow] = axes.map(|d| edge_moved(d, now, then));
            let all = match self.next[k] {
                Some(next) if next > k => own.join(ways[next][1]),
                // Around the box, where the next slab is an image.
                Some(next) => own.join(ways[next][1].seen_from(slow)),
                None => own,
            };
            all.closer() + length(fast) + length(middle)
        };
        self.nearer.clear();
        self.nearer.extend((0..ways.len()).map(closer));
        self.ways = ways;
        &self.nearer
    }

    /// The ways of a slab's grains since its own list was made, and since that of the slab before.
    fn ways(&self, grains: &Grains, k: usize) -> [Ways; 2] {
        // SAFETY: the processor was asked; members are grains, and all of them have been seen.
        unsafe {
            #[cfg(target_arch = "x86_64")]
            if has_avx2() {
                return self.ways_avx2(grains, k);
            }
            self.ways_in::<Plain>(grains, k)
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    unsafe fn ways_avx2(&self, grains: &Grains, k: usize) -> [Ways; 2] {
        // SAFETY: passed on.
        unsafe { self.ways_in::<perigrain_base::math::four::Avx2>(grains, k) }
    }

    #[inline(always)]
    unsafe fn ways_in<F: Four>(&self, grains: &Grains, k: usize) -> [Ways; 2] {
        // SAFETY: passed on.
        unsafe {
            let (mut own, mut before) = (Span::<F>::new(), Span::<F>::new());
            for place in self.members[k].clone() {
                let i = self.grain(place);
                let now = F::load3(grains.x.get_unchecked(i).as_ptr());
                let radius = grains.radius.get_unchecked(i);
                own.take(now, *radius, self.own.get_unchecked(place));
                before.take(now, *radius, self.before.get_unchecked(place));
            }
            [own.ways(), before.ways()]
        }
    }

    /// Keeps the present places for the list of slab `k`.
    fn see(&mut self, grains: &Grains, k: usize) {
        self.listed[k] = grains.period;
        let place = |i: usize| [grains.x[i][0], grains.x[i][1], grains.x[i][2], grains.radius[i]];
        for at in self.members[k].clone() {
            self.own[at] = place(self.grain(at));
        }
        for at in self.next[k].map_or(0..0, |next| self.members[next].clone()) {
            self.before[at] = place(self.grain(at));
        }
    }
}

#[cfg(test)]
mod tests;
