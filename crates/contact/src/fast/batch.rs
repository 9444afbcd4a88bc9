//! Contacts that are evaluated together, stage by stage: collection, geometry, law, sums to memory.

use super::Alike;
use super::found::Found;
use super::lists::{FILL, List, Short};
use super::sweep::Cx;
use crate::{Ends, Geometry, Granular, Motion};
use perigrain_base::math::lanes::{Lanes, load_rows, place, store_rows};
use perigrain_base::math::vec3::{SIX, Vec3, dot, scale, sub};
use perigrain_base::par;
use rooms::{Outgoing, Room};
use sizes::{Sizes, beside_frozen, geometry, reduced, too_deep};
use std::mem::MaybeUninit;
use std::ops::Range;

mod rooms;
mod sizes;

/// Contacts that go through each stage of the evaluation before the next stage begins. A processor looks
/// ahead over some five hundred instructions: stages are short enough to overlap several groups of contacts,
/// which hides the latency of roots and divisions.
pub(super) const BATCH: usize = 64;
/// The largest number of groups in a batch.
const GROUPS: usize = BATCH / 4;

/// Contacts that pass through the stages together, possibly from several lists; the last one is repeated up
/// to a full group.
pub(super) struct Batch<V, const N: usize> {
    /// Number of contacts waiting to be evaluated.
    waiting: usize,
    /// Pointers to their histories.
    past: [*mut f64; BATCH],
    i: [u32; BATCH],
    j: [u32; BATCH],
    /// The second grains with their images.
    w: [u32; BATCH],
    /// x_i − x_j, coordinate by coordinate [length].
    apart: MaybeUninit<[[f64; BATCH + FILL]; 3]>,
    geometry: Room<Geometry<V>>,
    /// Radii and derived sizes of two grains, if all grains have one radius.
    sizes: Option<Sizes<V>>,
    /// Reduced mass, if all grains have one mass.
    mass: Option<V>,
    /// Force on i [force].
    force: Room<Outgoing<N>>,
    /// Torques on i and on j, each about its centre [force × length].
    torque: Room<[Outgoing<N>; 2]>,
    /// Normal damping force and tangential force on i, for the energy ledger [force].
    deeds: Room<[Outgoing<N>; 2]>,
}

impl<V: Lanes<N>, const N: usize> Batch<V, N> {
    /// An empty batch.
    ///
    /// # Safety
    /// The processor must support the form.
    #[inline(always)]
    #[allow(clippy::manual_map)] // closures are not compiled for AVX
    pub unsafe fn new(alike: Alike) -> Self {
        // SAFETY: the caller's guarantee.
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

    /// Whether any contacts are waiting.
    pub fn waits(&self) -> bool {
        self.waiting > 0
    }

    /// Whether the batch is full.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.waiting == BATCH
    }

    /// Takes as many of these pairs of a short list as fit; returns their number.
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
            // SAFETY: the caller's guarantee; there is room for all of them.
            unsafe {
                *self.i.get_unchecked_mut(at) = *short.i.as_ptr().add(k);
                let w = *short.w.as_ptr().add(k);
                *self.w.get_unchecked_mut(at) = w;
                *self.j.get_unchecked_mut(at) = place(w) as u32;
                *self.past.get_unchecked_mut(at) = past.add(W * k);
            }
        }
        for d in 0..3 {
            // SAFETY: both have spare lanes at their end.
            unsafe {
                let (from, to) = (found.apart(d).add(which.start), self.apart(d).add(self.waiting));
                for at in (0..taken).step_by(N) {
                    // Lanes beyond the last pair are copied too; their values do not matter.
                    let lanes = from.add(at).cast::<[MaybeUninit<f64>; N]>().read();
                    to.add(at).cast::<[MaybeUninit<f64>; N]>().write(lanes);
                }
            }
        }
        self.waiting += taken;
        taken
    }

    /// Start of the column of x_i − x_j along an axis.
    #[inline(always)]
    fn apart(&mut self, d: usize) -> *mut f64 {
        debug_assert!(d < 3);
        // SAFETY: one of three rows.
        unsafe { self.apart.as_mut_ptr().cast::<f64>().add(d * (BATCH + FILL)) }
    }

    /// Evaluates the law for all waiting contacts, at least one. Sums over them are added to the list of the
    /// last ones.
    ///
    /// # Safety
    /// Entries of their lists must be grains.
    #[inline(always)]
    pub unsafe fn run<const W: usize>(&mut self, cx: &Cx, law: &Granular, list: &mut List) {
        let count = std::mem::take(&mut self.waiting);
        // SAFETY: the caller's guarantee.
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
                self.book(deeds, count);
                if law.flows() {
                    self.book_flow::<W>(cx, &deeds[2], law, count, list);
                }
            }
        }
    }

    /// Repeats the last contact up to a full group.
    #[inline(always)]
    unsafe fn fill_up(&mut self, count: usize) {
        for at in count..count.next_multiple_of(N) {
            // SAFETY: the caller's guarantee; the batch has room for whole groups.
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

    /// First stage: geometry of the contacts; returns whether some overlap too deeply. With many grains, the
    /// second grains lie in distant memory, in neighbouring tiles: each stage prefetches what the next one
    /// needs.
    #[inline(always)]
    unsafe fn meet(&mut self, cx: &Cx, group: usize) -> bool {
        // SAFETY: the caller's guarantee.
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
                (mass, true) => {
                    let (mi, mj) = (V::pick(m, i), V::pick(m, j));
                    let zero = mi.like(0.0);
                    // Two frozen grains seldom touch in a group: tags are looked at where they do.
                    let both = V::both(zero.above(mi), zero.above(mj));
                    let side = if V::mask_bits(both) == 0 { zero } else { self.sides(cx, N * group) };
                    beside_frozen(mi, mj, side, mass)
                }
            };
            let g = geometry([x, y, z], &sizes, mass);
            self.geometry.put(group, g);
            V::any(too_deep(&g))
        }
    }

    /// Second stage: forces, torques and histories.
    #[inline(always)]
    unsafe fn act<const W: usize>(&mut self, cx: &Cx, law: &Granular, memory: usize, group: usize) {
        // SAFETY: the caller's guarantee.
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
            let mut ends = Ends::none(g.overlap);
            if law.needs_ends() {
                ends = self.ends(cx, g, at);
            }
            let wrench = law.contact_of(g, [&own, &other], ends, &mut history[..memory], cx.step);
            self.force.put(group, Outgoing::of(wrench.force));
            self.torque.put(group, [Outgoing::of(wrench.torque_i), Outgoing::of(wrench.torque_j)]);
            if cx.deeds.is_some() {
                // Evaluates the law's force again from the updated history.
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
                // Lanes without a contact repeat the last one and would write identical values.
                store_rows(past, part, four);
            }
        }
    }

    /// 1 where the first grain has the smaller tag, −1 where the second one has it.
    ///
    /// # Safety
    /// There must be such contacts, whose entries are grains.
    #[inline(never)]
    unsafe fn sides(&self, cx: &Cx, at: usize) -> V {
        let mut side = [0.0; N];
        for lane in 0..N {
            let [i, j] = [self.i[at + lane], self.j[at + lane]].map(|k| k as usize);
            side[lane] = if cx.tag[i] <= cx.tag[j] { 1.0 } else { -1.0 };
        }
        // SAFETY: the caller's guarantee.
        unsafe { V::of(side) }
    }

    /// The sides of some contacts; not inlined, so that laws without torques in their history do not pay for it.
    ///
    /// # Safety
    /// There must be such contacts, whose entries are grains.
    #[inline(never)]
    unsafe fn ends(&self, cx: &Cx, g: &Geometry<V>, at: usize) -> Ends<V> {
        let (mut inertia, mut side) = ([0.0; N], [0.0; N]);
        for lane in 0..N {
            // SAFETY: the caller's guarantee.
            let radii = unsafe { [number(&g.radii[0], lane), number(&g.radii[1], lane)] };
            let [i, j] = [self.i[at + lane], self.j[at + lane]].map(|k| k as usize);
            // Negative masses are those of frozen grains.
            let masses = [i, j].map(|k| if cx.mass[k] < 0.0 { f64::INFINITY } else { cx.mass[k] });
            inertia[lane] = Ends::of_spheres(radii, masses).inertia;
            side[lane] = if cx.tag[i] <= cx.tag[j] { 1.0 } else { -1.0 };
        }
        // SAFETY: the caller's guarantee.
        unsafe { Ends { inertia: V::of(inertia), side: V::of(side) } }
    }

    /// Last stage: adds the forces and torques of one contact.
    #[inline(always)]
    unsafe fn add(&self, cx: &Cx, group: usize, lane: usize) {
        let (f, t): (*mut f64, *mut f64) = (cx.force.as_ptr().cast(), cx.torque.as_ptr().cast());
        // SAFETY: the caller's guarantee.
        unsafe {
            let at = N * group + lane;
            let (i, j) = (*self.i.get_unchecked(at), *self.j.get_unchecked(at));
            self.force.at(group).act::<V::Pair>(f, lane, i, j);
            let [own, other] = self.torque.at(group);
            own.add::<V::Pair>(t, lane, i);
            other.add::<V::Pair>(t, lane, j);
        }
    }

    /// Adds the work of the first contacts to the sums of the energy ledger.
    #[inline(always)]
    unsafe fn book(&self, deeds: &[par::Shared<Vec3>; 3], count: usize) {
        let (damping, across): (*mut f64, *mut f64) = (deeds[0].as_ptr().cast(), deeds[1].as_ptr().cast());
        for at in 0..count {
            let (group, lane) = (at / N, at % N);
            // SAFETY: the caller's guarantee; all of them have been evaluated.
            unsafe {
                let (i, j) = (*self.i.get_unchecked(at), *self.j.get_unchecked(at));
                let [along, beside] = self.deeds.at(group);
                along.act::<V::Pair>(damping, lane, i, j);
                beside.act::<V::Pair>(across, lane, i, j);
            }
        }
    }

    /// Adds Σ d ⊗ F of the first contacts, which must have passed all stages.
    unsafe fn add_virial(&mut self, count: usize, sum: &mut [f64; 6]) {
        for at in 0..count {
            let (group, lane) = (at / N, at % N);
            // SAFETY: the caller's guarantee.
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
    /// Geometry of a contact that has passed the first stage.
    ///
    /// # Safety
    /// There must be such a contact.
    #[inline]
    unsafe fn geometry_of(&self, at: usize) -> Geometry {
        // SAFETY: the caller's guarantee.
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

    /// Adds the elastic forces and the stored energy of a dissipative law, for the first contacts, which must
    /// have been evaluated: scalar code and not inlined, as for heat.
    #[inline(never)]
    unsafe fn book_flow<const W: usize>(
        &self,
        cx: &Cx,
        pressing: &par::Shared<Vec3>,
        law: &Granular,
        count: usize,
        list: &mut List,
    ) {
        let none = [0.0; W];
        for at in 0..count {
            // SAFETY: the caller's guarantee: each contact has its own history row and two grains, which no
            // other thread accesses now.
            unsafe {
                let g = self.geometry_of(at);
                let row = std::slice::from_raw_parts(self.past[at], W);
                // Where nothing was stored, the row may be that of an earlier contact.
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

    /// Adds the heat flow through the first contacts, which must have passed the first stage: scalar code and
    /// not inlined, so that systems without heat do not pay for it.
    #[inline(never)]
    unsafe fn add_heat(&self, cx: &Cx, law: &Granular, count: usize) {
        let Some((temperature, flow)) = &cx.heat else { return };
        for at in 0..count {
            // SAFETY: the caller's guarantee; entries are grains, and the caller keeps other threads away.
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

/// Prefetches the memory at this address, where the processor supports it; nothing is read.
#[inline(always)]
fn fetch<T>(at: *const T) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: any address is allowed, because nothing is read.
    unsafe {
        std::arch::x86_64::_mm_prefetch::<{ std::arch::x86_64::_MM_HINT_T0 }>(at.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = at;
}

/// One number of a lane vector, for code that is not compiled for the lanes' instruction set.
///
/// # Safety
/// There must be such a lane.
#[inline]
unsafe fn number<V: Lanes<N>, const N: usize>(lanes: &V, lane: usize) -> f64 {
    const { assert!(size_of::<V>() == N * size_of::<f64>()) };
    // SAFETY: lanes are this many consecutive numbers.
    unsafe { *(&raw const *lanes).cast::<f64>().add(lane) }
}
