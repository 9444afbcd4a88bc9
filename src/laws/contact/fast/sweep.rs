//! The inner loops: distances four at a time, contacts four at a time, forces into the records.

use super::lists::{Short, Slab};
use super::{Fast, Laws, MOST_MEMORY, NONE, has_avx2};
use crate::laws::contact::{Advance, ContactLaw, Geometry, Loop, Motion, Wrench};
use crate::math::four::{Four, Plain};
use crate::math::real::Real;
use crate::math::vec3::Vec3;
use crate::par;
use std::marker::PhantomData;

/// Bits of a list entry that hold a place; the image stands above them.
pub const PLACE_BITS: u32 = 27;
/// How far the image is shifted.
pub const HERE_BITS: u32 = PLACE_BITS;
/// Hits that laws are evaluated for at a time where there are several laws: part of the order of additions.
const BLOCK: usize = 64;
/// Room for hits: some blocks and what a test may put behind them.
const ROOM: usize = 4 * BLOCK;
/// How many hits ahead memory is asked for.
const AHEAD: usize = 12;

/// The place in a list entry.
#[inline(always)]
pub fn place(w: u32) -> u32 {
    w & ((1 << PLACE_BITS) - 1)
}

/// What the loops read and where they write.
struct Cx<'a, L> {
    laws: &'a Laws<L>,
    position: &'a [[f64; 4]],
    motion: &'a [[f64; 8]],
    kind: &'a [u16],
    shifts: &'a [[f64; 4]; 32],
    force: par::Shared<'a, [f64; 8]>,
    step: Advance,
    now: f64,
    store: bool,
    virial: bool,
    /// Whether some grains are frozen.
    frozen: bool,
}

impl<L: ContactLaw> Fast<L> {
    /// Adds up the forces of all contacts.
    pub(super) fn sweep(&mut self, step: Advance, store: bool, virial: bool, frozen: bool) {
        let (width, avx2) = (self.width, has_avx2());
        let mut lists = std::mem::take(&mut self.lists);
        let slabs = par::Shared::new(&mut lists);
        let cx = Cx {
            laws: &self.laws,
            position: &self.position,
            motion: &self.motion,
            kind: &self.kind,
            shifts: &self.shifts,
            force: par::Shared::new(&mut self.force),
            step,
            now: self.now,
            store,
            virial,
            frozen,
        };
        par::two_colours(slabs.len(), |k| {
            // SAFETY: each part writes its own slab, and forces of places in it and the next one, which two_colours
            // keeps apart; list entries are places of records; AVX2 only where there is AVX2.
            unsafe {
                let slab = &mut slabs.get(k..k + 1)[0];
                match (width, avx2) {
                    #[cfg(target_arch = "x86_64")]
                    (4, true) => contacts_avx2::<L, 4>(&cx, slab),
                    #[cfg(target_arch = "x86_64")]
                    (_, true) => contacts_avx2::<L, 8>(&cx, slab),
                    (4, _) => contacts::<Plain, L, 4>(&cx, slab),
                    _ => contacts::<Plain, L, 8>(&cx, slab),
                }
            }
        });
        self.lists = lists;
    }
}

/// Calls `hit` with the numbers of all pairs of the long list whose surfaces are nearer than `thin`, in order.
///
/// # Safety
/// List entries must be places of records.
pub unsafe fn near<L: ContactLaw>(fast: &Fast<L>, slab: &Slab, thin: f64, hit: impl FnMut(u32)) {
    // SAFETY: passed on.
    unsafe {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            return near_avx2(&fast.position, &fast.shifts, slab, thin, hit);
        }
        near_in::<Plain>(&fast.position, &fast.shifts, slab, thin, hit);
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn near_avx2(at: &[[f64; 4]], shifts: &[[f64; 4]; 32], slab: &Slab, thin: f64, hit: impl FnMut(u32)) {
    // SAFETY: passed on.
    unsafe { near_in::<crate::math::four::Avx2>(at, shifts, slab, thin, hit) }
}

#[inline(always)]
unsafe fn near_in<F: Four>(
    at: &[[f64; 4]],
    shifts: &[[f64; 4]; 32],
    slab: &Slab,
    thin: f64,
    mut hit: impl FnMut(u32),
) {
    let list = &slab.long;
    for k in (0..list.i.len()).step_by(4) {
        // SAFETY: lists are filled up to fours; entries are places of records.
        let mut bits =
            unsafe { closer::<F>(at, shifts, list.i.as_ptr().add(k), list.w.as_ptr().add(k), thin) };
        while bits != 0 {
            hit(k as u32 + bits.trailing_zeros());
            bits &= bits - 1;
        }
    }
}

/// Which of four pairs have surfaces nearer than `extra`, as bits.
#[inline(always)]
unsafe fn closer<F: Four>(
    at: &[[f64; 4]],
    shifts: &[[f64; 4]; 32],
    i: *const u32,
    w: *const u32,
    extra: f64,
) -> u32 {
    // SAFETY: passed on.
    unsafe {
        let sign = F::load([1.0, 1.0, 1.0, -1.0].as_ptr());
        let rows = [
            apart(at, shifts, *i, *w, sign),
            apart(at, shifts, *i.add(1), *w.add(1), sign),
            apart(at, shifts, *i.add(2), *w.add(2), sign),
            apart(at, shifts, *i.add(3), *w.add(3), sign),
        ];
        let [x, y, z, sum] = F::transpose(rows);
        let reach = sum + extra;
        F::bits((reach * reach).above(x * x + y * y + z * z))
    }
}

/// x_i − x_j and, by the sign of the last lane, R_i + R_j.
#[inline(always)]
unsafe fn apart<F: Four>(at: &[[f64; 4]], shifts: &[[f64; 4]; 32], i: u32, w: u32, sign: F) -> F {
    // SAFETY: passed on.
    unsafe {
        let a = F::load(at.as_ptr().add(i as usize).cast());
        let b = F::load(at.as_ptr().add(place(w) as usize).cast());
        let shift = F::load(shifts.as_ptr().add((w >> HERE_BITS) as usize).cast());
        a - (b + shift) * sign
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
unsafe fn contacts_avx2<L: ContactLaw, const W: usize>(cx: &Cx<L>, slab: &mut Slab) {
    // SAFETY: passed on.
    unsafe { contacts::<crate::math::four::Avx2, L, W>(cx, slab) }
}

/// All contacts of a slab.
#[inline(always)]
unsafe fn contacts<F: Four, L: ContactLaw, const W: usize>(cx: &Cx<L>, slab: &mut Slab) {
    slab.virial = [0.0; 6];
    let mut hits = [0; ROOM + AHEAD + 4];
    let (mut count, mut k, end) = (0, 0, slab.short.i.len());
    loop {
        while k < end && count + 4 <= ROOM {
            // SAFETY: lists are filled up to fours; entries are places of records.
            let bits = unsafe {
                let short = &slab.short;
                closer::<F>(cx.position, cx.shifts, short.i.as_ptr().add(k), short.w.as_ptr().add(k), 0.0)
            };
            // Writes past `count` do no harm: the next ones overwrite them.
            for lane in 0..4 {
                hits[count] = (k + lane) as u32;
                count += (bits >> lane & 1) as usize;
            }
            k += 4;
        }
        let ready = if k == end { count } else { count - count % BLOCK };
        // The evaluation writes behind the hits it is given.
        let mut rest = [0; BLOCK];
        rest[..count - ready].copy_from_slice(&hits[ready..count]);
        // SAFETY: passed on.
        unsafe { evaluate::<F, L, W>(cx, slab, &mut hits, ready) };
        if k == end {
            break;
        }
        count -= ready;
        hits[..count].copy_from_slice(&rest[..count]);
    }
}

/// The contacts of the first `ready` hits.
#[inline(always)]
unsafe fn evaluate<F: Four, L: ContactLaw, const W: usize>(
    cx: &Cx<L>,
    slab: &mut Slab,
    hits: &mut [u32; ROOM + AHEAD + 4],
    ready: usize,
) {
    // SAFETY: passed on.
    unsafe {
        if let [law] = &cx.laws.distinct[..] {
            return of_law::<F, L, W>(cx, law, slab, hits, ready);
        }
        let mut own = [0; BLOCK + AHEAD + 4];
        for block in hits[..ready].chunks(BLOCK) {
            for (number, law) in cx.laws.distinct.iter().enumerate() {
                let mut count = 0;
                for &k in block {
                    let (i, w) = (slab.short.i[k as usize], slab.short.w[k as usize]);
                    let which = cx.laws.which(cx.kind[i as usize], cx.kind[place(w) as usize]);
                    own[count] = k;
                    count += usize::from(which != NONE && usize::from(which) == number);
                }
                of_law::<F, L, W>(cx, law, slab, &mut own, count);
            }
        }
    }
}

/// Contacts of one law: four at a time or, where the law wants that, one by one.
#[inline(always)]
unsafe fn of_law<F: Four, L: ContactLaw, const W: usize>(
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
    hits[count..count + AHEAD + 4].fill(last);
    // SAFETY: passed on.
    unsafe {
        if !law.in_lanes() {
            for k in &hits[..count] {
                one::<L, W>(cx, law, slab, *k as usize);
            }
            return;
        }
        let fours = Fours::<F, L, W> { cx, slab, hits, count, lanes: PhantomData };
        if W == 4 && F::FAST { law.within(fours) } else { fours.run(law) }
    }
}

/// The loop over contacts of one law, four at a time.
struct Fours<'a, 'b, F, L, const W: usize> {
    cx: &'a Cx<'b, L>,
    slab: &'a mut Slab,
    hits: &'a [u32],
    count: usize,
    lanes: PhantomData<F>,
}

impl<F: Four, L: ContactLaw, const W: usize> Loop<L> for Fours<'_, '_, F, L, W> {
    #[inline(always)]
    fn run(self, law: &L) {
        let (cx, hits, memory) = (self.cx, self.hits, law.memory());
        for k in (0..self.count).step_by(4) {
            // SAFETY: hits are pairs of the list, and their entries places of records; `of_law` made it.
            unsafe {
                for ahead in &hits[k + AHEAD..k + AHEAD + 4] {
                    let j = place(*self.slab.short.w.as_ptr().add(*ahead as usize)) as usize;
                    F::prefetch(cx.motion.as_ptr().add(j));
                    F::prefetch(cx.force.as_ptr().add(j));
                }
                let group = Group::<F>::load(&self.slab.short, hits.as_ptr().add(k));
                group.act::<L, W>(cx, law, memory, self.slab, (self.count - k).min(4));
            }
        }
    }
}

/// Four contacts: their pairs.
struct Group<F> {
    k: [usize; 4],
    i: [usize; 4],
    w: [u32; 4],
    zero: F,
}

impl<F: Four> Group<F> {
    #[inline(always)]
    unsafe fn load(short: &Short, hits: *const u32) -> Self {
        // SAFETY: passed on.
        unsafe {
            let k = [*hits, *hits.add(1), *hits.add(2), *hits.add(3)];
            let k = [k[0] as usize, k[1] as usize, k[2] as usize, k[3] as usize];
            let (pi, pw) = (short.i.as_ptr(), short.w.as_ptr());
            let i = [*pi.add(k[0]), *pi.add(k[1]), *pi.add(k[2]), *pi.add(k[3])];
            let w = [*pw.add(k[0]), *pw.add(k[1]), *pw.add(k[2]), *pw.add(k[3])];
            let i = [i[0] as usize, i[1] as usize, i[2] as usize, i[3] as usize];
            Self { k, i, w, zero: F::splat(0.0) }
        }
    }

    /// Four rows of four numbers, turned into lanes.
    #[inline(always)]
    unsafe fn rows(p: [*const f64; 4]) -> [F; 4] {
        // SAFETY: passed on.
        unsafe { F::transpose([F::load(p[0]), F::load(p[1]), F::load(p[2]), F::load(p[3])]) }
    }

    /// The first four numbers of four records of eight, turned into lanes.
    #[inline(always)]
    unsafe fn records(p: *const f64, k: &[usize; 4]) -> [F; 4] {
        // SAFETY: passed on.
        unsafe { Self::rows([p.add(8 * k[0]), p.add(8 * k[1]), p.add(8 * k[2]), p.add(8 * k[3])]) }
    }

    #[inline(always)]
    unsafe fn act<L: ContactLaw, const W: usize>(
        &self,
        cx: &Cx<L>,
        law: &L,
        memory: usize,
        slab: &mut Slab,
        count: usize,
    ) {
        // SAFETY: passed on.
        unsafe {
            let (i, w, k) = (self.i, self.w, self.k);
            let j = [place(w[0]), place(w[1]), place(w[2]), place(w[3])];
            let j = [j[0] as usize, j[1] as usize, j[2] as usize, j[3] as usize];
            let one = F::splat(1.0);
            let d = F::transpose([
                apart(cx.position, cx.shifts, i[0] as u32, w[0], one),
                apart(cx.position, cx.shifts, i[1] as u32, w[1], one),
                apart(cx.position, cx.shifts, i[2] as u32, w[2], one),
                apart(cx.position, cx.shifts, i[3] as u32, w[3], one),
            ]);
            let m: *const f64 = cx.motion.as_ptr().cast();
            let ([a0, a1, a2, mi], [p0, p1, p2, ri]) = (Self::records(m, &i), Self::records(m.add(4), &i));
            let ([b0, b1, b2, mj], [q0, q1, q2, rj]) = (Self::records(m, &j), Self::records(m.add(4), &j));

            let past = slab.short.history.as_mut_ptr();
            let h = [past.add(W * k[0]), past.add(W * k[1]), past.add(W * k[2]), past.add(W * k[3])];
            let mut history = [self.zero; MOST_MEMORY + 1];
            for part in 0..W / 4 {
                let p = [h[0].add(4 * part), h[1].add(4 * part), h[2].add(4 * part), h[3].add(4 * part)];
                let lanes = Self::rows([p[0], p[1], p[2], p[3]]);
                history[4 * part] = lanes[0];
                history[4 * part + 1] = lanes[1];
                history[4 * part + 2] = lanes[2];
                history[4 * part + 3] = lanes[3];
            }
            let lasts = history[W - 1].above(F::splat(cx.now - 0.5));
            for part in 0..W - 1 {
                history[part] = F::choose(lasts, history[part], self.zero);
            }

            let mass = if cx.frozen { beside_frozen(mi, mj) } else { reduced(mi, mj) };
            let g = geometry([d[0], d[1], d[2]], [ri, rj], mass);
            let own = Motion { velocity: [a0, a1, a2], spin: [p0, p1, p2] };
            let other = Motion { velocity: [b0, b1, b2], spin: [q0, q1, q2] };
            let wrench = law.contact(&g, &own, &other, &mut history[..memory], cx.step);

            if cx.store {
                history[W - 1] = F::splat(cx.now + 1.0);
                for part in 0..W / 4 {
                    let rows = F::transpose([
                        history[4 * part],
                        history[4 * part + 1],
                        history[4 * part + 2],
                        history[4 * part + 3],
                    ]);
                    // Lanes without a contact repeat the last one, in whose place they would write the same.
                    for lane in 0..4 {
                        rows[lane].store(h[lane].add(4 * part));
                    }
                }
            }
            self.add(cx, &j, &wrench, count);
            if cx.virial {
                self.add_virial(&[d[0], d[1], d[2]], &wrench.force, count, &mut slab.virial);
            }
        }
    }

    /// Lanes of vectors, turned into rows. (No closure: those are not inlined into code for AVX2.)
    #[inline(always)]
    fn of(&self, v: &Vec3<F>) -> [F; 4] {
        F::transpose([v[0], v[1], v[2], self.zero])
    }

    /// Forces and torques into the records, contact by contact.
    #[inline(always)]
    unsafe fn add<L>(&self, cx: &Cx<L>, j: &[usize; 4], w: &Wrench<F>, count: usize) {
        // SAFETY: passed on.
        unsafe {
            let (force, ti, tj) = (self.of(&w.force), self.of(&w.torque_i), self.of(&w.torque_j));
            let f: *mut f64 = cx.force.as_ptr().cast();
            for lane in 0..4 {
                if lane >= count {
                    break;
                }
                let (pi, pj) = (f.add(8 * self.i[lane]), f.add(8 * j[lane]));
                (F::load(pi) + force[lane]).store(pi);
                (F::load(pj) - force[lane]).store(pj);
                (F::load(pi.add(4)) + ti[lane]).store(pi.add(4));
                (F::load(pj.add(4)) + tj[lane]).store(pj.add(4));
            }
        }
    }

    #[inline(always)]
    unsafe fn add_virial(&self, d: &Vec3<F>, f: &Vec3<F>, count: usize, sum: &mut [f64; 6]) {
        for (s, (a, b)) in sum.iter_mut().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
            let mut terms = [0.0; 4];
            // SAFETY: an array of four numbers.
            unsafe { (d[a] * f[b]).store(terms.as_mut_ptr()) };
            terms[..count].iter().for_each(|t| *s += t);
        }
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
    let (j, s) = (place(w) as usize, cx.shifts[(w >> HERE_BITS) as usize]);
    let (a, b) = (cx.position[i], cx.position[j]);
    let d = [a[0] - (b[0] + s[0]), a[1] - (b[1] + s[1]), a[2] - (b[2] + s[2])];
    let (mi, mj) = (&cx.motion[i], &cx.motion[j]);
    let mass = if cx.frozen { beside_frozen(mi[3], mj[3]) } else { reduced(mi[3], mj[3]) };
    let g = geometry(d, [a[3], b[3]], mass);
    let motion = |m: &[f64; 8]| Motion { velocity: [m[0], m[1], m[2]], spin: [m[4], m[5], m[6]] };
    let mut row = [0.0; MOST_MEMORY + 1];
    let past = &mut slab.short.history[k * W..][..W];
    if past[W - 1] == cx.now {
        row[..W].copy_from_slice(past);
    }
    let wrench = law.contact(&g, &motion(mi), &motion(mj), &mut row[..law.memory()], cx.step);
    if cx.store {
        past[..W - 1].copy_from_slice(&row[..W - 1]);
        past[W - 1] = cx.now + 1.0;
    }
    // SAFETY: places of records; the caller keeps other threads away.
    unsafe {
        let own = &mut *cx.force.as_ptr().add(i);
        (0..3).for_each(|d| own[d] += wrench.force[d]);
        (0..3).for_each(|d| own[4 + d] += wrench.torque_i[d]);
        let other = &mut *cx.force.as_ptr().add(j);
        (0..3).for_each(|d| other[d] -= wrench.force[d]);
        (0..3).for_each(|d| other[4 + d] += wrench.torque_j[d]);
    }
    if cx.virial {
        for (s, (a, b)) in slab.virial.iter_mut().zip([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]) {
            *s += d[a] * wrench.force[b];
        }
    }
}
