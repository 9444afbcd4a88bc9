//! Histogram bins and the sorting of values into them.

use perigrain_styles::words::Words;

/// What happens to values outside the bounds.
#[derive(Clone, Copy, Default, PartialEq, Words)]
#[word(what = "value of beyond")]
pub enum Beyond {
    /// What lies outside lo and hi is not counted.
    #[default]
    Ignore,
    /// What lies outside counts in the end bins.
    End,
    /// What lies outside counts in two bins of its own.
    Extra,
}

/// Equal bins between two bounds.
#[derive(Clone, Copy)]
pub struct Bins {
    /// Lower bound.
    pub lo: f64,
    /// Upper bound.
    pub hi: f64,
    /// Number of bins between the bounds.
    pub inner: usize,
    /// Treatment of values outside the bounds.
    pub beyond: Beyond,
}

impl Bins {
    /// Number of bins.
    pub fn count(&self) -> usize {
        self.inner + if self.beyond == Beyond::Extra { 2 } else { 0 }
    }

    /// The bin of a value, if it has one.
    pub fn of(&self, value: f64) -> Option<usize> {
        let first = usize::from(self.beyond == Beyond::Extra);
        if value < self.lo || value > self.hi {
            let last = self.count() - 1;
            return (self.beyond != Beyond::Ignore).then_some(if value < self.lo { 0 } else { last });
        }
        let inverse = 1.0 / ((self.hi - self.lo) / self.inner as f64);
        Some(first + (((value - self.lo) * inverse) as usize).min(self.inner - 1))
    }

    /// The centre of a bin; for the two extra bins the bounds themselves.
    pub fn centre(&self, k: usize) -> f64 {
        let size = (self.hi - self.lo) / self.inner as f64;
        match self.beyond {
            Beyond::Extra if k == 0 => self.lo,
            Beyond::Extra if k == self.inner + 1 => self.hi,
            Beyond::Extra => self.lo + (k as f64 - 1.0 + 0.5) * size,
            _ => self.lo + (k as f64 + 0.5) * size,
        }
    }
}

/// A histogram: counts, totals inside and outside the bounds, smallest and largest value.
pub struct Histogram {
    /// One per bin; then the totals of counted and uncounted values.
    pub counts: Vec<f64>,
    /// Smallest and largest value.
    pub extremes: [f64; 2],
}

impl Histogram {
    /// An empty histogram.
    pub fn new(bins: &Bins) -> Self {
        Self { counts: vec![0.0; bins.count() + 2], extremes: [f64::INFINITY, f64::NEG_INFINITY] }
    }

    /// Counts a value.
    pub fn add(&mut self, bins: &Bins, value: f64, weight: f64) {
        self.extremes = [self.extremes[0].min(value), self.extremes[1].max(value)];
        let (counted, missing) = (bins.count(), bins.count() + 1);
        match bins.of(value) {
            Some(k) => {
                self.counts[k] += weight;
                self.counts[counted] += weight;
            }
            None => self.counts[missing] += weight,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_belong_to_the_bins() {
        let bins = |beyond| Bins { lo: 0.0, hi: 2.0, inner: 4, beyond };
        let of = |b: Bins| [-0.1, 0.0, 0.49, 0.5, 1.99, 2.0, 2.1].map(|v| b.of(v));
        assert_eq!(of(bins(Beyond::Ignore)), [None, Some(0), Some(0), Some(1), Some(3), Some(3), None]);
        assert_eq!(of(bins(Beyond::End)), [0, 0, 0, 1, 3, 3, 3].map(Some));
        assert_eq!(of(bins(Beyond::Extra)), [0, 1, 1, 2, 4, 4, 5].map(Some));
        let extra = bins(Beyond::Extra);
        assert_eq!([0, 1, 4, 5].map(|k| extra.centre(k)), [0.0, 0.25, 1.75, 2.0]);
        assert_eq!(bins(Beyond::End).centre(3), 1.75);
    }

    #[test]
    fn what_is_not_counted_is_counted_too() {
        let bins = Bins { lo: 0.0, hi: 1.0, inner: 2, beyond: Beyond::Ignore };
        let mut h = Histogram::new(&bins);
        for (v, weight) in [(0.2, 1.0), (0.7, 2.0), (3.0, 4.0)] {
            h.add(&bins, v, weight);
        }
        assert_eq!(h.counts, [1.0, 2.0, 3.0, 4.0]);
        assert_eq!(h.extremes, [0.2, 3.0]);
    }
}
