//! For how long nobody can touch a wall, and when it is worth while to find that out.

use perigrain_world::{Seen, Travel};

/// While nobody goes farther than there was room at the last look, nobody touches the wall, and it is not looked at.
#[derive(Default)]
pub struct Peace {
    /// The last look, and how far everybody may go.
    seen: Option<(Seen, f64)>,
    /// When it was.
    since: i64,
    /// How many steps in which nobody touches go by until the next look, and how many did before the last one.
    wait: u32,
    waited: u32,
}

/// To look takes as long as to find nobody touching: a look that saves fewer steps is not repeated soon.
const WORTH: i64 = 8;
/// The longest wait for the next look, in steps.
const LONGEST_WAIT: u32 = 64;

impl Peace {
    /// Whether it lasts by the account of ways.
    pub fn lasts(&self, account: Travel) -> bool {
        self.seen.is_some_and(|(seen, room)| seen.within(account, room))
    }

    /// Somebody touches, or the wall moves.
    pub fn end(&mut self) {
        self.seen = None;
    }

    /// At this step there was so much room.
    pub fn begin(&mut self, step: i64, seen: Seen, room: f64) {
        (self.seen, self.since) = (Some((seen, room)), step);
    }

    /// Whether to look in this step, in which nobody touches.
    pub fn is_worth_a_look(&mut self, step: i64) -> bool {
        if self.seen.take().is_some() {
            let short = step - self.since < WORTH;
            self.waited = if short { (2 * self.waited + 1).min(LONGEST_WAIT) } else { 0 };
            self.wait = self.waited;
        }
        let looks = self.wait == 0;
        self.wait = self.wait.saturating_sub(1);
        looks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_that_save_little_are_not_repeated_soon() {
        let looks = |lasting: i64| {
            let (mut peace, mut looks, mut step) = (Peace::default(), 0, 0);
            while step < 1000 {
                step += 1;
                if peace.is_worth_a_look(step) {
                    looks += 1;
                    peace.begin(step, Seen::default(), 1.0);
                    step += lasting;
                }
            }
            looks
        };
        assert!((95..105).contains(&looks(9)), "each that saves ten steps: {}", looks(9));
        assert!(looks(0) < 25, "one in 65 steps at last: {}", looks(0));
    }
}
