//! The thread pool and loops over parts; the only user of rayon.

use std::sync::{Arc, PoisonError, RwLock};

use rayon::ThreadPool;

static POOL: RwLock<Option<Arc<ThreadPool>>> = RwLock::new(None);

/// Room on the stack of each thread: loops compiled without optimisation need some megabytes.
const STACK: usize = 16 << 20;

/// Sets the number of threads for everything that follows; 0 means all cores. Returns what was obtained:
/// one thread if the system grants no more.
pub fn set_threads(n: usize) -> usize {
    let n = if n == 0 { std::thread::available_parallelism().map_or(1, usize::from) } else { n };
    let pool = if n > 1 {
        rayon::ThreadPoolBuilder::new().num_threads(n).stack_size(STACK).build().ok()
    } else {
        None
    };
    *POOL.write().unwrap_or_else(PoisonError::into_inner) = pool.map(Arc::new);
    threads()
}

/// The number of threads in use.
pub fn threads() -> usize {
    pool().map_or(1, |p| p.current_num_threads())
}

/// The calling thread's number, below [`threads`]: for scratch memory of one piece per thread.
pub fn slot() -> usize {
    rayon::current_thread_index().unwrap_or(0)
}

fn pool() -> Option<Arc<ThreadPool>> {
    POOL.read().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Runs `work` on a thread of the pool if there is one: loops inside it start without handing over between threads,
/// which takes longer than a loop over a few thousand particles.
pub fn inside<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    match pool() {
        None => work(),
        Some(pool) => pool.install(work),
    }
}

/// Runs `work` inside the pool if there is one and `parts` are worth it, else right here.
pub(super) fn enter<R: Send>(parts: usize, work: impl FnOnce(bool) -> R + Send) -> R {
    if parts < 2 {
        return work(false);
    }
    match pool() {
        None => work(false),
        Some(pool) => pool.install(|| work(true)),
    }
}

/// Calls `f` once for each of `n` parts, in any order; parts must not write what others touch.
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

/// Calls `f` for the parts 0, 2, 4, ..., and for each of 1, 3, 5, ... after the two beside it: part `k` may write into part
/// `k + 1` as well (the last one into the first if there is an even number of them), and every particle receives its additions in
/// the same order for any number of threads.
pub fn two_colours(n: usize, f: impl Fn(usize) + Sync) {
    let f = &f;
    enter(n, |threaded| {
        if threaded {
            (0..2).for_each(|colour| halve(0, (n + 1 - colour) / 2, &|k| f(2 * k + colour)));
            return;
        }
        // An odd part right after the two even ones beside it: what it touches is in fast memory still.
        for even in (0..n).step_by(2) {
            f(even);
            if even > 0 {
                f(even - 1);
            }
        }
        if n > 0 && n.is_multiple_of(2) {
            f(n - 1);
        }
    });
}

/// Halves a range of parts until one is left; idle threads steal the upper halves.
fn halve(lo: usize, hi: usize, f: &(impl Fn(usize) + Sync)) {
    if hi - lo < 2 {
        (lo..hi).for_each(f);
        return;
    }
    let mid = lo.midpoint(hi);
    rayon::join(|| halve(lo, mid, f), || halve(mid, hi, f));
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn every_part_runs_once() {
        for n in [0, 1, 2, 7, 64] {
            let hits: Vec<AtomicUsize> = (0..n).map(|_| AtomicUsize::new(0)).collect();
            for_rows(n, |k| {
                hits[k].fetch_add(1, Ordering::Relaxed);
            });
            two_colours(n, |k| {
                hits[k].fetch_add(1, Ordering::Relaxed);
            });
            assert!(hits.iter().all(|h| h.load(Ordering::Relaxed) == 2));
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
    fn second_colour_starts_after_the_first() {
        set_threads(2);
        let done = AtomicUsize::new(0);
        two_colours(9, |k| {
            // Parts 0, 2, 4, 6, 8 come first.
            if k % 2 == 1 {
                assert!(done.load(Ordering::SeqCst) >= 5);
            }
            done.fetch_add(1, Ordering::SeqCst);
        });
        set_threads(1);
    }
}
