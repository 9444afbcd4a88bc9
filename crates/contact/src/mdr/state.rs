//! What grains of a powder know of themselves: their first and present size, free surface, strain, mean stress.

use super::Material;
use perigrain_world::columns::{Columns, PLASTIC_BEGUN};
use perigrain_world::{Constant, World};
use std::f64::consts::PI;

macro_rules! columns {
    ($($name:ident)*) => { [$(Constant::new(concat!("property/atom/mdr/d_", stringify!($name)))),*] };
}

/// The columns, named as LAMMPS' decks call them.
static COLUMNS: [Constant<Vec<f64>>; 21] = columns![
    Ro dRavg Vgeo Velas Vcaps eps_bar dRnumerator dRdenominator Acon0 Acon1 Atot Atot_sum ddelta_bar psi
    sigmaxx sigmayy sigmazz sigmaxy sigmaxz sigmayz grown
];

/// How slowly growth follows: each step's growth is mixed with the mean of those before.
const FRESH: f64 = 0.1;

/// The columns of all grains.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// First radius [length]; 0 of grains that nobody has looked at.
    pub first: Vec<f64>,
    /// Mean growth of recent steps.
    pub growth: Vec<f64>,
    /// Volume without what planes cut off.
    pub left_volume: Vec<f64>,
    /// Volume under the mean stress.
    pub volume: Vec<f64>,
    /// Volume that planes cut off.
    pub caps: Vec<f64>,
    /// Mean volumetric strain.
    pub strain: Vec<f64>,
    /// Volume that flow displaces in this step, negative.
    pub displaced: Vec<f64>,
    /// By how much that takes off the surface over which it is spread.
    pub covered: Vec<f64>,
    /// Area of contact in the step before.
    pub area_before: Vec<f64>,
    /// Area of contact.
    pub area: Vec<f64>,
    /// All of the surface.
    pub surface: Vec<f64>,
    /// What planes change of it.
    pub surface_change: Vec<f64>,
    /// By how much planes came nearer in this step, on average over their areas.
    pub mean: Vec<f64>,
    /// ψ: the free part of the surface.
    pub free: Vec<f64>,
    /// Mean stress: xx yy zz xy xz yz.
    pub stress: [Vec<f64>; 6],
    /// Growth in this step.
    pub grown: Vec<f64>,
}

/// What contacts ask about a grain: see [`State`].
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Grain<R = f64> {
    /// First radius.
    pub first: R,
    /// Volume under the mean stress.
    pub volume: R,
    /// Volume without what planes cut off.
    pub left_volume: R,
    /// Area of contact in the step before.
    pub area_before: R,
    /// How the bulk answers: the mean approach of its planes where too little of its surface is free, else 0.
    pub mean: R,
    /// Radius.
    pub radius: R,
}

impl<R> Grain<R> {
    /// From its numbers, as they stand in memory.
    #[inline(always)]
    pub fn of([first, volume, left_volume, area_before, mean, radius]: [R; 6]) -> Self {
        Self { first, volume, left_volume, area_before, mean, radius }
    }
}

impl State {
    fn all(&mut self) -> [&mut Vec<f64>; 21] {
        let [xx, yy, zz, xy, xz, yz] = &mut self.stress;
        [
            &mut self.first,
            &mut self.growth,
            &mut self.left_volume,
            &mut self.volume,
            &mut self.caps,
            &mut self.strain,
            &mut self.displaced,
            &mut self.covered,
            &mut self.area_before,
            &mut self.area,
            &mut self.surface,
            &mut self.surface_change,
            &mut self.mean,
            &mut self.free,
            xx,
            yy,
            zz,
            xy,
            xz,
            yz,
            &mut self.grown,
        ]
    }

    /// Takes the columns out of the world; they are made where they are missing.
    pub fn take(columns: &mut Columns, n: usize) -> Self {
        let mut state = Self::default();
        for (key, column) in COLUMNS.iter().zip(state.all()) {
            *column = std::mem::take(columns.scalar(**key, n));
        }
        state
    }

    /// Makes the columns.
    pub fn declare(w: &mut World) {
        let n = w.n();
        for key in COLUMNS.iter() {
            w.columns.scalar(**key, n);
        }
    }

    /// Puts them back.
    pub fn put(mut self, columns: &mut Columns) {
        for (key, column) in COLUMNS.iter().zip(self.all()) {
            let n = column.len();
            *columns.scalar(**key, n) = std::mem::take(column);
        }
    }

    /// Measures grains that are new.
    pub fn welcome(&mut self, radius: &[f64]) {
        for (k, &r) in radius.iter().enumerate() {
            if self.first[k] != 0.0 {
                continue;
            }
            self.first[k] = r;
            self.volume[k] = 4.0 / 3.0 * PI * r * r * r;
            self.left_volume[k] = self.volume[k];
            self.surface[k] = 4.0 * PI * r * r;
            self.free[k] = 1.0;
        }
    }

    /// Begins a step: surface and volume after the contacts of the step before, growth by what they displaced. Sums over
    /// contacts begin anew.
    pub fn begin(&mut self, m: &Material, radius: &mut [f64]) {
        for (k, r) in radius.iter_mut().enumerate() {
            self.surface[k] = 4.0 * PI * *r * *r + self.surface_change[k];
            self.grown[k] = 0.0;
            let first = self.first[k];
            let whole = 4.0 / 3.0 * PI * first * first * first;
            self.volume[k] = whole * (1.0 + self.strain[k]);
            self.left_volume[k] = (4.0 / 3.0 * PI * *r * *r * *r - self.caps[k]).min(whole);
            self.free[k] = (self.surface[k] - self.area[k]) / self.surface[k];
            // The surface rises everywhere by what is displaced over the part of it that no plane covers.
            let rise = self.displaced[k] / (self.covered[k] - 4.0 * PI * *r * *r);
            if rise > 0.0 && self.covered[k] != 0.0 && self.free[k] >= m.confinement {
                self.growth[k] = (1.0 - FRESH) * self.growth[k] + FRESH * rise;
                self.grown[k] = self.growth[k];
                *r += self.growth[k];
            }
            self.area_before[k] = self.area[k];
        }
        let sums = [
            &mut self.caps,
            &mut self.strain,
            &mut self.displaced,
            &mut self.covered,
            &mut self.area,
            &mut self.surface_change,
            &mut self.mean,
        ];
        sums.into_iter().chain(&mut self.stress).for_each(|c| c.fill(0.0));
    }

    /// What contacts ask about grain `k` of this radius.
    pub fn grain(&self, m: &Material, k: usize, radius: f64) -> Grain {
        Grain {
            first: self.first[k],
            volume: self.volume[k],
            left_volume: self.left_volume[k],
            area_before: self.area_before[k],
            mean: if self.free[k] < m.confinement { self.mean[k] } else { 0.0 },
            radius,
        }
    }
}

/// Whether somebody has begun this step (`at` as for [`begin`]).
pub fn begun(w: &World, at: (i64, bool)) -> bool {
    !at.1 && w.memo.get(*PLASTIC_BEGUN).is_some_and(|s| s[..] == [at.0 as f64])
}

/// Begins step `at.0` for all grains, unless somebody has done so in this step; in setup (`at.1`) grains are only measured.
pub fn begin(w: &mut World, at: (i64, bool), m: &Material) -> State {
    let (step, setup) = (at.0 as f64, at.1);
    let n = w.n();
    let mut state = State::take(&mut w.columns, n);
    state.welcome(&w.particles.radius);
    if !setup && !begun(w, at) {
        state.begin(m, &mut w.particles.radius);
        w.memo.insert(*PLASTIC_BEGUN, vec![step]);
    }
    state
}
