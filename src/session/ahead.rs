//! How many steps a deck will make in all, as far as reading it tells.

use super::{Options, Session, whole};
use perigrain_lang::{Command, Script};
use perigrain_out::log::Log;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a check has seen of runs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Foreseen {
    steps: i64,
    /// Only a run can tell how many there are.
    unsure: bool,
}

impl Session {
    /// Takes note of a `run` line of a deck that is only read.
    pub(super) fn foresee(&mut self, cmd: &Command, steps: i64) {
        let upto = cmd.args.iter().any(|w| w.text == "upto") && self.world.parts.unseen.step;
        let open = upto || cmd.args.iter().any(|w| w.unknown);
        self.foreseen.steps = self.foreseen.steps.saturating_add(steps);
        self.foreseen.unsure |= open;
    }

    /// Takes note that the line at hand, or how often it comes, hangs on a run.
    pub(super) fn doubt(&mut self, script: &Script) {
        self.foreseen.unsure |= script.is_speculative() || script.is_cut_short();
    }
}

/// The steps of all runs of a deck; nothing where only a run can tell, where the deck is refused, or when `stop` is set.
pub fn steps_ahead(options: &Options, name: &str, text: &str, stop: &Arc<AtomicBool>) -> Option<i64> {
    let options = Options { log: Log::silent(), limit: None, ..options.clone() };
    let mut session = whole::begin(&options, stop).ok()?;
    session.run_text(name, text).ok()?;
    let Foreseen { steps, unsure } = session.foreseen;
    (!unsure && session.has_seen_all() && !stop.load(Ordering::Relaxed)).then_some(steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(lines: &str) -> Option<i64> {
        let scene = "units lj\nregion b block 0 3 0 3 0 3\ncreate_box 1 b\ncreate_atoms 1 single 1 1 1\nmass 1 1\nfix 1 all nve\n";
        steps_ahead(&Options::default(), "in.deck", &(scene.to_owned() + lines), &Arc::default())
    }

    #[test]
    fn loops_are_added_up_and_what_hangs_on_a_run_is_unknown() {
        let turns = "variable k loop 4\nlabel a\nrun 100\nnext k\njump SELF a\nrun 300 every 50 NULL\n";
        assert_eq!(steps(turns), Some(700));
        // A run before may end earlier.
        assert_eq!(steps("run 100\nrun 300 upto\n"), None);
        let until = "label a\nrun 100\nif \"$(ke) > 1\" then \"jump SELF a\"\n";
        assert_eq!(steps(until), None);
        assert_eq!(steps("variable n equal ke\nrun $(v_n)\n"), None);
        assert_eq!(steps("run 100\nif \"$(ke) > 1\" then \"run 50\"\n"), None);
        assert_eq!(steps("run 100\nno_such_command\n"), None);
    }
}
