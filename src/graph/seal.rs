//! Declarations and world become a step plan: values before their readers, and only values that are read.

mod context;

use super::answers::Declared;
use super::keywords::{self, Need, Sources};
use super::node::{FixNode, Graph};
use super::values::{Evaluate, Keyword, Once, groups_alone, reads};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_lang::{Dep, RefKind, ValueRef, Vars};
use perigrain_output::log::Log;
use perigrain_pairs::PLASTIC_GRAIN;
use perigrain_plan::{Level, Op, Placed, Stage, StepPlan, When};
use perigrain_styles::fix::Facts;
use perigrain_styles::probe::Probe;
use perigrain_styles::{Reading, SealCx, Shape};
use perigrain_world::{GroupId, SlotId, World};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A plan in the making.
pub struct Sealer<'a> {
    world: &'a mut World,
    graph: &'a Graph,
    vars: Arc<Vars>,
    /// The ops so far.
    pub plan: StepPlan,
    span: Span,
    /// The computes placed so far, which may be requested again, and their evaluations; name and stage.
    placed: Vec<(String, Stage)>,
    /// Names being resolved, to find circles.
    trail: Vec<String>,
    /// Evaluations of variables and keywords so far, for the present compute or else for all other lines: each has a slot of its
    /// own.
    uses: usize,
    /// The log of the run.
    pub log: Log,
    /// Steps are load steps of `statics`.
    pub at_rest: bool,
    /// Declarations as formulas see them.
    declared: Option<Arc<Declared>>,
    /// The word outside computes and variables whose value is being planned.
    word: Span,
    /// The first such word that needs energies or pressures.
    pub tallies: Option<Span>,
    /// The level of steps that the present fix has been given.
    chosen: Option<usize>,
    /// The bit of the group that the present fix acts on; 0 where no fix is present.
    group: u32,
}

impl<'a> Sealer<'a> {
    /// Starts an empty plan.
    pub fn new(world: &'a mut World, graph: &'a Graph, vars: Arc<Vars>) -> Self {
        Self {
            world,
            graph,
            vars,
            plan: StepPlan::default(),
            span: Span::default(),
            placed: vec![],
            trail: vec![],
            uses: 0,
            log: Log::silent(),
            at_rest: false,
            declared: None,
            word: Span::default(),
            tallies: None,
            chosen: None,
            group: 0,
        }
    }

    /// Adds ops that come from the line at `span`.
    pub fn add(&mut self, ops: Vec<Box<dyn Op>>, span: Span) {
        for op in ops {
            let mut placed = Placed::new(op, Some(span));
            if placed.about.stage == Stage::PostForce && placed.about.level == Level::Outermost {
                placed.about.level = self.level();
            }
            self.plan.add(placed);
        }
    }

    /// As `add`, for forces; with several levels of steps they act in one of them.
    pub fn add_forces(&mut self, ops: Vec<Box<dyn Op>>, span: Span, level: usize) {
        for op in ops {
            let mut placed = Placed::new(op, Some(span));
            if self.plan.levels.is_some() {
                placed.about.level = Level::At(level);
            }
            self.plan.add(placed);
        }
    }

    /// What follows belongs to the fix declared at `span`, which has been given a level of steps or not and acts on the group with
    /// this bit.
    pub fn at_fix(&mut self, span: Span, level: Option<usize>, group: u32) {
        self.at(span);
        self.chosen = level.filter(|_| self.plan.levels.is_some());
        self.group = group;
    }

    /// Notes the parts of a full step that this scene does without.
    pub fn note_left_out(&mut self) {
        let p = &self.world.particles;
        let out: [(bool, &str, &str); 5] = [
            (!p.style.sphere, "rotation and torque", "no particle has a radius"),
            (self.graph.pair.is_none(), "pair forces", "no pair_style"),
            (self.plan.energy.is_empty(), "energy tally", "nothing reads the potential energy"),
            (self.plan.virial.is_empty(), "virial tally", "nothing reads the pressure"),
            (self.plan.atom_energy.is_empty(), "per-particle energies", "nothing reads them"),
        ];
        for (missing, what, why) in out {
            if missing {
                self.leave_out(what, why);
            }
        }
    }

    /// At multiples of which step the values of a fix are new; 0 and 1: at every step.
    pub fn fix_interval(&self, r: &ValueRef) -> i64 {
        match r.kind {
            RefKind::Fix => self.graph.find_fix(&r.name).map_or(0, |f| f.fix.shape().every),
            _ => 0,
        }
    }

    /// Whether only a run determines how many elements a value has; a fixed number was checked when its line was read, and some
    /// fixes fill theirs only when they act.
    pub fn is_open(&self, r: &ValueRef) -> bool {
        match r.kind {
            RefKind::Fix => self.graph.find_fix(&r.name).is_none_or(|f| f.fix.shape().vector == Shape::OPEN),
            _ => true,
        }
    }

    /// Whether the pair style in force has plastic grains.
    pub fn grains_are_plastic(&self) -> bool {
        self.world.facts.has(*PLASTIC_GRAIN)
    }

    /// The probes of single pairs, see [`Pair::probes`](perigrain_styles::Pair::probes).
    fn probes_of(&self, bonds: bool) -> Result<Vec<Box<dyn Probe>>> {
        let probes = self.graph.pair.as_ref().map_or(Ok(vec![]), |node| node.pair.probes(self.world, bonds));
        Ok(probes?.into_iter().map(|(_, probe)| probe).collect())
    }

    /// All fixes with their declarations.
    pub fn facts(&self) -> impl Iterator<Item = (&'a FixNode, Facts)> {
        self.graph.fixes.iter().map(|f| (f, f.fix.facts(self.world)))
    }

    /// Whether a fix changes the box during the run.
    pub fn deforms(&self) -> bool {
        self.facts().any(|(_, facts)| facts.deforms != [false; 6])
    }

    /// What is declared.
    pub fn graph(&self) -> &'a Graph {
        self.graph
    }

    /// What follows belongs to the line at `span`.
    pub fn at(&mut self, span: Span) {
        (self.span, self.chosen, self.group) = (span, None, 0);
    }

    /// What follows is planned for the word at `span`, unless it is for a compute or variable that is being planned itself.
    fn at_word(&mut self, span: Span) {
        if self.trail.is_empty() {
            self.word = span;
        }
    }

    /// Places a provider so that it runs before what is added to `stage` next.
    fn provide(&mut self, op: Box<dyn Op>, when: When, provides: String) {
        let mut placed = Placed { provides, ..Placed::new(op, Some(self.span)) };
        placed.about.when = when;
        if self.plan.levels.is_some() {
            placed.about.level = Level::Every;
        }
        self.plan.add(placed);
    }

    fn enter(&mut self, name: String, span: Span) -> Result<()> {
        if self.trail.contains(&name) {
            let circle = self.trail.join(" → ");
            return fail(Code::CONFLICT, span, format!("`{name}` depends on itself: {circle} → {name}"));
        }
        self.trail.push(name);
        Ok(())
    }

    /// The slot of a compute that is fresh at `stage` whenever `when` fires.
    fn compute(&mut self, id: &str, span: Span, stage: Stage, when: &When) -> Result<SlotId> {
        let graph = self.graph;
        let Some(node) = graph.find_compute(id) else {
            return fail(Code::UNKNOWN_COMPUTE, span, format!("there is no compute `{id}`"));
        };
        self.at_word(span);
        let key = format!("c_{id}");
        let slot = self.world.slots.id(&key);
        self.world.slots.get_mut(slot).offers = node.compute.shape().offers();
        if self.placed.contains(&(key.clone(), stage)) {
            // Already there: it only has to act at these times too, and so must what it reads.
            self.widen(&key, stage, when);
        }
        self.enter(key.clone(), span)?;
        let outer = (std::mem::replace(&mut self.span, node.span), std::mem::take(&mut self.uses));
        let op = node.compute.op(self, slot, stage, when);
        (self.span, self.uses) = outer;
        self.trail.pop();
        let op = op?;
        if !self.placed.contains(&(key.clone(), stage)) {
            self.provide(Box::new(Once { op, stage, slot }), when.clone(), key.clone());
            self.placed.push((key, stage));
        }
        Ok(slot)
    }

    /// Has the computes that take note of how a run begins evaluated in its setup.
    ///
    /// # Errors
    /// What they miss in the scene.
    pub fn begin_computes(&mut self) -> Result<()> {
        for node in self.graph.computes.iter().filter(|c| c.compute.begins()) {
            self.compute(&node.id, node.span, Stage::Output, &When::First)?;
        }
        Ok(())
    }

    /// The same in the last step for those that have values after a run only if that step has tallied for them.
    ///
    /// # Errors
    /// As `begin_computes`.
    pub fn end_computes(&mut self) -> Result<()> {
        for node in self.graph.computes.iter().filter(|c| c.compute.tallied()) {
            self.compute(&node.id, node.span, Stage::Output, &When::Last)?;
        }
        Ok(())
    }

    /// Places the evaluation of a variable or keyword into a slot. A compute that is requested again requests its own inputs
    /// again: these are not evaluated once more, but at these times too.
    fn evaluate(
        &mut self,
        what: &str,
        stage: Stage,
        when: &When,
        op: impl FnOnce(SlotId) -> Box<dyn Op>,
    ) -> SlotId {
        self.uses += 1;
        let reader = self.trail.iter().rev().find(|name| name.starts_with("c_"));
        let key = match reader {
            Some(reader) => format!("{what}#{reader} {stage:?} {}", self.uses),
            None => format!("{what}#{}", self.uses),
        };
        let slot = self.world.slots.id(&key);
        if self.placed.contains(&(key.clone(), stage)) {
            self.widen(&key, stage, when);
        } else {
            self.provide(op(slot), when.clone(), key.clone());
            self.placed.push((key, stage));
        }
        slot
    }

    fn widen(&mut self, key: &str, stage: Stage, when: &When) {
        for p in self.plan.ops.iter_mut().filter(|p| p.about.stage == stage && p.provides == key) {
            p.about.when = p.about.when.clone().or(when.clone());
        }
    }

    /// Declarations as formulas see them.
    pub fn declared(&mut self) -> Arc<Declared> {
        let (w, graph) = (&*self.world, self.graph);
        self.declared.get_or_insert_with(|| Arc::new(Declared::new(w, graph))).clone()
    }

    /// A variable's value; each use is evaluated by itself.
    fn variable(&mut self, r: &ValueRef, stage: Stage, when: &When) -> Result<Reading> {
        let vars = self.vars.clone();
        if vars.kind(&r.name).is_none() {
            return fail(Code::UNKNOWN_VARIABLE, r.span, format!("there is no variable `{}`", r.name));
        }
        self.at_word(r.span);
        self.enter(format!("v_{}", r.name), r.span)?;
        let deps = vars.depends(&r.name);
        let mut from = BTreeMap::new();
        for dep in deps {
            let (name, slot) = match dep {
                Dep::Keyword(k) => {
                    let reading = self.keyword(&k, r.span, stage, when)?;
                    let Reading::Scalar(slot) = reading else { continue };
                    (k, slot)
                }
                Dep::Ref(d) => (d.to_string(), self.source(&d, stage, when)?),
            };
            from.insert(name, slot);
        }
        self.trail.pop();
        let shape = self.graph.variables.get(&r.name).copied().unwrap_or_default();
        let declared = self.declared();
        let (name, variable, span) = (format!("variable {}", r.name), r.name.clone(), r.span);
        let (reads, common) = (reads(&vars, &variable), None);
        let fixed = |id: &GroupId| self.world.groups.is_fixed(*id);
        let bit = |group: String| self.world.groups.find(&group).filter(fixed).map(|id| id.bit());
        let groups = groups_alone(&vars, &variable)
            .and_then(|groups| groups.into_iter().map(bit).try_fold(0, |all, bit| Some(all | bit?)));
        // What a compute reads of particles is that of all.
        let group = if self.trail.iter().any(|name| name.starts_with("c_")) { 0 } else { self.group };
        let slot = self.evaluate(&format!("v_{}", r.name), stage, when, |slot| {
            Box::new(Evaluate {
                declared,
                name,
                variable,
                span,
                vars,
                from,
                slot,
                stage,
                reads,
                groups,
                common,
                group,
            })
        });
        self.world.slots.get_mut(slot).offers = shape.offers();
        Ok(match r.index.as_slice() {
            _ if shape.atom.is_some() => Reading::Atom(slot, 0),
            [] if shape.vector > 0 => Reading::Vector(slot),
            [k] if shape.vector > 0 => Reading::Element(slot, k - 1),
            _ => Reading::Scalar(slot),
        })
    }

    /// A thermo keyword's value over all particles, never divided by their number.
    ///
    /// # Errors
    /// Unknown keywords.
    pub fn keyword_total(&mut self, name: &str, span: Span, stage: Stage, when: &When) -> Result<Reading> {
        self.keyword_as(name, span, stage, when, false)
    }

    fn keyword_as(
        &mut self,
        name: &str,
        span: Span,
        stage: Stage,
        when: &When,
        norm: bool,
    ) -> Result<Reading> {
        let Some((name, _, needs)) = keywords::find(name) else {
            return fail(Code::UNKNOWN_NAME, span, format!("there is no thermo keyword `{name}`"));
        };
        let thermo = &self.graph.thermo;
        let ids = (thermo.temp.clone(), thermo.press.clone(), thermo.pe.clone());
        let mut sources = Sources { norm, ..Sources::default() };
        for need in *needs {
            match need {
                Need::Temp => sources.temp = Some(self.compute(&ids.0, span, stage, when)?),
                Need::Press => sources.press = Some(self.compute(&ids.1, span, stage, when)?),
                Need::Pe => sources.pe = Some(self.compute(&ids.2, span, stage, when)?),
                Need::Pair => self.request_energy(when),
            }
        }
        Ok(Reading::Scalar(
            self.evaluate(name, stage, when, |slot| Box::new(Keyword { name, sources, slot, stage })),
        ))
    }

    /// The slot of a compute or fix, fresh for a formula evaluated between runs.
    ///
    /// # Errors
    /// Unknown names.
    pub fn reference(&mut self, r: &ValueRef) -> Result<SlotId> {
        self.source(r, Stage::Output, &When::Always)
    }

    /// What the compute, fix or variable of a reference offers.
    fn shape_of(&self, r: &ValueRef) -> Shape {
        let graph = self.graph;
        match r.kind {
            RefKind::Variable => graph.variables.get(&r.name).copied(),
            RefKind::Compute | RefKind::ComputeAtom => graph.find_compute(&r.name).map(|c| c.compute.shape()),
            RefKind::Fix | RefKind::FixAtom => graph.find_fix(&r.name).map(|f| f.fix.shape()),
        }
        .unwrap_or_default()
    }

    /// The slot of a compute or fix that a formula reads.
    pub(super) fn source(&mut self, r: &ValueRef, stage: Stage, when: &When) -> Result<SlotId> {
        match r.kind {
            RefKind::Compute | RefKind::ComputeAtom => self.compute(&r.name, r.span, stage, when),
            RefKind::Fix | RefKind::FixAtom => match self.graph.find_fix(&r.name) {
                Some(node) => {
                    let name = format!("f_{}", r.name);
                    let slot = self.world.slots.id(&name);
                    // What acts within steps reads values of the step before.
                    if when.is_always() || stage < Stage::EndOfStep {
                        self.plan.watched.push(name);
                    }
                    self.world.slots.get_mut(slot).offers = node.fix.shape().offers();
                    Ok(slot)
                }
                None => fail(Code::UNKNOWN_FIX, r.span, format!("there is no fix `{}`", r.name)),
            },
            RefKind::Variable => match self.variable(r, stage, when)? {
                Reading::Scalar(s) | Reading::Atom(s, _) | Reading::Vector(s) | Reading::Element(s, _) => {
                    Ok(s)
                }
                _ => fail(Code::WRONG_KIND, r.span, "this variable has no value here"),
            },
        }
    }
}
