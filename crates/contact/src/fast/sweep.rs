//! The inner loop of a step: tests the pairs of short lists, and evaluates contacts batch by batch.

use super::batch::Batch;
use super::found::{Found, ROOM};
use super::lists::{FILL, List, Short, are_little};
use super::near::Places;
use super::{Alike, Fast, Laws, Sums};
use crate::driver::Grains;
use crate::law::Loop;
use crate::{Advance, Granular};
use perigrain_base::math::form::InLanes;
use perigrain_base::math::four::Four;
use perigrain_base::math::lanes::{Lanes, PLACE_BITS, place};
use perigrain_base::math::vec3::Vec3;
use perigrain_base::par;
use perigrain_neigh::tiles::shift_of;
use std::ops::Range;

/// Above this number, grains and pairs exceed a second-level cache of 1 MB.
const MANY: usize = 8192;

/// Inputs and outputs of the loops.
pub(super) struct Cx<'a> {
    pub laws: &'a Laws,
    pub x: &'a [Vec3],
    pub v: &'a [Vec3],
    pub omega: &'a [Vec3],
    pub radius: &'a [f64],
    pub mass: &'a [f64],
    /// Properties that are equal for all grains.
    pub alike: Alike,
    pub kind: &'a [u16],
    pub tag: &'a [u32],
    pub shifts: &'a [[f64; 4]; 32],
    pub force: par::Shared<'a, Vec3>,
    pub torque: par::Shared<'a, Vec3>,
    /// Temperatures, and heat flow into the grains.
    pub heat: Option<(&'a [f64], par::Shared<'a, f64>)>,
    pub step: Advance,
    pub now: f64,
    pub store: bool,
    pub virial: bool,
    /// Outputs for the energy ledger: damping forces, tangential forces, and elastic forces of dissipative
    /// laws.
    pub deeds: Option<[par::Shared<'a, Vec3>; 3]>,
    /// Whether some grains are frozen.
    pub frozen: bool,
    /// Largest gap between grains that stick together [length].
    pub span: f64,
    /// Velocities of images, if they move.
    pub drift: Option<&'a Drift<'a>>,
    /// Whether the data of the grains exceeds the second-level cache.
    pub are_many: bool,
}

/// Images that move with a deforming box.
pub(super) struct Drift<'a> {
    /// Velocity of each image relative to its grain [length/time].
    by: [Vec3; 27],
    /// Tags of the grains.
    tag: &'a [u32],
    /// Group masks, and the bit of the group whose images move.
    mask: &'a [u32],
    group: u32,
}

impl<'a> Drift<'a> {
    /// For these grains, if images move.
    fn of(grains: &Grains<'a>) -> Option<Self> {
        let (flow, mask) = grains.flow?;
        let by = std::array::from_fn(|image| flow.velocity(shift_of(image as u32)));
        Some(Self { by, tag: grains.tag, mask, group: flow.group.bit() })
    }

    /// Velocities to add for second grains as seen by `i`, coordinate by coordinate; not inlined, so that
    /// boxes at rest do not pay for it. As in the plain loop, the grain with the larger tag is the image.
    ///
    /// # Safety
    /// There must be `N` pairs of grains, the second ones with images.
    #[inline(never)]
    pub unsafe fn added<const N: usize>(&self, i: *const u32, w: *const u32) -> [[f64; N]; 3] {
        let mut added = [[0.0; N]; 3];
        for lane in 0..N {
            // SAFETY: the caller's guarantee.
            let (i, w) = unsafe { (*i.add(lane) as usize, *w.add(lane)) };
            let j = place(w);
            let image = if self.tag[i] < self.tag[j] { j } else { i };
            if self.mask[image] & self.group != 0 {
                let by = self.by[(w >> PLACE_BITS) as usize];
                (0..3).for_each(|d| added[d][lane] = by[d]);
            }
        }
        added
    }
}

impl Cx<'_> {
    /// Whether contacts of several lists are evaluated together. Forces have the same bits: they are added in
    /// the same order.
    fn joins(&self) -> bool {
        // The stored energy of dissipative laws is summed per list.
        let by_list = self.virial || (self.deeds.is_some() && self.laws.distinct.iter().any(Granular::flows));
        self.laws.distinct.len() == 1 && !by_list
    }

    /// Positions of the grains.
    pub fn places(&self) -> Places<'_> {
        Places { x: self.x, radius: self.radius, alike: self.alike.radius, shifts: self.shifts }
    }

    /// Whether a pair touches, or touched in the last step and still sticks together.
    fn holds<const W: usize>(&self, short: &Short, k: usize) -> bool {
        let (i, w) = (short.i[k] as usize, short.w[k]);
        let (j, d) = (place(w), self.places().between(i, w));
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let (ri, rj) = (self.radius[i], self.radius[j]);
        let sum = ri + rj;
        if square < sum * sum {
            return true;
        }
        if short.history[(k + 1) * W - 1] != self.now {
            return false;
        }
        let law = self.laws.distinct.get(usize::from(self.laws.which(self.kind[i], self.kind[j])));
        let far = sum + law.map_or(0.0, |law| law.gap(ri * rj / sum));
        square < far * far
    }
}

impl Fast {
    /// Sums the forces of all contacts, or of those in some successive lists in the order of a single thread.
    pub(super) fn sweep(
        &mut self,
        grains: &Grains,
        sums: Sums,
        step: Advance,
        (store, virial): (bool, bool),
        only: Option<Range<usize>>,
    ) {
        let (width, form) = (self.width, self.form);
        let mut lists = std::mem::take(&mut self.lists);
        // A single thread takes the lists in order.
        let shares = only.is_none() && (self.timed || (par::threads() > 1 && !are_little(&lists)));
        let shared = par::Shared::new(&mut lists);
        let drift = Drift::of(grains);
        let cx = Cx {
            laws: &self.laws,
            x: grains.x,
            v: grains.v,
            omega: grains.omega,
            radius: grains.radius,
            mass: if self.signed.is_empty() { grains.mass } else { &self.signed },
            alike: self.alike,
            kind: grains.kind,
            tag: grains.tag,
            shifts: &self.shifts,
            force: par::Shared::new(sums.force),
            torque: par::Shared::new(sums.torque),
            heat: sums.heat.map(|(temperature, flow)| (temperature, par::Shared::new(flow))),
            step,
            now: self.now,
            store,
            virial,
            deeds: sums.deeds.map(|deeds| deeds.map(par::Shared::new)),
            frozen: !self.signed.is_empty(),
            span: self.span,
            drift: drift.as_ref(),
            are_many: grains.x.len() > MANY,
        };
        let contacts = |which: &[usize]| {
            // SAFETY: each part writes its own lists, and forces of grains in their tiles and neighbouring
            // ones, which `each_list` keeps separate; list entries are grains; AVX is used only where it is
            // supported.
            unsafe {
                match width {
                    4 => form.run(Contacts::<4> { cx: &cx, lists: &shared, which }),
                    8 => form.run(Contacts::<8> { cx: &cx, lists: &shared, which }),
                    _ => form.run(Contacts::<12> { cx: &cx, lists: &shared, which }),
                }
            }
        };
        match only {
            Some(some) => contacts(&self.order[some]),
            None if shares => self.each_list(|k| contacts(&[k])),
            None => contacts(&self.order),
        }
        self.lists = lists;
    }
}

/// All contacts of some lists, one list after the other, with at most `W` − 1 history entries.
struct Contacts<'a, 'b, const W: usize> {
    cx: &'a Cx<'b>,
    lists: &'a par::Shared<'a, List>,
    which: &'a [usize],
}

impl<const W: usize> InLanes for Contacts<'_, '_, W> {
    type Out = ();

    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let Self { cx, lists, which } = self;
        let (mut batch, mut found) = (None, Found::new());
        for (at, &k) in which.iter().enumerate() {
            // SAFETY: the caller's guarantee: no other thread has these lists.
            let list = unsafe { &mut lists.get(k..k + 1)[0] };
            let ends = at + 1 == which.len() || !cx.joins();
            // SAFETY: the caller's guarantee.
            unsafe { of_list::<N, V, W>(cx, list, &mut found, &mut batch, ends) };
        }
    }
}

/// The contacts of a list, which may wait in the batch for those of the next one, unless it `ends`.
#[inline(always)]
unsafe fn of_list<const N: usize, V: Lanes<N>, const W: usize>(
    cx: &Cx,
    list: &mut List,
    found: &mut Found,
    batch: &mut Option<Batch<V, N>>,
    ends: bool,
) {
    list.found([0.0; 6], false, 0);
    found.clear();
    let at = cx.places();
    let (mut k, end) = (0, list.short.i.len());
    loop {
        while k < end && found.len() + FILL <= ROOM {
            let sure = (end - k).min((ROOM - found.len()) / FILL * FILL);
            // SAFETY: lists are padded; entries are grains. There is room for this many.
            unsafe {
                match at.alike {
                    Some(_) => found.test::<N, V, true>(&list.short, &at, cx.span, k..k + sure),
                    None => found.test::<N, V, false>(&list.short, &at, cx.span, k..k + sure),
                }
            }
            k += sure;
        }
        // Pairs that still stick are moved to the front.
        let holding = match cx.span > 0.0 {
            true => found.sift(|k| cx.holds::<W>(&list.short, k as usize)),
            false => found.len(),
        };
        list.touching += holding;
        let ends = ends && k == end;
        if holding > 0 || (ends && batch.as_ref().is_some_and(Batch::waits)) {
            // SAFETY: the caller's guarantee. Created at the first contact: in loose systems most lists have
            // none.
            let batch = match &mut *batch {
                Some(batch) => batch,
                none => none.insert(unsafe { Batch::<V, N>::new(cx.alike) }),
            };
            // SAFETY: the caller's guarantee.
            unsafe { evaluate::<N, V, W>(cx, list, batch, (found, holding), ends) };
        }
        if k == end {
            break;
        }
        found.clear();
    }
}

/// Evaluates the first `holding` contacts found; if it `ends`, none is left waiting.
#[inline(always)]
unsafe fn evaluate<const N: usize, V: Lanes<N>, const W: usize>(
    cx: &Cx,
    list: &mut List,
    batch: &mut Batch<V, N>,
    (found, ready): (&Found, usize),
    ends: bool,
) {
    // SAFETY: the caller's guarantee.
    unsafe {
        if let [law] = &cx.laws.distinct[..] {
            return of_law::<N, V, W>(cx, law, list, batch, (found, 0..ready), ends);
        }
        // The pairs of one law are consecutive in a list.
        let mut from = 0;
        while from < ready {
            let number = law_of(cx, list, found, from);
            let end = (from + 1..ready).find(|at| law_of(cx, list, found, *at) != number).unwrap_or(ready);
            if let Some(law) = cx.laws.distinct.get(usize::from(number)) {
                of_law::<N, V, W>(cx, law, list, batch, (found, from..end), true);
            }
            from = end;
        }
    }
}

/// The law number of one of the contacts found.
#[inline(always)]
fn law_of(cx: &Cx, list: &List, found: &Found, at: usize) -> u8 {
    let k = found.numbers()[at] as usize;
    cx.laws.which(cx.kind[list.short.i[k] as usize], cx.kind[place(list.short.w[k])])
}

/// Contacts of one law.
///
/// # Safety
/// They must be pairs of the list, whose entries must be grains.
#[inline(always)]
unsafe fn of_law<const N: usize, V: Lanes<N>, const W: usize>(
    cx: &Cx,
    law: &Granular,
    list: &mut List,
    batch: &mut Batch<V, N>,
    (found, some): (&Found, Range<usize>),
    ends: bool,
) {
    let many = Many::<N, V, W> { cx, list, batch, found, some, ends };
    if W == 4 && V::Row::FAST { law.within(many) } else { many.run(law) }
}

/// The loop over contacts of one law, several at a time.
struct Many<'a, 'b, const N: usize, V, const W: usize> {
    cx: &'a Cx<'b>,
    list: &'a mut List,
    batch: &'a mut Batch<V, N>,
    found: &'a Found,
    /// The contacts of this law among those found.
    some: Range<usize>,
    ends: bool,
}

impl<const N: usize, V: Lanes<N>, const W: usize> Loop for Many<'_, '_, N, V, W> {
    #[inline(always)]
    fn run(self, law: &Granular) {
        let Self { cx, list, batch, found, some: Range { start: mut taken, end }, ends } = self;
        loop {
            // SAFETY: they are pairs of the list, and its entries are grains; lists do not change while
            // contacts are evaluated.
            unsafe {
                taken += batch.take::<W>(&mut list.short, found, taken..end);
                if !(batch.is_full() || (ends && batch.waits())) {
                    return;
                }
                batch.run::<W>(cx, law, list);
            }
        }
    }
}
