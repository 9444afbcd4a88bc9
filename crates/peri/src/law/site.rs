//! A site while its columns are settled, and the moduli of its type.

use crate::law::freed::Free;
use crate::law::moment::Moment;

/// Moduli of a type as laws need them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stiffness {
    /// 3K.
    pub bulk: f64,
    /// 15G.
    pub shear: f64,
    /// Yield stress.
    pub yield_stress: f64,
    /// Twice the yield limit of LAMMPS, 25 σ²/(8π δ⁵).
    pub limit: f64,
    /// δ of its bonds among themselves; 0 where it has none.
    pub horizon: f64,
    /// Share of the shear modulus that relaxes.
    pub lambda: f64,
    /// What is left of an element's stretch after the step, and of the step's own.
    pub left: (f64, f64),
}

/// What a site remembers of a dilatation that relaxes.
#[derive(Clone, Copy, Debug)]
pub struct Unrelaxed {
    /// θ at the last step that advanced.
    pub before: f64,
    /// The part of it that is not yet relaxed.
    pub left: f64,
}

/// A site of a body, with the sum that a sweep over its bonds has found.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    /// Its moduli.
    pub own: Stiffness,
    /// Weighted volume m = Σ ω w |xi|² V over the family at the start.
    pub weighted: f64,
    /// Σ ω² w |xi|² V over it.
    pub spread: f64,
    /// The sum of the sweep.
    pub sum: f64,
    /// Dilatation θ.
    pub theta: f64,
    /// What it remembers of that.
    pub unrelaxed: Unrelaxed,
    /// Accumulated plastic multiplier.
    pub plastic: f64,
    /// Its broken bonds, if there are some.
    pub free: Option<Free>,
    /// Σ ω² w |xi|² V over them.
    pub gone_spread: f64,
    /// S of them.
    pub slip: f64,
    /// The sum of the dilatation in the last step that advanced, of sites with broken bonds.
    pub sum_before: f64,
    /// What this step turns into heat besides what living bonds lose, over the volume of the site.
    pub heat: f64,
    /// What is the same for all.
    pub moment: &'a Moment,
    /// The step advances: what the site remembers moves on.
    pub advance: bool,
}

impl Site<'_> {
    /// θ of elastic bonds from the sum of the dilatation.
    #[inline(always)]
    pub fn dilatation(&self) -> f64 {
        match self.free {
            Some(free) => free.dilatation(self.sum),
            None => 3.0 * (1.0 / self.weighted) * self.sum,
        }
    }
}
