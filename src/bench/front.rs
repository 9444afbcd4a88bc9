//! The Pareto front: what nothing else beats in both time and error.

/// Errors that differ by less than this part are the same.
const SAME: f64 = 1e-6;

/// Whether each pair of time and error is on the front; pairs that are missing are not.
pub fn of(costs: &[Option<(f64, f64)>]) -> Vec<bool> {
    let beaten = |(time, error): (f64, f64)| {
        let beats = |(t, e): &(f64, f64)| {
            let (no_worse, better) = (*e <= error * (1.0 + SAME), *e < error * (1.0 - SAME));
            *t <= time && no_worse && (*t < time || better)
        };
        costs.iter().flatten().any(beats)
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
        // What is slower with the same error but for rounding is beaten.
        assert_eq!(of(&[Some((1.0, 0.1)), Some((2.0, 0.1 * (1.0 - 1e-12)))]), [true, false]);
        assert!(of(&[]).is_empty());
    }
}
