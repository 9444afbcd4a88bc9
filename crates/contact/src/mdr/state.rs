//! State of plastic grains: original and current size, free surface, strain, mean stress.

use super::Material;
use perigrain_world::columns::Columns;
use perigrain_world::contacts::Contacts;
use perigrain_world::{Constant, Under, World};
use std::f64::consts::PI;

/// How the names of the columns begin: decks read them as those of a fix property/atom.
pub const BEGIN: &str = "property/atom/mdr/";

macro_rules! columns {
    ($($name:ident)*) => {
        [$(Constant::in_role(
            concat!("property/atom/mdr/d_", stringify!($name)),
            concat!("d_", stringify!($name)),
        )),*]
    };
}

/// The name in `memo` of the last step that plastic grains have begun.
pub static BEGUN: Constant<Vec<f64>> = Constant::new("mdr/begun");

/// The name of the contacts of plastic grains, besides those of their pair style: the history of each side, and what both have in common.
pub static SIDES: Constant<Contacts> = Constant::moved("mdr", Under::Sides);

/// The columns, named as in LAMMPS' decks.
static COLUMNS: [Constant<Vec<f64>>; 21] = columns![
    Ro dRavg Vgeo Velas Vcaps eps_bar dRnumerator dRdenominator Acon0 Acon1 Atot Atot_sum ddelta_bar psi
    sigmaxx sigmayy sigmazz sigmaxy sigmaxz sigmayz grown
];

/// Smoothing of the growth: weight of each step's growth against the mean of earlier ones.
const FRESH: f64 = 0.1;

/// The columns of all grains.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// Original radius [length]; 0 for new grains.
    pub first: Vec<f64>,
    /// Mean growth of recent steps.
    pub growth: Vec<f64>,
    /// Volume without the caps cut off by planes.
    pub left_volume: Vec<f64>,
    /// Volume under the mean stress.
    pub volume: Vec<f64>,
    /// Volume of the caps cut off by planes.
    pub caps: Vec<f64>,
    /// Mean volumetric strain.
    pub strain: Vec<f64>,
    /// Volume displaced by plastic flow in this step, negative.
    pub displaced: Vec<f64>,
    /// Reduction of the surface over which it is distributed.
    pub covered: Vec<f64>,
    /// Contact area in the previous step.
    pub area_before: Vec<f64>,
    /// Contact area.
    pub area: Vec<f64>,
    /// Total surface area.
    pub surface: Vec<f64>,
    /// Change of the surface area by planes.
    pub surface_change: Vec<f64>,
    /// Area-weighted mean approach of the planes in this step.
    pub mean: Vec<f64>,
    /// ψ: the free fraction of the surface.
    pub free: Vec<f64>,
    /// Mean stress: xx yy zz xy xz yz.
    pub stress: [Vec<f64>; 6],
    /// Growth in this step.
    pub grown: Vec<f64>,
}

/// Data of a grain that contacts need: see [`State`].
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub struct Grain<R = f64> {
    /// Original radius.
    pub first: R,
    /// Volume under the mean stress.
    pub volume: R,
    /// Volume without the caps cut off by planes.
    pub left_volume: R,
    /// Contact area in the previous step.
    pub area_before: R,
    /// The bulk's response: the mean approach of its planes if too little of its surface is free, else 0.
    pub mean: R,
    /// Radius.
    pub radius: R,
}

impl<R> Grain<R> {
    /// From its numbers, in memory order.
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

    /// Takes the columns out of the world; creates missing ones.
    pub fn take(columns: &mut Columns, n: usize) -> Self {
        let mut state = Self::default();
        for (key, column) in COLUMNS.iter().zip(state.all()) {
            *column = std::mem::take(columns.scalar(**key, n));
        }
        state
    }

    /// Creates the columns; contacts from a restart file are known by their name from now on.
    pub fn declare(w: &mut World) {
        let n = w.n();
        debug_assert_eq!(SIDES.under(), Some(Under::Sides));
        for key in COLUMNS.iter() {
            w.columns.scalar(**key, n);
        }
    }

    /// Puts the columns back.
    pub fn put(mut self, columns: &mut Columns) {
        for (key, column) in COLUMNS.iter().zip(self.all()) {
            let n = column.len();
            *columns.scalar(**key, n) = std::mem::take(column);
        }
    }

    /// Initializes new grains.
    pub fn add_grains(&mut self, radius: &[f64]) {
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

    /// Begins a step: surface and volume after the contacts of the previous step, and growth by the volume
    /// they displaced. Resets the sums over contacts.
    pub fn begin(&mut self, m: &Material, radius: &mut [f64]) {
        for (k, r) in radius.iter_mut().enumerate() {
            self.surface[k] = 4.0 * PI * *r * *r + self.surface_change[k];
            self.grown[k] = 0.0;
            let first = self.first[k];
            let whole = 4.0 / 3.0 * PI * first * first * first;
            self.volume[k] = whole * (1.0 + self.strain[k]);
            self.left_volume[k] = (4.0 / 3.0 * PI * *r * *r * *r - self.caps[k]).min(whole);
            self.free[k] = (self.surface[k] - self.area[k]) / self.surface[k];
            // The surface rises uniformly where no plane covers it, by the displaced volume.
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

    /// The data of grain `k` of this radius for contacts.
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

/// Whether this step has been begun (`at` as for [`begin`]).
pub fn begun(w: &World, at: (i64, bool)) -> bool {
    !at.1 && w.memo.get(*BEGUN).is_some_and(|s| s[..] == [at.0 as f64])
}

/// Begins step `at.0` for all grains, unless that has been done in this step; in the setup (`at.1`) grains
/// are only measured.
pub fn begin(w: &mut World, at: (i64, bool), m: &Material) -> State {
    let (step, setup) = (at.0 as f64, at.1);
    let n = w.n();
    let mut state = State::take(&mut w.columns, n);
    state.add_grains(&w.particles.radius);
    if !setup && !begun(w, at) {
        state.begin(m, &mut w.particles.radius);
        w.memo.insert(*BEGUN, vec![step]);
    }
    state
}
