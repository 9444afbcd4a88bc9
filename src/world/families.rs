//! Peridynamic families: what bonds exist, what they are made of, and which still live.

use crate::diag::{Code, Diagnostic, Result};

/// Coefficients of the prototype microelastic brittle model for one pair of types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PmbCoeff {
    /// Micromodulus, energy per distance and volume squared.
    pub c: f64,
    /// Horizon, a distance.
    pub horizon: f64,
    /// Critical stretch of an otherwise unstretched family.
    pub s00: f64,
    /// How much compression raises the critical stretch; not negative.
    pub alpha: f64,
}

/// Coefficients by pair of types (1-based), symmetric; unset pairs belong to other styles or to none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PmbTable {
    types: usize,
    pairs: Vec<Option<PmbCoeff>>,
}

impl PmbTable {
    /// A table for `types` types with nothing set.
    pub fn new(types: usize) -> Self {
        Self { types, pairs: vec![None; types * types] }
    }

    /// The number of types.
    pub fn types(&self) -> usize {
        self.types
    }

    /// Sets types `a`, `b` and `b`, `a`.
    ///
    /// # Errors
    /// A coefficient that makes no sense is refused by name; the caller knows the place in the deck.
    pub fn set(&mut self, a: u16, b: u16, coeff: PmbCoeff) -> Result<()> {
        let bad = |what: &str| {
            Err(Diagnostic::error(Code::BAD_VALUE, None, format!("peri/pmb: {what}"))
                .help("pair_coeff I J c horizon s00 alpha")
                .into())
        };
        if !(coeff.c.is_finite() && coeff.c >= 0.0) {
            return bad("c must be finite and not negative");
        }
        if !(coeff.horizon.is_finite() && coeff.horizon > 0.0) {
            return bad("the horizon must be positive");
        }
        if coeff.s00.is_nan() || coeff.s00 < 0.0 {
            return bad("s00 must not be negative");
        }
        if !(coeff.alpha.is_finite() && coeff.alpha >= 0.0) {
            return bad("alpha must be finite and not negative");
        }
        let (a, b) = (usize::from(a) - 1, usize::from(b) - 1);
        self.pairs[a * self.types + b] = Some(coeff);
        self.pairs[b * self.types + a] = Some(coeff);
        Ok(())
    }

    /// The coefficients of types `a` and `b` if they were set.
    pub fn get(&self, a: u16, b: u16) -> Option<&PmbCoeff> {
        self.pairs[(usize::from(a) - 1) * self.types + usize::from(b) - 1].as_ref()
    }

    /// The pairs that were set.
    pub fn iter(&self) -> impl Iterator<Item = &PmbCoeff> {
        self.pairs.iter().flatten()
    }
}

/// How the volume of a partner near the horizon counts (`peri_modify volume`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForceUnit {
    /// Force per volume, as LAMMPS' peri styles.
    #[default]
    Density,
    /// Force: the density times the volume of the particle it acts on.
    Newton,
}

/// Which layout bonds are kept in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// The lattice where a body is one, the list elsewhere.
    #[default]
    Auto,
    /// The list everywhere.
    List,
}

/// Everything about families that is not a coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FamilyOptions {
    /// Partial volumes.
    pub volume: VolumeRule,
    /// What `f` holds.
    pub unit: ForceUnit,
    /// Spacing of the latest `lattice` command: partial volumes and short-range contact use it.
    pub lattice_spacing: f64,
    /// One critical stretch per particle, and LAMMPS' absolute threshold for stretch.
    pub compat_lammps: bool,
    /// Lattice or list.
    pub layout: Layout,
    /// Leave out what is exactly at rest; same bits either way.
    pub skip_rest: bool,
    /// Use the portable kernels even where better ones would run.
    pub portable: bool,
}

impl FamilyOptions {
    /// The defaults for a lattice spacing.
    pub fn new(lattice_spacing: f64) -> Self {
        Self {
            volume: VolumeRule::Lammps,
            unit: ForceUnit::Density,
            lattice_spacing,
            compat_lammps: false,
            layout: Layout::Auto,
            skip_rest: true,
            portable: false,
        }
    }
}

/// An orthogonal box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Low corner.
    pub lo: [f64; 3],
    /// High corner.
    pub hi: [f64; 3],
    /// Which directions repeat.
    pub periodic: [bool; 3],
}

impl Bounds {
    /// The shortest of `d` and its images.
    #[inline]
    pub fn nearest(&self, mut d: [f64; 3]) -> [f64; 3] {
        for k in 0..3 {
            let length = self.hi[k] - self.lo[k];
            if self.periodic[k] && d[k].abs() > 0.5 * length {
                d[k] -= length * (d[k] / length).round();
            }
        }
        d
    }
}

/// Energy and virial of one force evaluation; the caller zeroes them.
#[derive(Debug, Default)]
pub struct PeriTally<'a> {
    /// Sum over particles: energy densities, or energies under [`ForceUnit::Newton`].
    pub energy: f64,
    /// Virial xx, yy, zz, xy, xz, yz: with one volume factor, as LAMMPS.
    pub virial: [f64; 6],
    /// Energy (density) of each particle, added to.
    pub per_atom_energy: Option<&'a mut [f64]>,
}

/// What families need to know about particles: columns of equal length, and the box.
#[derive(Clone, Copy, Debug)]
pub struct PeriView<'a> {
    /// Positions.
    pub x: &'a [[f64; 3]],
    /// Positions at creation.
    pub x0: &'a [[f64; 3]],
    /// Types, from 1.
    pub kind: &'a [u16],
    /// Volumes.
    pub volume: &'a [f64],
    /// The box.
    pub bounds: Bounds,
}

/// All families of a scene: state only; `laws::peri` builds and sweeps them.
#[derive(Clone, Debug)]
pub struct Families {
    /// Coefficients in force.
    pub table: PmbTable,
    /// Rules the families were built with.
    pub options: FamilyOptions,
    /// Whether a step has been advanced: nothing breaks before.
    pub armed: bool,
    /// Row starts, one more than there are rows.
    pub start: Vec<usize>,
    /// Partners, rows in order.
    pub partner: Vec<u32>,
    /// Reference length per partner.
    pub r0: Vec<f64>,
    /// Whether the bond still lives.
    pub alive: Vec<bool>,
    /// Sum of the volumes of all partners at the start, per particle.
    pub family_volume: Vec<f64>,
    /// Smallest stretch of each family in the previous step; LAMMPS' critical stretch under compat.
    pub limit: Vec<f64>,
}
