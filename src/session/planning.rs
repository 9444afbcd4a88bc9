//! `perigrain plan`: the plans of a deck's runs, each once; and what a deck that is only looked at cannot know.

use super::causes::Refused;
use super::running::Pass;
use super::{Mode, Session};
use crate::graph::FixNode;
use perigrain_base::diag::{Code, Diagnostics, Result, Sources, Span};
use perigrain_lang::{Command, Line, Script};
use perigrain_plan::explain;
use std::fmt::Write;

/// A plan and the lines whose runs have it, each with how often.
struct Planned {
    text: String,
    runs: Vec<(Span, u64)>,
}

/// All plans of a deck, and the lines whose effect only a run determines.
#[derive(Default)]
pub(super) struct Plans {
    list: Vec<Planned>,
    open: Vec<(Span, String)>,
}

impl Plans {
    /// Takes note of one more run of the line at `span`.
    pub fn add(&mut self, text: String, span: Span) {
        let known = self.list.iter().position(|p| p.text == text);
        let at = known.unwrap_or_else(|| {
            self.list.push(Planned { text, runs: vec![] });
            self.list.len() - 1
        });
        let runs = &mut self.list[at].runs;
        match runs.iter_mut().find(|(s, _)| *s == span) {
            Some((_, times)) => *times += 1,
            None => runs.push((span, 1)),
        }
    }

    /// Notes a line whose effect only a run determines; the first reason for it counts.
    pub fn leave_open(&mut self, span: Span, why: impl Into<String>) {
        if self.open.iter().all(|(s, _)| *s != span) {
            self.open.push((span, why.into()));
        }
    }

    /// The plans in the order of their first runs, then what was left open.
    pub fn text(&self, sources: &Sources) -> String {
        let line = |span: Span| {
            let name = sources.get(span.file).map_or("", |s| s.name.as_str());
            format!("{name}:{}", sources.place(span).0)
        };
        let mut out = String::new();
        for p in &self.list {
            let all: u64 = p.runs.iter().map(|(_, times)| times).sum();
            let each = |&(span, times): &(Span, u64)| match p.runs.len() > 1 && times > 1 {
                true => format!("{} ({times} times)", line(span)),
                false => line(span),
            };
            let places: Vec<String> = p.runs.iter().map(each).collect();
            let often = if all == 1 { "once".into() } else { format!("{all} times") };
            let _ = writeln!(out, "run at {}, used {often}\n{}", places.join(", "), p.text);
        }
        if self.list.is_empty() {
            out += "no run, no plan\n\n";
        }
        if !self.open.is_empty() {
            out += "what only a run determines\n";
        }
        let mut open: Vec<String> =
            self.open.iter().map(|(span, why)| format!("  {:<34} {why}\n", line(*span))).collect();
        // Commands of one line with the same remark.
        open.dedup();
        out += &open.concat();
        out.trim_end().to_owned()
    }
}

/// Whether a mistake of this kind may lie in values or in the scene rather than in the words of a line.
fn is_of_values(code: Code) -> bool {
    [
        Code::BAD_VALUE,
        Code::WRONG_ORDER,
        Code::WRONG_KIND,
        Code::INCOMPLETE,
        Code::CONFLICT,
        Code::SUSPICIOUS,
        Code::LOST,
        Code::NOT_FINITE,
        Code::TOO_LARGE,
        Code::HALTED,
    ]
    .contains(&code)
}

/// Whether a line holds a value that only a run determines, for which a placeholder stands.
pub(super) fn depends_on_a_run(cmd: &Command) -> bool {
    cmd.args.iter().chain([&cmd.name]).any(|w| w.unknown)
}

impl Session {
    pub(super) fn planning(&self) -> bool {
        self.options.mode == Mode::Plan
    }

    /// Whether the scene is only checked and only a run determines the present state of particles.
    pub(super) fn unsure(&self) -> bool {
        self.world.unseen.particles
    }

    /// Notes what is no longer known after a run that was not made. `ends` is whether its last step is known.
    pub(super) fn unsee(&mut self, ends: bool) {
        let w = &self.world;
        let facts = |f: &FixNode| f.fix.facts(w);
        let fixes = &self.graph.fixes;
        let deforms = fixes.iter().any(|f| facts(f).deforms != [false; 6]);
        let halts = fixes.iter().any(|f| f.style == "halt") || w.settings.deadline.is_some();
        let hurries = fixes.iter().any(|f| f.style.starts_with("dt/"));
        let u = &mut self.world.unseen;
        u.particles = true;
        u.space |= deforms;
        u.step |= halts || !ends;
        u.time |= u.step || hurries;
        self.vars.forget_internal();
    }

    /// Takes note of the plan of a run.
    ///
    /// # Errors
    /// What styles miss in a scene of which everything is known.
    pub(super) fn plan_of(&mut self, span: Span, pass: Pass) -> Result<()> {
        match self.sealed(span, pass) {
            Ok((plan, _)) => self.plans.add(explain::text(&plan, false), span),
            Err(e) if self.unsure() => {
                let why = e.0.first().map_or("", |d| d.message.as_str());
                self.plans.leave_open(span, format!("no plan: {why}"));
            }
            Err(e) => return Err(e),
        }
        Ok(())
    }

    /// A refused line of which only a run determines whether it is wrong: it has no effect, and the deck continues.
    pub(super) fn forgives(&self, script: &Script, line: Option<&Line>, e: &Diagnostics) -> bool {
        if !self.looking() || !e.has_errors() {
            return false;
        }
        if self.planning() && script.is_speculative() {
            return true;
        }
        let cmd = line.and_then(|l| l.command.as_deref());
        let words = || cmd.into_iter().flat_map(|c| c.args.iter().chain([&c.name]));
        let stands_in = cmd.is_some_and(depends_on_a_run);
        let later = self.planning() && words().any(|w| self.world.promised.get(&w.text).is_some());
        e.0.iter().all(|d| {
            let at_stand_in = words().any(|w| w.unknown && Some(w.span) == d.span);
            let of_values = is_of_values(d.code) && (stands_in || (self.planning() && self.unsure()));
            of_values || at_stand_in || (later && matches!(d.code, Code::NO_FILE | Code::BAD_FILE))
        })
    }

    /// Reads on behind a line that was forgiven.
    pub(super) fn read_on(&mut self, line: Option<&Line>, raw: &str, e: Diagnostics, refused: &mut Refused) {
        let cmd = line.and_then(|l| l.command.as_deref());
        let span = cmd.map(|c| c.span).or_else(|| e.0.first().and_then(|d| d.span));
        let why = e.0.first().map_or("", |d| d.message.as_str());
        self.plans.leave_open(span.unwrap_or_default(), format!("left out: {why}"));
        refused.causes(raw, e);
        match cmd.map(|c| c.name.text.as_str()) {
            Some("run" | "minimize" | "statics" | "fatigue" | "rerun") => self.unsee(false),
            Some(name) if self.planning() && self.graph.tables.command(name).is_some() => {
                let unseen = &mut self.world.unseen;
                (unseen.particles, unseen.vague) = (true, true);
            }
            _ => {}
        }
    }

    /// Notes a line of a plan whose effect only a run determines.
    pub(super) fn note_open(&mut self, script: &Script, cmd: &Command) {
        if !self.planning() || ["print", "label", "log", "echo", "info"].contains(&cmd.name.text.as_str()) {
            return;
        }
        if script.is_speculative() {
            self.plans.leave_open(cmd.span, "stands behind a condition, which is taken to hold");
        } else if depends_on_a_run(cmd) {
            let words: Vec<&str> = cmd.text.split_whitespace().collect();
            self.plans.leave_open(cmd.span, format!("values not known are read as 1: {}", words.join(" ")));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_plans_are_printed_once_with_their_runs() {
        let mut sources = Sources::default();
        let file = sources.add("in.d", "run 1\nrun 2\nrun 3\n");
        let at = |k: usize| Span::new(file, 6 * k, 6 * k + 5);
        let mut plans = Plans::default();
        for k in [0, 1, 1, 2] {
            plans.add(if k == 2 { "b\n".into() } else { "a\n".into() }, at(k));
        }
        plans.leave_open(at(2), "why");
        plans.leave_open(at(2), "why else");
        plans.leave_open(Span::new(file, 13, 14), "why");
        let wanted = "run at in.d:1, in.d:2 (2 times), used 3 times\na\n\nrun at in.d:3, used once\nb\n\n\
                      what only a run determines\n  in.d:3                             why";
        assert_eq!(plans.text(&sources), wanted);
    }
}
