//! Virials of single particles, for steps at which they are read.

use super::seal::Sealer;
use perigrain_base::diag::Result;
use perigrain_plan::{About, Needs, Op, Span as Rows, Stage, Tick};
use perigrain_styles::SealCx;
use perigrain_styles::probe::{Probe, Request, look_all};
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA, RADIUS,
    TAG, TALLY, TRAVEL, V, X, X0,
};
use perigrain_world::{RunStyle, World};

/// Adds the op that gets the virials of particles from pair styles; after everything that may read them.
///
/// # Errors
/// What is missing in the scene.
pub fn seal(s: &mut Sealer) -> Result<()> {
    if s.plan.atom_virial.is_empty() {
        return Ok(());
    }
    let (span, graph) = (s.span(), s.graph());
    let Some(pair) = graph.pair.as_ref().map(|node| &node.pair) else { return Ok(()) };
    let RunStyle::Respa(respa) = s.world().settings.run_style.clone() else {
        let probes = s.probes()?;
        s.add(ops(probes), span);
        return Ok(());
    };
    for (k, probe) in pair.probes(s.world(), false)? {
        s.add_forces(ops(vec![probe]), span, respa.of_pair(k));
    }
    Ok(())
}

fn ops(probes: Vec<Box<dyn Probe>>) -> Vec<Box<dyn Op>> {
    if probes.is_empty() { vec![] } else { vec![Box::new(Virials { probes })] }
}

/// Probes every pair after the forces of a step: positions and velocities are still those that forces saw.
struct Virials {
    probes: Vec<Box<dyn Probe>>,
}

impl Op for Virials {
    fn about(&self) -> About {
        // Contacts are there whenever virials of particles are requested.
        let needs = Needs::new()
            .read(MASK | MOLECULE | BONDS | MEMO)
            .read(
                BOX | COLUMNS
                    | CONTACTS
                    | FACTS
                    | FAMILIES
                    | TAG
                    | LISTS
                    | TRAVEL
                    | X
                    | X0
                    | V
                    | OMEGA
                    | RADIUS
                    | MASS
                    | KIND,
            )
            .write(TALLY);
        About::new("virials of particles", Stage::Force, needs)
    }
    fn span(&mut self, _: &mut World, t: &Tick) -> Rows {
        if t.atom_virial { Rows::All } else { Rows::Requested }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        if !t.atom_virial {
            return Ok(());
        }
        let pairs = look_all(&mut self.probes, w, Request::Felt { setup: t.setup })?;
        let atoms = &mut w.tally.atom_virial;
        for p in &pairs {
            let virial = p.virial();
            for i in [p.i, p.j] {
                (0..6).for_each(|k| atoms[i as usize][k] += 0.5 * virial[k]);
            }
        }
        Ok(())
    }
}
