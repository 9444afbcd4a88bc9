//! Pairs that may come into short-range contact.

/// Pairs without a living bond that may come into short-range contact before they are looked for again.
#[derive(Clone, Debug, Default, serde::Serialize, serde::Deserialize)]
pub struct NearPairs {
    /// Pairs within a body (the list counts as one), and pairs across bodies.
    pub pairs: [Vec<NearPair>; 2],
    /// How much closer than at the last search two particles of the same body, and of different ones, may be.
    pub spent: [f64; 2],
    /// How much closer they may come before pairs must be searched anew.
    pub allowed: [f64; 2],
    /// How much farther than contact pairs are kept.
    pub skin: f64,
    /// Particles without a family whose type has short-range contact, and where they were.
    pub loose: Vec<(u32, [f64; 3])>,
    /// Where all particles were when pairs within a body were last searched; empty where that is not needed.
    #[serde(default)]
    pub looked: Vec<[f64; 3]>,
}

/// Two particles, the first with the lower number, that may come into short-range contact.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct NearPair {
    /// The particles.
    pub ends: [u32; 2],
    /// What [`NearPairs::spent`] must reach before they can touch.
    pub after: f32,
    /// The square of the distance at which they touch, or a little more: only for restart files, whose layout stays.
    pub within: f32,
}
