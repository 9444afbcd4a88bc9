//! Contacts of many grains: spatial order, short lists, vectorized evaluation; the same numbers as the plain
//! driver.
//!
//! Grains are sorted into tiles, which are blocks of cells ([`Tiles`]); memory access is best if the world is
//! in the same order. Each tile has a list of the pairs within the skin, and a shorter list of the pairs
//! within a thin second skin, which holds the contact histories. If sizes differ much, pairs with large
//! grains have their own lists. A step tests the distances of the short list and evaluates the law for four
//! or eight pairs at a time ([`form`]), stage by stage (`batch`). Tiles have colours such that neighbours
//! differ, and of two tiles whose pairs share grains the one of the lower colour comes first: the order of
//! additions is the same for any number of threads.

mod batch;
mod bidisperse;
mod deep;
mod found;
mod image_shift;
mod laws;
mod list_validity;
mod lists;
mod memory;
mod near;
mod per_tile;
mod ranks;
mod search;
mod sweep;
mod upkeep;

use super::driver::Grains;
use super::{Advance, MOST_MEMORY};
pub use laws::Laws;
use list_validity::ListValidity;
use lists::{List, Short};
use memory::Book;
pub use perigrain_base::math::form::{Form, InLanes};
use perigrain_base::math::four::has_avx2;
use perigrain_base::math::lanes::{PLACE_BITS, place};
use perigrain_base::math::periods::Periods;
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;
use perigrain_base::par::ordered::Precedence;
use perigrain_neigh::list::small;
use perigrain_neigh::tiles::{Tiles, edges};
use perigrain_world::contacts::Contacts;
pub use ranks::{Dealt, Own};
use std::ops::Range;
use upkeep::Upkeep;

/// Lists for up to this many grains keep their buffers when they are remade.
const SMALL: usize = 1 << 15;
/// The largest number of grains: index and image share 32 bits.
pub const MOST_GRAINS: usize = (1 << PLACE_BITS) - 1;
/// The second skin relative to the first.
const THIN: f64 = 0.15;
/// The image of padding entries: so far away that squared distances are infinite.
const NOWHERE: u32 = 31;
const FAR: f64 = 1e200;
/// Margin for the growth of radii under a list, in the gaps that contacts can span.
const AMPLE: f64 = 1.25;
/// No law.
const NONE: u8 = u8::MAX;

/// The box for which lists are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Lower corner [length].
    pub lo: [f64; 3],
    /// Edges; zero along directions that are not periodic, where the box is not tilted.
    pub period: Periods,
    /// Reach of the lists beyond touching [length].
    pub reach: f64,
    /// Reach beyond touching of lists that are remade at every rebuild [length].
    pub skin: f64,
}

/// The columns that contacts add to, one row per grain.
pub struct Sums<'a> {
    /// Forces.
    pub force: &'a mut [Vec3],
    /// Torques about the centres.
    pub torque: &'a mut [Vec3],
    /// Temperatures, and the heat flow into each grain to add to [energy/time].
    pub heat: Option<(&'a [f64], &'a mut [f64])>,
    /// For the energy ledger: normal damping forces, tangential forces, and elastic forces of dissipative
    /// laws.
    pub deeds: Option<[&'a mut [Vec3]; 3]>,
}

/// Properties that are equal for all grains, so that they are not looked up per grain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Alike {
    radius: Option<f64>,
    /// If some are frozen, the mass without its sign.
    mass: Option<f64>,
}

/// The value of all elements, if they are equal.
fn one_of_all(list: &[f64]) -> Option<f64> {
    let (first, rest) = list.split_first()?;
    rest.iter().all(|a| a == first).then_some(*first)
}

/// Whether two lists are equal: eight at a time, because it runs in every step in which radii may change.
fn same(a: &[f64], b: &[f64]) -> bool {
    let ((eights_a, rest_a), (eights_b, rest_b)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let differ = |a: &[f64; 8], b: &[f64; 8]| a.iter().zip(b).fold(false, |differ, (a, b)| differ | (a != b));
    a.len() == b.len() && rest_a == rest_b && !eights_a.iter().zip(eights_b).any(|(a, b)| differ(a, b))
}

/// Lists and contacts of all grains.
#[derive(Clone, Debug)]
pub struct Fast {
    laws: Laws,
    form: Form,
    /// Tags of the grains when the lists were made.
    tag: Vec<u32>,
    /// Displacements since the short lists were made.
    validity: ListValidity,
    /// Masses, negative for frozen grains, if there are any.
    signed: Vec<f64>,
    /// Properties that are equal for all grains.
    alike: Alike,
    /// Radii used for the reach of pairs in short lists.
    measured: Vec<f64>,
    /// Number of periods by which grains have been wrapped since lists were made.
    turns: Vec<[i8; 3]>,
    /// Lists of tiles, then lists of pairs with large grains, slab by slab.
    lists: Vec<List>,
    /// On several ranks: which pairs this rank lists.
    own: Option<Own>,
    /// Lists in the order of a single thread.
    order: Vec<usize>,
    /// The neighbours of each tile, and which of them come first.
    beside: Vec<Vec<u32>>,
    precedence: Precedence,
    /// The grains of each tile, and whether all grains are in tile order.
    members: Vec<Range<usize>>,
    in_order: bool,
    /// Whether the time of each tile is measured.
    timed: bool,
    /// Displacement of each image, and a 0; very far for padding.
    shifts: [[f64; 4]; 32],
    /// The periods of these images.
    period: Periods,
    /// The second skin [length]; infinite if short lists equal the long ones.
    thin: f64,
    /// Cost of the second skin.
    upkeep: Upkeep,
    /// Largest gap between grains that stick together [length].
    span: f64,
    /// Whether long lists are newer than short ones.
    stale: bool,
    /// Whether short lists are known to be empty and without results.
    idle: bool,
    /// Number of the current step with histories; contacts of the last one carry it.
    now: f64,
    /// Numbers per pair in the short list: the history and the number of its step.
    width: usize,
    /// Lists whose long lists have gained pairs.
    due: Vec<usize>,
    /// Histories from before the lists were remade.
    book: Option<Book>,
    /// Of the first pairs that overlapped too deeply, the one with the smallest ids, and its overlap relative
    /// to the radius.
    pub deep: Option<([u32; 2], f64)>,
    /// Buffers for new short lists.
    spare: Vec<Short>,
    /// Buffers for the next evaluation tile by tile.
    waiting: per_tile::Waiting,
}

impl Fast {
    /// Without grains.
    pub fn new(laws: Laws) -> Self {
        // With the number of the step, in rows of four.
        let width = (laws.memory() + 1).next_multiple_of(4).min(MOST_MEMORY + 1);
        Self {
            laws,
            form: Form::here(),
            tag: vec![],
            validity: ListValidity::default(),
            signed: vec![],
            alike: Alike::default(),
            measured: vec![],
            turns: vec![],
            lists: vec![],
            own: None,
            order: vec![],
            beside: vec![],
            precedence: Precedence::default(),
            members: vec![],
            in_order: false,
            timed: false,
            shifts: [[0.0; 4]; 32],
            period: Periods::default(),
            thin: 0.0,
            upkeep: Upkeep::default(),
            span: 0.0,
            stale: true,
            idle: false,
            now: 0.0,
            width,
            due: vec![],
            book: None,
            deep: None,
            spare: vec![],
            waiting: Default::default(),
        }
    }

    /// Evaluates in lanes of this form, which the processor must support, from now on: all forms give the
    /// same bits.
    pub fn compute_as(&mut self, form: Form) {
        self.form = form;
    }

    /// Looks up mass and radius of each grain until [`Fast::weigh`], even if all are equal: the bits are the
    /// same.
    pub fn one_by_one(&mut self) {
        self.alike = Alike::default();
    }

    /// Removes all grains and contacts.
    pub fn clear(&mut self) {
        *self = Self { timed: self.timed, ..Self::new(self.laws.clone()) };
    }

    /// The largest gap at which grains of up to this radius can stick together [length].
    pub fn span(&self, largest: f64) -> f64 {
        self.laws.span(largest)
    }

    /// All grains that are in some list, ascending.
    pub fn listed(&self) -> Vec<u32> {
        let is_listed = self.are_listed();
        (0..self.len() as u32).filter(|row| is_listed[*row as usize]).collect()
    }

    /// Whether each grain is in some list.
    fn are_listed(&self) -> Vec<bool> {
        let mut is_listed = vec![false; self.len()];
        for long in self.lists.iter().map(|list| &list.long) {
            let pairs = long.i.iter().zip(&long.w).filter(|(_, w)| **w >> PLACE_BITS != NOWHERE);
            pairs.for_each(|(i, w)| {
                [*i as usize, place(*w)].into_iter().for_each(|row| is_listed[row] = true)
            });
        }
        is_listed
    }

    /// Number of grains the lists were made for.
    pub fn len(&self) -> usize {
        self.tag.len()
    }

    /// Whether there are no grains.
    pub fn is_empty(&self) -> bool {
        self.tag.is_empty()
    }

    /// Remakes all lists from these positions (wrapped into the box; [`Fast::turn`] adapts to grains wrapped
    /// since), with pairs for which `keep(i, j)`. Histories of the last evaluation are kept; those of
    /// `known(self, own)` are added. An evaluation must follow. If grains are distributed over ranks, `own`
    /// selects the lists that this rank needs for the forces on its own grains ([`Fast::is_part`]); this
    /// excludes separate lists for large grains.
    pub fn rebuild(
        &mut self,
        grains: &Grains,
        frame: &Frame,
        known: impl FnOnce(&Self, Option<&Own>) -> Option<Contacts>,
        dealt: Option<Dealt>,
        keep: &(impl Fn(usize, usize) -> bool + Sync),
    ) {
        let largest = par::best(grains.radius, 0.0, f64::max);
        self.span = self.laws.span(largest);
        let reach = frame.reach + self.span;
        let [edge, far] = edges(grains.radius, reach);
        let sort = || {
            let mut tiles = Tiles::default();
            tiles.sort(grains.x, grains.tag, [edge, far], &frame.lo, &frame.period);
            tiles
        };
        // Work for one thread each.
        let n = grains.x.len();
        let large =
            || if edge == far { vec![] } else { self.find_large(grains, (frame.period, reach), keep) };
        let ((tiles, book), large, own) = match dealt.filter(|_| edge == far) {
            None => {
                let known = known(self, None);
                let remember = || self.remember(grains.tag, known.as_ref());
                let (found, large) = par::both(n, || par::both(n, sort, remember), large);
                (found, large, None)
            }
            Some(dealt) => {
                let tiles = sort();
                let own = Own::new(dealt, &tiles);
                let known = known(self, Some(&own));
                ((tiles, self.remember(grains.tag, known.as_ref())), vec![], Some(own))
            }
        };
        let whole = self.upkeep.takes_whole(self.pairs());
        // The book holds their histories: frees memory for the new lists.
        if grains.x.len() > SMALL {
            self.lists.iter_mut().for_each(|l| l.short = Short::default());
            self.spare = vec![];
        } else {
            self.lists.iter_mut().for_each(|l| l.short.clear());
        }
        self.turns = vec![];
        self.tag.clear();
        self.tag.extend_from_slice(grains.tag);
        self.see_images(frame.period);
        self.thin = if whole { f64::INFINITY } else { THIN * frame.skin };
        let small = if edge == far { None } else { Some(small(grains.radius)) };
        let both_small = |i: usize, j: usize| {
            small.is_none_or(|small| grains.radius[i] < small && grains.radius[j] < small)
        };
        let has = |tile: usize, i: usize, j: usize| own.as_ref().is_none_or(|own| own.has(tile, i, j));
        let listed = |tile: usize| own.as_ref().is_none_or(|own| own.lists(tile));
        self.make_long(grains, &tiles, reach, listed, &|tile, i, j| {
            both_small(i, j) && has(tile, i, j) && keep(i, j)
        });
        if edge != far {
            self.add_large(&large, &tiles);
        }
        self.own = own;
        self.watch_listed();
        self.lists.iter_mut().for_each(|list| list.long.fill_up());
        self.validity.begin(self.lists.len());
        self.members = (0..tiles.count()).map(|k| tiles.members(k)).collect();
        self.in_order = tiles.order.iter().zip(0..).all(|(grain, place)| *grain == place);
        self.put_in_order(&tiles);
        self.book = Some(book);
        self.stale = true;
    }

    /// Whether there has been an evaluation since the last [`Fast::rebuild`], as [`Fast::admit`] requires.
    pub fn can_admit(&self) -> bool {
        !self.stale && self.book.is_none()
    }

    /// Adds pairs of the given grains that `keep` has only now begun to accept; `grains` and `frame` are
    /// those of the last [`Fast::rebuild`]. The lists are the same as after a rebuild. Returns `false`
    /// without any change if a rebuild is required: before an evaluation, with large grains, and if grains or
    /// images have been wrapped since.
    pub fn admit(
        &mut self,
        grains: &Grains,
        frame: &Frame,
        ends: &[usize],
        keep: &(impl Fn(usize, usize) -> bool + Sync),
    ) -> bool {
        let reach = frame.reach + self.span;
        let [edge, far] = edges(grains.radius, reach);
        let elsewhere = !self.turns.is_empty() || self.period != frame.period;
        if !self.can_admit() || edge != far || elsewhere || grains.tag != self.tag {
            return false;
        }
        let mut tiles = Tiles::default();
        tiles.sort(grains.x, grains.tag, [edge, far], &frame.lo, &frame.period);
        if tiles.count() != self.lists.len() {
            return false;
        }
        let own = self.own.take();
        let has = |tile: usize, i: usize, j: usize| own.as_ref().is_none_or(|own| own.has(tile, i, j));
        let listed = |tile: usize| own.as_ref().is_none_or(|own| own.lists(tile));
        self.due = self
            .extend_long(grains, &tiles, reach, (ends, listed), &|tile, i, j| has(tile, i, j) && keep(i, j));
        self.own = own;
        self.watch_listed();
        true
    }

    /// Evaluates all contacts for the current state of the grains and adds forces and torques to `f` and
    /// `torque`. With `store`, histories are updated, otherwise only forces change. With `virial`, returns Σ
    /// d ⊗ F: xx yy zz xy xz yz. Heat flow is added to `heat`, if given.
    pub fn run(&mut self, grains: &Grains, sums: Sums, step: Advance, store: bool, virial: bool) -> [f64; 6] {
        self.begin(grains);
        if !self.idle {
            self.idle = self.lists.iter().all(|l| l.short.i.is_empty());
            match self.idle {
                true => self.lists.iter_mut().for_each(|l| l.found([0.0; 6], false, 0)),
                false => self.sweep(grains, sums, step, (store, virial), None),
            }
            if self.deep.is_none() && self.lists.iter().any(|l| l.deep) {
                self.deep = self.find_deep(grains, &self.lists);
            }
        }
        self.now += if store { 1.0 } else { 0.0 };
        let mut total = [0.0; 6];
        for list in self.lists.iter().filter(|_| virial) {
            (0..6).for_each(|k| total[k] += list.virial[k]);
        }
        total
    }

    /// Makes short lists if they are due.
    pub(super) fn begin(&mut self, grains: &Grains) {
        self.follow(&grains.period);
        let stale = std::mem::take(&mut self.stale);
        let mut due = std::mem::take(&mut self.due);
        self.validity.renew(&self.lists, grains, &due);
        let looks = self.validity.looks;
        let mut strayed = self.validity.strayed(&self.lists, grains, self.thin, stale);
        let looks = self.validity.looks - looks;
        due.retain(|k| !strayed.contains(k));
        strayed.extend(due);
        let made = if stale { 0 } else { strayed.iter().map(|k| self.lists[*k].long.i.len()).sum() };
        self.upkeep.step(made, looks * grains.x.len());
        self.make_short(grains, &strayed);
    }

    /// Number of tiles.
    fn tiles(&self) -> usize {
        self.members.len()
    }

    /// Number of lists of pairs with large grains.
    fn large(&self) -> usize {
        self.order.len() - self.tiles()
    }

    /// Calls `f` for the lists of tiles, then for those of large grains: a list may write to its tile and the
    /// neighbouring ones, or to its slab and the next one.
    fn each_list(&self, f: impl Fn(usize) + Sync) {
        self.precedence.run(&f);
        par::two_colours(self.large(), |k| f(self.tiles() + k));
    }

    /// Determines which lists come before which, and a single-thread order that satisfies this.
    fn put_in_order(&mut self, tiles: &Tiles) {
        let colours: Vec<u8> = (0..tiles.count()).map(|tile| tiles.colour(tile)).collect();
        self.beside = (0..tiles.count()).map(|tile| tiles.beside(tile)).collect();
        self.precedence = Precedence::of(&colours, &self.beside);
        self.precedence.keep_times(self.timed);
        let large = self.lists.len() - tiles.count();
        self.order.clear();
        self.order.extend_from_slice(self.precedence.line());
        self.order.extend(par::in_turn(large).map(|k| tiles.count() + k));
    }

    /// Measures the time of each tile from now on, starting again at each [`Fast::rebuild`].
    pub fn time_tiles(&mut self) {
        self.timed = true;
        self.precedence.keep_times(true);
    }

    /// Number of tiles, size of the largest, and the largest possible speedup with several threads by the
    /// times of tiles; `None` if no times were measured.
    pub fn describe_tiles(&self) -> Option<String> {
        let most = self.members.iter().map(Range::len).max().unwrap_or(0);
        self.precedence.described(&format!("{most} grains"))
    }

    /// Updates which grains are frozen and which properties are equal: after a [`Fast::rebuild`], and when
    /// masses, radii or frozen groups may have changed.
    pub fn weigh(&mut self, grains: &Grains) {
        self.alike = Alike { radius: one_of_all(grains.radius), mass: one_of_all(grains.mass) };
        if !same(&self.measured, grains.radius) {
            self.measured.clear();
            self.measured.extend_from_slice(grains.radius);
            let mut lists = std::mem::take(&mut self.lists);
            let (this, shared) = (&*self, par::Shared::new(&mut lists));
            par::for_rows_if(grains.x.len() > par::CHUNK, shared.len(), |k| {
                // SAFETY: each part writes its own list.
                this.measure(grains, unsafe { &mut shared.get(k..k + 1)[0].short });
            });
            self.lists = lists;
        }
        let known = if grains.frozen.is_empty() { 0 } else { self.tag.len() };
        self.signed.resize(known, 0.0);
        if known > 0 {
            par::each((&mut self.signed[..], grains.mass, grains.frozen), |_, (signed, mass, frozen)| {
                for ((signed, m), frozen) in signed.iter_mut().zip(mass).zip(frozen) {
                    *signed = if *frozen { -m } else { *m };
                }
            });
        }
    }

    /// Energy stored by contacts of dissipative laws in the last evaluation, if recorded [energy].
    pub fn held(&self) -> f64 {
        self.lists.iter().map(|list| list.held).sum()
    }

    /// Number of pairs in long lists and in short ones.
    pub fn pairs(&self) -> [usize; 2] {
        let sum = |f: fn(&List) -> usize| self.lists.iter().map(f).sum();
        [sum(|s| s.long.i.len()), sum(|s| s.short.i.len())]
    }
}

#[cfg(test)]
mod tests;
