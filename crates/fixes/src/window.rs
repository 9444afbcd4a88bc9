//! Time averages for all `fix ave/…`: when samples are taken, and how successive averages are combined.

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_plan::When;
use perigrain_styles::words::{At, Words};
pub use perigrain_walls::shared::forget;
use perigrain_world::{Numbers, World};

/// `Nevery Nrepeat Nfreq`.
#[derive(Words)]
pub struct Samples {
    /// Distance of the samples of an average [steps].
    #[word(name = "Nevery", what = "Nevery", from = 1)]
    every: i64,
    /// Samples of an average.
    #[word(name = "Nrepeat", what = "Nrepeat", from = 1)]
    repeat: At<i64>,
    /// Distance of the averages, a multiple of Nevery; the last sample of an average is at one of these steps [steps].
    #[word(name = "Nfreq", what = "Nfreq", from = 1)]
    freq: At<i64>,
}

/// When samples are taken.
#[derive(Clone, Copy, Debug)]
pub struct Schedule {
    /// Steps between samples.
    pub every: i64,
    /// Samples per average.
    pub repeat: i64,
    /// Steps between averages.
    pub freq: i64,
    /// No sample before this step.
    pub start: i64,
}

/// What a schedule does at a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Due {
    /// The first sample of an average.
    pub first: bool,
    /// The last one: the average is complete.
    pub last: bool,
}

impl Schedule {
    /// From the three numbers; no sample before the step `start`.
    ///
    /// # Errors
    /// Samples that overlap.
    pub fn new(samples: &Samples, start: i64) -> Result<Self> {
        let Samples { every, repeat, freq } = *samples;
        if freq.value % every != 0 && !freq.unknown {
            let text = format!("Nfreq must be a multiple of Nevery: {} is none of {every}", freq.value);
            return fail(Code::BAD_VALUE, freq.span, text);
        }
        let (span, repeat, freq) = (repeat.span, repeat.value, freq.value);
        if repeat.saturating_mul(every) > freq && !samples.freq.unknown {
            let text = format!("{repeat} samples every {every} steps do not fit into {freq} steps");
            return Err(Diagnostic::error(Code::BAD_VALUE, span, text)
                .help("Nrepeat times Nevery may be at most Nfreq")
                .into());
        }
        Ok(Self { every, repeat, freq, start })
    }

    /// Steps at which samples may be due.
    pub fn when(&self) -> When {
        match self.repeat {
            1 => When::Every(self.freq),
            _ => When::Samples { every: self.every, repeat: self.repeat, freq: self.freq },
        }
    }

    /// The first sample at or after a step: averages that have begun earlier are skipped.
    fn next_from(&self, step: i64) -> i64 {
        let mut next = step.div_euclid(self.freq) * self.freq + self.freq;
        if next < self.start {
            next += (self.start - next + self.freq - 1) / self.freq * self.freq;
        }
        if next - self.freq == step && self.repeat == 1 {
            return step;
        }
        next -= (self.repeat - 1) * self.every;
        if next < step { next + self.freq } else { next }
    }

    /// Discards all samples; the next is taken at the current step at the earliest.
    pub fn declare(&self, w: &mut World, kept: &Kept) {
        forget(w, kept.key);
        let next = self.next_from(w.clock.step);
        w.memo.insert(kept.next, vec![next as f64, 0.0]);
    }

    /// The last sample of an average that begins at this step.
    pub fn last(&self, first: i64) -> i64 {
        first + (self.repeat - 1) * self.every
    }

    /// Whether a sample is due at this step; advances the schedule.
    pub fn due(&self, w: &mut World, kept: &Kept, step: i64) -> Option<Due> {
        let (mut next, mut taken) = match w.memo.get(kept.next).map(Vec::as_slice) {
            Some(&[next, taken]) => (next as i64, taken as i64),
            _ => (self.next_from(step), 0),
        };
        // `reset_timestep` may have jumped past the next sample, or far away from it.
        if step > next || next - step > self.freq + self.start.max(0) {
            (next, taken) = (self.next_from(step), 0);
        }
        let due = step == next;
        let found = Due { first: taken == 0, last: taken + 1 == self.repeat };
        if due {
            taken = if found.last { 0 } else { taken + 1 };
            next = if found.last {
                step + self.freq - (self.repeat - 1) * self.every
            } else {
                step + self.every
            };
        }
        w.memo.insert(kept.next, vec![next as f64, taken as f64]);
        due.then_some(found)
    }
}

/// Keys of an average in the world's memory.
#[derive(Clone, Copy)]
pub struct Kept {
    /// Common prefix.
    pub key: Numbers,
    /// The next sample, and how many have been taken.
    next: Numbers,
    sum: Numbers,
    total: Numbers,
    count: Numbers,
    list: Numbers,
}

impl Kept {
    /// The keys below this one.
    pub fn below(key: Numbers) -> Self {
        let [next, sum, total, count, list] =
            ["/next", "/sum", "/total", "/count", "/list"].map(|what| key.with(what));
        Self { key, next, sum, total, count, list }
    }
}

/// How an average goes with the ones before it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Words)]
#[word(what = "kind of average")]
pub enum Ave {
    /// Each average for itself.
    #[default]
    One,
    /// The mean of all averages so far.
    Running,
    /// The mean of the last M averages.
    Window(
        /// The number of averages in a window.
        #[word(name = "M", from = 1)]
        usize,
    ),
}

/// Sums samples and combines averages; its state is in the world's memory.
pub struct Averager {
    /// Keys of the state.
    pub kept: Kept,
    /// Samples per average: the divisor of the sum; 1 keeps sums.
    pub repeat: i64,
    /// How averages are combined.
    pub ave: Ave,
    /// Which values of each row are the latest ones instead of averages; as long as a row, or empty.
    pub off: Vec<bool>,
}

impl Averager {
    /// Adds a sample. After the last one of an average, returns the summed averages and their number.
    pub fn add(&self, w: &mut World, values: &[f64], due: Due) -> Option<(Vec<f64>, f64)> {
        let off = |i: usize| self.off.get(i % self.off.len().max(1)).copied().unwrap_or(false);
        let mut sum = w.memo.remove(self.kept.sum).unwrap_or_default();
        if due.first || sum.len() != values.len() {
            sum.clear();
            sum.resize(values.len(), 0.0);
        }
        for (i, (sum, value)) in sum.iter_mut().zip(values).enumerate() {
            *sum = if off(i) { *value } else { *sum + value };
        }
        if !due.last {
            w.memo.insert(self.kept.sum, sum);
            return None;
        }
        for (i, sum) in sum.iter_mut().enumerate() {
            if !off(i) {
                *sum /= self.repeat as f64;
            }
        }
        let (mut total, count) = self.join(w, &sum);
        for (i, total) in total.iter_mut().enumerate().filter(|(i, _)| off(*i)) {
            *total = count * sum[i];
        }
        w.memo.insert(self.kept.sum, sum);
        Some((total, count))
    }

    /// Combines an average with the earlier ones.
    fn join(&self, w: &mut World, one: &[f64]) -> (Vec<f64>, f64) {
        let kept = &self.kept;
        let mut total = w.memo.remove(kept.total).unwrap_or_default();
        let mut count = w.memo.get(kept.count).and_then(|c| c.first().copied()).unwrap_or(0.0);
        if total.len() != one.len() || self.ave == Ave::One {
            (total, count) = (vec![0.0; one.len()], 0.0);
            w.memo.remove(kept.list);
        }
        for (total, one) in total.iter_mut().zip(one) {
            *total += one;
        }
        count += 1.0;
        if let Ave::Window(most) = self.ave {
            let list = w.memo.get_or(kept.list, Vec::new);
            if count > most as f64 {
                for (total, old) in total.iter_mut().zip(list.drain(..one.len())) {
                    *total -= old;
                }
                count -= 1.0;
            }
            list.extend_from_slice(one);
        }
        w.memo.insert(kept.count, vec![count]);
        w.memo.insert(kept.total, total.clone());
        (total, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_world::Key;

    fn steps(s: &Schedule, from: i64) -> Vec<i64> {
        let mut w = World::default();
        w.clock.step = from;
        let kept = Kept::below(Key::new("k"));
        s.declare(&mut w, &kept);
        (from..40).filter(|&k| s.due(&mut w, &kept, k).is_some()).collect()
    }

    // The first two are from LAMMPS' manual of fix ave/time, scaled down.
    #[test]
    fn samples_end_at_multiples() {
        let s = Schedule { every: 2, repeat: 3, freq: 10, start: 0 };
        assert_eq!(steps(&s, 0), [6, 8, 10, 16, 18, 20, 26, 28, 30, 36, 38]);
        assert_eq!(steps(&s, 7), [16, 18, 20, 26, 28, 30, 36, 38]);
        assert_eq!(steps(&Schedule { start: 21, ..s }, 0), [26, 28, 30, 36, 38]);
        let one = Schedule { every: 5, repeat: 1, freq: 15, start: 0 };
        assert_eq!(steps(&one, 0), [0, 15, 30]);
        assert_eq!(steps(&one, 1), [15, 30]);
        let mut t = perigrain_plan::Tick::between_runs(&perigrain_world::Clock::default());
        let fires: Vec<i64> = (0..21)
            .filter(|&k| {
                t.step = k;
                s.when().fires(&t)
            })
            .collect();
        assert_eq!(fires, [0, 6, 8, 10, 16, 18, 20]);
    }

    #[test]
    fn averages_of_averages() {
        let due = Due { first: true, last: true };
        for (ave, wanted) in
            [(Ave::One, [1.0, 2.0, 6.0]), (Ave::Running, [1.0, 1.5, 3.0]), (Ave::Window(2), [1.0, 1.5, 4.0])]
        {
            let mut w = World::default();
            let a = Averager { kept: Kept::below(Key::new("k")), repeat: 1, ave, off: vec![false, true] };
            let means = [1.0, 2.0, 6.0].map(|v| {
                let (total, count) = a.add(&mut w, &[v, v], due).unwrap();
                assert_eq!(total[1] / count, v);
                total[0] / count
            });
            assert_eq!(means, wanted, "{ave:?}");
            forget(&mut w, Key::new("k"));
            assert!(w.memo.is_empty());
        }
    }
}
