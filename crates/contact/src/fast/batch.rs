//! Contacts that are evaluated together, stage by stage: who they are, where they touch, what the law says, sums to memory.

use super::Alike;
use super::found::Found;
use super::lists::{FILL, List, Short};
use super::sweep::Cx;
use crate::{Geometry, Granular, Motion};
use perigrain_base::math::lanes::{Lanes, load_rows, place, store_rows};
use perigrain_base::math::vec3::{SIX, Vec3, dot, scale, sub};
use perigrain_base::par;
use rooms::{Outgoing, Room};
use sizes::{Sizes, beside_frozen, geometry, reduced, too_deep};
use std::mem::MaybeUninit;
use std::ops::Range;

mod rooms;
mod sizes;

/// How many contacts go through each stage of the evaluation before the next stage begins. A processor looks ahead over some
/// five hundred instructions: stages are so short that several groups of contacts are under way in each of them, and nobody
/// waits for roots and quotients.
pub(super) const BATCH: usize = 64;
/// The most groups of a batch.
const GROUPS: usize = BATCH / 4;

/// Contacts that go from stage to stage together, perhaps of several lists; what is past the last one repeats it up to a full
/// group.
pub(super) struct Batch<V, const N: usize> {
    /// How many wait to be evaluated.
    waiting: usize,
    /// What each remembers.
    past: [*mut f64; BATCH],
    i: [u32; BATCH],
    j: [u32; BATCH],
    /// Which images the second ones are, with their places.
    w: [u32; BATCH],
    /// x_i − x_j, coordinate by coordinate [length].
    apart: MaybeUninit<[[f64; BATCH + FILL]; 3]>,
    geometry: Room<Geometry<V>>,
    /// Of two grains, where all have one radius.
    sizes: Option<Sizes<V>>,
    /// The reduced mass, where all have one mass.
    mass: Option<V>,
    /// On i [force].
    force: Room<Outgoing<N>>,
    /// On i and on j, each about its centre [force × length].
    torque: Room<[Outgoing<N>; 2]>,
    /// Of the force on i, damping along the normal and what acts across it, where the ledger of energy asks [force].
    deeds: Room<[Outgoing<N>; 2]>,
}

impl<V: Lanes<N>, const N: usize> Batch<V, N> {
    /// Without contacts.
    ///
    /// # Safety
    /// The processor must have what the form needs.
    #[inline(always)]
    #[allow(clippy::manual_map)] // closures are not compiled for AVX
    pub unsafe fn new(alike: Alike) -> Self {
        // SAFETY: passed on.
        let (sizes, mass) = unsafe {
            let sizes = match alike.radius {
                Some(radius) => Some(Sizes::of([V::all(radius); 2])),
                None => None,
            };
            let mass = match alike.mass {
                Some(mass) => Some(reduced(V::all(mass), V::all(mass))),
                None => None,
            };
            (sizes, mass)
        };
        Self {
            waiting: 0,
            past: [std::ptr::null_mut(); BATCH],
            i: [0; BATCH],
            j: [0; BATCH],
            w: [0; BATCH],
            apart: MaybeUninit::uninit(),
            geometry: Room::new(),
            sizes,
            mass,
            force: Room::new(),
            torque: Room::new(),
            deeds: Room::new(),
        }
    }

    /// Whether some wait to be evaluated.
    pub fn waits(&self) -> bool {
        self.waiting > 0
    }

    /// Whether there is no room for more.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.waiting == BATCH
    }

    /// Takes as many of these pairs of a short list as there is room for; how many.
    ///
    /// # Safety
    /// They must be pairs of the list, which must not change until they have been evaluated.
    #[inline(always)]
    pub unsafe fn take<const W: usize>(
        &mut self,
        short: &mut Short,
        found: &Found,
        which: Range<usize>,
    ) -> usize {
        let taken = which.len().min(BATCH - self.waiting);
        let which = which.start..which.start + taken;
        let past = short.history.as_mut_ptr();
        for (at, k) in (self.waiting..).zip(&found.numbers()[which.clone()]) {
            let k = *k as usize;
            // SAFETY: passed on; there is room for all of them.
            unsafe {
                *self.i.get_unchecked_mut(at) = *short.i.as_ptr().add(k);
                let w = *short.w.as_ptr().add(k);
                *self.w.get_unchecked_mut(at) = w;
                *self.j.get_unchecked_mut(at) = place(w) as u32;
                *self.past.get_unchecked_mut(at) = past.add(W * k);
            }
        }
        for d in 0..3 {
            // SAFETY: behind both there is room for some lanes.
            unsafe {
                let (from, to) = (found.apart(d).add(which.start), self.apart(d).add(self.waiting));
                for at in (0..taken).step_by(N) {
                    // What stands behind the last one is copied as well, whatever it is.
                    let lanes = from.add(at).cast::<[MaybeUninit<f64>; N]>().read();
                    to.add(at).cast::<[MaybeUninit<f64>; N]>().write(lanes);
                }
            }
        }
        self.waiting += taken;
        taken
    }

    /// Where x_i − x_j begins along an axis.
    #[inline(always)]
    fn apart(&mut self, d: usize) -> *mut f64 {
        debug_assert!(d < 3);
        // SAFETY: one of three rows.
        unsafe { self.apart.as_mut_ptr().cast::<f64>().add(d * (BATCH + FILL)) }
    }

    /// Evaluates the law for those that wait, at least one. What they are in sum is told to the list of the last ones.
    ///
    /// # Safety
    /// Entries of their lists must be grains.
    #[inline(always)]
    pub unsafe fn run<const W: usize>(&mut self, cx: &Cx, law: &Granular, list: &mut List) {
        let count = std::mem::take(&mut self.waiting);
        // SAFETY: passed on.
        unsafe {
            self.fill_up(count);
            for group in 0..count.div_ceil(N) {
                list.deep |= self.meet(cx, group);
            }
            let memory = law.memory();
            for group in 0..count.div_ceil(N) {
                self.act::<W>(cx, law, memory, group);
            }
            if cx.virial {
                self.add_virial(count, &mut list.virial);
            }
            if cx.heat.is_some() {
                self.add_heat(cx, law, count);
            }
            for group in 0..count / N {
                for lane in 0..N {
                    self.add(cx, group, lane);
                }
            }
            for lane in 0..count % N {
                self.add(cx, count / N, lane);
            }
            if let Some(deeds) = &cx.deeds {
                self.tell(deeds, count);
                if law.flows() {
                    self.tell_flow::<W>(cx, &deeds[2], law, count, list);
                }
            }
        }
    }

    /// Repeats the last contact up to a full group.
    #[inline(always)]
    unsafe fn fill_up(&mut self, count: usize) {
        for at in count..count.next_multiple_of(N) {
            // SAFETY: passed on; the batch has room for whole groups.
            unsafe {
                *self.i.get_unchecked_mut(at) = *self.i.get_unchecked(count - 1);
                *self.j.get_unchecked_mut(at) = *self.j.get_unchecked(count - 1);
                *self.w.get_unchecked_mut(at) = *self.w.get_unchecked(count - 1);
                *self.past.get_unchecked_mut(at) = *self.past.get_unchecked(count - 1);
                for d in 0..3 {
                    *self.apart(d).add(at) = *self.apart(d).add(count - 1);
                }
            }
        }
    }

    /// First stage: where and how grains touch. Whether some overlap too far. Where grains are many, what later stages read of the second
    /// ones comes from afar, from tiles beside: each stage asks for what the next one will want.
    #[inline(always)]
    unsafe fn meet(&mut self, cx: &Cx, group: usize) -> bool {
        // SAFETY: passed on.
        unsafe {
            let (i, j) = (self.i.as_ptr().add(N * group), self.j.as_ptr().add(N * group));
            if cx.are_many {
                for lane in 0..N {
                    let j = *j.add(lane) as usize;
                    fetch(cx.v.as_ptr().wrapping_add(j));
                    fetch(cx.omega.as_ptr().wrapping_add(j));
                    fetch(*self.past.get_unchecked(N * group + lane));
                }
            }
            let [p, q, r] = [self.apart(0), self.apart(1), self.apart(2)];
            let (p, q, r) = (p.add(N * group).cast(), q.add(N * group).cast(), r.add(N * group).cast());
            let [x, y, z] = [V::of(*p), V::of(*q), V::of(*r)];
            let (r, m) = (cx.radius.as_ptr(), cx.mass.as_ptr());
            let sizes = match self.sizes {
                Some(sizes) => sizes,
                None => Sizes::of([V::pick(r, i), V::pick(r, j)]),
            };
            let mass = match (self.mass, cx.frozen) {
                (Some(mass), false) => mass,
                (None, false) => reduced(V::pick(m, i), V::pick(m, j)),
                (mass, true) => beside_frozen(V::pick(m, i), V::pick(m, j), mass),
            };
            let g = geometry([x, y, z], &sizes, mass);
            self.geometry.put(group, g);
            V::any(too_deep(&g))
        }
    }

    /// Second stage: forces, torques and what is remembered.
    #[inline(always)]
    unsafe fn act<const W: usize>(&mut self, cx: &Cx, law: &Granular, memory: usize, group: usize) {
        // SAFETY: passed on.
        unsafe {
            let at = N * group;
            let (i, j) = (self.i.as_ptr().add(at), self.j.as_ptr().add(at));
            let past = &*self.past.as_ptr().add(at).cast::<[*mut f64; N]>();
            // (No closures in here: they are not compiled for AVX.)
            if cx.are_many {
                for lane in 0..N {
                    let j = *j.add(lane) as usize;
                    fetch(cx.force.as_ptr().wrapping_add(j));
                    fetch(cx.torque.as_ptr().wrapping_add(j));
                }
            }
            let (v, spin) = (cx.v.as_ptr(), cx.omega.as_ptr());
            let own = Motion { velocity: V::vectors(v, i), spin: V::vectors(spin, i) };
            let mut other = Motion { velocity: V::vectors(v, j), spin: V::vectors(spin, j) };
            if let Some(drift) = cx.drift {
                let added = drift.added::<N>(i, self.w.as_ptr().add(at));
                for d in 0..3 {
                    other.velocity[d] = other.velocity[d] + V::of(added[d]);
                }
            }

            let mut history = [V::all(0.0); W];
            for part in (0..W).step_by(4) {
                [history[part], history[part + 1], history[part + 2], history[part + 3]] =
                    load_rows(past, part);
            }
            let lasts = history[W - 1].above(V::all(cx.now - 0.5));
            for part in 0..W - 1 {
                history[part] = V::choose(lasts, history[part], V::all(0.0));
            }

            let g = self.geometry.at(group);
            let wrench = law.contact(g, &own, &other, &mut history[..memory], cx.step);
            self.force.put(group, Outgoing::of(wrench.force));
            self.torque.put(group, [Outgoing::of(wrench.torque_i), Outgoing::of(wrench.torque_j)]);
            if cx.deeds.is_some() {
                // The force of the law once more, from what it remembers now.
                let (mut now, n) = (history, g.normal);
                let central = dot(wrench.force, n);
                let damping = scale(central - law.push(g, &mut now[..memory]), n);
                let across = sub(wrench.force, scale(central, n));
                self.deeds.put(group, [Outgoing::of(damping), Outgoing::of(across)]);
            }
            if !cx.store {
                return;
            }
            history[W - 1] = V::all(cx.now + 1.0);
            for part in (0..W).step_by(4) {
                let four = [history[part], history[part + 1], history[part + 2], history[part + 3]];
                // Lanes without a contact repeat the last one, in whose place they would write the same.
                store_rows(past, part, four);
            }
        }
    }

    /// Last stage: adds the forces and torques of one contact.
    #[inline(always)]
    unsafe fn add(&self, cx: &Cx, group: usize, lane: usize) {
        let (f, t): (*mut f64, *mut f64) = (cx.force.as_ptr().cast(), cx.torque.as_ptr().cast());
        // SAFETY: passed on.
        unsafe {
            let at = N * group + lane;
            let (i, j) = (*self.i.get_unchecked(at), *self.j.get_unchecked(at));
            self.force.at(group).act::<V::Pair>(f, lane, i, j);
            let [own, other] = self.torque.at(group);
            own.add::<V::Pair>(t, lane, i);
            other.add::<V::Pair>(t, lane, j);
        }
    }

    /// Adds what the first contacts did to the sums of the ledger of energy.
    #[inline(always)]
    unsafe fn tell(&self, deeds: &[par::Shared<Vec3>; 3], count: usize) {
        let (damping, across): (*mut f64, *mut f64) = (deeds[0].as_ptr().cast(), deeds[1].as_ptr().cast());
        for at in 0..count {
            let (group, lane) = (at / N, at % N);
            // SAFETY: passed on; all of them have acted.
            unsafe {
                let (i, j) = (*self.i.get_unchecked(at), *self.j.get_unchecked(at));
                let [along, beside] = self.deeds.at(group);
                along.act::<V::Pair>(damping, lane, i, j);
                beside.act::<V::Pair>(across, lane, i, j);
            }
        }
    }

    /// Adds Σ d ⊗ F of the first contacts, which must have gone through all stages.
    unsafe fn add_virial(&mut self, count: usize, sum: &mut [f64; 6]) {
        for at in 0..count {
            let (group, lane) = (at / N, at % N);
            // SAFETY: the caller's promise.
            let d = unsafe { [0, 1, 2].map(|k| *self.apart(k).add(at)) };
            // SAFETY: as above.
            let force = unsafe { self.force.at(group) };
            let f = force.numbers(lane);
            for (s, (a, b)) in sum.iter_mut().zip(SIX) {
                *s += d[a] * f[b];
            }
        }
    }
}

impl<V: Lanes<N>, const N: usize> Batch<V, N> {
    /// How one of the contacts touches that have been met.
    ///
    /// # Safety
    /// There must be such a contact.
    #[inline]
    unsafe fn geometry_of(&self, at: usize) -> Geometry {
        // SAFETY: passed on.
        unsafe {
            let (g, lane) = (self.geometry.at(at / N), at % N);
            Geometry {
                normal: [0, 1, 2].map(|k| number(&g.normal[k], lane)),
                overlap: number(&g.overlap, lane),
                radii: [number(&g.radii[0], lane), number(&g.radii[1], lane)],
                curvature: number(&g.curvature, lane),
                mass: number(&g.mass, lane),
            }
        }
    }

    /// Adds the elastic forces of a law that flows, and what its contacts hold, of the first ones, which must have acted: in plain
    /// numbers and out of line, as with heat.
    #[inline(never)]
    unsafe fn tell_flow<const W: usize>(
        &self,
        cx: &Cx,
        pressing: &par::Shared<Vec3>,
        law: &Granular,
        count: usize,
        list: &mut List,
    ) {
        let none = [0.0; W];
        for at in 0..count {
            // SAFETY: the caller's promise: each contact has a row of memory and two grains of its own, which no other thread touches
            // now.
            unsafe {
                let g = self.geometry_of(at);
                let row = std::slice::from_raw_parts(self.past[at], W);
                // Where nothing was stored the row may be that of an earlier contact.
                let lasts = row[W - 1] > cx.now - 0.5;
                let history = if lasts { &row[..law.memory()] } else { &none[..law.memory()] };
                let [push, held] = law.pressing(&g, history);
                list.held += held;
                let (i, j) = (self.i[at] as usize, self.j[at] as usize);
                for d in 0..3 {
                    (*pressing.as_ptr().add(i))[d] += push * g.normal[d];
                    (*pressing.as_ptr().add(j))[d] -= push * g.normal[d];
                }
            }
        }
    }

    /// Adds the heat through the first contacts, which must have been met: in plain numbers and out of line, so that scenes
    /// without heat do not carry it.
    #[inline(never)]
    unsafe fn add_heat(&self, cx: &Cx, law: &Granular, count: usize) {
        let Some((temperature, flow)) = &cx.heat else { return };
        for at in 0..count {
            // SAFETY: the caller's promise; entries are grains, and the caller keeps other threads away.
            unsafe {
                let geometry = self.geometry_of(at);
                let (i, j) = (self.i[at] as usize, self.j[at] as usize);
                let into = law.conductance(&geometry) * (temperature[j] - temperature[i]);
                *flow.as_ptr().add(i) += into;
                *flow.as_ptr().add(j) -= into;
            }
        }
    }
}

/// Has the memory at this address brought near, where the processor can do that; nothing is read.
#[inline(always)]
fn fetch<T>(at: *const T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: no address is wrong: nothing is read from it.
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(at.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = at;
}

/// One of the numbers in lanes, where lanes are not compiled for the processor.
///
/// # Safety
/// There must be such a lane.
#[inline]
unsafe fn number<V: Lanes<N>, const N: usize>(lanes: &V, lane: usize) -> f64 {
    const { assert!(size_of::<V>() == N * size_of::<f64>()) };
    // SAFETY: lanes are so many numbers, one behind the other.
    unsafe { *(&raw const *lanes).cast::<f64>().add(lane) }
}
