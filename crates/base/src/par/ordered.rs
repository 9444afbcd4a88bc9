//! Parts that write to the same places, each after certain others: whichever thread does what and when, every place receives its
//! additions in the same order.

use super::pool::{for_rows, threads};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Which parts come before which. A clone is empty.
#[derive(Debug, Default)]
pub struct Precedence {
    /// The parts that come after each, one part's behind the other's; where they end.
    after: Vec<u32>,
    ends: Vec<usize>,
    /// How many come before each.
    before: Vec<u32>,
    /// Parts in an order that one thread can follow: each after those that come before it, and otherwise near those before it in number.
    line: Vec<usize>,
    /// Parts by colour, and by number within a colour.
    ranks: Vec<u32>,
    /// The least time that each has taken [ns], where that is measured; else empty.
    times: Vec<AtomicU64>,
    state: Mutex<State>,
}

/// How far a run has come.
#[derive(Debug, Default)]
struct State {
    /// How many parts before each are not done.
    left: Vec<AtomicU32>,
    /// By thread: how many of its parts have been taken, and these.
    shares: Vec<(AtomicUsize, Vec<u32>)>,
}

impl State {
    /// Begins a run of parts in this order, each after so many, with so many threads.
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

    /// The next part of a share, if all are done that come before it.
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

/// So often a thread looks whether a part can be taken before it lets others have the processor.
const PATIENCE: u32 = 200;

/// Threads for which bounds are given.
const THREADS: [usize; 3] = [8, 16, 64];

impl Precedence {
    /// That of parts of these colours, each of which writes to places of these others: of two that do, the one of the lower colour comes
    /// first. Two of one colour must not write to the same place.
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

    /// How many parts there are.
    pub fn parts(&self) -> usize {
        self.before.len()
    }

    /// Parts in the order of one thread.
    pub fn line(&self) -> &[usize] {
        &self.line
    }

    /// The parts that come after one.
    fn after(&self, part: usize) -> &[u32] {
        let from = if part == 0 { 0 } else { self.ends[part - 1] };
        &self.after[from..self.ends[part]]
    }

    /// Calls `work` for each part once, on all threads, each after those that come before it. A thread takes parts of neighbouring numbers,
    /// and those of others where none of its own can be taken.
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
                    // Others are at work on what comes before; they may be waiting for a processor.
                    idle += 1;
                    if idle < PATIENCE { std::hint::spin_loop() } else { std::thread::yield_now() }
                }
            }
        });
    }

    /// From now on the time is kept that each part takes, or no longer.
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

    /// How many parts of this size at most there are, the time that all of them take, and by how much some numbers of threads can be
    /// faster at most, from the times of parts alone; nothing where no times have been kept.
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

    /// When all parts are done, if so many threads take them as [`Precedence::run`] has them do, each takes its time, and nothing else
    /// takes time.
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

/// Parts in an order that follows these colours, each after those of lower ones beside it.
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

/// Says that a part has failed, if it has: nothing waits for what comes after it then.
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

    /// A ring of parts that each write to both neighbours.
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
