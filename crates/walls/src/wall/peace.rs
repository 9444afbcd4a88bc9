//! Predicts how long no particle can touch a wall, and decides when this prediction pays off.

use perigrain_world::{Seen, Travel};

/// A period without contacts: while no particle moves farther than the clearance at the last check, the wall
/// is skipped.
#[derive(Default)]
pub struct Peace {
    /// The last check, and the clearance at that time.
    seen: Option<(Seen, f64)>,
    /// Step of the last check.
    since: i64,
    /// Contact-free steps left until the next check, and the number before the last one.
    wait: u32,
    waited: u32,
}

/// A check costs as much as finding no contact: if it saves fewer steps, it is not repeated soon.
const WORTH: i64 = 8;
/// The longest wait for the next check, in steps.
const LONGEST_WAIT: u32 = 64;

impl Peace {
    /// Whether the period still holds for these displacements.
    pub fn lasts(&self, account: Travel) -> bool {
        self.seen.is_some_and(|(seen, room)| seen.within(account, room))
    }

    /// Ends the period: there is a contact, or the wall moves.
    pub fn end(&mut self) {
        self.seen = None;
    }

    /// Begins a period at this step with this clearance.
    pub fn begin(&mut self, step: i64, seen: Seen, room: f64) {
        (self.seen, self.since) = (Some((seen, room)), step);
    }

    /// Whether to check in this step, in which nothing touches.
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
