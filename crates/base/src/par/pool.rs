//! The thread pool and loops over parts; the only code that uses rayon.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, PoisonError, RwLock};
use std::thread;
use std::time::{Duration, Instant};

use super::{CHUNK, pays};
use rayon::{ThreadPool, Yield};

static POOL: RwLock<Option<Arc<Pool>>> = RwLock::new(None);
/// The number of threads: read several times per step, where a lock would cost as much as moving a few
/// particles.
static THREADS: AtomicUsize = AtomicUsize::new(1);

/// The threads, and whether they are looking for work.
struct Pool {
    threads: ThreadPool,
    /// Number + 1 of the thread whose work the others look for; 0 while they sleep.
    awake: Arc<AtomicUsize>,
}

/// Stack size of each thread [bytes]: loops compiled without optimization need some megabytes.
pub const STACK: usize = 16 << 20;

/// Maximum number of threads, however many are requested: results are the same.
const MOST: usize = 1024;

/// Sets the number of threads from now on; 0 means all cores. Returns the number obtained: one thread if the
/// system grants no more.
pub fn set_threads(n: usize) -> usize {
    let n = if n == 0 { std::thread::available_parallelism().map_or(1, usize::from) } else { n };
    let n = n.min(MOST);
    let pool = if n > 1 {
        rayon::ThreadPoolBuilder::new().num_threads(n).stack_size(STACK).build().ok()
    } else {
        None
    };
    let pool = pool.map(|threads| Arc::new(Pool { threads, awake: Arc::default() }));
    THREADS.store(pool.as_ref().map_or(1, |p| p.threads.current_num_threads()), Ordering::Relaxed);
    *POOL.write().unwrap_or_else(PoisonError::into_inner) = pool;
    threads()
}

/// The number of threads in use: one if more do not pay off.
#[inline]
pub fn threads() -> usize {
    if pays::alone() { 1 } else { most_threads() }
}

/// The largest number of threads that may be used.
#[inline]
pub fn most_threads() -> usize {
    THREADS.load(Ordering::Relaxed)
}

/// The calling thread's index, below [`most_threads`]: for per-thread scratch memory.
pub fn slot() -> usize {
    rayon::current_thread_index().unwrap_or(0)
}

fn pool() -> Option<Arc<Pool>> {
    POOL.read().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Runs `work` on a thread of the pool, if there is one: loops inside it start without a handover between
/// threads, which takes longer than a loop over a few thousand particles.
pub fn inside<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    match pool() {
        None => work(),
        Some(pool) => {
            let (stop, ranks) = (crate::stop::present(), crate::comm::present());
            let mut work = Once::new(|| crate::comm::run_as(ranks, || stop.heed(work)));
            pool.install(&mut || work.run());
            work.out()
        }
    }
}

/// Runs `work` inside the pool if there is one and `parts` are enough, else on this thread.
#[inline]
pub(super) fn enter<R: Send>(parts: usize, work: impl FnOnce(bool) -> R + Send) -> R {
    match entered(parts) {
        None => work(false),
        Some(pool) => {
            let mut work = Once::new(|| work(true));
            pool.install(&mut || work.run());
            work.out()
        }
    }
}

/// The pool, awake, if there is one and `parts` are enough.
#[inline]
fn entered(parts: usize) -> Option<Arc<Pool>> {
    if parts < 2 {
        return None;
    }
    woken()
}

/// The pool, awake, if there is one.
fn woken() -> Option<Arc<Pool>> {
    pays::shares();
    if pays::alone() {
        return None;
    }
    let pool = pool()?;
    pool.wake();
    Some(pool)
}

/// Work as a trait object: all handover code is then compiled once, here, instead of for each loop of each
/// crate, where it took a quarter to a half of the compile time; an indirect call costs little compared with
/// the handover.
type Work<'a> = &'a mut (dyn FnMut() + Send);

/// Work to be done once, and its result.
struct Once<F, R> {
    work: Option<F>,
    out: Option<R>,
}

impl<R, F: FnOnce() -> R> Once<F, R> {
    fn new(work: F) -> Self {
        Self { work: Some(work), out: None }
    }

    fn run(&mut self) {
        self.out = self.work.take().map(|work| work());
    }

    fn out(self) -> R {
        let Some(out) = self.out else { unreachable!("work that has not been done has ended") };
        out
    }
}

impl Pool {
    /// Runs the work on a thread of the pool.
    fn install(&self, work: Work) {
        self.threads.install(work);
    }

    /// Makes the other threads look for work of this one for a while: between two loops of a step they would
    /// fall asleep, and waking one takes longer than many loops. A thread outside the pool must wait for a
    /// pool thread anyway.
    fn wake(&self) {
        let Some(home) = self.threads.current_thread_index() else { return };
        if self.awake.load(Ordering::Relaxed) == home + 1 {
            return;
        }
        self.awake.store(home + 1, Ordering::Relaxed);
        let awake = self.awake.clone();
        self.threads.spawn_broadcast(move |thread| {
            if thread.index() != home {
                look_out(&awake);
            }
        });
    }
}

/// How long an idle thread looks for work.
const PATIENCE: Duration = Duration::from_millis(1);

thread_local! {
    /// Whether this thread is looking for work, or waits for another one to finish.
    static LOOKS_OUT: Cell<Looks> = const { Cell::new(Looks::Not) };
}

/// State of a thread without work of its own.
#[derive(Clone, Copy, PartialEq)]
enum Looks {
    Not,
    ForWork,
    ForAnEnd,
}

/// Executes available work until there has been none for a while.
fn look_out(awake: &AtomicUsize) {
    match LOOKS_OUT.get() {
        Looks::Not => LOOKS_OUT.set(Looks::ForWork),
        // The work found may be another call of this function.
        Looks::ForWork => return,
        // A thread that waits for this one must not wait until it times out: it will be woken again.
        Looks::ForAnEnd => return awake.store(0, Ordering::Relaxed),
    }
    let mut last = Instant::now();
    while last.elapsed() < PATIENCE && !pays::alone() {
        if rayon::yield_now() == Some(Yield::Executed) {
            last = Instant::now();
        } else {
            thread::yield_now();
        }
    }
    LOOKS_OUT.set(Looks::Not);
    awake.store(0, Ordering::Relaxed);
}

/// Runs both, the second on another thread if one is looking for work. A thread that has finished its part
/// does other work until the other part ends: [`rayon::join`] alone soon falls asleep.
pub(super) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    let (mut a, mut b) = (Once::new(a), Once::new(b));
    join_work(&mut || a.run(), &mut || b.run());
    (a.out(), b.out())
}

/// Like [`join`].
fn join_work(a: Work, b: Work) {
    let done = AtomicBool::new(false);
    let first = || {
        a();
        let looked = LOOKS_OUT.replace(Looks::ForAnEnd);
        let since = Instant::now();
        while !done.load(Ordering::Acquire) && since.elapsed() < PATIENCE {
            if rayon::yield_now() != Some(Yield::Executed) {
                thread::yield_now();
            }
        }
        LOOKS_OUT.set(looked);
    };
    let second = || {
        b();
        done.store(true, Ordering::Release);
    };
    rayon::join(first, second);
}

/// Runs two tasks concurrently, if there are threads and more rows than one chunk: starting another thread
/// takes longer than the work for a few grains.
pub fn both<A: Send, B: Send>(
    rows: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    enter(rows.div_ceil(CHUNK), |threaded| if threaded { join(a, b) } else { (a(), b()) })
}

/// Calls `f` once for each of `n` parts, in any order; parts must not write data that others access.
pub fn for_rows(n: usize, f: impl Fn(usize) + Sync) {
    let f = &f;
    enter(n, |threaded| {
        if threaded {
            halve(0, n, f);
        } else {
            (0..n).for_each(f);
        }
    });
}

/// [`for_rows`] if that is `worth` starting other threads, else part by part.
pub fn for_rows_if(worth: bool, n: usize, f: impl Fn(usize) + Sync) {
    if worth { for_rows(n, f) } else { (0..n).for_each(f) }
}

/// Calls `f` for the parts 0, 2, 4, ..., and for each of 1, 3, 5, ... after its two neighbours: part `k` may
/// also write into part `k + 1` (the last one into the first if their number is even), and every particle
/// receives its additions in the same order for any number of threads.
pub fn two_colours(n: usize, f: impl Fn(usize) + Sync) {
    let f = &f;
    enter(n, |threaded| {
        if threaded {
            (0..2).for_each(|colour| halve(0, (n + 1 - colour) / 2, &|k| f(2 * k + colour)));
            return;
        }
        in_turn(n).for_each(f);
    });
}

/// The single-thread order of the parts in [`two_colours`]: an odd part follows its two even neighbours, so
/// that its data is still in cache.
pub fn in_turn(n: usize) -> impl Iterator<Item = usize> {
    let beside = |even: usize| [Some(even), even.checked_sub(1)].into_iter().flatten();
    let last = (n > 0 && n.is_multiple_of(2)).then(|| n - 1);
    (0..n).step_by(2).flat_map(beside).chain(last)
}

/// Halves a range of parts until one is left; idle threads steal the upper halves.
fn halve(lo: usize, hi: usize, f: &(dyn Fn(usize) + Sync)) {
    if hi - lo < 2 {
        (lo..hi).for_each(f);
        return;
    }
    let mid = lo.midpoint(hi);
    join_work(&mut || halve(lo, mid, f), &mut || halve(mid, hi, f));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_runs_once() {
        for n in [0, 1, 2, 7, 64] {
            let hits: Vec<AtomicUsize> = (0..n).map(|_| AtomicUsize::new(0)).collect();
            for worth in [false, true] {
                for_rows_if(worth, n, |k| {
                    hits[k].fetch_add(1, Ordering::Relaxed);
                });
            }
            two_colours(n, |k| {
                hits[k].fetch_add(1, Ordering::Relaxed);
            });
            assert!(hits.iter().all(|h| h.load(Ordering::Relaxed) == 3));
        }
    }

    #[test]
    fn odd_parts_follow_both_even_ones_beside_them() {
        set_threads(1);
        for n in [1, 2, 3, 8, 9] {
            let order = std::sync::Mutex::new(vec![]);
            two_colours(n, |k| order.lock().unwrap().push(k));
            let order = order.into_inner().unwrap();
            let at = |k: usize| order.iter().position(|o| *o == k % n);
            for k in (1..n).step_by(2) {
                assert!(at(k) > at(k - 1) && (at(k) > at(k + 1)), "{order:?}");
            }
        }
    }

    #[test]
    fn an_odd_part_starts_after_its_neighbours_have_ended() {
        set_threads(2);
        let ended: Vec<AtomicBool> = (0..9).map(|_| AtomicBool::new(false)).collect();
        two_colours(9, |k| {
            if k % 2 == 1 {
                // True for any number of threads, which other tests may set meanwhile.
                assert!([k - 1, k + 1].iter().all(|beside| ended[*beside].load(Ordering::SeqCst)));
            }
            ended[k].store(true, Ordering::SeqCst);
        });
        set_threads(1);
    }
}
