//! Lines of `calibrate` acted on a bare world, with a bond style of beams and a law of contacts.

use super::Calibrate;
use perigrain_base::diag::{Diagnostics, Result, fail};
use perigrain_bonded::stiffness::{Beam, Shear, Stiffness};
use perigrain_commands::COMMANDS;
use perigrain_lang::{Args, ValueRef, Word};
use perigrain_plan::Op;
use perigrain_styles::probe::{Interaction, Probe, Request};
use perigrain_styles::pull::{Pull, Stretched};
use perigrain_styles::testing::lines::{self, command};
use perigrain_styles::{
    ActCx, BondForce, BuildCx, CommandStyle, Flow, Motion, Names, SealCx, Shape, UseKind, Values,
};
use perigrain_world::{GroupId, Key, World};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Beams: Young's modulus, ratio and radius of each type.
#[derive(Clone)]
pub struct Beams(pub BTreeMap<u16, [f64; 3]>);

impl Beams {
    pub fn standard(types: u16) -> Self {
        Self((1..=types).map(|kind| (kind, [1e9, 0.2, 0.4e-3])).collect())
    }
}

impl BondForce for Beams {
    fn name(&self) -> &'static str {
        "beams"
    }
    fn coeff(&mut self, kinds: &[u16], args: &mut Args, _cx: &BuildCx) -> Result<()> {
        let numbers = [args.number("E")?, args.number("nu")?, args.number("the radius")?];
        self.0.extend(kinds.iter().map(|kind| (*kind, numbers)));
        Ok(())
    }
    fn covers(&self, kind: u16) -> bool {
        self.0.contains_key(&kind)
    }
    fn ops(&self, _cx: &mut dyn SealCx) -> Result<Vec<Box<dyn Op>>> {
        Ok(vec![])
    }
    fn single(&self, _w: &World, _bond: &Stretched) -> Option<Pull> {
        None
    }
    fn stiffness(&self, kind: u16, length: f64, _radii: [f64; 2]) -> Option<Stiffness> {
        let [young, poisson, radius] = *self.0.get(&kind)?;
        let beam = Beam { young, poisson, radius, length }.stiffness(Shear::Paper);
        let spring = Stiffness { normal: beam.normal, ..Stiffness::default() };
        (young != 7.0).then_some(if poisson == f64::INFINITY { spring } else { beam })
    }
    fn tunable(&self) -> &'static [&'static str] {
        &["E", "nu", "radius"]
    }
    fn tuned(&self, name: &str, kind: u16, factor: f64) -> Option<(Box<dyn BondForce>, f64)> {
        let mut tuned = self.clone();
        let at = ["E", "nu", "radius"].iter().position(|n| *n == name)?;
        let value = &mut tuned.0.get_mut(&kind)?[at];
        *value *= factor;
        let value = *value;
        Some((Box::new(tuned), value))
    }
    fn written(&self, kind: u16) -> Option<String> {
        self.0.get(&kind).map(|[e, nu, r]| format!("{e:e} {nu} {r:e}"))
    }
}

/// Contacts of 1 GPa and ν = 0.2, or of a constant stiffness.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    None,
    Hertz,
    Hooke,
}

impl Probe for Law {
    fn name(&self) -> &'static str {
        "law"
    }
    fn own(&self) -> usize {
        0
    }
    fn listed(&self, _w: &World) -> Result<Vec<[u32; 2]>> {
        Ok(vec![])
    }
    fn look(&mut self, _w: &World, _request: Request, _closely: bool) -> Result<Vec<Interaction>> {
        Ok(vec![])
    }
    fn pressed(&self, _types: [u16; 2], overlap: f64, curvature: f64) -> Option<[f64; 3]> {
        let root = (curvature * overlap).sqrt();
        match self {
            Law::None => None,
            Law::Hertz => {
                let push = 4.0 / 3.0 * 5.208333333333333e8 * root * overlap;
                Some([push, 8.0 * 1.1574074074074074e8 * root, 0.4 * push * overlap])
            }
            Law::Hooke => Some([1e6 * overlap, 0.0, 0.5e6 * overlap * overlap]),
        }
    }
}

struct Declared(Option<Beams>, Law);

impl Names for Declared {
    fn compute(&self, id: &str) -> Option<Shape> {
        (id == "taken").then(Shape::default)
    }
    fn compute_style(&self, id: &str) -> Option<&'static str> {
        (id == "taken").then_some("ke")
    }
    fn fix(&self, _id: &str) -> Option<Shape> {
        None
    }
    fn variable_shape(&self, _name: &str) -> Option<Shape> {
        None
    }
    fn all(&self, _kind: UseKind) -> Vec<String> {
        vec![]
    }
}

impl Values for Declared {
    fn with_internal(&mut self, w: &mut World, r: &ValueRef, _set: &[(&ValueRef, f64)]) -> Result<f64> {
        self.scalar(w, r)
    }
    fn scalar(&mut self, _w: &mut World, r: &ValueRef) -> Result<f64> {
        fail(perigrain_base::diag::Code::WRONG_KIND, r.span, "no number")
    }
    fn per_atom(&mut self, _w: &mut World, _r: &ValueRef) -> Result<Vec<f64>> {
        Ok(vec![])
    }
    fn flow(&mut self, _w: &mut World, _compute: &ValueRef) -> Result<Flow> {
        Ok(Flow { taken: vec![], group: GroupId::ALL, whole: [false; 3], apart: vec![] })
    }
    fn stop(&mut self, _w: &mut World, _fix: &Word, _what: Motion) -> Result<()> {
        Ok(())
    }
    fn probes(&self, _w: &World) -> Result<Vec<Box<dyn Probe>>> {
        Ok(vec![Box::new(self.1)])
    }
    fn bonds(&self) -> Option<Box<dyn BondForce>> {
        self.0.clone().map(|b| Box::new(b) as Box<dyn BondForce>)
    }
}

/// The world after these lines, each of which must work.
pub fn scene(text: &str) -> World {
    lines::scene(COMMANDS, text)
}

/// The results of a line: its numbers, its log lines, the lines it left for later, its warnings.
#[derive(Debug)]
pub struct Did {
    pub numbers: Vec<f64>,
    pub lines: Vec<String>,
    pub then: Vec<String>,
    pub notes: Vec<String>,
}

pub fn act(w: &mut World, line: &str, beams: Beams) -> Result<Did> {
    act_with(w, line, beams, Law::None)
}

pub fn act_with(w: &mut World, line: &str, beams: Beams, law: Law) -> Result<Did> {
    let line = command(line);
    let (notes, uses) = (RefCell::new(Diagnostics::default()), RefCell::default());
    let mut declared = Declared(Some(beams), law);
    let mut args = Args::new(&line);
    let cx = BuildCx {
        world: w,
        names: &declared,
        id: "",
        group: GroupId::ALL,
        span: line.span,
        checking: false,
        notes: &notes,
        uses: &uses,
    };
    let act = Calibrate.parse(&mut args, &cx)?;
    args.finish()?;
    let (id, _) = act.leaves().unwrap();
    let (mut lines, mut then) = (vec![], vec![]);
    act.apply(&mut ActCx {
        world: w,
        values: &mut declared,
        span: line.span,
        lines: &mut lines,
        then: &mut then,
        notes: &notes,
    })?;
    Ok(Did {
        numbers: w.memo.get(Key::new(&format!("calibrate {id}"))).unwrap().clone(),
        lines,
        then: then.into_iter().map(|(line, _)| line.text).collect(),
        notes: notes.into_inner().0.into_iter().map(|n| n.message).collect(),
    })
}
