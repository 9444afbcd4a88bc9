//! The number of steps a deck will make in all, as far as it can be found by reading the deck.

use super::{Options, Session, whole};
use crate::graph::env::DeckEnv;
use perigrain_base::diag::Span;
use perigrain_lang::{Command, Script, substitute_known};
use perigrain_output::log::Log;
use perigrain_styles::{Use, UseKind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The steps of all runs of a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ahead {
    /// How many.
    pub steps: i64,
    /// A run may end the deck earlier.
    pub at_most: bool,
}

/// What a check has seen of runs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Foreseen {
    steps: i64,
    /// Those of the run seen last.
    last: i64,
    /// Only a run determines how many there are.
    unsure: bool,
    /// They may be fewer.
    at_most: bool,
    /// The step up to which the loop goes back whose `if` line has been read, and whether there was such a loop.
    until: Option<i64>,
    looped: bool,
}

impl Session {
    /// Takes note of a `run` line of a deck that is only read.
    pub(super) fn foresee(&mut self, cmd: &Command, steps: i64) {
        let upto = cmd.args.iter().any(|w| w.text == "upto") && self.world.unseen.step;
        let open = upto || cmd.args.iter().any(|w| w.unknown);
        let halts = self.graph.fixes.iter().any(|f| f.style == "halt");
        let seen = &mut self.foreseen;
        seen.steps = seen.steps.saturating_add(steps);
        seen.last = steps;
        seen.unsure |= open;
        seen.at_most |= halts;
    }

    /// Notes that the present line, or the number of its repetitions, depends on a run.
    pub(super) fn doubt(&mut self, script: &Script) {
        let seen = &mut self.foreseen;
        seen.unsure |= script.is_speculative() || (script.is_cut_short() && !seen.looped);
    }

    /// Takes note of a line that may close a loop: `if "$t < ${tend} && …" then "jump SELF label"` lets it end at a known time.
    pub(super) fn foresee_loop(&mut self, raw: &str) {
        self.foreseen.until = self.bound(raw);
    }

    /// Notes a jump of which only a run determines whether it is made.
    pub(super) fn foresee_jump(&mut self) {
        let seen = &mut self.foreseen;
        let Some(until) = seen.until.take().filter(|_| seen.last > 0) else {
            seen.unsure = true;
            return;
        };
        let missing = (until - seen.steps).max(0) as u64;
        let turns = missing.div_ceil(seen.last as u64) as i64;
        seen.steps = seen.steps.saturating_add(turns.saturating_mul(seen.last));
        (seen.at_most, seen.looped) = (true, true);
    }

    /// The step from which the condition of an `if` line does not hold, if it reads the clock.
    fn bound(&mut self, raw: &str) -> Option<i64> {
        let condition = raw.split(['"', '\'']).nth(1)?;
        // In parentheses anything may stand.
        let mut depth = 0;
        let outside = condition.chars().filter(|c| {
            depth += i32::from(*c == '(') - i32::from(*c == ')');
            depth == 0
        });
        if outside.collect::<String>().contains("||") {
            return None;
        }
        condition.split("&&").find_map(|part| self.bound_of(part))
    }

    fn bound_of(&mut self, part: &str) -> Option<i64> {
        let (left, right) = part.split_once('<')?;
        let right = right.trim_start_matches('=').trim();
        let clock = match left.trim().strip_prefix('$')?.trim_matches(['(', ')', '{', '}']) {
            own @ ("time" | "step") => own.to_string(),
            name => {
                let name = name.strip_prefix("v_").unwrap_or(name).to_string();
                let line = self.graph.lines.provider(&Use { kind: UseKind::Variable, name })?;
                let words: Vec<&str> = line.text.split_whitespace().collect();
                let [_, _, "equal", formula] = words[..] else { return None };
                formula.to_string()
            }
        };
        let mut env = DeckEnv { w: &mut self.world, graph: &self.graph };
        let text =
            substitute_known(right, Span::default(), &self.vars, &mut env).ok().filter(|s| !s.unknown)?;
        let end: f64 = text.text.trim().parse().ok()?;
        let follows = self.graph.fixes.iter().any(|f| f.style.starts_with("dt/"));
        let steps = match clock.as_str() {
            "step" => end,
            "time" if !follows && self.world.clock.dt > 0.0 => end / self.world.clock.dt,
            _ => return None,
        };
        (0.0..1e15).contains(&steps).then(|| (steps - 1e-6).ceil() as i64)
    }
}

/// The steps of all runs of a deck; `None` where only a run determines them, where the deck is refused, or when `stop` is set.
pub fn steps_ahead(options: &Options, name: &str, text: &str, stop: &Arc<AtomicBool>) -> Option<Ahead> {
    let options = Options { log: Log::silent(), limit: None, ..options.clone() };
    let mut session = whole::begin(&options, stop).ok()?;
    session.run_text(name, text).ok()?;
    let Foreseen { steps, unsure, at_most, .. } = session.foreseen;
    (!unsure && session.has_seen_all() && !stop.load(Ordering::Relaxed)).then_some(Ahead { steps, at_most })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(lines: &str) -> Option<(i64, bool)> {
        let scene = "units lj\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\nmass 1 1\nfix 1 all nve\n";
        let ahead = steps_ahead(&Options::default(), "in.deck", &(scene.to_owned() + lines), &Arc::default());
        ahead.map(|a| (a.steps, a.at_most))
    }

    #[test]
    fn loops_are_added_up_and_what_depends_on_a_run_is_unknown() {
        let turns = "variable k loop 4\nlabel a\nrun 100\nnext k\njump SELF a\nrun 300 every 50 NULL\n";
        assert_eq!(steps(turns), Some((700, false)));
        // A run before may end earlier.
        assert_eq!(steps("run 100\nrun 300 upto\n"), None);
        let until = "label a\nrun 100\nif \"$(ke) > 1\" then \"jump SELF a\"\n";
        assert_eq!(steps(until), None);
        assert_eq!(steps("variable n equal ke\nrun $(v_n)\n"), None);
        assert_eq!(steps("run 100\nif \"$(ke) > 1\" then \"run 50\"\n"), None);
        assert_eq!(steps("run 100\nno_such_command\n"), None);
    }

    #[test]
    fn loops_that_read_the_clock_have_an_end() {
        let turns = |condition: &str| {
            format!(
                "timestep 0.01\nvariable t equal time\nvariable tend index 2.5\nrun 20\nlabel a\nrun 100\n\
                 if \"{condition}\" then \"jump SELF a\"\nrun 7\n"
            )
        };
        // 120 steps are made when the condition is evaluated first, and 320 when it no longer holds.
        assert_eq!(steps(&turns("$t < ${tend}")), Some((327, true)));
        assert_eq!(steps(&turns("$(step) <= 250 && ($(ke) > 1 || $(pe) > 1)")), Some((327, true)));
        assert_eq!(steps(&turns("$t < ${tend} || $(ke) > 1")), None);
        assert_eq!(steps(&turns("$(ke) < ${tend}")), None);
        let twice = turns("$t < ${tend}") + "label b\nrun 10\nif \"$(ke) > 1\" then \"jump SELF b\"\n";
        assert_eq!(steps(&twice), None);
    }
}
