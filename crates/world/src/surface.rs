//! Surfaces of peridynamic solids: which particles meet others as spheres.

use super::GroupId;

/// How a group of hybrid particles is chosen among a solid's (`group ID surface …`).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Surface {
    /// The solids.
    pub parent: GroupId,
    /// Which particles lie at the surface.
    pub rule: Rule,
    /// How many layers count.
    pub shells: usize,
    /// At multiples of which steps of a run it is chosen anew; never for `None`.
    pub every: Option<i64>,
}

/// Which particles lie at the surface.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Rule {
    /// Those with fewer nearest neighbours.
    Neighbours(usize),
    /// Those whose Σ r² V over the family is below this part of the largest.
    Weight(f64),
}
