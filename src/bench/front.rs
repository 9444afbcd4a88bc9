//! The Pareto front: what nothing else beats in both time and error.

/// Whether each pair of time and error is on the front; pairs that are missing are not.
pub fn of(costs: &[Option<(f64, f64)>]) -> Vec<bool> {
    let beaten = |(time, error): (f64, f64)| {
        let others = costs.iter().flatten();
        others.filter(|o| **o != (time, error)).any(|(t, e)| *t <= time && *e <= error)
    };
    costs.iter().map(|cost| cost.is_some_and(|c| !beaten(c))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_on_the_front_is_beaten_in_both() {
        let costs = [Some((1.0, 0.1)), Some((2.0, 0.01)), Some((3.0, 0.02)), None, Some((2.0, 0.01))];
        assert_eq!(of(&costs), [true, true, false, false, true]);
        assert!(of(&[]).is_empty());
    }
}
