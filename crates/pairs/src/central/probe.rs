//! Probes for single pairs of a central law.

use super::{Law, Table};
use crate::shared::{built_at, near};
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::scale;
use perigrain_neigh::list::{Pair, difference};
use perigrain_styles::probe::{Interaction, Probe, Request};
use perigrain_world::{Allowed, World};

/// Evaluates single pairs.
pub struct CentralProbe<L> {
    table: Table<L>,
}

impl<L: Law> CentralProbe<L> {
    /// With these coefficients.
    pub fn new(table: Table<L>) -> Self {
        Self { table }
    }

    fn list(&self, w: &World) -> Vec<Pair> {
        near(w, built_at(w), &self.table.wanted, w.settings.neighbor.skin, &Allowed::felt(w))
    }
}

impl<L: Law> Probe for CentralProbe<L> {
    fn name(&self) -> &'static str {
        L::NAME
    }

    fn own(&self) -> usize {
        0
    }

    fn cutoff(&self, _w: &World) -> Option<f64> {
        Some(self.table.farthest()).filter(|c| *c > 0.0)
    }

    fn listed(&self, w: &World) -> Result<Vec<[u32; 2]>> {
        Ok(self.list(w).iter().map(|p| [p.i, p.j]).collect())
    }

    fn look(&mut self, w: &World, _request: Request, _closely: bool) -> Result<Vec<Interaction>> {
        self.table.renew(w);
        self.table.weigh(w);
        let interaction = |pair: &Pair| {
            let felt = self.table.felt(w, pair)?;
            let d = difference(&w.particles.x, &w.periods(), pair);
            let (force, energy) = (scale(felt.force, d), felt.energy);
            Some(Interaction { i: pair.i, j: pair.j, d, force, energy, ..Interaction::default() })
        };
        Ok(self.list(w).iter().filter_map(interaction).collect())
    }
}
