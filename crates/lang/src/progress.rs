//! Loops that can never end: a jump that is made again and again while nothing changes.

use perigrain_base::diag::FileId;
use std::collections::BTreeMap;

/// The record of one jump.
#[derive(Clone, Copy, Debug, Default)]
struct Turns {
    count: u64,
    /// The state at the last turn whose number is a power of two.
    kept: Option<u64>,
}

/// The states in which jumps have been made.
///
/// Whatever the length of a circle of states, it is found by comparing each state with that of the last turn whose
/// number is a power of two (Brent's method): no list of states is kept.
#[derive(Clone, Debug, Default)]
pub(super) struct Progress {
    turns: BTreeMap<(FileId, u32), Turns>,
    outside: u64,
}

impl Progress {
    /// Something outside the variables has changed, so that no state comes back.
    pub fn outside(&mut self) {
        self.outside += 1;
    }

    /// One more jump from `place` in `state`; its number, `None` if this state has been there before.
    pub fn turn(&mut self, place: (FileId, u32), state: u64) -> Option<u64> {
        let state = state ^ self.outside.wrapping_mul(0xA24B_AED4_963E_E407);
        let turns = self.turns.entry(place).or_default();
        turns.count += 1;
        if turns.kept == Some(state) {
            return None;
        }
        if turns.count.is_power_of_two() {
            turns.kept = Some(state);
        }
        Some(turns.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_circles_of_any_length_and_nothing_else() {
        let place = (FileId(0), 7);
        for length in [1, 2, 3, 10, 1000] {
            let mut p = Progress::default();
            let found = (0..4 * length).find(|k| p.turn(place, k % length).is_none());
            assert!(found.is_some(), "{length}");
            let mut p = Progress::default();
            assert!((0..1000).all(|k| p.turn(place, k) == Some(k + 1)));
            let mut p = Progress::default();
            let changing = |_| {
                p.outside();
                p.turn(place, 1).is_some()
            };
            assert!((0..1000).all(changing));
        }
    }
}
