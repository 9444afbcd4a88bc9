//! The size of a difference: of two values, or of two series at common times.

use crate::sweep::series::Series;

/// How a measure is compared with its reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Norm {
    /// What is made of the differences.
    pub kind: Kind,
    /// Divided by the same of the reference.
    pub relative: bool,
}

/// What is made of differences.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// That of the last values.
    #[default]
    End,
    /// The largest.
    Max,
    /// Their mean.
    L1,
    /// The root of their mean square.
    L2,
}

/// The names of norms on the command line.
pub const NAMES: [(&str, Norm); 8] = [
    ("rel", Norm { kind: Kind::End, relative: true }),
    ("end", Norm { kind: Kind::End, relative: false }),
    ("max", Norm { kind: Kind::Max, relative: false }),
    ("l1", Norm { kind: Kind::L1, relative: false }),
    ("l2", Norm { kind: Kind::L2, relative: false }),
    ("rel-max", Norm { kind: Kind::Max, relative: true }),
    ("rel-l1", Norm { kind: Kind::L1, relative: true }),
    ("rel-l2", Norm { kind: Kind::L2, relative: true }),
];

/// Times that differ by less than this part of their spacing are one.
const SAME: f64 = 1e-6;

impl Norm {
    /// The norm of this name.
    pub fn named(name: &str) -> Option<Self> {
        NAMES.iter().find(|(known, _)| *known == name).map(|(_, norm)| *norm)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        NAMES.iter().find(|(_, norm)| *norm == self).map_or("rel", |(name, _)| *name)
    }

    /// The error of values against those expected, pairwise.
    pub fn of(self, pairs: &[(f64, f64)]) -> f64 {
        let size = self.size(pairs.iter().map(|(value, expected)| value - expected));
        if self.relative { size / self.size(pairs.iter().map(|(_, expected)| *expected)) } else { size }
    }

    fn size(self, values: impl ExactSizeIterator<Item = f64>) -> f64 {
        let n = values.len().max(1) as f64;
        match self.kind {
            Kind::End => values.last().map_or(f64::NAN, f64::abs),
            Kind::Max => values.map(f64::abs).fold(0.0, |a, b| if a.is_nan() || b <= a { a } else { b }),
            Kind::L1 => values.map(f64::abs).sum::<f64>() / n,
            Kind::L2 => (values.map(|v| v * v).sum::<f64>() / n).sqrt(),
        }
    }
}

/// Values of two series at the times of the one with fewer rows, the other interpolated.
///
/// # Errors
/// Series that do not cover the same time, in a few words.
pub fn paired(ours: &Series, expected: &Series) -> Result<Vec<(f64, f64)>, String> {
    let ends = |s: &Series| Some((*s.times.first()?, *s.times.last()?));
    let (Some(a), Some(b)) = (ends(ours), ends(expected)) else { return Err("there are no rows".into()) };
    let spacing = |s: &Series, (from, to): (f64, f64)| (to - from) / (s.times.len() - 1).max(1) as f64;
    let (h_a, h_b) = (spacing(ours, a), spacing(expected, b));
    let close = h_a.max(h_b) * 1.001;
    if (a.0 - b.0).abs() > close || (a.1 - b.1).abs() > close {
        return Err(format!("it goes from {} to {}, the reference from {} to {}", a.0, a.1, b.0, b.1));
    }
    let within = |t: f64, (from, to): (f64, f64), h: f64| t >= from - SAME * h && t <= to + SAME * h;
    let mut pairs = vec![];
    if ours.times.len() <= expected.times.len() {
        for (t, value) in ours.times.iter().zip(&ours.values).filter(|(t, _)| within(**t, b, h_b)) {
            pairs.push((*value, at(expected, *t, h_b)));
        }
    } else {
        for (t, value) in expected.times.iter().zip(&expected.values).filter(|(t, _)| within(**t, a, h_a)) {
            pairs.push((at(ours, *t, h_a), *value));
        }
    }
    if pairs.is_empty() { Err("there are no common times".into()) } else { Ok(pairs) }
}

/// The value of a series at a time: that of its row, else of the cubic through the four rows around it.
fn at(series: &Series, time: f64, spacing: f64) -> f64 {
    let (times, values) = (&series.times, &series.values);
    let after = times.partition_point(|t| *t < time);
    for k in after.saturating_sub(1)..(after + 1).min(times.len()) {
        if (times[k] - time).abs() <= SAME * spacing {
            return values[k];
        }
    }
    let count = times.len().min(4);
    let first = after.saturating_sub(count / 2).min(times.len() - count);
    let rows = first..first + count;
    rows.clone()
        .map(|k| {
            let others = rows.clone().filter(|j| *j != k);
            values[k] * others.map(|j| (time - times[j]) / (times[k] - times[j])).product::<f64>()
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(n: usize, f: impl Fn(f64) -> f64) -> Series {
        let times: Vec<f64> = (0..=n).map(|k| k as f64 / n as f64).collect();
        Series { values: times.iter().map(|t| f(*t)).collect(), times }
    }

    #[test]
    fn norms_match_their_names() {
        let pairs = [(1.0, 0.0), (-1.0, 2.0), (5.0, 4.0)];
        let of = |name: &str| Norm::named(name).unwrap().of(&pairs);
        assert_eq!((of("end"), of("rel"), of("max")), (1.0, 0.25, 3.0));
        assert!((of("l1") - 5.0 / 3.0).abs() < 1e-15 && (of("l2") - (11.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!((of("rel-l2") - (11.0f64 / 20.0).sqrt()).abs() < 1e-15 && of("rel-max") == 0.75);
        assert!(NAMES.iter().all(|(name, norm)| norm.name() == *name) && Norm::named("l3").is_none());
        assert!(Norm::named("max").unwrap().of(&[(f64::NAN, 0.0), (1.0, 0.0)]).is_nan());
    }

    #[test]
    fn series_are_compared_at_common_times() {
        let (coarse, fine) = (series(10, |t| t * t), series(40, |t| t * t + 0.5));
        let pairs = paired(&coarse, &fine).unwrap();
        assert_eq!(pairs.len(), 11);
        assert!(pairs.iter().all(|(a, b)| b - a == 0.5), "at rows nothing is interpolated");
        // A cubic goes through other times without error.
        let other = series(33, |t| t * t * t);
        let off = paired(&series(10, |t| t * t * t), &other).unwrap();
        assert!(off.iter().all(|(a, b)| (a - b).abs() < 1e-14), "{off:?}");
        let mut short = series(40, |t| t);
        short.times.truncate(30);
        short.values.truncate(30);
        assert!(paired(&coarse, &short).unwrap_err().contains("the reference from 0 to 0.725"));
        assert!(paired(&coarse, &Series::default()).is_err());
    }
}
