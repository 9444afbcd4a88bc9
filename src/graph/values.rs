//! The ops that put values of computes, thermo keywords and variables into slots.

use super::answers::Declared;
use super::keywords::{self, Sources};
use super::measure;
use super::step_env::RunEnv;
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_lang::{Value, Vars};
use perigrain_plan::{About, Needs, Op, OpClass, Span as Rows, Stage, Tick};
use perigrain_styles::FORMULAS;
use perigrain_styles::act::no_number;
use perigrain_world::field::{BONDS, BOX, F, LISTS, MASS, MEMO, OMEGA, SLOTS, TALLY, TORQUE, V, X};
use perigrain_world::{Fields, SlotId, World};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A compute's op, at the stage of its reader, at most once per step (of the shortest ones).
pub(super) struct Once {
    /// The op.
    pub(super) op: Box<dyn Op>,
    /// The stage of its reader.
    pub(super) stage: Stage,
    /// Where the value goes.
    pub(super) slot: SlotId,
}

impl Op for Once {
    fn about(&self) -> About {
        let about = self.op.about();
        About { in_setup: true, class: OpClass::Output, ..About::new(about.name, self.stage, about.needs) }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        // Within a step of several levels everything moves on.
        if w.slots.get(self.slot).step == Some(t.step) && !t.phase.nested() {
            return Ok(());
        }
        self.op.run(w, t)
    }
}

/// A thermo keyword on its way into a slot.
pub(super) struct Keyword {
    /// The keyword.
    pub(super) name: &'static str,
    /// What it reads.
    pub(super) sources: Sources,
    /// Where the value goes.
    pub(super) slot: SlotId,
    /// The stage of its reader.
    pub(super) stage: Stage,
}

impl Op for Keyword {
    fn about(&self) -> About {
        let forces = if self.name.starts_with('f') { F } else { Fields::NONE };
        let needs =
            Needs::new().read(BONDS | BOX | LISTS | MASS | MEMO | TALLY | SLOTS | forces).write(SLOTS);
        About { in_setup: true, class: OpClass::Output, ..About::new(self.name, self.stage, needs) }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let value = keywords::value(self.name, w, &self.sources);
        let slot = w.slots.get_mut(self.slot);
        slot.scalar = value;
        slot.step = Some(t.step);
        Ok(())
    }
}

/// A variable on its way into a slot.
pub(super) struct Evaluate {
    /// Declarations as formulas see them.
    pub(super) declared: Arc<Declared>,
    /// For plan and timing.
    pub(super) name: String,
    /// The variable.
    pub(super) variable: String,
    /// Where it is used.
    pub(super) span: Span,
    /// All variables.
    pub(super) vars: Arc<Vars>,
    /// Where the values that its formula names are.
    pub(super) from: BTreeMap<String, SlotId>,
    /// Where the value goes.
    pub(super) slot: SlotId,
    /// The stage of its reader.
    pub(super) stage: Stage,
    /// What its formula reads of the scene.
    pub(super) reads: Fields,
    /// The bits of the only groups whose particles it reads, if it names no others.
    pub(super) groups: Option<u32>,
    /// Whether all ranks move all of these alike, as long as particles are what they are.
    pub(super) common: Option<([u64; 2], bool)>,
    /// The bit of the group that the reading fix acts on; 0 where no fix reads it.
    pub(super) group: u32,
}

/// Words for forces and torques, and for all else that particles have which moves with them.
const FORCES: [&str; 8] = ["fx", "fy", "fz", "fcm", "torque", "tqx", "tqy", "tqz"];
const ATTRIBUTES: [&str; 17] = [
    "x", "y", "z", "vx", "vy", "vz", "fx", "fy", "fz", "omegax", "omegay", "omegaz", "tqx", "tqy", "tqz",
    "rmask", "grmask",
];
const MOTION: [&str; 24] = [
    "x", "y", "z", "vx", "vy", "vz", "omegax", "omegay", "omegaz", "count", "mass", "charge", "gyration",
    "ke", "xcm", "vcm", "fcm", "bound", "angmom", "torque", "omega", "inertia", "rmask", "grmask",
];

/// Whether a variable's formula, or that of one it names, has one of these words in it.
fn names(vars: &Vars, name: &str, words: &[&str]) -> bool {
    fn looks(vars: &Vars, name: &str, words: &[&str], seen: &mut Vec<String>) -> bool {
        if seen.iter().any(|s| s == name) {
            return false;
        }
        seen.push(name.to_string());
        let text = vars.definition(name).unwrap_or_default();
        let mut found = text.split(|c: char| !c.is_alphanumeric() && c != '_');
        found.any(|word| {
            words.contains(&word)
                || word.strip_prefix("v_").is_some_and(|other| looks(vars, other, words, seen))
        })
    }
    looks(vars, name, words, &mut vec![])
}

/// The groups that a variable's formula, and those that it names, pass to group functions, if they read no other particles.
pub(super) fn groups_alone(vars: &Vars, name: &str) -> Option<Vec<String>> {
    fn look(vars: &Vars, name: &str, seen: &mut Vec<String>, groups: &mut Vec<String>) -> bool {
        if seen.iter().any(|s| s == name) {
            return true;
        }
        seen.push(name.to_string());
        let text = vars.definition(name).unwrap_or_default();
        let mut rest = &text[..];
        while let Some(start) = rest.find(|c: char| c.is_alphanumeric() || c == '_') {
            rest = &rest[start..];
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            let (word, after) = rest.split_at(end);
            rest = after;
            if let Some(inside) =
                after.trim_start().strip_prefix('(').filter(|_| measure::NAMES.contains(&word))
            {
                let Some((args, after)) = inside.split_once(')') else { return false };
                groups.push(args.split(',').next().unwrap_or_default().trim().to_string());
                rest = after;
                continue;
            }
            let other = word.strip_prefix("v_").is_none_or(|other| look(vars, other, seen, groups));
            if !other || ATTRIBUTES.contains(&word) {
                return false;
            }
        }
        true
    }
    let mut groups = vec![];
    look(vars, name, &mut vec![], &mut groups).then_some(groups)
}

/// What a variable's formula reads of the scene.
pub(super) fn reads(vars: &Vars, name: &str) -> Fields {
    let moves = X | V | OMEGA;
    let motion = if names(vars, name, &MOTION) { FORMULAS } else { FORMULAS.without(moves) };
    motion | if names(vars, name, &FORCES) { F | TORQUE } else { Fields::NONE }
}

impl Evaluate {
    /// Refuses values that would put something other than numbers into the scene: formulas need not hold for particles that the
    /// reading fix does not act on.
    fn must_be_numbers(&self, w: &World, value: &Value) -> Result<()> {
        let bad = match value {
            Value::Number(a) if a.is_nan() => (*a, None),
            Value::Atom(list) => {
                let acted_on = w.particles.mask.iter().map(|mask| mask & self.group != 0);
                match list.iter().zip(acted_on).position(|(a, acted_on)| acted_on && !a.is_finite()) {
                    Some(i) => (list[i], w.particles.tag.get(i).copied()),
                    None => return Ok(()),
                }
            }
            _ => return Ok(()),
        };
        Err(no_number(format_args!("v_{}", self.variable), bad.0, bad.1, self.span).into())
    }
}

impl Op for Evaluate {
    fn about(&self) -> About {
        About {
            in_setup: true,
            class: OpClass::Output,
            ..About::new(&self.name, self.stage, Needs::new().read(self.reads).write(SLOTS))
        }
    }
    fn span(&mut self, w: &mut World, _: &Tick) -> Rows {
        let Some(bits) = self.groups else { return Rows::All };
        let rebuild = w.rebuild.past();
        let now = [rebuild.roster, rebuild.places];
        let (then, common) = *self.common.get_or_insert_with(|| (now, w.is_common(bits)));
        if common && then == now { Rows::Requested } else { Rows::All }
    }
    fn run(&mut self, w: &mut World, t: &Tick) -> Result<()> {
        let mut env = RunEnv::new(w, &self.declared, &self.from);
        let value = self.vars.value(&self.variable, self.span, &mut env)?;
        // What is only shown may be anything; what moves particles must be numbers.
        if !matches!(self.stage, Stage::EndOfStep | Stage::Output) {
            self.must_be_numbers(w, &value)?;
        }
        let slot = w.slots.get_mut(self.slot);
        slot.step = Some(t.step);
        match value {
            Value::Number(a) => slot.scalar = a,
            Value::Atom(list) => (slot.atom, slot.cols) = (list, 1),
            Value::Vector(list) => slot.vector = list,
            Value::Unknown => {
                return fail(
                    Code::WRONG_KIND,
                    self.span,
                    format!("variable `{}` has no number here", self.variable),
                );
            }
        }
        Ok(())
    }
}
