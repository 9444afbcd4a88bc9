//! Contacts evaluated together: what they need in lanes, and what comes of it to its places.

use super::MOST_MEMORY;
use super::lists::{Short, Slab};
use super::near::grain;
use super::sweep::Cx;
use crate::laws::contact::driver::DEEP;
use crate::laws::contact::{ContactLaw, Geometry, Motion, Wrench};
use crate::math::four::{Four, Lanes};
use crate::math::pair::Pair;
use crate::math::real::Real;
use crate::math::vec3::{SIX, Vec3, scale};

/// Contacts that are evaluated together: their pairs. (Loops, no closures: those are not inlined into code for AVX.)
pub(super) struct Group<const N: usize> {
    k: [usize; N],
    i: [usize; N],
    j: [usize; N],
    w: [u32; N],
}

impl<const N: usize> Group<N> {
    #[inline(always)]
    pub unsafe fn load(short: &Short, hits: *const u32) -> Self {
        let mut g = Self { k: [0; N], i: [0; N], j: [0; N], w: [0; N] };
        for lane in 0..N {
            // SAFETY: passed on.
            unsafe {
                // Volatile, for else compilers make one gathering of eight loads and take it apart again.
                let k = hits.add(lane).read_volatile() as usize;
                let w = short.w.as_ptr().add(k).read_volatile();
                (g.k[lane], g.w[lane], g.j[lane]) = (k, w, grain(w));
                g.i[lane] = short.i.as_ptr().add(k).read_volatile() as usize;
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
    pub unsafe fn act<V: Lanes<N>, L: ContactLaw, const W: usize>(
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
        let force = Apart::<V::Pair, N>::new(w.force);
        let (own, other) = (Apart::new(w.torque_i), Apart::new(w.torque_j));
        let (f, t): (*mut f64, *mut f64) = (cx.force.as_ptr().cast(), cx.torque.as_ptr().cast());
        // SAFETY: passed on. Groups are full but the last one of a list: loops of known length are written out.
        unsafe {
            if count >= N {
                for lane in 0..N {
                    force.act(f, lane, self.i[lane], self.j[lane]);
                }
                for lane in 0..N {
                    own.add(t, lane, self.i[lane]);
                    other.add(t, lane, self.j[lane]);
                }
                return;
            }
            for lane in 0..count {
                force.act(f, lane, self.i[lane], self.j[lane]);
                own.add(t, lane, self.i[lane]);
                other.add(t, lane, self.j[lane]);
            }
        }
    }
}

/// Vectors in lanes as they go to memory: x and y together, and z.
struct Apart<P, const N: usize> {
    xy: [P; N],
    z: [f64; N],
}

impl<P: Pair, const N: usize> Apart<P, N> {
    #[inline(always)]
    fn new<V: Lanes<N, Pair = P>>([x, y, z]: Vec3<V>) -> Self {
        Self { xy: V::pairs(x, y), z: z.numbers() }
    }

    /// Adds the vector of a lane to that of grain `i`.
    #[inline(always)]
    unsafe fn add(&self, to: *mut f64, lane: usize, i: usize) {
        // SAFETY: passed on.
        unsafe {
            let to = to.add(3 * i);
            self.xy[lane].add_to(to);
            *to.add(2) += self.z[lane];
        }
    }

    /// Adds the vector of a lane to that of grain `i` and takes it from that of grain `j`.
    #[inline(always)]
    unsafe fn act(&self, to: *mut f64, lane: usize, i: usize, j: usize) {
        // SAFETY: passed on.
        unsafe {
            self.add(to, lane, i);
            let to = to.add(3 * j);
            self.xy[lane].take_from(to);
            *to.add(2) -= self.z[lane];
        }
    }
}

/// Adds Σ d ⊗ F of the first lanes.
#[inline(always)]
fn add_virial<const N: usize, V: Lanes<N>>(d: Vec3<V>, f: Vec3<V>, count: usize, sum: &mut [f64; 6]) {
    for (s, (a, b)) in sum.iter_mut().zip(SIX) {
        (d[a] * f[b]).numbers()[..count].iter().for_each(|t| *s += t);
    }
}

/// The geometry of touching spheres, as `Geometry::of_spheres`.
#[inline(always)]
fn geometry<R: Real>(d: Vec3<R>, radii: [R; 2], mass: R) -> Geometry<R> {
    let sum = radii[0] + radii[1];
    let distance = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    Geometry {
        normal: scale(sum.like(1.0) / distance, d),
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
pub(super) unsafe fn one<L: ContactLaw, const W: usize>(cx: &Cx<L>, law: &L, slab: &mut Slab, k: usize) {
    let (i, w) = (slab.short.i[k] as usize, slab.short.w[k]);
    let (j, d) = (grain(w), cx.places().between(i, w));
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
        for (s, (a, b)) in slab.virial.iter_mut().zip(SIX) {
            *s += d[a] * wrench.force[b];
        }
    }
}
