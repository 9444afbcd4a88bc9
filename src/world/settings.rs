//! Choices of a deck that concern everybody.

use crate::units::UnitSystem;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Whose numbers are wanted where LAMMPS 22Jul2025 is wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Compat {
    /// The right ones.
    #[default]
    Perigrain,
    /// LAMMPS' own, for comparison.
    Lammps,
}

/// When neighbour lists are rebuilt (`neighbor`, `neigh_modify`).
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct NeighborSettings {
    /// Extra reach of the lists [length].
    pub skin: f64,
    /// Earliest rebuild after the last one [steps].
    pub delay: i64,
    /// Consider a rebuild every so many steps.
    pub every: i64,
    /// Rebuild only if some particle moved more than half the skin.
    pub check: bool,
    /// Build at the first run's setup only.
    pub once: bool,
    /// Pairs of groups that never interact: `exclude group a b`.
    pub exclude_groups: Vec<(u32, u32)>,
    /// Pairs of types that never interact: `exclude type a b`.
    pub exclude_types: Vec<(u16, u16)>,
}

impl Default for NeighborSettings {
    fn default() -> Self {
        Self {
            skin: 0.3,
            delay: 0,
            every: 1,
            check: true,
            once: false,
            exclude_groups: vec![],
            exclude_types: vec![],
        }
    }
}

/// Choices of a deck that concern everybody.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct Settings {
    /// The deck's units.
    pub units: UnitSystem,
    /// Whose numbers.
    pub compat: Compat,
    /// Space dimension minus three is never printed; 3 or 2.
    pub two_dimensional: bool,
    /// Faces of the box to come.
    pub boundary: super::Boundary,
    /// Neighbour-list policy.
    pub neighbor: NeighborSettings,
    /// The list layout for every peridynamic body (`-layout list`).
    #[serde(skip)]
    pub force_list: bool,
    /// Work also where everything is at rest (`-rest full`).
    #[serde(skip)]
    pub no_skipping: bool,
    /// The portable kernels even where faster ones would run.
    #[serde(skip)]
    pub portable: bool,
    /// Set from outside (Ctrl-C): end the run at the next whole step.
    #[serde(skip)]
    pub stop: Arc<AtomicBool>,
}

impl Settings {
    /// Whether LAMMPS' artefacts are wanted.
    pub fn lammps(&self) -> bool {
        self.compat == Compat::Lammps
    }
}
