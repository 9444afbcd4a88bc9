//! The cost of a session's runs for its summary: where the time went, and which pictures were drawn.

use super::Session;
use perigrain_lang::Command;
use perigrain_plan::{OpClass, Stage, StepPlan};
use std::collections::BTreeSet;
use std::time::Duration;

/// A part of steps, in all runs of a session together.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The op's name.
    pub name: String,
    /// When in a step it acts.
    pub stage: Stage,
    /// What it counts as.
    pub class: OpClass,
    /// Wall time.
    pub time: Duration,
    /// Calls.
    pub calls: u64,
}

/// What runs have taken and drawn so far.
#[derive(Clone, Debug, Default)]
pub struct Spent {
    /// The parts of steps, in the order in which they first acted.
    pub parts: Vec<Part>,
    /// Names of pictures as decks have them, with `*` for the step.
    pub pictures: BTreeSet<String>,
}

impl Spent {
    /// Adds what a run has taken.
    fn add(&mut self, plan: &StepPlan) {
        for p in &plan.ops {
            let same = |part: &&mut Part| *part.name == *p.about.name && part.stage == p.about.stage;
            match self.parts.iter_mut().find(same) {
                Some(part) => {
                    part.time += p.meter.time;
                    part.calls += p.meter.calls;
                }
                None => self.parts.push(Part {
                    name: p.about.name.to_string(),
                    stage: p.about.stage,
                    class: p.about.class,
                    time: p.meter.time,
                    calls: p.meter.calls,
                }),
            }
        }
    }
}

impl Session {
    /// What all runs so far have taken and drawn.
    pub fn spent(&self) -> &Spent {
        &self.spent
    }

    /// Takes note of what a run has taken and drawn.
    pub(super) fn spend(&mut self, plan: &StepPlan) {
        self.spent.add(plan);
        for d in self.graph.dumps.iter().filter(|d| d.style == "image") {
            if !self.spent.pictures.contains(&d.file) {
                self.spent.pictures.insert(d.file.clone());
            }
        }
    }

    /// Takes note of what `write_dump GROUP image FILE` draws.
    pub(super) fn drew(&mut self, cmd: &Command) {
        if let [_, style, file, ..] = &cmd.args[..]
            && style.text == "image"
        {
            self.spent.pictures.insert(file.text.clone());
        }
    }

    /// What a column of the step table is: `compute STYLE`, `fix STYLE`, `variable`; nothing of what has a page of its own.
    pub fn column_is(&self, word: &str) -> Option<String> {
        let name = word.get(2..)?.split('[').next().unwrap_or_default();
        match word.get(..2)? {
            "c_" => self.graph.find_compute(name).map(|c| format!("compute {}", c.style)),
            "f_" => self.graph.find_fix(name).map(|f| format!("fix {}", f.style)),
            "v_" => Some("variable".into()),
            _ => None,
        }
    }
}
