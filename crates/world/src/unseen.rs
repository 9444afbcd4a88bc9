//! The parts of a scene that are unknown while a deck is only checked, because only a run determines them.

/// Parts of the scene that a check or a plan does not know. A run sees everything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unseen {
    /// What particles do, how many there are, and what is computed from them.
    pub particles: bool,
    /// The present step: a run may have ended early.
    pub step: bool,
    /// The time and the length of a step.
    pub time: bool,
    /// The length of a step that the deck has computed from what a run determines.
    pub length: bool,
    /// Place and lengths of the box.
    pub space: bool,
    /// The particles are not even those with which a run would begin: a line that makes or changes them depends on a value that
    /// only a run determines.
    pub vague: bool,
}

impl Unseen {
    /// What a check sees: the box that the deck gives, and nothing that happens in it.
    pub fn in_a_check() -> Self {
        Self { particles: true, step: true, time: true, ..Self::default() }
    }
}
