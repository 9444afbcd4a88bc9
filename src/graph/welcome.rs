//! Particles that join during a run: fixes and computes take note of where they begin.

use super::seal::Sealer;
use perigrain_base::diag::Result;
use perigrain_plan::{About, Needs, Op, Stage, Tick};
use perigrain_styles::{Compute, Fix, SealCx};
use perigrain_world::World;
use perigrain_world::field::{BOX, COLUMNS, IMAGE, LISTS, MASK, MASS, MEMO, QUAT, RADIUS, V, X};

/// Adds the op, where some fix makes particles.
pub fn seal(s: &mut Sealer) {
    let graph = s.graph();
    if !s.facts().any(|(_, facts)| facts.makes_particles) {
        return;
    }
    let fixes = graph.fixes.iter().map(|f| f.fix.clone()).collect();
    let computes = graph.computes.iter().map(|c| c.compute.clone()).collect();
    let op = Welcome { fixes, computes, roster: s.world().rebuild.roster };
    let span = s.span();
    s.add(vec![Box::new(op)], span);
}

/// Tells everybody when particles have joined.
struct Welcome {
    fixes: Vec<Box<dyn Fix>>,
    computes: Vec<Box<dyn Compute>>,
    /// Who was there when they were told last.
    roster: u64,
}

impl Op for Welcome {
    fn about(&self) -> About {
        let noted = BOX | X | V | QUAT | IMAGE | MASK | RADIUS | MASS;
        About::new("welcome", Stage::Exchange, Needs::new().read(noted | MEMO | LISTS).keep(COLUMNS))
    }
    fn run(&mut self, w: &mut World, _t: &Tick) -> Result<()> {
        if self.roster != w.rebuild.roster {
            self.roster = w.rebuild.roster;
            self.fixes.iter().for_each(|f| f.welcome(w));
            self.computes.iter().for_each(|c| c.welcome(w));
        }
        Ok(())
    }
}
