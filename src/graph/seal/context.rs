//! What ops can request while a plan is made.

use super::Sealer;
use crate::graph::{bond_formulas, texts};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_lang::{RefKind, ValueRef};
use perigrain_output::log::Log;
use perigrain_pairs::bond::BondForce;
use perigrain_plan::{LeftOut, Level, Op, Stage, When};
use perigrain_styles::pair::Deck;
use perigrain_styles::probe::{Probe, WallProbe};
use perigrain_styles::{BondFormula, Compute, Gravity, Names, PlaceTest, Pull, Reading, SealCx, Text, Wants};
use perigrain_world::adapted::Coefficient;
use perigrain_world::{SlotId, World};

impl SealCx for Sealer<'_> {
    fn world(&mut self) -> &mut World {
        self.world
    }

    fn span(&self) -> Span {
        self.span
    }

    fn at_rest(&self) -> bool {
        self.at_rest
    }

    fn level(&self) -> Level {
        self.chosen.map_or(Level::Outermost, Level::At)
    }

    fn slot(&mut self, name: &str) -> SlotId {
        self.world.slots.id(name)
    }

    fn value(&mut self, r: &ValueRef, stage: Stage, when: &When) -> Result<Reading> {
        let shape = self.shape_of(r);
        let number = match r.index.as_slice() {
            [] => shape.scalar,
            [k] => *k <= shape.vector,
            _ => true,
        };
        self.reading(r, if number { Wants::Number } else { Wants::PerAtom }, stage, when)
    }

    fn reading(&mut self, r: &ValueRef, wants: Wants, stage: Stage, when: &When) -> Result<Reading> {
        let wrong = |text: String| fail(Code::WRONG_KIND, r.span, text);
        match r.kind {
            RefKind::ComputeAtom | RefKind::FixAtom => {
                return wrong(format!("`{r}` belongs in a formula: use an equal-style variable"));
            }
            RefKind::Variable => {
                let reading = self.variable(r, stage, when)?;
                return match (wants, &reading) {
                    (Wants::Vector, Reading::Vector(_)) | (Wants::Number | Wants::PerAtom, _) => Ok(reading),
                    _ => wrong(format!("`{r}` has no such value")),
                };
            }
            RefKind::Compute | RefKind::Fix => {}
        }
        let shape = self.shape_of(r);
        let slot = self.source(r, stage, when)?;
        Ok(match (wants, r.index.as_slice()) {
            (Wants::Number, []) if shape.scalar => Reading::Scalar(slot),
            (Wants::Number, [k]) if *k <= shape.vector => Reading::Element(slot, k - 1),
            (Wants::Number, [i, j]) if *i <= shape.array_rows && *j <= shape.array => {
                Reading::Cell(slot, i - 1, j - 1)
            }
            (Wants::PerAtom, []) if shape.atom == Some(1) => Reading::Atom(slot, 0),
            (Wants::PerAtom, [k]) if shape.atom.is_some_and(|c| *k <= c) => Reading::Atom(slot, k - 1),
            (Wants::Vector, []) if shape.vector > 0 => Reading::Vector(slot),
            (Wants::Vector, [k]) if *k <= shape.array => Reading::Column(slot, k - 1),
            (Wants::Local, []) if shape.local == 1 => Reading::Local(slot, 0),
            (Wants::Local, [k]) if *k <= shape.local => Reading::Local(slot, k - 1),
            _ => return wrong(format!("`{r}` has no such value")),
        })
    }

    fn keyword(&mut self, name: &str, span: Span, stage: Stage, when: &When) -> Result<Reading> {
        self.at_word(span);
        let norm = self.graph.thermo.normalized(self.world);
        self.keyword_as(name, span, stage, when, norm)
    }

    fn text(&mut self, text: &str, span: Span, stage: Stage, when: &When) -> Result<Text> {
        let vars = self.vars.clone();
        texts::text(self, vars, text, span, stage, when)
    }

    fn steps(&mut self, r: &ValueRef) -> Result<When> {
        texts::steps(self.world, &self.vars, r)
    }

    fn test(
        &mut self,
        r: &ValueRef,
        sets: &[Option<ValueRef>; 3],
        stage: Stage,
        when: &When,
    ) -> Result<PlaceTest> {
        let vars = self.vars.clone();
        texts::test(self, vars, r, sets, stage, when)
    }

    fn bond_formula(&mut self, r: &ValueRef, stage: Stage, when: &When) -> Result<BondFormula> {
        let vars = self.vars.clone();
        bond_formulas::formula(self, vars, r, stage, when)
    }

    fn pulls(&self) -> Vec<Pull> {
        self.facts().filter_map(|(_, facts)| facts.pull).collect()
    }

    fn gravities(&mut self) -> Vec<Gravity> {
        let found = self.facts().filter(|(_, facts)| facts.pull.is_some());
        let found: Vec<_> = found.map(|(f, facts)| (f.id.clone(), f.group, !facts.disabled)).collect();
        let gravity = |(id, group, acts): (String, _, _)| {
            let slot = self.world.slots.id(&format!("f_{id}"));
            Gravity { id, group, acts, slot }
        };
        found.into_iter().map(gravity).collect()
    }

    fn adopts(&self, id: &str) -> Option<Vec<String>> {
        self.graph.find_fix(id).map(|f| f.fix.facts(self.world).adopts)
    }

    fn adopter(&self, template: &str) -> Option<(String, &'static str)> {
        let mut all = self.facts();
        let found = all.find(|(_, facts)| facts.adopts.iter().any(|name| name == template));
        found.map(|(f, _)| (f.id.clone(), f.style))
    }

    fn log(&self) -> Log {
        self.log.clone()
    }

    fn refresh(&mut self, id: &str, stage: Stage, when: &When) -> Result<Option<Box<dyn Op>>> {
        let graph = self.graph;
        match graph.find_compute(id) {
            Some(node) => node.compute.refresh(self, stage, when),
            None => fail(Code::UNKNOWN_NAME, self.span, format!("there is no compute `{id}`")),
        }
    }

    fn bias(&self, r: &ValueRef) -> Option<Box<dyn Compute>> {
        self.graph.knows_flow(&r.name).map(|c| c.compute.clone())
    }

    fn pair_styles(&self) -> Vec<&'static str> {
        Names::pair_styles(self.graph)
    }

    fn coefficient(&self, of: &Coefficient) -> Option<f64> {
        self.graph.coefficient(of)
    }

    fn bonds(&self) -> Option<Box<dyn BondForce>> {
        self.graph.bond.as_ref().map(|b| b.force.clone())
    }

    fn request_energy(&mut self, when: &When) {
        self.tallies.get_or_insert(self.word);
        self.plan.energy.push(when.clone());
    }

    fn request_virial(&mut self, when: &When) {
        self.tallies.get_or_insert(self.word);
        self.plan.virial.push(when.clone());
    }

    fn request_atom_energy(&mut self, when: &When) {
        self.tallies.get_or_insert(self.word);
        self.plan.atom_energy.push(when.clone());
    }

    fn request_atom_virial(&mut self, when: &When) {
        self.tallies.get_or_insert(self.word);
        self.plan.atom_virial.push(when.clone());
    }

    fn probes(&mut self) -> Result<Vec<Box<dyn Probe>>> {
        self.probes_of(false)
    }

    fn singles(&mut self) -> Result<Vec<Box<dyn Probe>>> {
        self.probes_of(true)
    }

    fn wall_probes(&mut self) -> Result<Vec<(String, Box<dyn WallProbe>)>> {
        let (graph, mut probes) = (self.graph, vec![]);
        for node in &graph.fixes {
            let Some(wall) = node.fix.wall() else { continue };
            if let Some(probe) = wall.probe(self)? {
                probes.push((node.id.clone(), probe));
            }
        }
        Ok(probes)
    }

    fn cutoff(&mut self) -> Option<f64> {
        self.graph.pair.as_ref()?.pair.scales(self.world, Deck::default()).cutoff
    }

    fn energy_fixes(&self) -> Vec<String> {
        self.graph.fixes.iter().filter(|f| f.energy).map(|f| format!("f_{}", f.id)).collect()
    }

    fn leave_out(&mut self, what: &str, why: &str) {
        let l = LeftOut { what: what.to_string(), why: why.to_string() };
        if !self.plan.left_out.contains(&l) {
            self.plan.left_out.push(l);
        }
    }
}
