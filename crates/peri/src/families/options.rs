//! Everything about families that is not a coefficient.

use crate::families::bond_weights::BondWeights;
use crate::families::criterion::Criterion;
use crate::families::view::PeriView;

/// How the volume of a partner near the horizon counts (`peri_modify volume`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum VolumeRule {
    /// Weight (delta + dx/2 - |xi|)/dx within dx/2 of the horizon, where families end: LAMMPS.
    #[default]
    Lammps,
    /// Weight 1 for every bond up to the horizon.
    None,
    /// The same weight as LAMMPS, but families reach to delta + dx/2, where it vanishes.
    Full,
}

impl VolumeRule {
    /// How far families reach for horizon `delta` and lattice spacing `dx`.
    pub fn reach(self, delta: f64, dx: f64) -> f64 {
        if self == Self::Full { delta + 0.5 * dx } else { delta }
    }

    /// The weight of a bond of reference length `r0` (physics: Parks et al. 2008, eq. 14).
    pub fn weight(self, r0: f64, delta: f64, dx: f64) -> f64 {
        let half = 0.5 * dx;
        if self == Self::None || (r0 - delta).abs() > half {
            return 1.0;
        }
        (-1.0 / (2.0 * half)) * r0 + (1.0 + (delta - half) / (2.0 * half))
    }
}

/// What `f` holds (`peri_modify force`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum ForceUnit {
    /// Force per volume, as LAMMPS' peri styles.
    #[default]
    Density,
    /// Force: the density times the volume of the particle it acts on.
    Newton,
}

/// Which layout bonds are kept in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Layout {
    /// The lattice where a body is one, the list elsewhere.
    #[default]
    Auto,
    /// The list everywhere.
    List,
}

/// Everything about families that is not a coefficient.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FamilyOptions {
    /// Partial volumes.
    pub volume: VolumeRule,
    /// What `f` holds.
    pub unit: ForceUnit,
    /// Spacing of the latest `lattice` command: partial volumes and short-range contact use it.
    pub lattice_spacing: f64,
    /// One critical stretch per particle, and LAMMPS' absolute threshold for stretch.
    pub compat_lammps: bool,
    /// Under that what LAMMPS has mended in 2026: each bond has the critical stretch of its own pair, and plastic bodies return
    /// to the yield surface.
    #[serde(default)]
    pub mended: bool,
    /// Broken bonds still push when they are shorter than at the start (`peri_modify broken compress`).
    pub compress: bool,
    /// Lattice or list.
    pub layout: Layout,
    /// Leave out what is exactly at rest; same bits either way.
    #[serde(skip)]
    pub skip_rest: bool,
    /// Use the portable kernels even where better ones would run.
    #[serde(skip)]
    pub portable: bool,
    /// No short-range repulsion: other contact laws keep particles apart.
    #[serde(default)]
    pub no_repulsion: bool,
    /// Members of one family whose bond is broken meet again as others do (`peri_modify family broken`).
    #[serde(default)]
    pub reunite: bool,
    /// What bonds are weighed by one at a time.
    #[serde(default)]
    pub weights: BondWeights,
    /// By what bonds break.
    #[serde(default)]
    pub criterion: Criterion,
}

/// Bond length changes below this count as none under `compat lammps`: an absolute length.
const NEAR_ZERO: f64 = 2.2204e-16;
/// Stretches below this carry exactly no force.
const DEAD_BAND: f64 = 4e-13;

impl FamilyOptions {
    /// The |z| (twice the stretch) below which a bond of this reference length counts as unstretched.
    pub fn dead_band(&self, length: f64) -> f64 {
        if self.compat_lammps { 2.0 * NEAR_ZERO / length } else { 2.0 * DEAD_BAND }
    }

    /// Whether particles have one critical stretch each, the largest of their bonds, as in LAMMPS 22Jul2025.
    pub fn one_stretch(&self) -> bool {
        self.compat_lammps && !self.mended
    }

    /// The distance below which two particles repel each other, bonded or not:
    /// min(0.9 of their distance at creation, 1.35 lattice spacings) (LAMMPS' peri styles).
    #[inline]
    pub fn contact_range(&self, view: &PeriView, i: u32, j: u32) -> f64 {
        let (a, b) = (view.x0[i as usize], view.x0[j as usize]);
        let d = view.bounds.nearest([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
        (0.9 * (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()).min(1.35 * self.lattice_spacing)
    }

    /// The defaults for a lattice spacing.
    pub fn new(lattice_spacing: f64) -> Self {
        Self {
            volume: VolumeRule::Lammps,
            unit: ForceUnit::Density,
            lattice_spacing,
            compat_lammps: false,
            mended: false,
            compress: false,
            layout: Layout::Auto,
            skip_rest: true,
            portable: false,
            no_repulsion: false,
            reunite: false,
            weights: BondWeights::default(),
            criterion: Criterion::default(),
        }
    }
}
