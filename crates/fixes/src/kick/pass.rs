//! One pass over particles: kicks, drifts and the fused forces, four particles at a time.

use super::super::enforce2d::{flatten, flatten_turning};
use super::super::freeze::hold;
use super::super::gravity::{pulled_each, pulled_four};
use chunk::{Chunk, Fours, chunk};
use kicks::{Parts, kick, kicked, only, parts_of};
use perigrain_base::math::body::rolled;
use perigrain_base::math::four::{Plain, has_avx2};
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::real::largest;
use perigrain_base::math::threes::{self, Threes};
use perigrain_plan::{Beside, BlockSums, ParticleBlock};
use perigrain_styles::matter::Masses;
use std::ops::Range;

mod chunk;
mod kicks;

/// The part of a step that a pass computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Part {
    /// First half kick and drift: v += Δt/2 · f/m, x += Δt · v; spins like velocities.
    First,
    /// Second half kick.
    Second,
    /// The second half kick of a step, and the first half kick and drift of the next one with the same
    /// forces.
    Both,
}

/// Constants for all particles.
#[derive(Clone, Copy)]
pub(super) struct Kick {
    /// Δt/2 in units that turn force/mass into velocity.
    pub half: f64,
    /// The same divided by I / (m R²).
    pub spin: f64,
    pub dt: f64,
    pub bit: u32,
    /// Whether orientations are integrated.
    pub oriented: bool,
}

/// Results of a chunk.
#[derive(Default)]
struct Came {
    /// Σ −m a·x over the particles that were pulled, before they drifted.
    energy: f64,
    /// Sum of the forces removed from held particles.
    held: [f64; 3],
    /// The largest v² after a drift.
    most: f64,
}

/// Results of groups of four, lane by lane.
struct Sums<F> {
    /// The largest v².
    fastest: F,
    /// Zero, unless some v² is not a number.
    wrong: F,
    energy: F,
}

impl<F: Threes> Sums<F> {
    /// # Safety
    /// The processor must support the form.
    #[inline(always)]
    unsafe fn new() -> Self {
        // SAFETY: the caller's guarantee.
        let zero = unsafe { F::splat(0.0) };
        Self { fastest: zero, wrong: zero, energy: zero }
    }
}

impl Kick {
    /// A block with the fused forces: results of the pull, the hold and the motion, with the same bits as
    /// when each runs alone.
    pub fn together(
        &self,
        s: &mut ParticleBlock,
        spins: bool,
        part: Part,
        mass: &[f64],
        beside: &Beside,
    ) -> [BlockSums; 3] {
        let (masses, start, own) = (Masses::Own(mass), s.start, 0..s.x.len());
        if beside.flat != 0 && !spins {
            let mask = s.mask();
            flatten_turning([&mut s.omega, &mut s.torque], mask, beside.flat);
        }
        let came = self.block(
            chunk(s, own, (spins, self.oriented, part), beside),
            spins,
            part,
            &masses,
            start,
            beside,
        );
        let sums = |sums| BlockSums { sums, most: 0.0 };
        [
            sums([came.energy, 0.0, 0.0]),
            sums(came.held),
            BlockSums { most: came.most, ..BlockSums::default() },
        ]
    }

    /// Some particles of a block; returns the largest v² after a drift.
    pub fn part_of(
        &self,
        s: &mut ParticleBlock,
        own: Range<usize>,
        spins: bool,
        part: Part,
        masses: &Masses,
    ) -> f64 {
        let first = s.start + own.start;
        {
            let alone = Beside::default();
            self.block(
                chunk(s, own, (spins, self.oriented, part), &alone),
                spins,
                part,
                masses,
                first,
                &alone,
            )
            .most
        }
    }

    /// The particles from `start` on.
    fn block(
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

    /// A chunk; `masses(k)` are the masses of four particles from `4 k` on, with arbitrary values beyond the
    /// end.
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

    /// Uses the widest form of this processor; the bits are the same.
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
        // SAFETY: the portable form has no requirements.
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
        unsafe { self.four::<perigrain_base::math::four::Avx2, KICKS, DRIFT, SPIN>(c, beside, masses) }
    }

    /// Four particles at a time; groups of four with different states one by one.
    ///
    /// # Safety
    /// The processor must support the form.
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
        let (quat4, quat) = c.quat.as_chunks_mut::<4>();
        let mut came = Came::default();
        let rest = Chunk { x, v, f, mask, omega, torque, radius, quat };
        self.each::<KICKS, DRIFT, SPIN>(rest, &masses(mask4.len()), beside, &mut came);
        let pulled = beside.pull.map_or(0, |pull| pull.bit);
        let same = |masks: &[u32]| {
            let (all, some) = masks.iter().fold((u32::MAX, 0), |(all, some), m| (all & m, some | m));
            let flat = all & beside.flat == beside.flat;
            all & self.bit != 0 && all & pulled == pulled && some & beside.held == 0 && flat
        };
        let mut fours =
            Fours { x: x4, v: v4, f: f4, omega: omega4, torque: torque4, radius: radius4, quat: quat4 };
        // SAFETY (all below): the caller's guarantee.
        let mut sums = unsafe { Sums::<F>::new() };
        if same(mask4.as_flattened()) {
            unsafe {
                self.all::<F, KICKS, DRIFT, SPIN>(&mut fours, 0..mask4.len(), &masses, beside, &mut sums)
            };
        } else {
            for (k, mask) in mask4.iter().enumerate() {
                if same(mask) {
                    unsafe {
                        self.all::<F, KICKS, DRIFT, SPIN>(&mut fours, k..k + 1, &masses, beside, &mut sums)
                    };
                } else {
                    self.each::<KICKS, DRIFT, SPIN>(fours.one(k, mask), &masses(k), beside, &mut came);
                }
            }
        }
        came.most = (sums.fastest + sums.wrong).numbers().into_iter().fold(came.most, largest);
        came.energy += sums.energy.numbers().iter().sum::<f64>();
        came
    }

    /// Particles in the same state, four at a time: these groups of four of a chunk.
    ///
    /// # Safety
    /// The processor must support the form.
    #[inline(always)]
    unsafe fn all<F: Threes, const KICKS: usize, const DRIFT: bool, const SPIN: bool>(
        &self,
        c: &mut Fours,
        own: Range<usize>,
        masses: &impl Fn(usize) -> [f64; 4],
        beside: &Beside,
        sums: &mut Sums<F>,
    ) {
        let first = own.start;
        // Cut to one length, so that bounds are checked once.
        let (x, v, f) = (&mut c.x[own.clone()], &mut c.v[own.clone()], &mut c.f[own.clone()]);
        let n = x.len();
        let (v, f) = (&mut v[..n], &mut f[..n]);
        let spinning = if SPIN { own.clone() } else { 0..0 };
        let (omega, radius) = (&mut c.omega[spinning.clone()], &c.radius[spinning]);
        let quat = if c.quat.is_empty() { &mut [][..] } else { &mut c.quat[own.clone()] };
        let torque = if c.torque.is_empty() { &mut [][..] } else { &mut c.torque[own] };
        let clears_torque = beside.clears && torque.len() == n;
        let (pulls, a) = beside.pull.map_or((false, [0.0; 3]), |pull| (true, pull.a));
        // SAFETY (all below): the caller's guarantee; arrays of twelve and of four numbers.
        unsafe {
            let (zero, along) = (F::splat(0.0), threes::repeated::<F>(a));
            let [level, about]: [Parts<F>; 2] = match beside.flat {
                0 => [None; 2],
                _ => [Some(parts_of::<F>([1.0, 1.0, 0.0])), Some(parts_of::<F>([0.0, 0.0, 1.0]))],
            };
            let (mut fastest, mut wrong, mut energy) = (sums.fastest, sums.wrong, sums.energy);
            for k in 0..n {
                let m = masses(first + k);
                let m = F::load(m.as_ptr());
                let at = x[k].as_flattened_mut().as_mut_ptr();
                let force = f[k].as_flattened_mut().as_mut_ptr();
                let mut push = threes::load::<F>(force);
                if pulls {
                    let depth;
                    (push, depth) = pulled_four(push, threes::load(at), m, along, a);
                    energy = energy - depth;
                }
                push = only(push, &level);
                if beside.clears {
                    threes::store([zero; 3], force);
                } else if pulls || beside.flat != 0 {
                    threes::store(push, force);
                }
                let v = kicked::<F, KICKS>(&mut v[k], &level, push, F::splat(self.half) / m);
                if SPIN {
                    let r = F::load(radius[k].as_ptr());
                    let turn = only(threes::load::<F>(torque[k].as_flattened().as_ptr()), &about);
                    let by = F::splat(self.spin) / (r * r * m);
                    let spin = kicked::<F, KICKS>(&mut omega[k], &about, turn, by);
                    if beside.flat != 0 && !clears_torque {
                        threes::store(turn, torque[k].as_flattened_mut().as_mut_ptr());
                    }
                    if DRIFT && let Some(four) = quat.get_mut(k) {
                        let spin = F::parted(spin);
                        let turns = (spin[0].abs() + spin[1].abs() + spin[2].abs()).above(zero);
                        // Roots and divisions dominate this pass: they are skipped where nothing rotates.
                        if F::any(turns) {
                            let rows = four.as_flattened_mut().as_mut_ptr();
                            let q = F::transpose([0, 4, 8, 12].map(|at| F::load(rows.add(at))));
                            let rolled = rolled(q, spin, 0.5 * self.dt);
                            let now = [0, 1, 2, 3].map(|c| F::choose(turns, rolled[c], q[c]));
                            let now = F::transpose(now);
                            now.into_iter().enumerate().for_each(|(l, row)| row.store(rows.add(4 * l)));
                        }
                    }
                }
                if clears_torque {
                    threes::store([zero; 3], torque[k].as_flattened_mut().as_mut_ptr());
                }
                if DRIFT {
                    let [a, b, c] = threes::load::<F>(at);
                    threes::store([a + v[0] * self.dt, b + v[1] * self.dt, c + v[2] * self.dt], at);
                    let [x, y, z] = F::parted([v[0] * v[0], v[1] * v[1], v[2] * v[2]]);
                    let square = x + y + z;
                    fastest = fastest.most(square);
                    // Zero times infinity or NaN is NaN, and stays NaN in a sum.
                    wrong = wrong + square * 0.0;
                }
            }
            (sums.fastest, sums.wrong, sums.energy) = (fastest, wrong, energy);
        }
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
        if beside.held != 0 {
            hold(c.f, c.torque, c.mask, beside.held, &mut came.held);
        }
        if beside.flat != 0 {
            flatten([c.v, c.f], c.mask, beside.flat);
            if SPIN {
                flatten_turning([c.omega, c.torque], c.mask, beside.flat);
            }
        }
        for (i, m) in (0..c.mask.len()).zip(m).filter(|(i, _)| c.mask[*i] & self.bit != 0) {
            let v = &mut c.v[i];
            kick::<KICKS>(v, &c.f[i], self.half / m);
            if DRIFT {
                (0..3).for_each(|d| c.x[i][d] += self.dt * v[d]);
                came.most = largest(came.most, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
            }
            if SPIN {
                let r = c.radius[i];
                kick::<KICKS>(&mut c.omega[i], &c.torque[i], self.spin / (r * r * m));
                let turns = c.omega[i].iter().map(|a| a.abs()).sum::<f64>() > 0.0;
                if DRIFT
                    && turns
                    && let Some(q) = c.quat.get_mut(i)
                {
                    *q = rolled(*q, c.omega[i], 0.5 * self.dt);
                }
            }
        }
        if beside.clears {
            c.f.fill([0.0; 3]);
            c.torque.fill([0.0; 3]);
        }
    }
}

#[cfg(test)]
mod tests;
