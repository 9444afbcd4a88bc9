//! The range of an axis and its marks at round numbers.

/// An axis; on a logarithmic one all values are logarithms.
pub(super) struct Axis {
    from: f64,
    to: f64,
    logarithmic: bool,
    /// Where its marks are, and their texts.
    pub marks: Vec<(f64, String)>,
}

/// Smallest and largest of the finite values.
fn ends(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let finite = values.filter(|v| v.is_finite());
    finite.map(|v| (v, v)).reduce(|(a, b), (v, _)| (a.min(v), b.max(v)))
}

impl Axis {
    /// An axis over these values, with marks at round numbers.
    pub fn over(values: impl Iterator<Item = f64>) -> Self {
        let (mut from, mut to) = ends(values).unwrap_or((0.0, 1.0));
        if to - from <= 1e-9 * to.abs().max(from.abs()) {
            let half = if to == 0.0 { 1.0 } else { 0.1 * to.abs() };
            (from, to) = (from - half, to + half);
        }
        let rough = (to - from) / 5.0;
        let power = 10_f64.powf(rough.log10().floor());
        let step =
            [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
        // What is past a mark by a fiftieth needs no further one.
        let (from, to) = ((from / step + 0.02).floor() * step, (to / step - 0.02).ceil() * step);
        let count = ((to - from) / step).round() as i32;
        let places = (0..=count).map(|k| from + f64::from(k) * step);
        let marks = places.map(|place| (place, text(place, step, from.abs().max(to.abs())))).collect();
        Self { from, to, logarithmic: false, marks }
    }

    /// A logarithmic axis over these values above zero: marks at powers of ten, or at 1, 2 and 5 times those where there are few.
    pub fn logarithmic(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = ends(values.filter(|v| *v > 0.0).map(f64::log10)).unwrap_or((0.0, 1.0));
        let digits: &[f64] = if high - low < 1.7 { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let powers = low.floor() as i32 - 1..=high.ceil() as i32 + 1;
        let all: Vec<(f64, String)> = powers
            .flat_map(|p| digits.iter().map(move |d| (d.log10() + f64::from(p), (*d, p))))
            .map(|(place, (d, p))| (place, power_text(d, p)))
            .collect();
        let first = all.iter().rposition(|(m, _)| *m <= low + 0.01).unwrap_or(0);
        let last = all.iter().position(|(m, _)| *m >= high - 0.01).unwrap_or(all.len() - 1).max(first + 1);
        let every = (last - first).div_ceil(8);
        let (from, to) = (all[first].0, all[last].0);
        let marks = all[first..=last].iter().step_by(every).cloned().collect();
        Self { from, to, logarithmic: true, marks }
    }

    /// Where a value, or the logarithm that a mark is, lies between the two ends of the field.
    pub fn place(&self, value: f64, [low, high]: [f64; 2]) -> f64 {
        low + (value - self.from) / (self.to - self.from) * (high - low)
    }

    /// Where a value lies between the two ends of the field.
    pub fn place_of(&self, value: f64, field: [f64; 2]) -> f64 {
        self.place(if self.logarithmic { value.log10() } else { value }, field)
    }
}

/// A mark's text: no more digits than the marks need.
fn text(value: f64, step: f64, most: f64) -> String {
    let value = if value.abs() < 1e-9 * step { 0.0 } else { value };
    if most >= 1e5 || step < 1e-4 {
        return format!("{value:.1e}");
    }
    let digits = (-step.log10().floor()).max(0.0) as usize;
    format!("{value:.digits$}")
}

/// A digit times a power of ten, as 0.5, 20 or 2e-7.
fn power_text(digit: f64, power: i32) -> String {
    match power {
        -2..=3 => format!("{}", (digit * 10f64.powi(power) * 1e4).round() / 1e4),
        _ => format!("{digit}e{power}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: &Axis) -> Vec<&str> {
        axis.marks.iter().map(|(_, text)| text.as_str()).collect()
    }

    #[test]
    fn axes_have_round_marks() {
        let axis = Axis::over([0.03, 0.97].into_iter());
        assert_eq!(texts(&axis), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        let axis = Axis::over([-12.0, 13.0].into_iter());
        assert_eq!(texts(&axis), ["-15", "-10", "-5", "0", "5", "10", "15"]);
        // One value, and none.
        assert!(Axis::over([5.0].into_iter()).from < 5.0);
        assert_eq!(Axis::over(std::iter::empty()).to, 1.0);
    }

    #[test]
    fn logarithmic_axes_have_powers_of_ten() {
        let axis = Axis::logarithmic([3e-6, 0.2, 0.0].into_iter());
        assert_eq!(texts(&axis), ["1e-6", "1e-5", "1e-4", "1e-3", "0.01", "0.1", "1"]);
        assert_eq!(axis.place_of(1e-3, [0.0, 6.0]), 3.0);
        let axis = Axis::logarithmic([0.3, 4.0].into_iter());
        assert_eq!(texts(&axis), ["0.2", "0.5", "1", "2", "5"]);
        assert_eq!(texts(&Axis::logarithmic([1e-3].into_iter())), ["1e-3", "2e-3"]);
        assert_eq!(texts(&Axis::logarithmic(std::iter::empty())), ["1", "2", "5", "10"]);
    }
}
