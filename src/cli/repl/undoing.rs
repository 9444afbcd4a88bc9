//! Snapshots of the session before each line that counts, within a stated limit of memory.

use crate::session::{Session, Snapshot};
use perigrain_output::rows::Mark;
use std::collections::VecDeque;

/// Bytes that snapshots may take together.
pub const LIMIT: u64 = 1 << 30;

/// The state before a line, and that line.
struct Before {
    state: Snapshot,
    mark: Mark,
    line: String,
}

/// What can be taken back, oldest first.
pub struct Undo {
    limit: u64,
    steps: VecDeque<Before>,
}

impl Undo {
    /// Nothing to take back yet.
    pub fn new(limit: u64) -> Self {
        Self { limit, steps: VecDeque::new() }
    }

    /// The state before a line that is about to be executed; `None` where the scene is larger than the limit.
    pub fn look(&self, session: &Session) -> Option<Snapshot> {
        (session.bytes() <= self.limit).then(|| session.snapshot(self.steps.back().map(|b| &b.state)))
    }

    /// A line counts now. Returns how many of the oldest lines can no longer be taken back for want of memory.
    pub fn push(&mut self, line: &str, state: Snapshot, mark: Mark) -> usize {
        self.steps.push_back(Before { state, mark, line: line.to_string() });
        let mut dropped = 0;
        while self.steps.len() > 1 && self.bytes() > self.limit {
            self.drop_oldest();
            dropped += 1;
        }
        dropped
    }

    /// A line counts whose state before could not be kept: nothing before it can be taken back either.
    pub fn forget(&mut self) {
        self.steps.clear();
    }

    /// Goes back by up to `n` lines; the lines taken back, latest first, and where tables ended before them.
    pub fn back(&mut self, n: usize, session: &mut Session) -> Option<(Vec<String>, Mark)> {
        let keep = self.steps.len().saturating_sub(n);
        let gone = self.steps.split_off(keep);
        let first = gone.front()?;
        session.restore(&first.state);
        let mark = first.mark;
        Some((gone.into_iter().rev().map(|b| b.line).collect(), mark))
    }

    fn bytes(&self) -> u64 {
        self.steps.iter().map(|b| b.state.bytes).sum()
    }

    /// The world of the oldest snapshot may be lent to later ones, whose own bytes then count.
    fn drop_oldest(&mut self) {
        let Some(oldest) = self.steps.pop_front() else { return };
        if let Some(next) = self.steps.front_mut()
            && next.state.bytes == 0
        {
            next.state.bytes = oldest.state.bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Options;

    const SCENE: &str = "units si\natom_style sphere\nregion b block 0 9 0 9 0 9 units box\ncreate_box 1 b\n";

    fn feed(session: &mut Session, undo: &mut Undo, line: &str) -> usize {
        let before = undo.look(session).unwrap();
        session.eval("line", line).unwrap();
        undo.push(line, before, Mark::default())
    }

    #[test]
    fn lines_are_taken_back_one_by_one() {
        let mut session = Session::new(Options::default()).unwrap();
        let mut undo = Undo::new(LIMIT);
        session.eval("scene", SCENE).unwrap();
        feed(&mut session, &mut undo, "create_atoms 1 single 1 1 1");
        feed(&mut session, &mut undo, "variable a equal 1");
        feed(&mut session, &mut undo, "variable a equal 2");
        assert_eq!(session.world.n(), 1);
        assert_eq!(undo.back(1, &mut session).unwrap().0, ["variable a equal 2"]);
        session.eval("line", "if \"$a != 1\" then \"no_such_command\"").unwrap();
        assert_eq!(undo.back(9, &mut session).unwrap().0.len(), 2);
        assert_eq!((session.world.n(), session.known().variables.len()), (0, 0));
        assert!(undo.back(1, &mut session).is_none());
    }

    #[test]
    fn random_numbers_come_again() {
        let screen = perigrain_output::log::Buffer::default();
        let log = perigrain_output::log::Log::new(Some(Box::new(screen.clone())));
        let mut session = Session::new(Options { log, ..Options::default() }).unwrap();
        let mut undo = Undo::new(LIMIT);
        let draw = "print $(random(0,1,4711))";
        session.eval("line", draw).unwrap();
        feed(&mut session, &mut undo, draw);
        undo.back(1, &mut session).unwrap();
        session.eval("line", draw).unwrap();
        let text = screen.text();
        let drawn: Vec<&str> = text.lines().collect();
        assert!(drawn[0] != drawn[1] && drawn[1] == drawn[2], "{drawn:?}");
    }

    #[test]
    fn the_oldest_go_when_memory_is_short() {
        let mut session = Session::new(Options::default()).unwrap();
        session.eval("scene", SCENE).unwrap();
        session.eval("line", "create_atoms 1 random 100 1 NULL").unwrap();
        let one = session.bytes();
        let mut undo = Undo::new(2 * one + one / 2);
        for k in 0..2 {
            let dropped = feed(&mut session, &mut undo, "displace_atoms all move 0.1 0 0 units box");
            assert_eq!(dropped, 0, "{k}");
        }
        assert_eq!(feed(&mut session, &mut undo, "displace_atoms all move 0.1 0 0 units box"), 1);
        assert!(Undo::new(one / 2).look(&session).is_none());
    }
}
