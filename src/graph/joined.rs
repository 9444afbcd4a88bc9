//! Particles that join during a run: fixes and computes take note of where they begin.

use super::seal::Sealer;
use perigrain_base::diag::Result;
use perigrain_plan::{About, Needs, Op, Span as Rows, Stage, Tick};
use perigrain_styles::{Compute, Fix, SealCx};
use perigrain_world::field::{BOX, COLUMNS, IMAGE, LISTS, MASK, MASS, MEMO, QUAT, RADIUS, V, X};
use perigrain_world::{Fields, World};

/// Adds the op, where some fix makes particles.
pub fn seal(s: &mut Sealer) {
    let graph = s.graph();
    if !s.facts().any(|(_, facts)| facts.makes_particles) {
        return;
    }
    let fixes = graph.fixes.iter().map(|f| f.fix.clone()).collect();
    let computes = graph.computes.iter().map(|c| c.compute.clone()).collect();
    let op = Joined { fixes, computes, roster: s.world().rebuild.roster };
    let span = s.span();
    s.add(vec![Box::new(op)], span);
}

/// Notifies fixes and computes when particles have joined.
struct Joined {
    fixes: Vec<Box<dyn Fix>>,
    computes: Vec<Box<dyn Compute>>,
    /// The roster at the last notification.
    roster: u64,
}

/// What is noted of particles that have joined.
const NOTED: Fields = BOX.and(X).and(V).and(QUAT).and(IMAGE).and(MASK).and(RADIUS).and(MASS);

impl Op for Joined {
    fn about(&self) -> About {
        About::new("joined", Stage::Exchange, Needs::new().read(NOTED | MEMO | LISTS).keep(COLUMNS))
    }
    fn span(&mut self, _: &mut World, _: &Tick) -> Rows {
        Rows::Requested
    }
    fn run(&mut self, w: &mut World, _t: &Tick) -> Result<()> {
        if self.roster != w.rebuild.roster {
            w.whole(NOTED);
            self.roster = w.rebuild.roster;
            self.fixes.iter().for_each(|f| f.particles_joined(w));
            self.computes.iter().for_each(|c| c.particles_joined(w));
        }
        Ok(())
    }
}
