//! `rerun`: forces and output for the snapshots of dumps, without motion.

use super::Session;
use super::running::Pass;
use crate::graph::Role;
use crate::graph::declaration::Context;
use perigrain_base::diag::Result;
use perigrain_commands::read_dump::Rerun;
use perigrain_lang::{Args, Command};
use perigrain_plan::run::verlet;
use perigrain_world::GroupId;
use std::cell::RefCell;
use std::time::Instant;

impl Session {
    pub(super) fn rerun(&mut self, cmd: &Command) -> Result<()> {
        let (notes, uses) = (RefCell::default(), RefCell::default());
        let cx = Context { span: cmd.span, checking: self.checking(), notes: &notes, uses: &uses };
        let mut args = Args::new(cmd);
        let rerun = Rerun::read(&mut args, &cx.build(&self.graph, &self.world, "", GroupId::ALL))?;
        args.finish()?;
        self.thermo_computes();
        self.record(cmd, Role::Run, None, vec![], vec![]);
        self.ready(cmd.span)?;
        self.check_run(cmd.span, false)?;
        if self.checking() {
            rerun.reel.comes(&self.world)?;
            self.promise_outputs();
            self.unsee(false);
            return Ok(());
        }
        self.print_notes()?;
        let Rerun { mut reel, start, stop, post } = rerun;
        let c = &mut self.world.clock;
        let (first, last) = (reel.first, reel.last);
        (c.began, c.step) = (None, first);
        self.world.resume = None;
        self.world.slots.invalidate();
        if self.planning() {
            self.plan_of(cmd.span, Pass::Rerun)?;
            self.promise_outputs();
            self.unsee(false);
            return Ok(());
        }
        let mut plan = self.sealed(cmd.span, Pass::Rerun)?.0;
        self.world.clock.running = true;
        self.world.clock.began = Some(Instant::now());
        // Contact history belongs to the scene before, not to the snapshot before.
        let mut contacts = self.world.contacts.clone();
        let outcome = verlet::look(&mut plan, &mut self.world, |w| {
            // Snapshots meet particles in the order of their creation.
            w.fall_back();
            let left = std::mem::replace(&mut w.contacts, contacts.clone());
            let shown = reel.next(w)?;
            match shown {
                // The contacts of particles that the snapshot has deleted are dropped from now on.
                Some(_) => contacts.clone_from(&w.contacts),
                None => w.contacts = left,
            }
            // Reading has set the counter; the run as a whole goes from `first` to `last`.
            let c = &mut w.clock;
            (c.start, c.stop) = (start.unwrap_or(first), stop.unwrap_or(last));
            let end = shown.as_ref().filter(|s| s.last).map_or(last, |s| s.step);
            (c.first, c.last) = (c.start, end);
            Ok(shown.is_some())
        });
        self.world.clock.running = false;
        let finished = plan.finish(&mut self.world);
        self.world.fall_back();
        let outcome = outcome.map_err(|e| e.at(cmd.span))?;
        finished?;
        self.ran = true;
        self.interrupted |= outcome.interrupted;
        self.log_end(&plan, &outcome, None, post)?;
        self.plan = Some(plan);
        Ok(())
    }
}
