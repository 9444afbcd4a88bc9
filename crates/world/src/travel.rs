//! An account of how far particles may have gone, so that not every step has to compare all positions with former ones.

/// The longest distance that any particle has moved since a run began, kept where all ops that move particles report to it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Travel {
    /// Which run it is.
    run: u64,
    /// The distance [length]; `None` where an op moves particles without reporting.
    way: Option<f64>,
}

/// The part of a limit that the account may use up: far more is left than additions to coordinates round off.
const SURE: f64 = 0.999;

impl Travel {
    /// A new run, in which all ops that move particles report, or not.
    pub fn begin(&mut self, reported: bool) {
        *self = Self { run: self.run + 1, way: reported.then_some(0.0) };
    }

    /// No particle has moved farther than this in a step [length]; a NaN counts as infinitely far.
    pub fn went(&mut self, at_most: f64) {
        let far = if at_most.is_nan() { f64::INFINITY } else { at_most };
        self.way = self.way.map(|way| way + far);
    }
}

/// How far any particle is from its place at some moment, as of the last measurement.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    account: Travel,
    /// How far it was then [length].
    moved: f64,
}

impl Seen {
    /// Positions were compared just now, with this result [length].
    pub fn measured(account: Travel, moved: f64) -> Self {
        Self { account, moved }
    }

    /// Whether, by the account, all particles are certainly less than `limit` [length] away still.
    pub fn within(&self, account: Travel, limit: f64) -> bool {
        let (Some(now), Some(then)) = (account.way, self.account.way) else { return false };
        // Back at a former state (a guard's) the account of later steps does not count.
        account.run == self.account.run && now >= then && self.moved + (now - then) < SURE * limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_account_bounds_what_was_seen() {
        let mut travel = Travel::default();
        assert!(!Seen::measured(travel, 0.0).within(travel, 1.0), "no run yet");
        travel.begin(true);
        let seen = Seen::measured(travel, 0.25);
        assert!(seen.within(travel, 0.5));
        travel.went(0.25);
        assert!(!seen.within(travel, 0.5) && seen.within(travel, 0.51));
        let later = Seen::measured(travel, 0.1);
        assert!(later.within(travel, 0.2));
        travel.went(f64::NAN);
        assert!(!later.within(travel, f64::MAX));
    }

    #[test]
    fn other_runs_former_states_and_silent_movers_are_not_trusted() {
        let mut travel = Travel::default();
        travel.begin(true);
        let before = travel;
        travel.went(0.1);
        let seen = Seen::measured(travel, 0.0);
        assert!(!seen.within(before, 1.0));
        travel.begin(true);
        travel.went(0.2);
        assert!(!seen.within(travel, 1.0));
        travel.begin(false);
        travel.went(0.1);
        assert!(!Seen::measured(travel, 0.0).within(travel, 1.0));
    }
}
