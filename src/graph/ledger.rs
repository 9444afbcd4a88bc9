//! The ledger's ops: forces of fixes are told apart as they act, and every step is entered.

use super::node::FixNode;
use super::seal::Sealer;
use perigrain_base::diag::Result;
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::SealCx;
use perigrain_styles::ledger::{self, Channel};
use perigrain_styles::step_op::StepOp;
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, F, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA,
    RADIUS, TAG, TALLY, TORQUE, TRAVEL, TYPE_MASS, V, VOLUME, X, X0,
};

/// Whether somebody keeps the ledger.
pub fn wanted(s: &Sealer) -> bool {
    let graph = s.graph();
    graph.computes.iter().any(|c| c.style == "energy/ledger")
        || graph.fixes.iter().any(|f| f.style == "dt/guard")
}

/// Before the fixes of a step.
pub fn begin(s: &mut Sealer) {
    let access = Needs::new().read(F | TORQUE | BONDS).write(FAMILIES | BONDS).keep(COLUMNS);
    let op = StepOp::new("ledger begins", Stage::PostForce, access, |w, t| {
        ledger::begin(w, t);
        Ok(())
    });
    let span = s.span();
    s.add(vec![op.boxed()], span);
}

/// After a fix, if it has changed forces.
pub fn mark(s: &mut Sealer, f: &FixNode, changed: [bool; 2]) {
    if changed == [false; 2] {
        return;
    }
    let channel = match f.style {
        "gravity" => Channel::Gravity,
        style if style.starts_with("wall/") => Channel::Walls,
        _ => Channel::Imposed,
    };
    let access = Needs::new().read(F | TORQUE).keep(COLUMNS);
    let op = StepOp::new(format!("ledger of fix {}", f.id), Stage::PostForce, access, move |w, t| {
        ledger::mark(w, t, channel, changed);
        Ok(())
    });
    s.add(vec![op.boxed()], f.span);
}

/// At the end of a step.
///
/// # Errors
/// What is missing in the scene.
pub fn end(s: &mut Sealer) -> Result<()> {
    let equations = |f: &&FixNode| ["nve", "nve/sphere", "nve/bpm/sphere"].contains(&f.style);
    let free = s.graph().fixes.iter().filter(equations).fold(0, |bits, f| bits | f.group.bit());
    let mut probes = s.probes()?;
    s.ask_energy(&When::First);
    s.ask_atom_energy(&When::First);
    let access = Needs::new()
        .read(F | TORQUE | TAG | MOLECULE | BOX | BONDS | LISTS | TRAVEL | FACTS | CONTACTS | TALLY | X0)
        .read(
            X | V | OMEGA | RADIUS | MASS | KIND | CONTACTS | MASK | COLUMNS | FAMILIES | VOLUME | TYPE_MASS,
        )
        .keep(MEMO);
    let op = StepOp::new("ledger", Stage::FinalIntegrate, access, move |w, t| {
        ledger::account(w, t, &mut probes, free)
    });
    let span = s.span();
    s.add(vec![op.in_setup(true).boxed()], span);
    Ok(())
}

/// Whether some ops change forces, and torques, after those of pairs.
pub fn changes(ops: &[Box<dyn Op>]) -> [bool; 2] {
    let late = ops.iter().map(|op| op.about()).filter(|about| about.stage == Stage::PostForce);
    late.fold([false; 2], |[force, torque], about| {
        [force | about.needs.changes(F), torque | about.needs.changes(TORQUE)]
    })
}
