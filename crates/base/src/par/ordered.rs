//! Parts that write to common rows in a fixed order: each row receives its additions in the same order, on
//! any threads at any time.

use super::pool::{for_rows, threads};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The order of parts. A clone is empty.
#[derive(Debug, Default)]
pub struct Precedence {
    /// The successors of each part, concatenated; `ends` holds the end of each.
    after: Vec<u32>,
    ends: Vec<usize>,
    /// The number of predecessors of each part.
    before: Vec<u32>,
    /// Parts in an order for a single thread: each after its predecessors, and otherwise close to its
    /// predecessors in number.
    line: Vec<usize>,
    /// Parts by colour, and by number within a colour.
    ranks: Vec<u32>,
    /// The shortest time of each part [ns], if measured; else empty.
    times: Vec<AtomicU64>,
    state: Mutex<State>,
}

/// Progress of a run.
#[derive(Debug, Default)]
struct State {
    /// The number of unfinished predecessors of each part.
    left: Vec<AtomicU32>,
    /// Per thread: the number of its parts taken, and its parts.
    shares: Vec<(AtomicUsize, Vec<u32>)>,
}

impl State {
    /// Begins a run of parts in this order, with these numbers of predecessors and this number of threads.
    fn begin(&mut self, (ranks, before): (&[u32], &[u32]), threads: usize) {
        self.left.resize_with(before.len(), Default::default);
        self.left.iter_mut().zip(before).for_each(|(left, before)| *left.get_mut() = *before);
        if self.shares.len() != threads {
            self.shares.clear();
            self.shares.resize_with(threads, Default::default);
            for part in ranks {
                self.shares[*part as usize * threads / ranks.len()].1.push(*part);
            }
        }
        self.shares.iter_mut().for_each(|(taken, _)| *taken.get_mut() = 0);
    }

    /// The next part of a share, if all its predecessors are done.
    fn take(&self, share: usize) -> Option<usize> {
        let (taken, parts) = &self.shares[share];
        loop {
            let at = taken.load(Ordering::Relaxed);
            let part = *parts.get(at)? as usize;
            if self.left[part].load(Ordering::Acquire) > 0 {
                return None;
            }
            if taken.compare_exchange(at, at + 1, Ordering::Relaxed, Ordering::Relaxed).is_ok() {
                return Some(part);
            }
        }
    }

    /// Whether all parts of a share have been taken.
    fn is_taken(&self, share: usize) -> bool {
        let (taken, parts) = &self.shares[share];
        taken.load(Ordering::Relaxed) >= parts.len()
    }
}

impl Clone for Precedence {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Number of attempts to take a part before a thread yields the processor.
const PATIENCE: u32 = 200;

/// Numbers of threads for which speedup bounds are given.
const THREADS: [usize; 3] = [8, 16, 64];

impl Precedence {
    /// The order of parts with these colours, each of which writes to rows of the parts in `others`: of two
    /// parts with common rows, the one with the lower colour comes first. Two parts of one colour must not
    /// have common rows.
    pub fn of(colours: &[u8], others: &[Vec<u32>]) -> Self {
        let mut ranks: Vec<u32> = (0..colours.len() as u32).collect();
        ranks.sort_by_key(|part| colours[*part as usize]);
        let (mut after, mut ends, mut before) = (vec![], vec![], vec![0; colours.len()]);
        for (part, others) in others.iter().enumerate() {
            for other in others {
                debug_assert_ne!(colours[part], colours[*other as usize], "parts {part} and {other}");
                if colours[part] < colours[*other as usize] {
                    after.push(*other);
                    before[*other as usize] += 1;
                }
            }
            ends.push(after.len());
        }
        Self { after, ends, before, line: lined_up(colours, others), ranks, ..Self::default() }
    }

    /// The number of parts.
    pub fn parts(&self) -> usize {
        self.before.len()
    }

    /// Parts in the order of a single thread.
    pub fn line(&self) -> &[usize] {
        &self.line
    }

    /// The successors of a part.
    fn after(&self, part: usize) -> &[u32] {
        let from = if part == 0 { 0 } else { self.ends[part - 1] };
        &self.after[from..self.ends[part]]
    }

    /// Calls `work` once for each part, on all threads, after its predecessors. A thread takes parts with
    /// neighbouring numbers, and parts of other threads when none of its own is ready.
    pub fn run(&self, work: impl Fn(usize) + Sync) {
        let failed = AtomicBool::new(false);
        let work = |part: usize| {
            let alarm = Alarm(&failed);
            self.timed(part, || work(part));
            drop(alarm);
        };
        let (parts, threads) = (self.parts(), threads());
        if threads == 1 || parts < 2 {
            return self.line.iter().for_each(|part| work(*part));
        }
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.begin((&self.ranks, &self.before), threads);
        let state = &*state;
        for_rows(threads, |first| {
            let from_first = (0..threads).map(|k| (first + k) % threads);
            let mut idle = 0;
            loop {
                if let Some(part) = from_first.clone().find_map(|share| state.take(share)) {
                    work(part);
                    let done = |next: &u32| state.left[*next as usize].fetch_sub(1, Ordering::AcqRel);
                    self.after(part).iter().for_each(|next| _ = done(next));
                    idle = 0;
                } else if failed.load(Ordering::Relaxed)
                    || from_first.clone().all(|share| state.is_taken(share))
                {
                    return;
                } else {
                    // Other threads work on the predecessors; they may be waiting for a processor.
                    idle += 1;
                    if idle < PATIENCE { std::hint::spin_loop() } else { std::thread::yield_now() }
                }
            }
        });
    }

    /// Starts or stops measuring the time of each part.
    pub fn keep_times(&mut self, keep: bool) {
        let parts = if keep { self.parts() } else { 0 };
        self.times.resize_with(parts, || u64::MAX.into());
    }

    fn timed<R>(&self, part: usize, work: impl FnOnce() -> R) -> R {
        let Some(least) = self.times.get(part) else { return work() };
        let start = Instant::now();
        let done = work();
        least.fetch_min(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        done
    }

    /// The largest number of parts of this size, their total time, and the largest possible speedup for some
    /// numbers of threads by the times of parts; `None` if no times were measured.
    pub fn described(&self, size: &str) -> Option<String> {
        let times: Vec<u64> = self.times.iter().map(|time| time.load(Ordering::Relaxed)).collect();
        if times.is_empty() || times.contains(&u64::MAX) {
            return None;
        }
        let alone: u64 = times.iter().sum();
        let bound = |threads| {
            let time = self.critical_path(&times, threads).max(1);
            format!("{:.1} for {threads} threads", alone as f64 / time as f64)
        };
        let (bounds, ms) = (THREADS.map(bound).join(", "), alone as f64 * 1e-6);
        Some(format!("{} tile(s) of {size} at most, {ms:.3} ms for forces; bound: {bounds}", times.len()))
    }

    /// The time at which all parts are done if this many threads take them as in [`Precedence::run`],
    /// counting the times of parts only.
    fn critical_path(&self, times: &[u64], threads: usize) -> u64 {
        let (mut left, mut place) = (self.before.clone(), vec![0; self.parts()]);
        self.ranks.iter().zip(0..).for_each(|(part, at)| place[*part as usize] = at);
        let ready = |part: usize| Reverse((place[part], part));
        let mut can_be_taken: BinaryHeap<_> =
            (0..self.parts()).filter(|k| left[*k] == 0).map(ready).collect();
        let mut at_work: BinaryHeap<Reverse<(u64, usize)>> = BinaryHeap::new();
        let mut now = 0;
        loop {
            while at_work.len() < threads {
                let Some(Reverse((_, part))) = can_be_taken.pop() else { break };
                at_work.push(Reverse((now + times[part], part)));
            }
            let Some(Reverse((end, part))) = at_work.pop() else { return now };
            now = end;
            for next in self.after(part).iter().map(|next| *next as usize) {
                left[next] -= 1;
                if left[next] == 0 {
                    can_be_taken.push(ready(next));
                }
            }
        }
    }
}

/// Parts in an order that follows these colours, each after its neighbours with lower colours.
fn lined_up(colours: &[u8], others: &[Vec<u32>]) -> Vec<usize> {
    let (mut line, mut taken, mut open) = (vec![], vec![false; colours.len()], vec![]);
    for first in 0..colours.len() {
        open.push(first);
        while let Some(&part) = open.last() {
            let due = |other: &&u32| colours[**other as usize] < colours[part] && !taken[**other as usize];
            match others[part].iter().find(due) {
                Some(other) if !taken[part] => open.push(*other as usize),
                _ => {
                    if !std::mem::replace(&mut taken[part], true) {
                        line.push(part);
                    }
                    open.pop();
                }
            }
        }
    }
    line
}

/// Signals that a part has panicked: its successors must not be waited for.
struct Alarm<'a>(&'a AtomicBool);

impl Drop for Alarm<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::set_threads;
    use super::*;

    /// A ring of parts, each of which writes to both neighbours.
    fn ring(n: usize) -> Precedence {
        let colours: Vec<u8> = (0..n).map(|k| (k % 2) as u8).collect();
        let others: Vec<Vec<u32>> =
            (0..n).map(|k| vec![((k + 1) % n) as u32, ((k + n - 1) % n) as u32]).collect();
        Precedence::of(&colours, &others)
    }

    #[test]
    fn each_part_is_done_once_after_those_before_it() {
        for (n, threads) in [(12, 1), (12, 3), (64, 7), (2, 2)] {
            set_threads(threads);
            let (ring, done) = (ring(n), Mutex::new(vec![]));
            ring.run(|part| done.lock().unwrap().push(part));
            set_threads(1);
            let done = done.into_inner().unwrap();
            let at = |part: usize| done.iter().position(|k| *k == part).unwrap();
            assert_eq!(done.len(), n);
            let after = |k: usize| ring.after(k).iter().map(|next| *next as usize);
            assert!((0..n).all(|k| after(k).all(|next| at(k) < at(next))), "{done:?}");
        }
        assert_eq!(ring(6).line(), [0, 2, 1, 4, 3, 5], "neighbours come soon");
    }

    #[test]
    fn a_part_that_fails_ends_the_run() {
        set_threads(3);
        let ring = ring(12);
        let run = || ring.run(|part| assert_ne!(part, 4, "this one fails"));
        let failed = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).is_err();
        set_threads(1);
        assert!(failed);
    }

    #[test]
    fn threads_wait_for_what_comes_before() {
        let ring = ring(8);
        let path = |threads| ring.critical_path(&[10; 8], threads);
        assert_eq!([1, 2, 4, 8].map(path), [80, 40, 20, 20]);
    }
}
