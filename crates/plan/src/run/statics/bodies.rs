//! What may move, what resists, and what the force column means.

use perigrain_statics::network::Network;

/// What may move.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// Components that do not move freely, one bit each (x, y, z, and three rotations), by particle.
    pub held: Vec<u8>,
    /// Those of them that stand on a path.
    pub led: Vec<u8>,
    /// What a force column of 1 means: the volume where forces are densities, else 1.
    pub weight: Vec<f64>,
    /// Bonds as springs between points, as far as they are known: they serve to solve linear systems faster.
    pub network: Network,
    /// The distance of neighbours [length].
    pub size: f64,
}

impl Body {
    /// Whether component `d` of particle `i` moves freely.
    pub fn frees(&self, i: usize, d: usize) -> bool {
        self.held[i] >> d & 1 == 0
    }

    /// Whether it stands on a path.
    pub fn leads(&self, i: usize, d: usize) -> bool {
        self.led[i] >> d & 1 == 1
    }
}
