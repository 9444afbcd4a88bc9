//! The world as formulas see it while the deck is read.

use super::answers::{self, Declared};
use super::keywords;
use super::measure;
use super::node::Graph;
use super::offered::{from_slot, of_particles, whole_vector};
use super::regions;
use super::seal::Sealer;
use super::step_env::{clock, column, one};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_lang::{Clock, Env, Question, RefKind, Value, ValueRef, Vars, Word};
use perigrain_plan::{Op, Stage, StepPlan, Tick, When};
use perigrain_styles::probe::Probe;
use perigrain_styles::{BondForce, Flow, Motion, Reading, SealCx, Values};
use perigrain_world::{Domain, Face, SlotId, World};
use std::sync::Arc;

/// While the deck is read: values are computed on the spot; values that only a run determines are unknown where a deck is only
/// checked.
pub struct DeckEnv<'a> {
    /// The world.
    pub w: &'a mut World,
    /// What is declared.
    pub graph: &'a Graph,
}

/// Whether only a run determines a keyword's value, where a scene is only checked.
fn hidden(w: &World, name: &str) -> bool {
    let u = &w.unseen;
    let follows =
        |d: &Domain| d.boundary.0.iter().flatten().any(|f| matches!(f, Face::Shrink | Face::ShrinkMin));
    // Faces that follow particles are where these are.
    let space = u.space || (u.particles && w.domain.as_ref().is_some_and(follows));
    match name {
        "step" | "elapsed" | "elaplong" => u.step,
        "time" | "dt" => u.time,
        "vol" | "lx" | "ly" | "lz" | "xlo" | "xhi" | "ylo" | "yhi" | "zlo" | "zhi" | "cella" | "cellb"
        | "cellc" | "avecx" | "bvecy" | "cvecz" => space,
        "xlat" | "ylat" | "zlat" | "xy" | "xz" | "yz" | "cellalpha" | "cellbeta" | "cellgamma" | "avecy"
        | "avecz" | "bvecx" | "bvecz" | "cvecx" | "cvecy" => false,
        "ecoul" | "eangle" | "edihed" | "eimp" | "elong" | "etail" | "dihedrals" | "impropers" => false,
        _ => u.particles,
    }
}

impl DeckEnv<'_> {
    /// Plans the values that `ask` requests and runs that plan once.
    fn evaluate<T>(
        &mut self,
        span: Span,
        vars: &Vars,
        request: impl FnOnce(&mut Sealer) -> Result<T>,
    ) -> Result<T> {
        let (answer, mut plan, t) = self.planned(span, vars, request)?;
        plan.run(self.w, &t, &Stage::ALL)?;
        Ok(answer)
    }

    /// The slot of a compute or fix, its values fresh.
    ///
    /// # Errors
    /// Values that are not available.
    pub fn slot(&mut self, r: &ValueRef, vars: &Vars) -> Result<SlotId> {
        regions::place_all(self.w, self.graph, vars);
        self.evaluate(r.span, vars, |s| s.reference(r))
    }

    /// Runs an op once, its values fresh, as `write_dump` does.
    ///
    /// # Errors
    /// Values that are not available, and the op's own failures.
    pub fn once(
        &mut self,
        span: Span,
        vars: &Vars,
        request: impl FnOnce(&mut Sealer) -> Result<Box<dyn Op>>,
    ) -> Result<()> {
        regions::place_all(self.w, self.graph, vars);
        let (mut op, mut plan, t) = self.planned(span, vars, request)?;
        plan.run(self.w, &t, &Stage::ALL)?;
        op.run(self.w, &t)?;
        op.finish(self.w)
    }

    fn planned<T>(
        &mut self,
        span: Span,
        vars: &Vars,
        request: impl FnOnce(&mut Sealer) -> Result<T>,
    ) -> Result<(T, StepPlan, Tick)> {
        self.w.spread_type_masses();
        let mut sealer = Sealer::new(self.w, self.graph, Arc::new(vars.clone()));
        sealer.at(span);
        let answer = request(&mut sealer)?;
        let word = sealer.tallies.unwrap_or(span);
        let mut plan = sealer.plan;
        let t = Tick::between_runs(&self.w.clock);
        let mut wanted = t.clone();
        plan.request_sums(&mut wanted);
        let tally = &self.w.tally;
        // LAMMPS checks the step alone, and returns what the last run has left of particles that were changed since.
        let stands = tally.step == Some(t.step) && (!*self.w.changed || self.w.settings.lammps());
        let short = (wanted.energy && !stands)
            || (wanted.virial && !(stands && tally.with_virial))
            || (wanted.atom_energy && !(stands && tally.with_atoms))
            || (wanted.atom_virial && !(stands && tally.with_atom_virial));
        if short {
            return Err(Diagnostic::error(
                Code::WRONG_ORDER,
                word,
                "energies or pressures of the present state have not been computed",
            )
            .help(
                "put `run 0` before this line, or let thermo output show the quantity at the run's last step",
            )
            .into());
        }
        Ok((answer, plan, t))
    }
}

impl DeckEnv<'_> {
    /// Whether only a run determines the state of particles.
    fn blind(&self) -> bool {
        self.w.unseen.particles
    }

    /// The result of `read` for the slot of a reference, filled for this moment; unknown where only a run determines it.
    fn filled(
        &mut self,
        r: &ValueRef,
        vars: &Vars,
        read: fn(&World, SlotId, &ValueRef) -> Result<Value>,
    ) -> Result<Value> {
        if self.blind() {
            return Ok(Value::Unknown);
        }
        regions::place_all(self.w, self.graph, vars);
        let slot = self.evaluate(r.span, vars, |s| s.reference(r))?;
        read(self.w, slot, r)
    }
}

impl Env for DeckEnv<'_> {
    fn keyword(&mut self, name: &str, span: Span, vars: &Vars) -> Option<Result<Value>> {
        let (name, ..) = keywords::find(name)?;
        if hidden(self.w, name) {
            return Some(Ok(Value::Unknown));
        }
        let reading = self.evaluate(span, vars, |s| s.keyword(name, span, Stage::Output, &When::Always));
        Some(reading.map(|r| Value::Number(r.get(self.w))))
    }

    fn reference(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value> {
        self.filled(r, vars, from_slot)
    }

    fn of_particles(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value> {
        self.filled(r, vars, of_particles)
    }

    fn particle(&mut self, attribute: &str, tag: usize, span: Span) -> Result<Value> {
        if self.blind() { Ok(Value::Unknown) } else { one(self.w, attribute, tag, span) }
    }

    fn column(&mut self, attribute: &str) -> Option<Result<Vec<f64>>> {
        self.w.spread_type_masses();
        column(self.w, attribute)
    }

    fn group_function(&mut self, name: &str, args: &[Word], span: Span, vars: &Vars) -> Result<Value> {
        self.w.spread_type_masses();
        regions::place_following(self.w, self.graph, vars, |name| args.iter().any(|a| a.text == name))?;
        let value = measure::group_function(self.w, name, args, span)?;
        Ok(if self.blind() { Value::Unknown } else { Value::Number(value) })
    }

    fn vector(&mut self, r: &ValueRef, vars: &Vars) -> Result<Value> {
        if self.blind() {
            return Ok(Value::Unknown);
        }
        regions::place_all(self.w, self.graph, vars);
        let slot = self.evaluate(r.span, vars, |s| s.reference(r))?;
        whole_vector(self.w, slot, r)
    }

    fn mask(&mut self, group: Option<&Word>, region: Option<&Word>, vars: &Vars) -> Result<Value> {
        let named = |name: &str| region.is_some_and(|r| r.text == name);
        regions::place_following(self.w, self.graph, vars, named)?;
        let list = answers::mask(self.w, group, region)?;
        Ok(if self.blind() { Value::Unknown } else { Value::Atom(list) })
    }

    fn setting(&self, name: &str) -> Option<Value> {
        answers::setting(self.w, self.blind(), name)
    }

    fn answer(&self, question: Question, category: &Word, name: &Word) -> Result<bool> {
        answers::answer(self.w, &Declared::new(self.w, self.graph), question, category, name)
    }

    fn timed_out(&self) -> bool {
        self.w.settings.timed_out()
    }

    fn sees_particles(&self) -> bool {
        !self.blind()
    }

    fn only_looks(&self) -> bool {
        self.blind()
    }

    fn may_be_written(&self, path: &str) -> bool {
        self.w.promised.may_come(path)
    }

    fn control(&self, name: &str) -> Option<f64> {
        self.w.controls.look_up(name).copied()
    }
    fn clock(&self) -> Clock {
        clock(self.w)
    }

    fn natoms(&self) -> usize {
        self.w.n()
    }

    fn keywords(&self) -> Vec<&str> {
        keywords::KEYWORDS.iter().map(|(n, ..)| *n).collect()
    }
}

/// Values for acts, between runs.
pub struct DeckValues<'a> {
    /// What is declared.
    pub graph: &'a Graph,
    /// The variable table.
    pub vars: Arc<Vars>,
}

impl Values for DeckValues<'_> {
    fn with_internal(&mut self, w: &mut World, r: &ValueRef, set: &[(&ValueRef, f64)]) -> Result<f64> {
        let vars = Arc::make_mut(&mut self.vars);
        for (variable, value) in set {
            if !vars.set_internal(&variable.name, *value) {
                let text = format!("variable `{}` must be of style internal", variable.name);
                return fail(Code::WRONG_KIND, variable.span, text);
            }
        }
        let vars = self.vars.clone();
        let mut env = DeckEnv { w, graph: self.graph };
        match vars.value(&r.name, r.span, &mut env)? {
            Value::Number(a) => Ok(a),
            _ => fail(Code::WRONG_KIND, r.span, format!("`{r}` has no single number")),
        }
    }

    fn scalar(&mut self, w: &mut World, r: &ValueRef) -> Result<f64> {
        match self.reading(w, r)? {
            reading if reading.per_atom() => fail(
                Code::WRONG_KIND,
                r.span,
                format!("`{r}` has one value per particle; one number is needed"),
            ),
            reading => Ok(reading.get(w)),
        }
    }

    fn per_atom(&mut self, w: &mut World, r: &ValueRef) -> Result<Vec<f64>> {
        let reading = self.reading(w, r)?;
        let values = (0..w.n()).map(|i| reading.atom(w, i)).collect();
        if let (Reading::Atom(slot, _), RefKind::Variable) = (reading, r.kind) {
            // Variables are evaluated anew at each use: values requested by acts need no place during runs.
            w.slots.get_mut(slot).empty();
        }
        Ok(values)
    }

    fn flow(&mut self, w: &mut World, compute: &ValueRef) -> Result<Flow> {
        match self.graph.knows_flow(&compute.name).and_then(|c| c.compute.flow(w)) {
            Some(flow) => Ok(flow),
            None => fail(Code::WRONG_KIND, compute.span, format!("`{compute}` takes no flow away")),
        }
    }

    fn stop(&mut self, w: &mut World, fix: &Word, what: Motion) -> Result<()> {
        match self.graph.find_fix(&fix.text) {
            Some(node) => node.fix.stop(w, what, fix.span),
            None => fail(Code::UNKNOWN_NAME, fix.span, format!("there is no fix `{}`", fix.text)),
        }
    }

    fn probes(&self, w: &World) -> Result<Vec<Box<dyn Probe>>> {
        let Some(node) = &self.graph.pair else { return Ok(vec![]) };
        let found = node.pair.probes(w, false).map_err(|e| e.at(node.span))?;
        Ok(found.into_iter().map(|(_, probe)| probe).collect())
    }

    fn bonds(&self) -> Option<Box<dyn BondForce>> {
        self.graph.bond.as_ref().map(|node| node.force.clone())
    }
}

impl DeckValues<'_> {
    fn reading(&mut self, w: &mut World, r: &ValueRef) -> Result<Reading> {
        let mut env = DeckEnv { w, graph: self.graph };
        regions::place_all(env.w, env.graph, &self.vars);
        env.evaluate(r.span, &self.vars, |s| s.value(r, Stage::Output, &When::Always))
    }
}
