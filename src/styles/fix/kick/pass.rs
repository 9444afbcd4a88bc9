//! One pass over particles: kicks, drifts and what stands beside them, four particles at a time.

use super::super::freeze::hold;
use super::super::gravity::{pulled_each, pulled_four};
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
                    let depth;
                    (push, depth) = pulled_four(push, threes::load(at), m, along, a);
                    energy = energy - depth;
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
        hold(c.f, c.torque, c.mask, beside.held, &mut came.held);
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
mod tests;
