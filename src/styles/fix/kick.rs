//! Half kicks and drifts of velocity Verlet in one pass over memory, four particles at a time.

use super::nve::half_step;
use crate::diag::Result;
use crate::math::four::{Plain, has_avx2};
use crate::math::lanes::Lanes;
use crate::math::threes::{self, Threes};
use crate::math::vec3::Vec3;
use crate::plan::{Act, Gist, Solids, Stretch, Tick};
use crate::styles::matter::Masses;
use crate::styles::step_op::StepOp;
use crate::world::{GroupId, World};

/// What a pass makes of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    /// First half kick and drift: v += Δt/2 · f/m, x += Δt · v; spins as velocities.
    First,
    /// Second half kick.
    Second,
    /// The second half kick of a step, and first half kick and drift of the next one under the same forces.
    Both,
}

/// Lets the op that begins a step make whole ones in stretches: half kicks and drifts of a group; with `inertia`,
/// I / (m R²), spins too: ω += Δt/2 · torque/I. How far anybody has gone at most is told to the account of ways.
pub fn first<F>(op: StepOp<F>, group: GroupId, inertia: Option<f64>) -> StepOp<F>
where
    F: FnMut(&mut World, &Tick) -> Result<()> + Send + 'static,
{
    op.taking_turns(move |w, t, _| whole(w, group, inertia, t, Part::First), went)
}

/// The same for the op that ends a step, and can begin the next one.
pub fn second<F>(op: StepOp<F>, group: GroupId, inertia: Option<f64>) -> StepOp<F>
where
    F: FnMut(&mut World, &Tick) -> Result<()> + Send + 'static,
{
    let part = |on: bool| if on { Part::Both } else { Part::Second };
    op.taking_turns(move |w, t, on| whole(w, group, inertia, t, part(on)), went)
}

/// A part of a step, or of a level of steps, of which only the shortest drift; of the two lengths of steps for grains and
/// solids see [`some`].
fn whole(w: &World, group: GroupId, inertia: Option<f64>, t: &Tick, part: Part) -> Option<Act> {
    let (short, solids) = (t.phase.level == 0, t.phase.solids.clone());
    let part = if part == Part::First && !short && solids.is_none() { Part::Second } else { part };
    // Bonds of solids turn nothing, so that short steps have none of it.
    let inertia = inertia.filter(|_| solids.is_none() || !short);
    let half = half_step(w, t.dt);
    let k = Kick { half, spin: inertia.map_or(0.0, |i| half / i), dt: t.dt, bit: group.bit() };
    Some(Box::new(move |s| {
        let masses = Masses::new(s.all.style, s.all.mass, s.all.kind, s.all.type_mass);
        let most = match &solids {
            None => k.part_of(s, 0..s.x.len(), inertia.is_some(), part, &masses),
            Some(solids) => some(&k, s, inertia.is_some(), part, &masses, (solids, short)),
        };
        Gist { most, ..Gist::default() }
    }))
}

/// A part of a step of two lengths: in the long one all are kicked and all but solids drift, in the short ones solids do
/// both. Solids are created one after the other: what a particle does is decided once for all like it that follow.
fn some(
    k: &Kick,
    s: &mut Stretch,
    spins: bool,
    part: Part,
    masses: &Masses,
    (solids, short): (&Solids, bool),
) -> f64 {
    let (mut from, mut most) = (0, 0.0);
    while from < s.x.len() {
        let (kind, mask) = (&s.all.kind[s.start + from..s.start + s.x.len()], &s.mask[from..]);
        let own = from..from + alike(kind, mask);
        let solid = solids.has(kind[0]);
        let drifts = short || !solid || mask[0] & solids.twice != 0;
        let part = if drifts { part } else { Part::Second };
        if solid || !short {
            most = faster(most, k.part_of(s, own.clone(), spins, part, masses));
        }
        from = own.end;
    }
    most
}

/// How many particles from the first on have its type and groups.
fn alike(kind: &[u16], mask: &[u32]) -> usize {
    const EACH: usize = 16;
    let (first, bits) = (kind[0], mask[0]);
    let mut n = 0;
    // Whole groups are compared without a branch for each.
    for (kind, mask) in kind.chunks_exact(EACH).zip(mask.chunks_exact(EACH)) {
        let differ = kind.iter().fold(0, |d, k| d | (k ^ first)) != 0;
        if differ || mask.iter().fold(0, |d, m| d | (m ^ bits)) != 0 {
            break;
        }
        n += EACH;
    }
    n + kind[n..].iter().zip(&mask[n..]).take_while(|(k, m)| (**k, **m) == (first, bits)).count()
}

/// Tells the account of ways what came of a part.
fn went(w: &mut World, t: &Tick, gist: Gist) {
    w.rebuild.travel.went(t.dt.abs() * gist.most.sqrt());
}

/// Spins, torques, radii.
type Turned<'a> = (&'a mut [Vec3], &'a [Vec3], &'a [f64]);

/// A stretch of particles.
struct Chunk<'a> {
    x: &'a mut [Vec3],
    v: &'a mut [Vec3],
    f: &'a [Vec3],
    mask: &'a [u32],
    turned: Turned<'a>,
}

/// What is the same for all particles.
struct Kick {
    /// Δt/2 in units that turn force/mass into velocity.
    half: f64,
    /// The same over I / (m R²).
    spin: f64,
    dt: f64,
    bit: u32,
}

impl Kick {
    /// Some particles of a stretch, and the largest v² among them after a drift.
    fn part_of(
        &self,
        s: &mut Stretch,
        own: std::ops::Range<usize>,
        spins: bool,
        part: Part,
        masses: &Masses,
    ) -> f64 {
        let first = s.start + own.start;
        let radius = || &s.all.radius[first..first + own.len()];
        let turned = match spins {
            true => (&mut s.omega[own.clone()], &s.torque[own.clone()], radius()),
            false => Turned::default(),
        };
        let (x, v) = (&mut s.x[own.clone()], &mut s.v[own.clone()]);
        let chunk = Chunk { x, v, f: &s.f[own.clone()], mask: &s.mask[own.clone()], turned };
        self.stretch(chunk, part, masses, first)
    }

    /// The particles from `start` on, and the largest v² among them after a drift.
    fn stretch(&self, c: Chunk, part: Part, masses: &Masses, start: usize) -> f64 {
        let (end, spins) = (start + c.x.len(), !c.turned.0.is_empty());
        match masses {
            Masses::Own(mass) => {
                let (fours, rest) = mass[start..end].as_chunks::<4>();
                let rest: [f64; 4] = std::array::from_fn(|l| rest.get(l).copied().unwrap_or(1.0));
                self.chunk(c, part, spins, |at| fours.get(at).copied().unwrap_or(rest))
            }
            by_type => self.chunk(c, part, spins, |at| {
                let mass = |i| if i < end { by_type.get(i) } else { 1.0 };
                std::array::from_fn(|l| mass(start + 4 * at + l))
            }),
        }
    }

    /// A chunk, and the largest v² in it after a drift; `masses(k)` are those of four particles from `4 k` on, whatever
    /// they are beyond the end.
    fn chunk(&self, c: Chunk, part: Part, spins: bool, masses: impl Fn(usize) -> [f64; 4]) -> f64 {
        match (part, spins) {
            (Part::First, true) => self.here::<1, true, true>(c, masses),
            (Part::Second, true) => self.here::<1, false, true>(c, masses),
            (Part::Both, true) => self.here::<2, true, true>(c, masses),
            (Part::First, false) => self.here::<1, true, false>(c, masses),
            (Part::Second, false) => self.here::<1, false, false>(c, masses),
            (Part::Both, false) => self.here::<2, true, false>(c, masses),
        }
    }

    /// As wide as this processor can; the bits are the same.
    fn here<const KICKS: usize, const DRIFT: bool, const SPIN: bool>(
        &self,
        c: Chunk,
        masses: impl Fn(usize) -> [f64; 4],
    ) -> f64 {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            // SAFETY: the processor has AVX2.
            return unsafe { self.avx2::<KICKS, DRIFT, SPIN>(c, masses) };
        }
        // SAFETY: this form needs nothing.
        unsafe { self.four::<Plain, KICKS, DRIFT, SPIN>(c, masses) }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn avx2<const KICKS: usize, const DRIFT: bool, const SPIN: bool>(
        &self,
        c: Chunk,
        masses: impl Fn(usize) -> [f64; 4],
    ) -> f64 {
        // SAFETY: the processor has AVX2.
        unsafe { self.four::<crate::math::four::Avx2, KICKS, DRIFT, SPIN>(c, masses) }
    }

    /// Four particles at a time, and those one by one that are not all of the group.
    ///
    /// # Safety
    /// The processor must have what the form needs.
    #[inline(always)]
    unsafe fn four<F: Threes, const KICKS: usize, const DRIFT: bool, const SPIN: bool>(
        &self,
        c: Chunk,
        masses: impl Fn(usize) -> [f64; 4],
    ) -> f64 {
        let Chunk { x, v, f, mask, turned: (omega, torque, radius) } = c;
        let (x4, x1) = x.as_chunks_mut::<4>();
        let (v4, v1) = v.as_chunks_mut::<4>();
        let (f4, f1) = f.as_chunks::<4>();
        let (mask4, mask1) = mask.as_chunks::<4>();
        let (omega4, omega1) = omega.as_chunks_mut::<4>();
        let (torque4, torque1) = torque.as_chunks::<4>();
        let (radius4, radius1) = radius.as_chunks::<4>();
        let mut slow = 0.0;
        // SAFETY (all below): the caller's promise; arrays of twelve and of four numbers.
        let (mut fastest, mut wrong) = unsafe { (F::splat(0.0), F::splat(0.0)) };
        for (k, (((x, v), f), mask)) in x4.iter_mut().zip(v4).zip(f4).zip(mask4).enumerate() {
            let m = masses(k);
            let all = mask[0] & mask[1] & mask[2] & mask[3] & self.bit != 0;
            if !all {
                slow = faster(slow, self.each::<KICKS, DRIFT>(x, v, f, &m, mask));
                if SPIN {
                    self.turn_each::<KICKS>(&mut omega4[k], &torque4[k], &radius4[k], &m, mask);
                }
                continue;
            }
            unsafe {
                let m = F::load(m.as_ptr());
                let v = kicked::<F, KICKS>(v, f, F::splat(self.half) / m);
                if SPIN {
                    let r = F::load(radius4[k].as_ptr());
                    kicked::<F, KICKS>(&mut omega4[k], &torque4[k], F::splat(self.spin) / (r * r * m));
                }
                if DRIFT {
                    let p = x.as_flattened_mut().as_mut_ptr();
                    let [a, b, c] = threes::load::<F>(p);
                    threes::store([a + v[0] * self.dt, b + v[1] * self.dt, c + v[2] * self.dt], p);
                    let [x, y, z] = F::parted([v[0] * v[0], v[1] * v[1], v[2] * v[2]]);
                    let square = x + y + z;
                    fastest = fastest.most(square);
                    // Zero times what is infinite or no number is no number, and stays so in a sum.
                    wrong = wrong + square * 0.0;
                }
            }
        }
        let m = masses(mask4.len());
        slow = faster(slow, self.each::<KICKS, DRIFT>(x1, v1, f1, &m, mask1));
        if SPIN {
            self.turn_each::<KICKS>(omega1, torque1, radius1, &m, mask1);
        }
        (fastest + wrong).numbers().into_iter().fold(slow, faster)
    }

    /// Particles one by one.
    #[inline(always)]
    fn each<const KICKS: usize, const DRIFT: bool>(
        &self,
        x: &mut [Vec3],
        v: &mut [Vec3],
        f: &[Vec3],
        m: &[f64; 4],
        mask: &[u32],
    ) -> f64 {
        let mut fastest = 0.0;
        for ((((x, v), f), m), mask) in x.iter_mut().zip(v).zip(f).zip(m).zip(mask) {
            if mask & self.bit == 0 {
                continue;
            }
            kick::<KICKS>(v, f, self.half / m);
            if DRIFT {
                (0..3).for_each(|d| x[d] += self.dt * v[d]);
                fastest = faster(fastest, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
            }
        }
        fastest
    }

    /// Spins one by one.
    #[inline(always)]
    fn turn_each<const KICKS: usize>(
        &self,
        omega: &mut [Vec3],
        torque: &[Vec3],
        radius: &[f64],
        m: &[f64; 4],
        mask: &[u32],
    ) {
        for ((((omega, torque), r), m), mask) in omega.iter_mut().zip(torque).zip(radius).zip(m).zip(mask) {
            if mask & self.bit != 0 {
                kick::<KICKS>(omega, torque, self.spin / (r * r * m));
            }
        }
    }
}

/// v += by · f, `KICKS` times.
#[inline(always)]
fn kick<const KICKS: usize>(v: &mut Vec3, f: &Vec3, by: f64) {
    for d in 0..3 {
        let dv = by * f[d];
        for _ in 0..KICKS {
            v[d] += dv;
        }
    }
}

/// [`kick`] of four, and what comes of it.
///
/// # Safety
/// The processor must have what the form needs.
#[inline(always)]
unsafe fn kicked<F: Threes, const KICKS: usize>(v: &mut [Vec3; 4], f: &[Vec3; 4], by: F) -> [F; 3] {
    let p = v.as_flattened_mut().as_mut_ptr();
    // SAFETY: twelve numbers each; the rest is the caller's promise.
    unsafe {
        let ([a, b, c], [fa, fb, fc], [ba, bb, bc]) =
            (threes::load::<F>(p), threes::load::<F>(f.as_flattened().as_ptr()), by.spread());
        let (da, db, dc) = (ba * fa, bb * fb, bc * fc);
        let mut now = [a, b, c];
        for _ in 0..KICKS {
            now = [now[0] + da, now[1] + db, now[2] + dc];
        }
        threes::store(now, p);
        now
    }
}

/// The larger one; a NaN counts as infinite.
#[inline(always)]
fn faster(a: f64, b: f64) -> f64 {
    if b <= a {
        a
    } else if b.is_nan() {
        f64::INFINITY
    } else {
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 11;

    fn some(seed: usize) -> Vec<Vec3> {
        let at = |i: usize| (((i * 7919 + seed * 104_729) % 1013) as f64 - 506.0) / 97.0;
        (0..N).map(|i| [at(3 * i), at(3 * i + 1), at(3 * i + 2)]).collect()
    }

    /// Positions, velocities and spins after these parts, by any form, and the last largest v².
    fn moved(parts: &[Part], wide: bool) -> (Vec<Vec3>, Vec<Vec3>, Vec<Vec3>, f64) {
        let (mut x, mut v, mut omega) = (some(1), some(2), some(3));
        let (f, torque) = (some(4), some(5));
        let radius: Vec<f64> = (0..N).map(|i| 0.3 + 0.01 * i as f64).collect();
        let mask: Vec<u32> = (0..N).map(|i| if i == 6 { 1 } else { 3 }).collect();
        let k = Kick { half: 0.01, spin: 0.025, dt: 0.02, bit: 2 };
        let masses = |k: usize| std::array::from_fn(|l| 1.0 + (4 * k + l) as f64 / 3.0);
        let mut fastest = 0.0;
        for part in parts {
            let turned = (&mut omega[..], &torque[..], &radius[..]);
            let c = Chunk { x: &mut x, v: &mut v, f: &f, mask: &mask, turned };
            fastest = match (part, wide) {
                (_, true) => k.chunk(c, *part, true, masses),
                // SAFETY: the portable form needs nothing.
                (Part::First, _) => unsafe { k.four::<Plain, 1, true, true>(c, masses) },
                // SAFETY: as above.
                (Part::Second, _) => unsafe { k.four::<Plain, 1, false, true>(c, masses) },
                // SAFETY: as above.
                (Part::Both, _) => unsafe { k.four::<Plain, 2, true, true>(c, masses) },
            };
        }
        (x, v, omega, fastest)
    }

    #[test]
    fn one_pass_has_the_bits_of_two_on_any_processor() {
        let two = moved(&[Part::First, Part::Second, Part::First], false);
        assert_eq!(moved(&[Part::First, Part::Both], false), two);
        assert_eq!(moved(&[Part::First, Part::Both], true), two);
    }

    #[test]
    fn the_formula_of_a_kick_and_a_drift() {
        let (x, v, omega, fastest) = moved(&[Part::First], true);
        let (x0, v0, omega0, f, torque) = (some(1), some(2), some(3), some(4), some(5));
        let mut most = 0.0_f64;
        for i in 0..N {
            let (m, r) = (1.0 + i as f64 / 3.0, 0.3 + 0.01 * i as f64);
            for d in 0..3 {
                let here = if i == 6 { 0.0 } else { 1.0 };
                let now = v0[i][d] + here * (0.01 / m) * f[i][d];
                assert_eq!(v[i][d], now);
                assert_eq!(x[i][d], x0[i][d] + here * 0.02 * now);
                assert_eq!(omega[i][d], omega0[i][d] + here * (0.025 / (r * r * m)) * torque[i][d]);
            }
            if i != 6 {
                most = most.max(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]);
            }
        }
        assert_eq!(fastest, most);
        assert_eq!([faster(1.0, f64::NAN), faster(f64::INFINITY, 2.0)], [f64::INFINITY; 2]);
    }

    #[test]
    fn who_moves_by_no_number_is_infinitely_fast_whoever_follows() {
        let k = Kick { half: 0.01, spin: 0.025, dt: 0.02, bit: 1 };
        for i in 0..N {
            let (mut x, mut v, f) = (some(1), some(2), some(4));
            v[i][1] = f64::NAN;
            let c = Chunk { x: &mut x, v: &mut v, f: &f, mask: &[1; N], turned: Turned::default() };
            assert_eq!(k.chunk(c, Part::First, false, |_| [1.0; 4]), f64::INFINITY, "{i}");
        }
    }
}
