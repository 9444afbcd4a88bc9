//! Decides whether short lists pay off: if grains pass each other fast, remaking them costs more than testing
//! all pairs of the long lists. Results do not depend on this: only touching pairs are evaluated, in the
//! order of the long list.

/// Cost per pair of a long list when a short one is made, in units of one pair test.
const TO_MAKE: usize = 4;
/// Cost of checking a grain's displacement, in the same units.
const TO_LOOK: usize = 3;
/// Number of times that long lists are used whole before short ones are tried again.
const RESTS: u32 = 16;

/// Cost of short lists since the long ones were made.
#[derive(Clone, Debug, Default)]
pub(super) struct Upkeep {
    steps: usize,
    /// Pairs of long lists from which short ones were made.
    made: usize,
    /// Grains checked.
    looked: usize,
    /// Remaining number of times that long lists are used whole.
    whole: u32,
}

impl Upkeep {
    /// Records a step: the pairs of long lists from which short ones were made, and the grains checked.
    pub fn step(&mut self, made: usize, looked: usize) {
        self.steps += 1;
        self.made += made;
        self.looked += looked;
    }

    /// Called when long lists are remade, with the current numbers of long and short pairs; returns whether
    /// the next ones are used whole.
    pub fn takes_whole(&mut self, [long, short]: [usize; 2]) -> bool {
        self.whole = match self.whole {
            0 => {
                let cost = TO_MAKE * self.made + TO_LOOK * self.looked;
                if cost > self.steps * long.saturating_sub(short) { RESTS } else { 0 }
            }
            left => left - 1,
        };
        (self.steps, self.made, self.looked) = (0, 0, 0);
        self.whole > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_lists_that_last_are_kept_and_others_are_tried_now_and_then() {
        let mut calm = Upkeep::default();
        for _ in 0..10 {
            (0..30).for_each(|step| calm.step(if step % 10 == 0 { 100 } else { 0 }, 0));
            assert!(!calm.takes_whole([150, 100]));
        }
        let (mut wild, mut whole) = (Upkeep::default(), 0);
        for _ in 0..170 {
            (0..10).for_each(|_| wild.step(50, 40));
            whole += u32::from(wild.takes_whole([150, 100]));
        }
        assert_eq!(whole, 160, "all but one in seventeen");
    }
}
