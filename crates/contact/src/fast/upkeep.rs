//! Whether short lists pay: where grains pass each other fast, to make them again and again takes longer than to test all pairs
//! of the long lists. Results do not hang on it: only pairs that touch are evaluated, in the order of the long list.

/// To look at a pair of a long list when a short one is made, in units of the test of a listed pair in a step.
const TO_MAKE: usize = 4;
/// To look how far a grain has strayed, in these units.
const TO_LOOK: usize = 3;
/// So many times long lists are taken whole before short ones are tried again.
const RESTS: u32 = 16;

/// What short lists have cost since long ones were made.
#[derive(Clone, Debug, Default)]
pub(super) struct Upkeep {
    steps: usize,
    /// Pairs of long lists that short ones were made from.
    made: usize,
    /// Grains that were looked at.
    looked: usize,
    /// How many more times long lists are taken whole.
    whole: u32,
}

impl Upkeep {
    /// A step was made in which short lists were made from so many pairs of long ones, and so many grains were looked at.
    pub fn step(&mut self, made: usize, looked: usize) {
        self.steps += 1;
        self.made += made;
        self.looked += looked;
    }

    /// New long lists come after these, with so many pairs in long and in short lists: whether they are taken whole.
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
