//! One step of a plan up to its outputs: ops that act on each particle by itself go over the particles together.

use super::acts::Room;
use super::ending::Ending;
use super::fuse::Waiting;
use super::schedule::{begin_watch, end_watch};
use super::{Acts, BlockSums, FusedPass, Span, Stage, StepPlan, Tick, Way, fuse, needs, share};
use perigrain_base::diag::Result;
use perigrain_base::par::CHUNK;
use perigrain_world::World;
use std::ops::Range;
use std::time::Duration;

/// So many particles are moved without looking at the clock.
const FEW: usize = 200;

/// Buffers that steps use again: a quiet step allocates no memory.
#[derive(Default)]
pub(super) struct Rooms {
    /// Each op's.
    acts: Vec<Room>,
    /// Whose acts are collected.
    ops: Vec<usize>,
    came: Vec<BlockSums>,
    waiting: Waiting,
}

impl StepPlan {
    /// Whether the last step has made the beginning of the next one, which has to be made then.
    pub fn begun(&self) -> bool {
        self.begun
    }

    /// Whether the step before has made the beginning of this one.
    pub fn take_begun(&mut self) -> bool {
        std::mem::take(&mut self.begun)
    }

    /// Makes one step up to its outputs. Ops that act on each particle separately are fused after the forces; with more than a
    /// chunk of particles they run while forces are added up. Where `more` steps are sure to follow and nothing reads the scene
    /// in between, the last kick is made together with the first one of the next step.
    ///
    /// # Errors
    /// The first op's that fails.
    pub fn step(&mut self, w: &mut World, t: &Tick, more: impl Fn(&World) -> bool) -> Result<()> {
        use Stage::{InitialIntegrate, PostIntegrate};
        let Self { timing, ops, .. } = self;
        timing.step(|| ops.iter().map(|p| p.meter.time).sum());
        if !self.take_begun() {
            self.run(w, t, &[InitialIntegrate])?;
        }
        let ending = self.ending(t);
        if w.n() <= CHUNK {
            self.run(
                w,
                t,
                &[PostIntegrate, Stage::Exchange, Stage::Neighbor, Stage::PreForce, Stage::Force],
            )?;
            self.end_as(w, t, &ending, more)?;
        } else {
            self.run(w, t, &[PostIntegrate, Stage::Exchange, Stage::Neighbor, Stage::PreForce])?;
            if !self.force_and_end(w, t, &ending, &more)? {
                self.run(w, t, &[Stage::Force])?;
                self.end_as(w, t, &ending, more)?;
            }
        }
        self.keep_ending(t, ending);
        Ok(())
    }

    /// For steps with a single force op that is followed only by ops on separate particles: if that op reports which particles
    /// have all their forces, these are moved while they are in the cache. Every particle sees the same as otherwise. `false`
    /// where this does not apply; nothing has been done then.
    fn force_and_end(
        &mut self,
        w: &mut World,
        t: &Tick,
        ending: &Ending,
        more: &impl Fn(&World) -> bool,
    ) -> Result<bool> {
        let order = &ending.order[..];
        let Some(force) = ending.force.filter(|_| !needs::collecting()) else { return Ok(false) };
        let Some(rows) = self.moved_at_once(w, t, force, order) else { return Ok(false) };
        if order.is_empty() || !order.iter().all(|k| self.ops[*k].about.fuses || self.rests(w, t, *k)) {
            return Ok(false);
        }
        begin_watch(w);
        let (all, last) = self.offer(w, t, (ending, order), more);
        let Rooms { acts, ops, mut came, mut waiting } = std::mem::take(&mut self.rooms);
        let own = Acts::new(&acts, &ops);
        let pass = FusedPass::new(own, rows, &mut waiting).filter(|_| all == order.len());
        let Some(mut pass) = pass else {
            self.rooms = Rooms { acts, ops, came, waiting };
            return Ok(false);
        };
        let (mut clock, mut moving) = (self.timing.clock(t), Duration::ZERO);
        let looks = clock;
        let p = &mut self.ops[force];
        let (span, before) = (p.span(w, t), w.traffic());
        share::before(w, span, std::iter::once(p.about.needs));
        let streamed = p.timed(w, t, &mut clock, |op, w| {
            op.run_streaming(w, t, &mut |w, particles| {
                // Reading the clock takes longer than moving a few particles.
                match particles.len() > FEW {
                    true => moving += looks.of(|| pass.ready(w, particles)),
                    false => pass.ready(w, particles),
                }
            })
        })?;
        p.meter.time = p.meter.time.saturating_sub(moving);
        // Nothing is dealt while particles are on their way.
        if w.share.is_some() {
            share::after(w, std::iter::once(p.about.needs));
            p.note(w, t, (span, before));
        }
        let before = w.traffic();
        let needs = || own.which.iter().map(|&k| self.ops[k].about.needs);
        share::before(w, Span::Own, needs());
        match streamed {
            true => pass.finish(w, &mut came),
            false => fuse(w, own, &mut came),
        }
        share::after(w, needs());
        for &k in &ops {
            self.ops[k].note(w, t, (Span::Own, if k == ops[0] { before } else { w.traffic() }));
        }
        self.rooms = Rooms { acts, ops, came, waiting };
        self.fused(w, t, last, clock.runs().then(|| moving + clock.lap()));
        end_watch(w, std::iter::once(&force).chain(order).map(|&k| self.ops[k].stated()));
        Ok(true)
    }

    /// The rows that can be moved as soon as they have their forces: all, or those of this rank where grains are shared out tile by tile, and
    /// nothing reads sums over all of them.
    fn moved_at_once(
        &mut self,
        w: &mut World,
        t: &Tick,
        force: usize,
        order: &[usize],
    ) -> Option<Range<usize>> {
        if w.share.is_none() {
            return Some(0..w.n());
        }
        let collective = t.collective && order.iter().any(|&k| self.ops[k].about.collective);
        let plain =
            w.grains_dealt().is_some() && !collective && self.ops[force].span(w, t) == Span::Requested;
        match &w.share.as_ref().filter(|_| plain)?.own[..] {
            [rows] => Some(rows.clone()),
            _ => None,
        }
    }

    /// Passes the results of a fused pass to its ops, and its duration if it was timed.
    fn fused(&mut self, w: &mut World, t: &Tick, last: Option<usize>, elapsed: Option<Duration>) {
        let Self { rooms, ops: all, begun, .. } = self;
        for (&k, sum) in rooms.ops.iter().zip(&rooms.came) {
            let p = &mut all[k];
            p.op.fused(w, t, *sum);
            p.meter.calls += 1;
            if let Some(elapsed) = elapsed {
                p.meter.time += elapsed / rooms.came.len() as u32;
                p.meter.reckon(p.op.bytes(w));
            }
            *begun |= last == Some(k);
        }
    }

    /// Whether an op that acts on no blocks is left out at this tick.
    fn rests(&mut self, w: &mut World, t: &Tick, k: usize) -> bool {
        self.ops[k].op.way(w, t, &mut Room::default()) == Way::Rests
    }

    /// Collects the actions of these ops, from the first on, on blocks of particles; ops that rest are skipped. The last kick and
    /// the clearing of forces extend into the next step where the plan allows it. Returns the number of ops, and the last kick if
    /// it extends.
    fn offer(
        &mut self,
        w: &mut World,
        t: &Tick,
        (ending, ops): (&Ending, &[usize]),
        more: &impl Fn(&World) -> bool,
    ) -> (usize, Option<usize>) {
        let (mut last, mut asked, mut on) = (None, false, None);
        self.rooms.ops.clear();
        if self.rooms.acts.len() != self.ops.len() {
            self.rooms.acts.resize_with(self.ops.len(), Room::default);
        }
        let collecting = needs::collecting();
        for (at, &k) in ops.iter().enumerate() {
            let turns = ending.last == Some(k) || ending.clears == Some(k);
            if turns && !asked {
                (last, asked) = (ending.last.filter(|_| self.begun || more(w)), true);
            }
            let (p, room) = (&mut self.ops[k], &mut self.rooms.acts[k]);
            let way = match turns && last.is_some() {
                true => {
                    let on = on.get_or_insert_with(|| Tick { on: true, ..t.clone() });
                    p.op.way(w, on, room)
                }
                // While accounts are collected, only ops that may fuse are queried: the others run alone.
                false if collecting && !p.about.fuses => Way::Alone,
                false => p.op.way(w, t, room),
            };
            match way {
                Way::Blocks => self.rooms.ops.push(k),
                Way::Rests => p.meter.calls += 1,
                Way::Alone => return (at, last),
            }
            if collecting {
                return (at + 1, last);
            }
        }
        (ops.len(), last)
    }

    /// What is left of a step, or of one of a level, after its forces. Ops that act on each particle by itself are fused;
    /// `more` as for [`StepPlan::step`].
    ///
    /// # Errors
    /// The first op's that fails.
    pub fn end(&mut self, w: &mut World, t: &Tick, more: impl Fn(&World) -> bool) -> Result<()> {
        let ending = self.ending(t);
        self.end_as(w, t, &ending, more)?;
        self.keep_ending(t, ending);
        Ok(())
    }

    fn end_as(
        &mut self,
        w: &mut World,
        t: &Tick,
        ending: &Ending,
        more: impl Fn(&World) -> bool,
    ) -> Result<()> {
        let (order, clears) = (&ending.order[..], ending.clears);
        let (mut at, mut clock) = (0, self.timing.clock(t));
        while at < order.len() {
            begin_watch(w);
            let (passed, last) = self.offer(w, t, (ending, &order[at..]), &more);
            if !self.rooms.ops.is_empty() {
                let Self { rooms: Rooms { acts, ops, came, .. }, ops: all, .. } = self;
                let collective = t.collective && ops.iter().any(|&k| all[k].about.collective);
                let span = if collective { Span::All } else { Span::Own };
                let before = w.traffic();
                share::before(w, span, ops.iter().map(|&k| all[k].about.needs));
                fuse(w, Acts::new(acts, ops), came);
                share::after(w, ops.iter().map(|&k| all[k].about.needs));
                // What was gathered for one of them was gathered for all; the first one has the bytes.
                let first = ops[0];
                for &k in &*ops {
                    all[k].note(w, t, (span, if k == first { before } else { w.traffic() }));
                }
                self.fused(w, t, last, clock.runs().then(|| clock.lap()));
                // The next op may have been queried too.
                let queried = &order[at..order.len().min(at + passed + 1)];
                end_watch(w, queried.iter().map(|&k| self.ops[k].stated()));
            }
            at += passed;
            if passed > 0 {
                continue;
            }
            let (k, p) = (order[at], &mut self.ops[order[at]]);
            let on = last == Some(k) && t.phase.levels == 1 && p.about.begins_next;
            if !self.begun && clears != Some(k) {
                match on {
                    true => {
                        let t = Tick { on, ..t.clone() };
                        p.alone(w, &t, &mut clock, |op, w| op.run(w, &t))?;
                    }
                    false => p.alone(w, t, &mut clock, |op, w| op.run(w, t))?,
                }
            }
            self.begun |= on;
            if !self.begun && last == Some(k) {
                return Ok(());
            }
            at += 1;
        }
        Ok(())
    }
}
