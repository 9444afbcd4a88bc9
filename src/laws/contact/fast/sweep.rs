//! The inner loops: distances four at a time, contacts four at a time, forces into the records.

use super::group::{Group, one};
use super::lists::{Short, Slab};
use super::near::{self, Places, grain};
use super::{Fast, Laws, NONE, has_avx2};
use crate::laws::contact::driver::Grains;
use crate::laws::contact::{Advance, ContactLaw, Loop};
use crate::math::four::{Four, Lanes, Plain};
use crate::math::vec3::Vec3;
use crate::par;
use std::marker::PhantomData;

/// Hits that laws are evaluated for at a time where there are several laws: part of the order of additions.
const BLOCK: usize = 64;
/// Room for hits: some blocks and what a test may put behind them.
const ROOM: usize = 4 * BLOCK;
/// How many hits ahead memory is asked for.
const AHEAD: usize = 12;

/// Most contacts evaluated at a time.
const MOST: usize = 8;

/// How many contacts are evaluated at a time; all have the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// Eight, with AVX-512.
    Eight,
    /// Four, with AVX2.
    Four,
    /// Four, on any processor.
    Plain,
}

impl Form {
    /// The widest one of this processor.
    fn here() -> Self {
        #[cfg(target_arch = "x86_64")]
        if crate::math::four::has_avx512() {
            return Self::Eight;
        }
        if has_avx2() { Self::Four } else { Self::Plain }
    }
}

/// What the loops read and where they write.
pub(super) struct Cx<'a, L> {
    pub laws: &'a Laws<L>,
    pub x: &'a [Vec3],
    pub v: &'a [Vec3],
    pub omega: &'a [Vec3],
    pub radius: &'a [f64],
    pub mass: &'a [f64],
    pub kind: &'a [u16],
    pub shifts: &'a [[f64; 4]; 32],
    pub force: par::Shared<'a, Vec3>,
    pub torque: par::Shared<'a, Vec3>,
    pub step: Advance,
    pub now: f64,
    pub store: bool,
    pub virial: bool,
    /// Whether some grains are frozen.
    pub frozen: bool,
    /// How far apart surfaces of grains that stick together can be [length].
    pub span: f64,
}

impl<L> Cx<'_, L> {
    /// Where grains are.
    pub fn places(&self) -> Places<'_> {
        Places { x: self.x, radius: self.radius, shifts: self.shifts }
    }
}

impl<L: ContactLaw> Cx<'_, L> {
    /// Puts those hits first that touch, or have touched in the last step and still hold together; how many they are.
    fn holding<const W: usize>(&self, short: &Short, hits: &mut [u32]) -> usize {
        let mut count = 0;
        for at in 0..hits.len() {
            let k = hits[at];
            hits[count] = k;
            count += usize::from(self.holds::<W>(short, k as usize));
        }
        count
    }

    fn holds<const W: usize>(&self, short: &Short, k: usize) -> bool {
        let (i, w) = (short.i[k] as usize, short.w[k]);
        let (j, d) = (grain(w), self.places().between(i, w));
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

impl<L: ContactLaw> Fast<L> {
    /// Adds up the forces of all contacts.
    pub(super) fn sweep(
        &mut self,
        grains: &Grains,
        [f, torque]: [&mut [Vec3]; 2],
        step: Advance,
        store: bool,
        virial: bool,
    ) {
        let (width, form) = (self.width, Form::here());
        let mut lists = std::mem::take(&mut self.lists);
        let slabs = par::Shared::new(&mut lists);
        let cx = Cx {
            laws: &self.laws,
            x: grains.x,
            v: grains.v,
            omega: grains.omega,
            radius: grains.radius,
            mass: if self.signed.is_empty() { grains.mass } else { &self.signed },
            kind: grains.kind,
            shifts: &self.shifts,
            force: par::Shared::new(f),
            torque: par::Shared::new(torque),
            step,
            now: self.now,
            store,
            virial,
            frozen: !self.signed.is_empty(),
            span: self.span,
        };
        par::two_colours(slabs.len(), |k| {
            // SAFETY: each part writes its own slab, and forces of grains in it and the next one, which two_colours keeps
            // apart; list entries are grains; AVX only where there is AVX.
            unsafe {
                let slab = &mut slabs.get(k..k + 1)[0];
                match (width, form) {
                    #[cfg(target_arch = "x86_64")]
                    (4, Form::Eight) => contacts_avx512::<L, 4>(&cx, slab),
                    #[cfg(target_arch = "x86_64")]
                    (_, Form::Eight) => contacts_avx512::<L, 8>(&cx, slab),
                    #[cfg(target_arch = "x86_64")]
                    (4, Form::Four) => contacts_avx2::<L, 4>(&cx, slab),
                    #[cfg(target_arch = "x86_64")]
                    (_, Form::Four) => contacts_avx2::<L, 8>(&cx, slab),
                    (4, _) => contacts::<4, Plain, L, 4>(&cx, slab),
                    _ => contacts::<4, Plain, L, 8>(&cx, slab),
                }
            }
        });
        self.lists = lists;
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn contacts_avx2<L: ContactLaw, const W: usize>(cx: &Cx<L>, slab: &mut Slab) {
    // SAFETY: passed on.
    unsafe { contacts::<4, crate::math::four::Avx2, L, W>(cx, slab) }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,avx512f,avx512dq,avx512vl")]
unsafe fn contacts_avx512<L: ContactLaw, const W: usize>(cx: &Cx<L>, slab: &mut Slab) {
    // SAFETY: passed on.
    unsafe { contacts::<8, crate::math::four::Avx512, L, W>(cx, slab) }
}

/// All contacts of a slab.
#[inline(always)]
unsafe fn contacts<const N: usize, V: Lanes<N>, L: ContactLaw, const W: usize>(cx: &Cx<L>, slab: &mut Slab) {
    (slab.virial, slab.deep) = ([0.0; 6], false);
    let at = cx.places();
    let mut hits = [0; ROOM + AHEAD + MOST];
    let (mut count, mut k, end) = (0, 0, slab.short.i.len());
    loop {
        while k < end && count + 4 <= ROOM {
            // SAFETY: lists are filled up to fours; entries are grains.
            let bits = unsafe {
                let short = &slab.short;
                at.closer::<V::Row>(short.i.as_ptr().add(k), short.w.as_ptr().add(k), cx.span)
            };
            // SAFETY: there is room for four; the next ones overwrite what stands past `count`.
            unsafe { near::put(hits.as_mut_ptr().add(count), bits, k as u32) };
            count += near::count(bits);
            k += 4;
        }
        let ready = if k == end { count } else { count - count % BLOCK };
        // The evaluation writes behind the hits it is given.
        let mut rest = [0; BLOCK];
        rest[..count - ready].copy_from_slice(&hits[ready..count]);
        let holding = if cx.span > 0.0 { cx.holding::<W>(&slab.short, &mut hits[..ready]) } else { ready };
        // SAFETY: passed on.
        unsafe { evaluate::<N, V, L, W>(cx, slab, &mut hits, holding) };
        if k == end {
            break;
        }
        count -= ready;
        hits[..count].copy_from_slice(&rest[..count]);
    }
}

/// The contacts of the first `ready` hits.
#[inline(always)]
unsafe fn evaluate<const N: usize, V: Lanes<N>, L: ContactLaw, const W: usize>(
    cx: &Cx<L>,
    slab: &mut Slab,
    hits: &mut [u32; ROOM + AHEAD + MOST],
    ready: usize,
) {
    // SAFETY: passed on.
    unsafe {
        if let [law] = &cx.laws.distinct[..] {
            return of_law::<N, V, L, W>(cx, law, slab, hits, ready);
        }
        let mut own = [0; BLOCK + AHEAD + MOST];
        for block in hits[..ready].chunks(BLOCK) {
            for (number, law) in cx.laws.distinct.iter().enumerate() {
                let mut count = 0;
                for &k in block {
                    let (i, w) = (slab.short.i[k as usize], slab.short.w[k as usize]);
                    let which = cx.laws.which(cx.kind[i as usize], cx.kind[grain(w)]);
                    own[count] = k;
                    count += usize::from(which != NONE && usize::from(which) == number);
                }
                of_law::<N, V, L, W>(cx, law, slab, &mut own, count);
            }
        }
    }
}

/// Contacts of one law: four at a time or, where the law wants that, one by one.
#[inline(always)]
unsafe fn of_law<const N: usize, V: Lanes<N>, L: ContactLaw, const W: usize>(
    cx: &Cx<L>,
    law: &L,
    slab: &mut Slab,
    hits: &mut [u32],
    count: usize,
) {
    if count == 0 {
        return;
    }
    // What stands behind the last hit is looked at and not used.
    let last = hits[count - 1];
    hits[count..count + AHEAD + MOST].fill(last);
    // SAFETY: passed on.
    unsafe {
        if !law.in_lanes() {
            for k in &hits[..count] {
                one::<L, W>(cx, law, slab, *k as usize);
            }
            return;
        }
        let many = Many::<N, V, L, W> { cx, slab, hits, count, lanes: PhantomData };
        if W == 4 && V::Row::FAST { law.within(many) } else { many.run(law) }
    }
}

/// The loop over contacts of one law, several at a time.
struct Many<'a, 'b, const N: usize, V, L, const W: usize> {
    cx: &'a Cx<'b, L>,
    slab: &'a mut Slab,
    hits: &'a [u32],
    count: usize,
    lanes: PhantomData<V>,
}

impl<const N: usize, V: Lanes<N>, L: ContactLaw, const W: usize> Loop<L> for Many<'_, '_, N, V, L, W> {
    #[inline(always)]
    fn run(self, law: &L) {
        let (cx, hits, memory) = (self.cx, self.hits, law.memory());
        for k in (0..self.count).step_by(N) {
            // SAFETY: hits are pairs of the list, and their entries grains; `of_law` made it.
            unsafe {
                for ahead in &hits[k + AHEAD..k + AHEAD + N] {
                    let j = grain(*self.slab.short.w.as_ptr().add(*ahead as usize));
                    V::Row::prefetch(cx.v.as_ptr().add(j));
                    V::Row::prefetch(cx.omega.as_ptr().add(j));
                    V::Row::prefetch(cx.force.as_ptr().add(j));
                    V::Row::prefetch(cx.torque.as_ptr().add(j));
                    // Few of the near pairs touch: what contacts remember does not come by itself.
                    V::Row::prefetch(self.slab.short.history.as_ptr().add(W * *ahead as usize));
                }
                let group = Group::<N>::load(&self.slab.short, hits.as_ptr().add(k));
                group.act::<V, L, W>(cx, law, memory, self.slab, (self.count - k).min(N));
            }
        }
    }
}
