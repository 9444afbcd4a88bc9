//! Pairs in short-range contact, in columns, and how hard they push each other: several at a time.

use std::ops::Range;

use crate::families::view::Sums;
use crate::families::{FamilyOptions, ForceUnit, PeriView, PmbTable};
use perigrain_base::math::form::InLanes;
use perigrain_base::math::lanes::Lanes;
use perigrain_base::math::vec3::SIX;

/// The most lanes.
const MOST: usize = 8;

/// Pairs that touch, or a few more: columns of which the first `count` numbers are in use.
#[derive(Debug, Default)]
pub struct Hits {
    /// How many.
    pub count: usize,
    /// The vector from the second particle to the first.
    pub d: [Vec<f64>; 3],
    /// Its square.
    pub square: Vec<f64>,
    /// The distance at which they touch.
    pub contact: Vec<f64>,
    /// 15 c/delta.
    pub stiff: Vec<f64>,
    /// The volume in the force on the first particle, and that of the second particle.
    pub volume: [Vec<f64>; 2],
    /// What comes out: the force on the first particle over the volume in it and over `d`.
    pub pull: Vec<f64>,
}

impl Hits {
    /// Makes room for so many more, and as many as kernels read beyond.
    #[inline]
    pub fn room(&mut self, more: usize) {
        let wanted = self.count + more + MOST;
        if self.pull.len() < wanted {
            self.grow(2 * wanted);
        }
    }

    #[cold]
    fn grow(&mut self, wanted: usize) {
        let Self { d: [x, y, z], square, contact, stiff, volume: [own, far], pull, .. } = self;
        for column in [x, y, z, square, contact, stiff, own, far, pull] {
            column.resize(wanted, 0.0);
        }
    }

    /// Takes a pair in hand: its vector, the square of that, the distance of contact and 15 c/delta.
    #[inline(always)]
    pub fn add(&mut self, [x, y, z, square, contact, stiff]: [f64; 6]) {
        self.room(1);
        let at = self.count;
        (self.d[0][at], self.d[1][at], self.d[2][at]) = (x, y, z);
        (self.square[at], self.contact[at], self.stiff[at]) = (square, contact, stiff);
        self.count += 1;
    }

    /// The vector of a pair.
    #[inline(always)]
    pub fn vector(&self, at: usize) -> [f64; 3] {
        [self.d[0][at], self.d[1][at], self.d[2][at]]
    }

    /// The energy of the second particle's push on the first one, over the volume in it: ¼ 15 c (d − r)²/delta.
    pub fn energy(&self, at: usize) -> f64 {
        let gap = self.contact[at] - self.square[at].sqrt();
        0.25 * self.stiff[at] * gap * gap
    }

    /// The energy of a particle of this volume under some pushes, and its half of their virial, which has the volumes of both ends.
    pub fn sums(&self, own: f64, all: Range<usize>) -> Sums {
        let mut sums = [0.0; 7];
        for at in all {
            sums[0] += self.energy(at) * self.volume[0][at];
            let (d, half) = (self.vector(at), 0.5 * self.pull[at] * own * self.volume[1][at]);
            SIX.iter().zip(&mut sums[1..]).for_each(|(&(a, b), v)| *v += half * d[a] * d[b]);
        }
        sums
    }
}

/// Finds how hard pairs push: f = 15 c V (d − r)/delta for r < d = min(0.9 |x0_i − x0_j|, 1.35 dx) (Parks et al. 2008, LAMMPS' peri
/// styles).
pub struct Push<'a>(pub &'a mut Hits);

impl InLanes for Push<'_> {
    type Out = ();
    const PICKS: bool = false;
    #[inline(always)]
    unsafe fn run<const N: usize, V: Lanes<N>>(self) {
        let hits = self.0;
        hits.room(0);
        // SAFETY: the caller's promise.
        let zero = unsafe { V::all(0.0) };
        for at in (0..hits.count).step_by(N) {
            let r = zero.like_column(&hits.square, at).sqrt();
            let gap = zero.like_column(&hits.contact, at) - r;
            // No direction where two are at the same place.
            let apart = r.at_least(zero.like(f64::MIN_POSITIVE));
            let pull = (zero.like_column(&hits.stiff, at) * gap / r).keep(apart);
            pull.to_column(&mut hits.pull, at);
        }
    }
}

/// What pushes depend on beside places.
pub struct Rules<'a> {
    /// Particles.
    pub view: &'a PeriView<'a>,
    unit: ForceUnit,
    compat: bool,
    /// 15 c/delta by pairs of types; NaN where there is no contact.
    stiff: &'a [f64],
    types: usize,
}

impl<'a> Rules<'a> {
    /// Those of a scene; `stiff` is scratch.
    pub fn new(
        view: &'a PeriView<'a>,
        table: &PmbTable,
        options: &FamilyOptions,
        stiff: &'a mut Vec<f64>,
    ) -> Self {
        let types = table.types();
        let pairs = (0..types * types).map(|k| table.get((k / types + 1) as u16, (k % types + 1) as u16));
        stiff.clear();
        stiff.extend(pairs.map(|pair| pair.map_or(f64::NAN, |k| 15.0 * k.c / k.horizon)));
        Self { view, unit: options.unit, compat: options.compat_lammps, stiff, types }
    }

    /// 15 c/delta of two particles, if they may touch.
    #[inline(always)]
    pub fn stiff(&self, i: u32, j: u32) -> Option<f64> {
        let stiff = match *self.stiff {
            [only] => only,
            _ => {
                let [a, b] = [i, j].map(|p| usize::from(self.view.kind[p as usize]) - 1);
                self.stiff[a * self.types + b]
            }
        };
        (!stiff.is_nan() && !self.view.excludes(i, j)).then_some(stiff)
    }

    /// The volume in the force on a particle from another one, of their volumes; `before` says that the first has the lower number:
    /// LAMMPS takes the volume of the second particle for both ends.
    #[inline(always)]
    pub fn volume(&self, own: f64, far: f64, before: bool) -> f64 {
        match self.unit {
            ForceUnit::Newton => own * far,
            ForceUnit::Density if self.compat && !before => own,
            ForceUnit::Density => far,
        }
    }
}
