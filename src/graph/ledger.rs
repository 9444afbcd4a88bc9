//! The ledger's ops: forces of fixes are booked separately as they act, and every step is entered.

use super::node::FixNode;
use super::seal::Sealer;
use perigrain_base::diag::{Result, Span};
use perigrain_plan::{Needs, Op, Stage, When};
use perigrain_styles::SealCx;
use perigrain_styles::ledger::{self, Channel};
use perigrain_styles::step_op::StepOp;
use perigrain_world::field::{
    BONDS, BOX, COLUMNS, CONTACTS, F, FACTS, FAMILIES, KIND, LISTS, MASK, MASS, MEMO, MOLECULE, OMEGA,
    RADIUS, TAG, TALLY, TORQUE, TRAVEL, TYPE_MASS, V, VOLUME, X, X0,
};

/// Whether a ledger is kept.
pub fn wanted(s: &Sealer) -> bool {
    let graph = s.graph();
    graph.computes.iter().any(|c| c.style == "energy/ledger")
        || graph.fixes.iter().any(|f| f.style == "dt/guard")
}

/// Before the fixes of a step.
pub fn begin(s: &mut Sealer) {
    let access =
        Needs::new().read(F | TORQUE | BONDS).write(FAMILIES | BONDS).keep(COLUMNS).only(&ledger::columns());
    let op = StepOp::new("ledger begins", Stage::PostForce, access, |w, t| {
        ledger::begin(w, t);
        Ok(())
    });
    let span = s.span();
    s.add(vec![op.boxed()], span);
}

/// Consecutive fixes of one channel, whose forces are booked together, apart from others'.
#[derive(Default)]
pub struct Marks {
    waiting: Option<Mark>,
}

struct Mark {
    channel: Channel,
    /// Whether they change forces, and torques.
    changed: [bool; 2],
    ids: Vec<String>,
    span: Span,
}

impl Marks {
    /// Before the ops of a fix: those of another channel that wait get theirs.
    pub fn before(&mut self, s: &mut Sealer, f: &FixNode, changed: [bool; 2]) {
        if changed != [false; 2] && self.waiting.as_ref().is_some_and(|m| m.channel != channel(f)) {
            self.set(s);
        }
    }

    /// After a fix, if it changes forces.
    pub fn after(&mut self, f: &FixNode, changed: [bool; 2]) {
        if changed == [false; 2] {
            return;
        }
        let none = || Mark { channel: channel(f), changed: [false; 2], ids: vec![], span: f.span };
        let mark = self.waiting.get_or_insert_with(none);
        (0..2).for_each(|k| mark.changed[k] |= changed[k]);
        mark.ids.push(f.id.clone());
    }

    /// Puts what waits into the plan.
    pub fn set(&mut self, s: &mut Sealer) {
        let Some(Mark { channel, changed, ids, span }) = self.waiting.take() else { return };
        let access = Needs::new().read(F | TORQUE).keep(COLUMNS).only(&ledger::columns());
        let name = format!("ledger of fix {}", ids.join(", "));
        let op = StepOp::new(name, Stage::PostForce, access, move |w, t| {
            ledger::mark(w, t, channel, changed);
            Ok(())
        });
        s.add(vec![op.boxed()], span);
    }
}

fn channel(f: &FixNode) -> Channel {
    match f.style {
        "gravity" => Channel::Gravity,
        style if style.starts_with("wall/") => Channel::Walls,
        _ => Channel::Imposed,
    }
}

/// At the end of a step.
///
/// # Errors
/// What is missing in the scene.
pub fn end(s: &mut Sealer) -> Result<()> {
    let equations = |f: &&FixNode| ["nve", "nve/sphere", "nve/bpm/sphere"].contains(&f.style);
    let free = s.graph().fixes.iter().filter(equations).fold(0, |bits, f| bits | f.group.bit());
    let every = Needs::new()
        .read(V | OMEGA | F | TORQUE | RADIUS | MASS | TYPE_MASS | VOLUME | KIND | MASK)
        .read(COLUMNS | FAMILIES | BONDS | FACTS)
        .keep(MEMO);
    let op = StepOp::new("ledger", Stage::FinalIntegrate, every, move |w, t| {
        ledger::account(w, t, free);
        Ok(())
    });
    let span = s.span();
    s.add(vec![op.in_setup(true).boxed()], span);
    let mut probes = s.probes()?;
    let ends = When::First.or(When::Last);
    s.request_energy(&ends);
    s.request_atom_energy(&ends);
    let all = Needs::new()
        .read(X | X0 | V | OMEGA | RADIUS | MASS | TYPE_MASS | VOLUME | KIND | MASK | TAG | MOLECULE)
        .read(COLUMNS | FAMILIES | BONDS | CONTACTS | TALLY | LISTS | BOX | TRAVEL | FACTS)
        .keep(MEMO);
    let op = StepOp::new("ledger of the run", Stage::FinalIntegrate, all, move |w, t| {
        ledger::balance(w, t, &mut probes)
    });
    s.add(vec![op.when(ends).in_setup(true).boxed()], span);
    Ok(())
}

/// Whether some ops change forces, and torques, after those of pairs.
pub fn changes(ops: &[Box<dyn Op>]) -> [bool; 2] {
    let late = ops.iter().map(|op| op.about()).filter(|about| about.stage == Stage::PostForce);
    late.fold([false; 2], |[force, torque], about| {
        [force | about.needs.changes(F), torque | about.needs.changes(TORQUE)]
    })
}
