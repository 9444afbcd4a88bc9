//! The loops of kicks and drifts, four particles at a time.

use super::super::gravity::pulled_each;
use crate::math::four::{Plain, has_avx2};
use crate::math::lanes::Lanes;
use crate::math::threes::{self, Threes};
use crate::math::vec3::Vec3;
use crate::plan::{Beside, Gist, Stretch};
use crate::styles::matter::Masses;
use std::ops::Range;

/// What a pass makes of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    /// First half kick and drift: v += Δt/2 · f/m, x += Δt · v; spins as velocities.
    First,
    /// Second half kick.
    Second,
    /// The second half kick of a step, and first half kick and drift of the next one under the same forces.
    Both,
}

/// A stretch of particles. Spins and torques are empty where there are none.
struct Chunk<'a> {
    x: &'a mut [Vec3],
    v: &'a mut [Vec3],
    f: &'a mut [Vec3],
    mask: &'a [u32],
    omega: &'a mut [Vec3],
    torque: &'a mut [Vec3],
    radius: &'a [f64],
}

/// What is the same for all particles.
#[derive(Clone, Copy)]
pub(super) struct Kick {
    /// Δt/2 in units that turn force/mass into velocity.
    pub half: f64,
    /// The same over I / (m R²).
    pub spin: f64,
    pub dt: f64,
    pub bit: u32,
}

/// What comes of a chunk.
#[derive(Default)]
struct Came {
    /// Σ −m a·x of those that were pulled, before they drifted.
    energy: f64,
    /// What was taken from those held.
    held: [f64; 3],
    /// The largest v² after a drift.
    most: f64,
}

impl Kick {
    /// A stretch, with what stands beside the motion: what came of a pull, of a hold and of the motion, with the bits that
    /// they have alone.
    pub fn together(
        &self,
        s: &mut Stretch,
        spins: bool,
        part: Part,
        mass: &[f64],
        beside: &Beside,
    ) -> [Gist; 3] {
        let (masses, start, own) = (Masses::Own(mass), s.start, 0..s.x.len());
        let came = self.stretch(chunk(s, own), spins, part, &masses, start, beside);
        let sums = |sums| Gist { sums, most: 0.0 };
        [sums([came.energy, 0.0, 0.0]), sums(came.held), Gist { most: came.most, ..Gist::default() }]
    }

    /// Some particles of a stretch, and the largest v² among them after a drift.
    pub fn part_of(
        &self,
        s: &mut Stretch,
        own: Range<usize>,
        spins: bool,
        part: Part,
        masses: &Masses,
    ) -> f64 {
        let first = s.start + own.start;
        self.stretch(chunk(s, own), spins, part, masses, first, &Beside::default()).most
    }

    /// The particles from `start` on.
    fn stretch(
        &self,
        c: Chunk,
        spins: bool,
        part: Part,
        masses: &Masses,
        start: usize,
        beside: &Beside,
    ) -> Came {
        let end = start + c.x.len();
        match masses {
            Masses::Own(mass) => {
                let (fours, rest) = mass[start..end].as_chunks::<4>();
                let rest: [f64; 4] = std::array::from_fn(|l| rest.get(l).copied().unwrap_or(1.0));
                self.chunk(c, part, spins, beside, |at| fours.get(at).copied().unwrap_or(rest))
            }
            by_type => self.chunk(c, part, spins, beside, |at| {
                let mass = |i| if i < end { by_type.get(i) } else { 1.0 };
                std::array::from_fn(|l| mass(start + 4 * at + l))
            }),
        }
    }

    /// A chunk; `masses(k)` are those of four particles from `4 k` on, whatever they are beyond the end.
    fn chunk(
        &self,
        c: Chunk,
        part: Part,
        spins: bool,
        beside: &Beside,
        masses: impl Fn(usize) -> [f64; 4],
    ) -> Came {
        match (part, spins) {
            (Part::First, true) => self.here::<1, true, true>(c, beside, masses),
            (Part::Second, true) => self.here::<1, false, true>(c, beside, masses),
            (Part::Both, true) => self.here::<2, true, true>(c, beside, masses),
            (Part::First, false) => self.here::<1, true, false>(c, beside, masses),
            (Part::Second, false) => self.here::<1, false, false>(c, beside, masses),
            (Part::Both, false) => self.here::<2, true, false>(c, beside, masses),
        }
    }

    /// As wide as this processor can; the bits are the same.
    fn here<const KICKS: usize, const DRIFT: bool, const SPIN: bool>(
        &self,
        c: Chunk,
        beside: &Beside,
        masses: impl Fn(usize) -> [f64; 4],
    ) -> Came {
        #[cfg(target_arch = "x86_64")]
        if has_avx2() {
            // SAFETY: the processor has AVX2.
            return unsafe { self.avx2::<KICKS, DRIFT, SPIN>(c, beside, masses) };
        }
        // SAFETY: this form needs nothing.
        unsafe { self.four::<Plain, KICKS, DRIFT, SPIN>(c, beside, masses) }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn avx2<const KICKS: usize, const DRIFT: bool, const SPIN: bool>(
        &self,
        c: Chunk,
        beside: &Beside,
        masses: impl Fn(usize) -> [f64; 4],
    ) -> Came {
        // SAFETY: the processor has AVX2.
        unsafe { self.four::<crate::math::four::Avx2, KICKS, DRIFT, SPIN>(c, beside, masses) }
    }

    /// Four particles at a time, and those one by one of whom not the same is true.
    ///
    /// # Safety
    /// The processor must have what the form needs.
    #[inline(always)]
    unsafe fn four<F: Threes, const KICKS: usize, const DRIFT: bool, const SPIN: bool>(
        &self,
        c: Chunk,
        beside: &Beside,
        masses: impl Fn(usize) -> [f64; 4],
    ) -> Came {
        let (x4, x) = c.x.as_chunks_mut::<4>();
        let (v4, v) = c.v.as_chunks_mut::<4>();
        let (f4, f) = c.f.as_chunks_mut::<4>();
        let (mask4, mask) = c.mask.as_chunks::<4>();
        let (omega4, omega) = c.omega.as_chunks_mut::<4>();
        let (torque4, torque) = c.torque.as_chunks_mut::<4>();
        let (radius4, radius) = c.radius.as_chunks::<4>();
        let mut came = Came::default();
        let rest = Chunk { x, v, f, mask, omega, torque, radius };
        self.each::<KICKS, DRIFT, SPIN>(rest, &masses(mask4.len()), beside, &mut came);
        let a = beside.pull.map_or([0.0; 3], |pull| pull.a);
        let pulled = beside.pull.map_or(0, |pull| pull.bit);
        // SAFETY (all below): the caller's promise; arrays of twelve and of four numbers.
        let (zero, along) = unsafe { (F::splat(0.0), threes::repeated::<F>(a)) };
        let (mut fastest, mut wrong, mut energy) = (zero, zero, zero);
        for (k, (((x, v), f), mask)) in x4.iter_mut().zip(v4).zip(f4).zip(mask4).enumerate() {
            let m = masses(k);
            let (all, some) = (mask[0] & mask[1] & mask[2] & mask[3], mask[0] | mask[1] | mask[2] | mask[3]);
            if all & self.bit == 0 || all & pulled != pulled || some & beside.held != 0 {
                let omega = omega4.get_mut(k).map_or(&mut [][..], |four| &mut four[..]);
                let torque = torque4.get_mut(k).map_or(&mut [][..], |four| &mut four[..]);
                let radius = radius4.get(k).map_or(&[][..], |four| &four[..]);
                let four = Chunk { x, v, f, mask, omega, torque, radius };
                self.each::<KICKS, DRIFT, SPIN>(four, &m, beside, &mut came);
                continue;
            }
            unsafe {
                let m = F::load(m.as_ptr());
                let (at, force) = (x.as_flattened_mut().as_mut_ptr(), f.as_flattened_mut().as_mut_ptr());
                let mut push = threes::load::<F>(force);
                if pulled != 0 {
                    let [ma, mb, mc] = m.spread();
                    push = [push[0] + ma * along[0], push[1] + mb * along[1], push[2] + mc * along[2]];
                    let [x, y, z] = F::parted(threes::load(at));
                    energy = energy - m * (x * a[0] + y * a[1] + z * a[2]);
                }
                if beside.clears {
                    threes::store([zero; 3], force);
                } else if pulled != 0 {
                    threes::store(push, force);
                }
                let v = kicked::<F, KICKS>(v, push, F::splat(self.half) / m);
                if SPIN {
                    let r = F::load(radius4[k].as_ptr());
                    let turn = threes::load::<F>(torque4[k].as_flattened().as_ptr());
                    kicked::<F, KICKS>(&mut omega4[k], turn, F::splat(self.spin) / (r * r * m));
                }
                if beside.clears && k < torque4.len() {
                    threes::store([zero; 3], torque4[k].as_flattened_mut().as_mut_ptr());
                }
                if DRIFT {
                    let [a, b, c] = threes::load::<F>(at);
                    threes::store([a + v[0] * self.dt, b + v[1] * self.dt, c + v[2] * self.dt], at);
                    let [x, y, z] = F::parted([v[0] * v[0], v[1] * v[1], v[2] * v[2]]);
                    let square = x + y + z;
                    fastest = fastest.most(square);
                    // Zero times what is infinite or no number is no number, and stays so in a sum.
                    wrong = wrong + square * 0.0;
                }
            }
        }
        came.most = (fastest + wrong).numbers().into_iter().fold(came.most, faster);
        came.energy += energy.numbers().iter().sum::<f64>();
        came
    }

    /// A few particles, one by one.
    #[inline(always)]
    fn each<const KICKS: usize, const DRIFT: bool, const SPIN: bool>(
        &self,
        c: Chunk,
        m: &[f64; 4],
        beside: &Beside,
        came: &mut Came,
    ) {
        if let Some(pull) = &beside.pull {
            came.energy += pulled_each(c.f, c.x, m, c.mask, pull.bit, pull.a);
        }
        for i in (0..c.mask.len()).filter(|i| c.mask[*i] & beside.held != 0) {
            (0..3).for_each(|d| came.held[d] += c.f[i][d]);
            c.f[i] = [0.0; 3];
            c.torque.get_mut(i).into_iter().for_each(|torque| *torque = [0.0; 3]);
        }
        for (i, m) in (0..c.mask.len()).zip(m).filter(|(i, _)| c.mask[*i] & self.bit != 0) {
            let v = &mut c.v[i];
            kick::<KICKS>(v, &c.f[i], self.half / m);
            if DRIFT {
                (0..3).for_each(|d| c.x[i][d] += self.dt * v[d]);
                came.most = faster(came.most, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
            }
            if SPIN {
                let r = c.radius[i];
                kick::<KICKS>(&mut c.omega[i], &c.torque[i], self.spin / (r * r * m));
            }
        }
        if beside.clears {
            c.f.fill([0.0; 3]);
            c.torque.fill([0.0; 3]);
        }
    }
}

/// Particles of a stretch as the loops see them.
fn chunk<'a>(s: &'a mut Stretch<'_>, own: Range<usize>) -> Chunk<'a> {
    let first = s.start + own.start;
    let (omega, torque, radius) = match s.omega.is_empty() {
        true => (&mut [][..], &mut [][..], &[][..]),
        false => {
            (&mut s.omega[own.clone()], &mut s.torque[own.clone()], &s.all.radius[first..first + own.len()])
        }
    };
    let (x, v, f) = (&mut s.x[own.clone()], &mut s.v[own.clone()], &mut s.f[own.clone()]);
    Chunk { x, v, f, mask: &s.mask[own], omega, torque, radius }
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
unsafe fn kicked<F: Threes, const KICKS: usize>(v: &mut [Vec3; 4], [fa, fb, fc]: [F; 3], by: F) -> [F; 3] {
    let p = v.as_flattened_mut().as_mut_ptr();
    // SAFETY: twelve numbers; the rest is the caller's promise.
    unsafe {
        let ([a, b, c], [ba, bb, bc]) = (threes::load::<F>(p), by.spread());
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
pub(super) fn faster(a: f64, b: f64) -> f64 {
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
    use crate::plan::Pull;

    const N: usize = 11;

    fn some(seed: usize) -> Vec<Vec3> {
        let at = |i: usize| (((i * 7919 + seed * 104_729) % 1013) as f64 - 506.0) / 97.0;
        (0..N).map(|i| [at(3 * i), at(3 * i + 1), at(3 * i + 2)]).collect()
    }

    /// Positions, velocities and spins after these parts, by any form, and the last largest v².
    fn moved(parts: &[Part], wide: bool) -> (Vec<Vec3>, Vec<Vec3>, Vec<Vec3>, f64) {
        let (mut x, mut v, mut omega) = (some(1), some(2), some(3));
        let (mut f, mut torque) = (some(4), some(5));
        let radius: Vec<f64> = (0..N).map(|i| 0.3 + 0.01 * i as f64).collect();
        let mask: Vec<u32> = (0..N).map(|i| if i == 6 { 1 } else { 3 }).collect();
        let k = Kick { half: 0.01, spin: 0.025, dt: 0.02, bit: 2 };
        let masses = |k: usize| std::array::from_fn(|l| 1.0 + (4 * k + l) as f64 / 3.0);
        let mut fastest = 0.0;
        for part in parts {
            let (x, v, f, omega, torque) =
                (&mut x[..], &mut v[..], &mut f[..], &mut omega[..], &mut torque[..]);
            let c = Chunk { x, v, f, mask: &mask, omega, torque, radius: &radius };
            let beside = Beside::default();
            fastest = match (part, wide) {
                (_, true) => k.chunk(c, *part, true, &beside, masses),
                // SAFETY: the portable form needs nothing.
                (Part::First, _) => unsafe { k.four::<Plain, 1, true, true>(c, &beside, masses) },
                // SAFETY: as above.
                (Part::Second, _) => unsafe { k.four::<Plain, 1, false, true>(c, &beside, masses) },
                // SAFETY: as above.
                (Part::Both, _) => unsafe { k.four::<Plain, 2, true, true>(c, &beside, masses) },
            }
            .most;
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
    fn what_stands_beside_a_motion_has_the_bits_it_has_alone() {
        let (pull, held) = (Pull { bit: 1, a: [0.3, -0.7, 1.1] }, 4);
        let beside = Beside { pull: Some(pull), held, clears: true };
        let k = Kick { half: 0.01, spin: 0.025, dt: 0.02, bit: 2 };
        let mass: Vec<f64> = (0..N).map(|i| 1.0 + i as f64 / 3.0).collect();
        let masses = |k: usize| std::array::from_fn(|l| mass.get(4 * k + l).copied().unwrap_or(1.0));
        let radius: Vec<f64> = (0..N).map(|i| 0.3 + 0.01 * i as f64).collect();
        // All alike, one that is held, one that is not pulled, one that stays.
        for mask in [[3; N], [3, 3, 3, 3, 7, 3, 3, 3, 3, 3, 7], [3, 3, 3, 3, 3, 2, 3, 3, 1, 3, 3]] {
            let run = |together: bool| {
                let (mut x, mut v, mut omega) = (some(1), some(2), some(3));
                let (mut f, mut torque) = (some(4), some(5));
                let (mut energy, mut taken) = (0.0, [0.0; 3]);
                if !together {
                    energy = pulled_each(&mut f, &x, &mass, &mask, pull.bit, pull.a);
                    for i in (0..N).filter(|&i| mask[i] & held != 0) {
                        (0..3).for_each(|d| taken[d] += f[i][d]);
                        (f[i], torque[i]) = ([0.0; 3], [0.0; 3]);
                    }
                }
                let c = Chunk {
                    x: &mut x,
                    v: &mut v,
                    f: &mut f,
                    mask: &mask,
                    omega: &mut omega,
                    torque: &mut torque,
                    radius: &radius,
                };
                let with = if together { beside } else { Beside::default() };
                let came = k.chunk(c, Part::Both, true, &with, masses);
                if together {
                    (energy, taken) = (came.energy, came.held);
                    assert_eq!([f, torque], [vec![[0.0; 3]; N], vec![[0.0; 3]; N]]);
                }
                ((x, v, omega, taken, came.most), energy)
            };
            let ((one, energy), (each, expected)) = (run(true), run(false));
            assert_eq!(one, each);
            // Eleven terms of about 10, added in another order.
            assert!((energy - expected).abs() < 1e-13, "{energy} {expected}");
        }
    }

    #[test]
    fn who_moves_by_no_number_is_infinitely_fast_whoever_follows() {
        let k = Kick { half: 0.01, spin: 0.025, dt: 0.02, bit: 1 };
        for i in 0..N {
            let (mut x, mut v, mut f) = (some(1), some(2), some(4));
            v[i][1] = f64::NAN;
            let (x, v, f) = (&mut x[..], &mut v[..], &mut f[..]);
            let c = Chunk { x, v, f, mask: &[1; N], omega: &mut [], torque: &mut [], radius: &[] };
            let most = k.chunk(c, Part::First, false, &Beside::default(), |_| [1.0; 4]).most;
            assert_eq!(most, f64::INFINITY, "{i}");
        }
    }
}
