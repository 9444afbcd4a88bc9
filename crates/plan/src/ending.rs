//! Which ops act in a step, found without querying every op in every step.

use super::{Placed, Stage, StepPlan, Tick, When};
use perigrain_world::field::{F, TORQUE};
use std::ops::Range;

/// Forces and what follows them in a step.
pub struct Ending {
    /// The op that adds forces, if there is exactly one.
    pub force: Option<usize>,
    /// Ops in order; behind the last kick the op that clears forces, if the next step begins there.
    pub order: Vec<usize>,
    /// The last kick, if the next step can begin there.
    pub last: Option<usize>,
    /// The op that clears forces in that case.
    pub clears: Option<usize>,
}

/// The ops that act in every step, stage by stage.
#[derive(Default)]
pub struct Usually {
    ops: Vec<usize>,
    /// The end of each stage in `ops`.
    ends: [usize; Stage::ALL.len()],
}

impl Usually {
    fn take(&mut self, ops: &[Placed]) {
        self.ops.clear();
        for (stage, end) in Stage::ALL.into_iter().zip(&mut self.ends) {
            let acts = |p: &Placed| p.about.stage == stage && p.about.when.is_always();
            self.ops.extend(ops.iter().enumerate().filter(|(_, p)| acts(p)).map(|(k, _)| k));
            *end = self.ops.len();
        }
    }

    /// The range of these stages in `ops`. Stages must be in order; others may lie in between.
    pub fn of(&self, stages: &[Stage]) -> Range<usize> {
        let [Some(first), Some(last)] = [stages.first(), stages.last()] else { return 0..0 };
        let begin = (*first as usize).checked_sub(1).map_or(0, |before| self.ends[before]);
        begin..self.ends[*last as usize]
    }

    /// The op at a place.
    pub fn at(&self, place: usize) -> usize {
        self.ops[place]
    }
}

impl StepPlan {
    /// Finds the step up to which only the ops of every step act: querying all ops in each step takes longer than moving a few
    /// particles.
    pub(super) fn look_ahead(&mut self, t: &Tick) {
        if self.quiet.1 == t.last && self.quiet.0.contains(&t.step) {
            return;
        }
        let sums = [&self.energy, &self.virial, &self.atom_energy, &self.atom_virial].into_iter().flatten();
        let all = self.ops.iter().map(|p| &p.about.when).chain(sums).filter(|w| !w.is_always());
        let next = all.map(|w| w.next(t.step, t.last)).min().unwrap_or(i64::MAX);
        self.quiet = (t.step..next, t.last);
        self.usually.take(&self.ops);
        self.requested = self.requested_by(When::is_always);
    }

    /// Whether ops with these times act at this tick.
    pub(super) fn fires(&self, when: &When, t: &Tick) -> bool {
        when.is_always() || (!self.is_quiet(t) && when.fires(t))
    }

    /// Whether only the ops of every step act at this tick.
    pub(super) fn is_quiet(&self, t: &Tick) -> bool {
        !t.setup && self.quiet.1 == t.last && self.quiet.0.contains(&t.step)
    }

    /// Whether this step and the next one are quiet: such steps all end alike.
    fn ends_as_usual(&self, t: &Tick) -> bool {
        t.phase.levels == 1 && self.is_quiet(t) && self.quiet.0.contains(&(t.step + 1))
    }

    /// Forces and what follows them in this step; see [`StepPlan::keep_ending`].
    pub(super) fn ending(&mut self, t: &Tick) -> Box<Ending> {
        let usual = self.usual.take();
        match usual.filter(|_| self.ends_as_usual(t)) {
            Some(ending) => ending,
            None => Box::new(self.find_ending(t)),
        }
    }

    /// Keeps the ending of this step for the next one, if that ends alike.
    pub(super) fn keep_ending(&mut self, t: &Tick, ending: Box<Ending>) {
        self.usual = Some(ending).filter(|_| self.ends_as_usual(t));
    }

    fn find_ending(&mut self, t: &Tick) -> Ending {
        let acts = |p: &Placed| p.about.level.acts(&t.phase) && self.fires(&p.about.when, t);
        let of = |stages: &[Stage]| {
            let all = self.ops.iter().enumerate();
            all.filter(|(_, p)| stages.contains(&p.about.stage) && acts(p))
                .map(|(k, _)| k)
                .collect::<Vec<_>>()
        };
        let (forces, mut order) = (of(&[Stage::Force]), of(&[Stage::PostForce, Stage::FinalIntegrate]));
        let last = self.last_kick(t);
        let clears = last.and_then(|_| self.clears_early());
        order.extend(clears);
        let force = if let [force] = forces[..] { Some(force) } else { None };
        Ending { force, order, last, clears }
    }

    /// The op that clears forces, if nothing reads them between the beginning of a step and that op.
    fn clears_early(&mut self) -> Option<usize> {
        let first = self.ops.iter().position(|p| p.about.stage >= Stage::PreForce)?;
        let clears = self.ops[first].about.stage == Stage::PreForce && self.ops[first].about.when.is_always();
        let reads = |p: &Placed| p.about.stage > Stage::InitialIntegrate && p.about.needs.reads(F | TORQUE);
        let before = &self.ops[..first];
        let unread = *self.unread.get_or_insert_with(|| !before.iter().any(reads));
        (clears && unread).then_some(first)
    }

    /// The op that ends the motion of this step, if its fix is the only one that moves particles and nothing reads the scene
    /// before the next step.
    fn last_kick(&self, t: &Tick) -> Option<usize> {
        let fires = |p: &Placed| self.fires(&p.about.when, t);
        let acts = |p: &Placed, stage| p.about.stage == stage && p.about.level.acts(&t.phase);
        let at = |stage| self.ops.iter().enumerate().filter(move |(_, p)| acts(p, stage));
        let looks = |stage| at(stage).any(|(_, p)| fires(p));
        let (mut first, mut second) = (at(Stage::InitialIntegrate), at(Stage::FinalIntegrate));
        let (Some((_, a)), None, Some((k, b)), None) =
            (first.next(), first.next(), second.next(), second.next())
        else {
            return None;
        };
        let one = a.from == b.from && a.about.when.is_always() && b.about.when.is_always();
        // The virial of constraints depends on how the first half of a step changes velocities. Short steps followed by others
        // keep the number of the long step, in which nothing reads the virial.
        let next = Tick { step: t.step + i64::from(t.phase.outermost()), ..t.clone() };
        let requested = [&self.virial, &self.atom_virial].into_iter().flatten().any(|w| self.fires(w, &next));
        let looks = t.phase.outermost() && (looks(Stage::EndOfStep) || looks(Stage::Output));
        (one && !requested && !looks).then_some(k)
    }
}
