//! A bench for unit tests of styles: a small world, lines as a deck has them, and a sealing without a graph.

pub mod lines;

use super::{
    BuildCx, Compute, ComputeStyle, Fix, FixStyle, Names, Pair, PlaceTest, Pull, Reading, SealCx, Shape,
    Text, UseKind, Wants,
};
use crate::probe::Probe;
use perigrain_base::diag::{Code, Diagnostics, FileId, Result, Span, fail};
use perigrain_lang::{Args, Command, RefKind, ValueRef, Word};
use perigrain_output::log::Log;
use perigrain_plan::{Op, Stage, Tick, When};
use perigrain_world::{AtomStyle, Boundary, Domain, GroupId, SlotId, World};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A world with particles and what has been declared around them.
#[derive(Default)]
pub struct Bench {
    /// The world.
    pub world: World,
    /// Equal-style variables and their values.
    pub equal: BTreeMap<String, f64>,
    /// Atom-style variables and their values.
    pub atom: BTreeMap<String, Vec<f64>>,
    /// Computes.
    pub computes: BTreeMap<String, Shape>,
    /// The pair style.
    pub pair: Option<Box<dyn Pair>>,
    /// Slots of fixes whose energy counts.
    pub energy_fixes: Vec<String>,
    /// Accelerations of fixes gravity.
    pub pulls: Vec<Pull>,
}

impl Bench {
    /// Particles of type 1 and mass 2 at these places, in a periodic box from -10 to 10.
    pub fn new(style: AtomStyle, places: &[[f64; 3]]) -> Self {
        let mut world = World { types: 1, type_mass: vec![Some(2.0)].into(), ..World::default() };
        world.domain = Some(Domain::new([-10.0; 3], [10.0; 3], Boundary::default())).into();
        world.particles.style = style;
        for (k, x) in places.iter().enumerate() {
            world.particles.push(k as u32 + 1, 1, *x);
        }
        world.particles.mass.fill(2.0);
        Self { world, ..Self::default() }
    }

    /// A fix `f` of all from the words after its style.
    pub fn fix(&self, style: &dyn FixStyle, words: &str) -> Result<Box<dyn Fix>> {
        let (notes, uses) = Default::default();
        style.build(&mut Args::new(&command(words)), &self.build_cx("f", &notes, &uses))
    }

    /// A compute `c` of all from the words after its style.
    pub fn compute(&self, style: &dyn ComputeStyle, words: &str) -> Result<Box<dyn Compute>> {
        let (notes, uses) = Default::default();
        style.build(&mut Args::new(&command(words)), &self.build_cx("c", &notes, &uses))
    }

    /// Reads options of `fix_modify` or `compute_modify`.
    pub fn modify(&self, words: &str, read: impl FnOnce(&mut Args, &BuildCx) -> Result<()>) -> Result<()> {
        let (notes, uses) = Default::default();
        read(&mut Args::new(&command(words)), &self.build_cx("c", &notes, &uses))
    }

    fn build_cx<'a>(
        &'a self,
        id: &'a str,
        notes: &'a RefCell<Diagnostics>,
        uses: &'a RefCell<Vec<super::Use>>,
    ) -> BuildCx<'a> {
        let span = span();
        BuildCx {
            world: &self.world,
            names: self,
            id,
            group: GroupId::ALL,
            span,
            checking: false,
            notes,
            uses,
        }
    }

    /// Seals a fix.
    pub fn seal(&mut self, fix: &dyn Fix) -> Result<Vec<Box<dyn Op>>> {
        fix.ops(self)
    }

    /// Seals a compute and runs it once; its slot then holds the values.
    pub fn evaluate(&mut self, compute: &dyn Compute) -> Result<&perigrain_world::Slot> {
        let slot = self.world.slots.id("c_c");
        let mut op = compute.op(self, slot, Stage::Output, &When::Always)?;
        let t = self.tick();
        op.run(&mut self.world, &t)?;
        Ok(self.world.slots.get(slot))
    }

    /// Runs the ops of one stage for the present step.
    pub fn stage(&mut self, ops: &mut [Box<dyn Op>], stage: Stage) -> Result<()> {
        let t = self.tick();
        ops.iter_mut().filter(|o| o.about().stage == stage).try_for_each(|o| o.run(&mut self.world, &t))
    }

    /// The tick of the present step.
    pub fn tick(&self) -> Tick {
        let clock = &self.world.clock;
        Tick {
            first: clock.first,
            last: clock.last,
            unchanged: false,
            energy: true,
            virial: true,
            atom_energy: true,
            contacts: true,
            atom_virial: true,
            ..Tick::between_runs(clock)
        }
    }

    /// The slot of a name.
    pub fn slot_of(&self, name: &str) -> &perigrain_world::Slot {
        self.world.slots.get(self.world.slots.find(name).expect("a slot that a test has made"))
    }
}

fn span() -> Span {
    Span::new(FileId::default(), 0, 0)
}

/// A line's words, each at its place.
pub fn command(words: &str) -> Command {
    let mut at = 0;
    let mut args = vec![];
    for w in words.split(' ').filter(|w| !w.is_empty()) {
        let start = at + words[at..].find(w).expect("a word of the line");
        at = start + w.len();
        args.push(Word::new(w, Span::new(FileId::default(), start, at)));
    }
    Command { name: Word::new("fix", span()), args, span: span(), text: words.to_string() }
}

impl Names for Bench {
    fn compute(&self, id: &str) -> Option<Shape> {
        self.computes.get(id).copied()
    }
    fn fix(&self, _id: &str) -> Option<Shape> {
        None
    }
    fn variable_shape(&self, name: &str) -> Option<Shape> {
        if self.atom.contains_key(name) {
            return Some(Shape { atom: Some(1), ..Shape::default() });
        }
        self.equal.contains_key(name).then_some(Shape { scalar: true, ..Shape::default() })
    }
    fn all(&self, _kind: UseKind) -> Vec<String> {
        self.equal.keys().chain(self.atom.keys()).cloned().collect()
    }
}

impl SealCx for Bench {
    fn world(&mut self) -> &mut World {
        &mut self.world
    }
    fn span(&self) -> Span {
        span()
    }
    fn pair_styles(&self) -> Vec<&'static str> {
        vec!["peri/pmb", "peri/eps"]
    }
    fn slot(&mut self, name: &str) -> SlotId {
        self.world.slots.id(name)
    }
    fn value(&mut self, r: &ValueRef, _stage: Stage, _when: &When) -> Result<Reading> {
        let slot = self.world.slots.id(&ValueRef { index: vec![], ..r.clone() }.to_string());
        if r.kind == RefKind::Variable {
            if let Some(a) = self.equal.get(&r.name) {
                return Ok(Reading::Const(*a));
            }
            if let Some(values) = self.atom.get(&r.name) {
                let s = self.world.slots.get_mut(slot);
                (s.atom, s.cols) = (values.clone(), 1);
                return Ok(Reading::Atom(slot, 0));
            }
        }
        match (self.computes.get(&r.name), r.index.first()) {
            (Some(s), k) if s.atom.is_some() => Ok(Reading::Atom(slot, k.map_or(0, |k| k - 1))),
            (Some(_), None) => Ok(Reading::Scalar(slot)),
            (Some(_), Some(k)) => Ok(Reading::Element(slot, k - 1)),
            (None, _) => fail(Code::UNKNOWN_NAME, r.span, format!("no {r}")),
        }
    }
    fn reading(&mut self, r: &ValueRef, wants: Wants, stage: Stage, when: &When) -> Result<Reading> {
        let slot = self.world.slots.id(&ValueRef { index: vec![], ..r.clone() }.to_string());
        match (wants, r.index.as_slice()) {
            (Wants::Vector, []) => Ok(Reading::Vector(slot)),
            (Wants::Vector, [k, ..]) => Ok(Reading::Column(slot, k - 1)),
            (Wants::Local, k) => Ok(Reading::Local(slot, k.first().map_or(0, |k| k - 1))),
            (Wants::Number, [i, j]) => Ok(Reading::Cell(slot, i - 1, j - 1)),
            _ => self.value(r, stage, when),
        }
    }
    fn keyword(&mut self, name: &str, span: Span, _stage: Stage, _when: &When) -> Result<Reading> {
        fail(Code::UNKNOWN_KEYWORD, span, name.to_string())
    }
    fn text(&mut self, text: &str, _span: Span, _stage: Stage, _when: &When) -> Result<Text> {
        let text = text.to_string();
        Ok(Box::new(move |_| Ok(text.clone())))
    }
    fn steps(&mut self, _r: &ValueRef) -> Result<When> {
        Ok(When::At([3, 5].into()))
    }
    fn test(
        &mut self,
        _r: &ValueRef,
        _sets: &[Option<ValueRef>; 3],
        _stage: Stage,
        _when: &When,
    ) -> Result<PlaceTest> {
        Ok(Box::new(|_, x| Ok(x[0] > 0.0)))
    }
    fn pulls(&self) -> Vec<Pull> {
        self.pulls.clone()
    }
    fn log(&self) -> Log {
        Log::silent()
    }
    fn bias(&self, _r: &ValueRef) -> Option<Box<dyn Compute>> {
        None
    }
    fn request_energy(&mut self, _when: &When) {}
    fn request_virial(&mut self, _when: &When) {}
    fn request_atom_energy(&mut self, _when: &When) {}
    fn request_atom_virial(&mut self, _when: &When) {}
    fn probes(&mut self) -> Result<Vec<Box<dyn Probe>>> {
        let probes = self.pair.as_ref().map_or(Ok(vec![]), |p| p.probes(&self.world, false));
        Ok(probes?.into_iter().map(|(_, probe)| probe).collect())
    }
    fn energy_fixes(&self) -> Vec<String> {
        self.energy_fixes.clone()
    }
    fn leave_out(&mut self, _what: &str, _why: &str) {}
}
