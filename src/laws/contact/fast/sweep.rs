//! The inner loops: distances four at a time, contacts four at a time, forces into the records.

use super::lists::{Short, Slab};
use super::{Fast, Laws, MOST_MEMORY, NONE, has_avx2};
use crate::laws::contact::driver::{DEEP, Grains};
use crate::laws::contact::{Advance, ContactLaw, Geometry, Loop, Motion, Wrench};
use crate::math::four::{Four, Lanes, Plain};
use crate::math::real::Real;
use crate::math::vec3::Vec3;
use crate::par;
use std::marker::PhantomData;

/// Bits of a list entry that hold a grain; the image stands above them.
pub const PLACE_BITS: u32 = 27;
/// How far the image is shifted.
pub const HERE_BITS: u32 = PLACE_BITS;
/// Hits that laws are evaluated for at a time where there are several laws: part of the order of additions.
const BLOCK: usize = 64;
/// Room for hits: some blocks and what a test may put behind them.
const ROOM: usize = 4 * BLOCK;
/// How many hits ahead memory is asked for.
const AHEAD: usize = 12;

/// By bits of a mask: the lanes that are set, in order.
const LANES: [[u32; 4]; 16] = lanes();

/// By bits of a mask, four bits each: how many lanes are set.
const COUNTS: u64 = 0x4332_3221_3221_2110;

const fn lanes() -> [[u32; 4]; 16] {
    let (mut table, mut bits) = ([[0; 4]; 16], 0);
    while bits < 16 {
        let (mut lane, mut count) = (0, 0);
        while lane < 4 {
            if bits >> lane & 1 == 1 {
                table[bits][count] = lane as u32;
                count += 1;
            }
            lane += 1;
        }
        bits += 1;
    }
    table
}

/// Most contacts evaluated at a time.
const MOST: usize = 8;

/// The grain in a list entry.
#[inline(always)]
pub fn grain(w: u32) -> usize {
    (w & ((1 << PLACE_BITS) - 1)) as usize
}

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
struct Cx<'a, L> {
    laws: &'a Laws<L>,
    x: &'a [Vec3],
    v: &'a [Vec3],
    omega: &'a [Vec3],
    radius: &'a [f64],
    mass: &'a [f64],
    kind: &'a [u16],
    shifts: &'a [[f64; 4]; 32],
    force: par::Shared<'a, Vec3>,
    torque: par::Shared<'a, Vec3>,
    step: Advance,
    now: f64,
    store: bool,
    virial: bool,
    /// Whether some grains are frozen.
    frozen: bool,
}

impl<L> Cx<'_, L> {
    fn places(&self) -> Places<'_> {
        Places { x: self.x, radius: self.radius, shifts: self.shifts }
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

/// Calls `hit` with the numbers of all pairs of the long list whose surfaces are nearer than `thin`, in order.
///
/// # Safety
/// List entries must be grains.
pub unsafe fn near(grains: &Grains, shifts: &[[f64; 4]; 32], slab: &Slab, thin: f64, hit: impl FnMut(u32)) {
    let at = Places { x: grains.x, radius: grains.radius, shifts };
    // SAFETY: passed on.
    unsafe {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            return near_avx2(at, slab, thin, hit);
        }
        near_in::<Plain>(at, slab, thin, hit);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn near_avx2(at: Places, slab: &Slab, thin: f64, hit: impl FnMut(u32)) {
    // SAFETY: passed on.
    unsafe { near_in::<crate::math::four::Avx2>(at, slab, thin, hit) }
}

#[inline(always)]
unsafe fn near_in<F: Four>(at: Places, slab: &Slab, thin: f64, mut hit: impl FnMut(u32)) {
    let list = &slab.long;
    for k in (0..list.i.len()).step_by(4) {
        // SAFETY: lists are filled up to fours; entries are grains.
        let mut bits = unsafe { at.closer::<F>(list.i.as_ptr().add(k), list.w.as_ptr().add(k), thin) };
        while bits != 0 {
            hit(k as u32 + bits.trailing_zeros());
            bits &= bits - 1;
        }
    }
}

/// Where grains are.
#[derive(Clone, Copy)]
struct Places<'a> {
    x: &'a [Vec3],
    radius: &'a [f64],
    shifts: &'a [[f64; 4]; 32],
}

impl Places<'_> {
    /// Which of four pairs have surfaces nearer than `extra`, as bits.
    #[inline(always)]
    unsafe fn closer<F: Four>(&self, i: *const u32, w: *const u32, extra: f64) -> u32 {
        // SAFETY: passed on.
        unsafe {
            let rows = [
                self.apart(*i, *w),
                self.apart(*i.add(1), *w.add(1)),
                self.apart(*i.add(2), *w.add(2)),
                self.apart(*i.add(3), *w.add(3)),
            ];
            let [x, y, z, _]: [F; 4] = F::transpose(rows);
            let r = self.radius.as_ptr();
            let own = [
                *r.add(*i as usize),
                *r.add(*i.add(1) as usize),
                *r.add(*i.add(2) as usize),
                *r.add(*i.add(3) as usize),
            ];
            let other = [
                *r.add(grain(*w)),
                *r.add(grain(*w.add(1))),
                *r.add(grain(*w.add(2))),
                *r.add(grain(*w.add(3))),
            ];
            let reach = F::load(own.as_ptr()) + F::load(other.as_ptr()) + extra;
            F::bits((reach * reach).above(x * x + y * y + z * z))
        }
    }

    /// x_i − x_j.
    #[inline(always)]
    unsafe fn apart<F: Four>(&self, i: u32, w: u32) -> F {
        // SAFETY: passed on.
        unsafe {
            let a = F::load3(self.x.as_ptr().add(i as usize).cast());
            let b = F::load3(self.x.as_ptr().add(grain(w)).cast());
            let shift = F::load(self.shifts.as_ptr().add((w >> HERE_BITS) as usize).cast());
            a - (b + shift)
        }
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
                at.closer::<V::Row>(short.i.as_ptr().add(k), short.w.as_ptr().add(k), 0.0)
            };
            // Writes past `count` do no harm: the next ones overwrite them.
            let [a, b, c, d] = LANES[bits as usize & 15];
            let k32 = k as u32;
            hits[count..count + 4].copy_from_slice(&[k32 + a, k32 + b, k32 + c, k32 + d]);
            count += (COUNTS >> (4 * bits) & 15) as usize;
            k += 4;
        }
        let ready = if k == end { count } else { count - count % BLOCK };
        // The evaluation writes behind the hits it is given.
        let mut rest = [0; BLOCK];
        rest[..count - ready].copy_from_slice(&hits[ready..count]);
        // SAFETY: passed on.
        unsafe { evaluate::<N, V, L, W>(cx, slab, &mut hits, ready) };
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

/// Contacts that are evaluated together: their pairs. (Loops, no closures: those are not inlined into code for AVX.)
struct Group<const N: usize> {
    k: [usize; N],
    i: [usize; N],
    j: [usize; N],
    w: [u32; N],
}

impl<const N: usize> Group<N> {
    #[inline(always)]
    unsafe fn load(short: &Short, hits: *const u32) -> Self {
        let mut g = Self { k: [0; N], i: [0; N], j: [0; N], w: [0; N] };
        for lane in 0..N {
            // SAFETY: passed on.
            unsafe {
                let k = *hits.add(lane) as usize;
                let w = *short.w.as_ptr().add(k);
                (g.k[lane], g.w[lane], g.j[lane]) = (k, w, grain(w));
                g.i[lane] = *short.i.as_ptr().add(k) as usize;
            }
        }
        g
    }

    /// Vectors of these grains, turned into lanes.
    #[inline(always)]
    unsafe fn vectors<V: Lanes<N>>(p: &[Vec3], at: &[usize; N]) -> Vec3<V> {
        // SAFETY: passed on.
        unsafe {
            let mut rows = [V::Row::splat(0.0); N];
            for lane in 0..N {
                rows[lane] = V::Row::load3(p.as_ptr().add(at[lane]).cast());
            }
            let [x, y, z, _] = V::of_rows(rows);
            [x, y, z]
        }
    }

    /// Numbers of these grains in lanes.
    #[inline(always)]
    unsafe fn numbers<V: Lanes<N>>(p: &[f64], at: &[usize; N]) -> V {
        // SAFETY: passed on.
        unsafe {
            let mut a = [0.0; N];
            for lane in 0..N {
                a[lane] = *p.as_ptr().add(at[lane]);
            }
            V::of(a)
        }
    }

    /// Four numbers from `part` on of records of `width` numbers, turned into lanes.
    #[inline(always)]
    unsafe fn records<V: Lanes<N>>(p: *const f64, width: usize, part: usize, at: &[usize; N]) -> [V; 4] {
        // SAFETY: passed on.
        unsafe {
            let mut rows = [V::Row::splat(0.0); N];
            for lane in 0..N {
                rows[lane] = V::Row::load(p.add(width * at[lane] + part));
            }
            V::of_rows(rows)
        }
    }

    #[inline(always)]
    unsafe fn apart<V: Lanes<N>, L>(&self, cx: &Cx<L>) -> [V; 4] {
        // SAFETY: passed on.
        unsafe {
            let mut rows = [V::Row::splat(0.0); N];
            for lane in 0..N {
                rows[lane] = cx.places().apart(self.i[lane] as u32, self.w[lane]);
            }
            V::of_rows(rows)
        }
    }

    #[inline(always)]
    unsafe fn act<V: Lanes<N>, L: ContactLaw, const W: usize>(
        &self,
        cx: &Cx<L>,
        law: &L,
        memory: usize,
        slab: &mut Slab,
        count: usize,
    ) {
        // SAFETY: passed on.
        unsafe {
            let [dx, dy, dz, _] = self.apart::<V, L>(cx);
            let own =
                Motion { velocity: Self::vectors(cx.v, &self.i), spin: Self::vectors(cx.omega, &self.i) };
            let other =
                Motion { velocity: Self::vectors(cx.v, &self.j), spin: Self::vectors(cx.omega, &self.j) };
            let radii = [Self::numbers(cx.radius, &self.i), Self::numbers(cx.radius, &self.j)];
            let (mi, mj): (V, V) = (Self::numbers(cx.mass, &self.i), Self::numbers(cx.mass, &self.j));

            let past = slab.short.history.as_mut_ptr();
            let mut history = [V::all(0.0); MOST_MEMORY + 1];
            for part in (0..W).step_by(4) {
                let lanes = Self::records::<V>(past, W, part, &self.k);
                [history[part], history[part + 1], history[part + 2], history[part + 3]] = lanes;
            }
            let lasts = history[W - 1].above(V::all(cx.now - 0.5));
            for part in 0..W - 1 {
                history[part] = V::choose(lasts, history[part], V::all(0.0));
            }

            let mass = if cx.frozen { beside_frozen(mi, mj) } else { reduced(mi, mj) };
            let g = geometry([dx, dy, dz], radii, mass);
            let wrench = law.contact(&g, &own, &other, &mut history[..memory], cx.step);
            slab.deep |= V::any(too_deep(&g));

            if cx.store {
                history[W - 1] = V::all(cx.now + 1.0);
                for part in (0..W).step_by(4) {
                    let rows =
                        V::to_rows([history[part], history[part + 1], history[part + 2], history[part + 3]]);
                    // Lanes without a contact repeat the last one, in whose place they would write the same.
                    for lane in 0..N {
                        rows[lane].store(past.add(W * self.k[lane] + part));
                    }
                }
            }
            self.add(cx, &wrench, count);
            if cx.virial {
                add_virial([dx, dy, dz], wrench.force, count, &mut slab.virial);
            }
        }
    }

    /// Adds forces and torques, contact by contact.
    #[inline(always)]
    unsafe fn add<V: Lanes<N>, L>(&self, cx: &Cx<L>, w: &Wrench<V>, count: usize) {
        // SAFETY: passed on.
        unsafe {
            let zero = V::all(0.0);
            let ([fx, fy, fz], [ax, ay, az], [bx, by, bz]) = (w.force, w.torque_i, w.torque_j);
            let force = V::to_rows([fx, fy, fz, zero]);
            let (ti, tj) = (V::to_rows([ax, ay, az, zero]), V::to_rows([bx, by, bz, zero]));
            let (f, t): (*mut f64, *mut f64) = (cx.force.as_ptr().cast(), cx.torque.as_ptr().cast());
            for lane in 0..N {
                if lane >= count {
                    break;
                }
                let (i, j) = (3 * self.i[lane], 3 * self.j[lane]);
                (V::Row::load3(f.add(i)) + force[lane]).store3(f.add(i));
                (V::Row::load3(f.add(j)) - force[lane]).store3(f.add(j));
                (V::Row::load3(t.add(i)) + ti[lane]).store3(t.add(i));
                (V::Row::load3(t.add(j)) + tj[lane]).store3(t.add(j));
            }
        }
    }
}

/// Adds Σ d ⊗ F of the first lanes.
#[inline(always)]
fn add_virial<const N: usize, V: Lanes<N>>(d: Vec3<V>, f: Vec3<V>, count: usize, sum: &mut [f64; 6]) {
    for (s, (a, b)) in sum.iter_mut().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
        (d[a] * f[b]).numbers()[..count].iter().for_each(|t| *s += t);
    }
}

/// The geometry of touching spheres, as `Geometry::of_spheres`.
#[inline(always)]
fn geometry<R: Real>(d: Vec3<R>, radii: [R; 2], mass: R) -> Geometry<R> {
    let sum = radii[0] + radii[1];
    let distance = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    Geometry {
        normal: [d[0] / distance, d[1] / distance, d[2] / distance],
        overlap: sum - distance,
        radii,
        curvature: radii[0] * radii[1] / sum,
        mass,
    }
}

/// Whether grains overlap by more than [`DEEP`] of the smaller radius.
#[inline(always)]
fn too_deep<R: Real>(g: &Geometry<R>) -> R::Mask {
    g.overlap.above(g.radii[0].least(g.radii[1]) * DEEP)
}

/// The reduced mass.
#[inline(always)]
fn reduced<R: Real>(mi: R, mj: R) -> R {
    mi * mj / (mi + mj)
}

/// The reduced mass where frozen grains have a minus sign and count as infinitely heavy.
#[inline(always)]
fn beside_frozen<R: Real>(mi: R, mj: R) -> R {
    let (zero, a, b) = (mi.like(0.0), mi.abs(), mj.abs());
    R::choose(zero.above(mj), a, R::choose(zero.above(mi), b, reduced(a, b)))
}

/// A single contact in plain numbers.
unsafe fn one<L: ContactLaw, const W: usize>(cx: &Cx<L>, law: &L, slab: &mut Slab, k: usize) {
    let (i, w) = (slab.short.i[k] as usize, slab.short.w[k]);
    let (j, s) = (grain(w), cx.shifts[(w >> HERE_BITS) as usize]);
    let (a, b) = (cx.x[i], cx.x[j]);
    let d = [a[0] - (b[0] + s[0]), a[1] - (b[1] + s[1]), a[2] - (b[2] + s[2])];
    let (mi, mj) = (cx.mass[i], cx.mass[j]);
    let mass = if cx.frozen { beside_frozen(mi, mj) } else { reduced(mi, mj) };
    let g = geometry(d, [cx.radius[i], cx.radius[j]], mass);
    let motion = |i: usize| Motion { velocity: cx.v[i], spin: cx.omega[i] };
    let mut row = [0.0; MOST_MEMORY + 1];
    let past = &mut slab.short.history[k * W..][..W];
    if past[W - 1] == cx.now {
        row[..W].copy_from_slice(past);
    }
    let wrench = law.contact(&g, &motion(i), &motion(j), &mut row[..law.memory()], cx.step);
    slab.deep |= too_deep(&g);
    if cx.store {
        past[..W - 1].copy_from_slice(&row[..W - 1]);
        past[W - 1] = cx.now + 1.0;
    }
    // SAFETY: entries are grains; the caller keeps other threads away.
    unsafe {
        let (f, t) = (cx.force.as_ptr(), cx.torque.as_ptr());
        (0..3).for_each(|d| (*f.add(i))[d] += wrench.force[d]);
        (0..3).for_each(|d| (*f.add(j))[d] -= wrench.force[d]);
        (0..3).for_each(|d| (*t.add(i))[d] += wrench.torque_i[d]);
        (0..3).for_each(|d| (*t.add(j))[d] += wrench.torque_j[d]);
    }
    if cx.virial {
        for (s, (a, b)) in slab.virial.iter_mut().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
            *s += d[a] * wrench.force[b];
        }
    }
}
