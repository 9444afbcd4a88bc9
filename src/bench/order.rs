//! Observed orders: by which power of a knob an error falls, over three settings of it.

use super::reference::{Against, finest};
use super::{Bench, Error, Measure};

/// Halves of an order that differ by more than this are uneven.
const EVEN: f64 = 0.5;

/// The order over three settings of a knob.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Order {
    /// The power.
    pub power: f64,
    /// Whether both halves, from the first setting to the second and on to the third, give about the same order. Where one error
    /// is small by chance they do not.
    pub is_even: bool,
}

/// Of each setting and each knob the order over it and the two settings before.
///
/// Where errors are differences to a finer run along the knob, the second setting has an order too: that run is the third.
pub fn all(bench: &Bench, measure: &Measure, errors: &[Error]) -> Vec<Vec<Option<Order>>> {
    let numbers: Vec<Option<Vec<f64>>> = (0..bench.axes.len()).map(|k| bench.numbers(k)).collect();
    let order = |point: usize, axis: usize| {
        let steps = numbers[axis].as_ref()?;
        if !contains_all(measure, &bench.axes[axis].names) {
            return None;
        }
        let mut places = bench.places(point);
        let here = places[axis];
        let mut error = |place: usize| {
            places[axis] = place;
            errors[bench.at(&places)].counted()
        };
        let (fine, middle) = (error(here)?, error(here.checked_sub(1)?)?);
        let coarse = here.checked_sub(2).map(error);
        // The reference has an error of its own along the line that it is on; switches of the program change no numbers.
        let on_line = finest(bench, measure, point).is_some_and(|reference| {
            let both = bench.places(reference).into_iter().zip(bench.places(point));
            both.enumerate().all(|(k, (a, b))| k == axis || a == b || bench.axes[k].is_switch())
        });
        let last = steps.last().filter(|_| on_line).copied();
        let half = of([steps[here - 1], steps[here]], [middle, fine], last);
        let Some(coarse) = coarse else {
            return half.filter(|_| last.is_some()).map(|power| Order { power, is_even: true });
        };
        let coarse = coarse?;
        let power = of([steps[here - 2], steps[here]], [coarse, fine], last)?;
        let other = of([steps[here - 2], steps[here - 1]], [coarse, middle], last)?;
        Some(Order { power, is_even: (half? - other).abs() <= EVEN })
    };
    (0..errors.len()).map(|k| (0..numbers.len()).map(|a| order(k, a)).collect()).collect()
}

/// Whether settings along these knobs are compared with one reference.
fn contains_all(measure: &Measure, names: &[String]) -> bool {
    match &measure.against {
        Against::Finest(knobs) => knobs.is_empty() || names.iter().any(|n| knobs.contains(n)),
        _ => true,
    }
}

/// The order p between two settings of a knob: errors are C hᵖ, or C (hᵖ − lastᵖ) where they are differences to a run with
/// `last`, which has an error of its own. Positive where the error falls from the first to the second.
pub fn of([coarse, fine]: [f64; 2], errors: [f64; 2], last: Option<f64>) -> Option<f64> {
    let ratio = (errors[0] / errors[1]).ln();
    // A knob that grows, such as a number of cells, is the inverse of a length.
    let (coarse, fine, last) =
        if coarse < fine { (1.0 / coarse, 1.0 / fine, last.map(f64::recip)) } else { (coarse, fine, last) };
    if !ratio.is_finite() || coarse == fine {
        return None;
    }
    let plain = ratio / (coarse / fine).ln();
    let Some(last) = last.filter(|last| *last < fine) else { return Some(plain) };
    // The ratio grows with p; without an answer the plain slope stands.
    let wanted = |p: f64| {
        let part = |h: f64| (p * (h / last).ln()).exp_m1();
        (part(coarse) / part(fine)).ln()
    };
    let (mut low, mut high) = (1e-3, 16.0);
    if !(wanted(low)..wanted(high)).contains(&ratio) {
        return Some(plain);
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if wanted(middle) < ratio { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn order(steps: [f64; 2], errors: [f64; 2], last: Option<f64>) -> f64 {
        of(steps, errors, last).unwrap()
    }

    #[test]
    fn an_order_is_the_slope_of_the_error() {
        assert!((order([0.2, 0.1], [4.0, 1.0], None) - 2.0).abs() < 1e-12);
        assert!((order([10.0, 20.0], [2.0, 1.0], None) - 1.0).abs() < 1e-12, "cells");
        assert!(order([0.2, 0.1], [1.0, 4.0], None) < -1.9);
        assert_eq!(of([0.2, 0.2], [1.0, 2.0], None), None);
        assert_eq!(of([0.2, 0.1], [1.0, 0.0], None), None);
    }

    #[test]
    fn the_error_of_the_reference_is_reckoned_with() {
        // Differences to a run with h = 1 of a method of second order: 15 and 3, which look like an order of 2.3.
        assert!((order([4.0, 2.0], [15.0, 3.0], Some(1.0)) - 2.0).abs() < 1e-9);
        assert!((order([25.0, 50.0], [15.0, 3.0], Some(100.0)) - 2.0).abs() < 1e-9);
        assert!((order([4.0, 2.0], [4.0, 4.0], Some(1.0))).abs() < 1e-9, "no order: the plain slope");
    }
}
