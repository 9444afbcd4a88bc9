//! Which material the bonds are made of: bond-based or ordinary state-based, and what of it outlives a step.

use crate::law::freed::Freed;
use crate::law::{BondLaw, of_law};
use perigrain_base::diag::{Code, Diagnostic, Result};

/// How much a bond counts for its length in state-based sums (`peri_modify influence`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Influence {
    /// 1/|xi|, as LAMMPS' state-based styles.
    #[default]
    Inverse,
    /// 1 (Silling et al. 2007; Hartmann et al. 2023).
    One,
    /// exp(−|xi|²/δ²).
    Gaussian,
}

impl Influence {
    /// The words of a deck with their meaning.
    pub const NAMES: [(&'static str, Influence); 3] =
        [("inverse", Influence::Inverse), ("one", Influence::One), ("gaussian", Influence::Gaussian)];

    /// ω of a bond of reference length `length` with horizon `delta`.
    pub fn of(self, length: f64, delta: f64) -> f64 {
        match self {
            Self::Inverse => 1.0 / length,
            Self::One => 1.0,
            Self::Gaussian => (-(length / delta).powi(2)).exp(),
        }
    }

    /// What the weighted volume ∫ ω |ξ|² of a whole ball is proportional to as its radius changes.
    pub fn whole(self, delta: f64) -> f64 {
        match self {
            Self::Inverse => delta.powi(4),
            Self::One | Self::Gaussian => delta.powi(5),
        }
    }

    /// What a micro-modulus of this shape is at `length`, over the constant one with the same bulk modulus: g(|xi|)
    /// ∫ x³ dx/∫ g x³ dx over the horizon, K being (2π/9) ∫ c ξ³ dξ.
    pub fn shape(self, length: f64, delta: f64) -> f64 {
        match self {
            Self::Inverse => 0.75 * delta / length,
            Self::One => 1.0,
            // ∫ exp(−x²) x³ dx from 0 to 1 is ½ − 1/e.
            Self::Gaussian => 0.25 / (0.5 - (-1.0f64).exp()) * self.of(length, delta),
        }
    }
}

/// Moduli of a state-based material; what a law does not use is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Moduli {
    /// Bulk modulus.
    pub bulk: f64,
    /// Shear modulus.
    pub shear: f64,
    /// Share of the shear modulus that relaxes.
    pub lambda: f64,
    /// Its relaxation time.
    pub tau: f64,
    /// Yield stress in tension.
    pub yield_stress: f64,
    /// Stretch at which microelastic bonds flow, below zero.
    pub syc: f64,
    /// Stretch beyond which microelastic bonds soften.
    #[serde(default)]
    pub peak: f64,
}

impl Moduli {
    /// Steps of length √(ρ/this) are stable for a state-based body of this horizon, whatever its shape [pressure/length²].
    ///
    /// The exact limit of the cubic lattice is 1.48 Δx/√(K/ρ) at ν = 0.25 and 3.39 at 0.48 for a horizon of 3.015 Δx (Bloch waves, weights
    /// of LAMMPS), but free bodies vibrate faster: a particle at an edge has a small weighted volume, and a dilatation that its own
    /// displacement changes. The numbers cover rods of 2 × 2 particles, plates, blocks and jittered points, horizons of 2 to 4 spacings and all
    /// weights (`tests/families/limits.rs`); large blocks stand steps 1.5 (ν = 0.25) to 1.8 times (0.48) as long.
    pub fn fastest(&self, horizon: f64) -> f64 {
        (FASTEST[0] * self.bulk + FASTEST[1] * self.shear) / (horizon * horizon)
    }
}

/// See [`Moduli::fastest`].
const FASTEST: [f64; 2] = [11.4, 19.6];

/// What bonds do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum LawKind {
    /// Prototype microelastic brittle bonds.
    #[default]
    Pmb,
    /// Linear elastic, ordinary state-based.
    Lps,
    /// The same with a relaxing deviatoric part.
    Ves,
    /// The same with a perfectly plastic deviatoric part.
    ElasticPlastic,
    /// Microelastic bonds that flow in compression.
    Yield,
    /// Microelastic bonds whose compression is cut off, without memory.
    NonlinearElastic,
    /// Microelastic bonds whose micro-modulus depends on their length or on how near the surface is.
    Shaped,
    /// As [`LawKind::Ves`] where types relax differently: each end of a bond remembers its own stretch.
    VesApart,
    /// Microelastic bonds that soften linearly beyond a peak.
    Softening,
    /// The same exponentially.
    Decaying,
}

impl LawKind {
    /// Whether there are columns of sites or memory of bonds.
    pub fn has_states(self) -> bool {
        self != Self::Pmb
    }

    /// Whether sites have forces beyond the reach of displacements: where dilatations are, and where bonds remember.
    pub fn spreads(self) -> bool {
        !self.bond_based() || self.memory() > 0
    }

    /// Whether a bond's force depends on nothing but the bond.
    pub fn bond_based(self) -> bool {
        matches!(
            self,
            Self::Pmb
                | Self::Yield
                | Self::NonlinearElastic
                | Self::Shaped
                | Self::Softening
                | Self::Decaying
        )
    }

    /// Whether a share of the shear modulus relaxes.
    pub fn relaxes(self) -> bool {
        matches!(self, Self::Ves | Self::VesApart)
    }

    /// Whether the extension of a broken bond is set free, under LAMMPS' laws (`compat`) or not.
    pub fn frees(self, compat: bool) -> bool {
        !self.bond_based() && !compat
    }

    /// Whether bonds lose energy for good while they live.
    pub fn flows(self) -> bool {
        self.softens() || matches!(self, Self::ElasticPlastic | Self::Yield)
    }

    /// Whether bonds soften beyond a peak.
    pub fn softens(self) -> bool {
        of_law!(self, false, W => <W as BondLaw>::LIMITED)
    }

    /// Numbers that each bond remembers.
    pub fn memory(self) -> usize {
        of_law!(self, false, W => <W as BondLaw>::MEMORY)
    }
}

/// The law of all families of a scene.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Law {
    /// Which.
    pub kind: LawKind,
    /// How bonds of different lengths count.
    pub influence: Influence,
    /// Moduli by type − 1.
    pub moduli: Vec<Moduli>,
    /// Stretches below which bonds flow or beyond which they soften, by pair of types (row by row); empty where none do.
    pub yields: Vec<f64>,
    /// Bonds of [`LawKind::Shaped`] are stiffer near surfaces (`peri_modify surface energy`).
    pub surface: bool,
    /// The time step of the last force evaluation: relaxation depends on it.
    pub dt: f64,
    /// Energies asked for are those that damage of softening bonds has taken.
    #[serde(skip)]
    pub lost: bool,
}

impl Law {
    /// The (negative) stretch at which bonds between two types begin to flow, or the one beyond which they soften.
    pub fn yields(&self, a: u16, b: u16) -> f64 {
        let types = self.moduli.len();
        let place = (usize::from(a) - 1) * types + usize::from(b) - 1;
        self.yields.get(place).copied().unwrap_or(f64::NEG_INFINITY)
    }

    /// How bonds count for their length in forces: under the plain microelastic law all alike.
    pub fn shape(&self) -> Influence {
        if self.kind == LawKind::Pmb { Influence::One } else { self.influence }
    }

    /// What a bond adds to both families' weights, over the partner's volume: of the weighted volume ω w |xi|², or where
    /// bonds are microelastic of Σ c w |xi| V/c, which a solid of the same modulus has as πδ⁴ (its energy at an even
    /// growth, 9/2 K ε² = ¼ ε² Σ c w |xi| V).
    pub fn weight(&self, length: f64, delta: f64, volume: f64) -> f64 {
        match self.kind.bond_based() {
            true => self.influence.shape(length, delta) * volume * length,
            false => self.influence.of(length, delta) * volume * length * length,
        }
    }

    /// The viscous law in the form that its types need: one memory for both ends of a bond serves only where all relax alike.
    /// What bonds remember `before`, the law of families that are there, cannot turn into something else.
    ///
    /// # Errors
    /// Types that relax differently where bonds remember one number.
    pub fn shared_or_apart(&mut self, before: Option<LawKind>) -> Result<()> {
        if self.kind != LawKind::Ves {
            return Ok(());
        }
        let mut viscous = self.moduli.iter().filter(|m| m.tau > 0.0).map(|m| (m.lambda, m.tau));
        let first = viscous.next();
        let apart = viscous.any(|own| Some(own) != first);
        if apart && before == Some(LawKind::Ves) {
            let text = "all types relaxed alike at the first run: they cannot relax differently now";
            return Err(Diagnostic::error(Code::WRONG_ORDER, None, text)
                .help(
                    "give types their own lambda and tau before the first run; their values may change then",
                )
                .into());
        }
        if apart || before == Some(LawKind::VesApart) {
            self.kind = LawKind::VesApart;
        }
        Ok(())
    }

    /// The moduli of a type.
    pub fn of(&self, kind: u16) -> Moduli {
        self.moduli.get(usize::from(kind) - 1).copied().unwrap_or_default()
    }
}

/// Columns that force kernels read, at most.
pub const COLUMNS: usize = 6;

/// In which form viscous bonds remember the stretch D of their Maxwell element: as decay D − fresh s, s being the bond's
/// stretch at the last step that advanced. With the shares of the next step that needs only its own stretch, since
/// D' = decay D + fresh (s' − s).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Held {
    /// Factor of D.
    pub decay: f64,
    /// Factor of −s.
    pub fresh: f64,
}

impl Default for Held {
    /// D itself.
    fn default() -> Self {
        Self { decay: 1.0, fresh: 0.0 }
    }
}

impl Held {
    /// The form for steps in which `decay` of a stretch is left and `fresh` of the step's own. Where hardly anything is left,
    /// D itself: it could not be had back.
    pub fn for_steps(decay: f64, fresh: f64) -> Self {
        if decay > 0.5 { Self { decay, fresh } } else { Self::default() }
    }
}

/// What the sites (cells or records) of a body carry under a state-based law, and what its bonds remember.
/// Columns start with as many unused entries as their owner says.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct SiteState {
    /// Weighted volume m = Σ ω w |xi|² V over the family at the start.
    pub weighted: Vec<f64>,
    /// Σ ω² w |xi|² V over it: how far the yield surface is.
    pub spread: Vec<f64>,
    /// Dilatation θ.
    pub theta: Vec<f64>,
    /// Dilatation at the last step that advanced.
    pub before: Vec<f64>,
    /// The part of it that is not yet relaxed.
    pub unrelaxed: Vec<f64>,
    /// Accumulated plastic multiplier.
    pub plastic: Vec<f64>,
    /// What broken bonds have left; nothing under LAMMPS' laws.
    pub freed: Freed,
    /// Numbers that each bond remembers; the layout knows the order.
    pub memory: Vec<f64>,
    /// The form of that under the viscous law.
    pub held: Held,
    /// Whether the bonds of a chunk of lattice cells remember anything, 0 or 1; not kept for lists.
    pub touched: Vec<u8>,
    /// Whether a lattice row has ever had a bond with something to remember: first and last coordinate.
    pub awake: Vec<(i32, i32)>,
    /// What the kernels read: up to [`COLUMNS`] columns, a stride apart.
    #[serde(skip)]
    pub columns: Vec<f64>,
    /// What bonds remembered before this evaluation, where LAMMPS' energies need it.
    #[serde(skip)]
    pub earlier: Vec<f64>,
    /// Sums being added up.
    #[serde(skip)]
    pub sums: Vec<f64>,
    /// Constants of the first sweep, as [`crate::families::lattice::LatticeBody::tables`].
    pub tables: Vec<f64>,
    /// Coordinates of each row beyond which no site has a dilatation.
    #[serde(skip)]
    pub active: Vec<(i32, i32)>,
}

impl SiteState {
    /// Whether the law has states at all.
    pub fn is_empty(&self) -> bool {
        self.weighted.is_empty()
    }

    /// What the energies of bonds depend on.
    pub fn remembered(&self) -> &[f64] {
        if self.earlier.is_empty() { &self.memory } else { &self.earlier }
    }

    /// Memory held.
    pub fn bytes(&self) -> usize {
        8 * (self.weighted.len()
            + self.spread.len()
            + self.theta.len()
            + self.before.len()
            + self.unrelaxed.len()
            + self.plastic.len()
            + self.freed.numbers()
            + self.memory.len()
            + self.earlier.len()
            + self.columns.len()
            + self.sums.len()
            + self.tables.len()
            + self.active.len()
            + self.awake.len())
            + self.touched.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn influence_functions() {
        assert_eq!(Influence::Inverse.of(0.5, 2.0), 2.0);
        assert_eq!(Influence::One.of(0.5, 2.0), 1.0);
        assert!((Influence::Gaussian.of(2.0, 2.0) - (-1.0f64).exp()).abs() < 1e-16);
    }

    #[test]
    fn shapes_keep_the_bulk_modulus() {
        // ∫ g x³ dx = 1/4 by the midpoint rule with a thousand points: off by its h²/24 · (first derivatives), 1e-6.
        for (_, influence) in Influence::NAMES {
            let at = |k: i32| (f64::from(k) + 0.5) / 1000.0;
            let sum: f64 = (0..1000).map(|k| influence.shape(at(k), 1.0) * at(k).powi(3)).sum();
            assert!((sum / 1000.0 - 0.25).abs() < 1e-6, "{influence:?} {sum}");
        }
    }

    #[test]
    fn types_without_moduli_have_none() {
        let law = Law { moduli: vec![Moduli { bulk: 2.0, ..Moduli::default() }], ..Law::default() };
        assert_eq!((law.of(1).bulk, law.of(2).bulk), (2.0, 0.0));
    }
}
