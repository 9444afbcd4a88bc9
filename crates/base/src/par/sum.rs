//! Reductions along a tree that depends only on the number of rows: the same bits for any number of threads.

use std::ops::Range;

use super::pool::{self, enter};
use super::{CHUNK, Split};

/// Maps every chunk of [`CHUNK`] indices below `n` and joins the results along a fixed tree; `None` if `n` is
/// 0.
pub fn reduce<T: Send>(
    n: usize,
    map: impl Fn(Range<usize>) -> T + Sync,
    join: impl Fn(T, T) -> T + Sync,
) -> Option<T> {
    fn tree<T: Send>(
        range: Range<usize>,
        threaded: bool,
        map: &(impl Fn(Range<usize>) -> T + Sync),
        join: &(impl Fn(T, T) -> T + Sync),
    ) -> T {
        if range.len() <= CHUNK {
            return map(range);
        }
        let mid = range.start + range.len().div_ceil(CHUNK).div_ceil(2) * CHUNK;
        let (low, high) = (range.start..mid, mid..range.end);
        let (a, b) = if threaded {
            pool::join(|| tree(low, true, map, join), || tree(high, true, map, join))
        } else {
            (tree(low, false, map, join), tree(high, false, map, join))
        };
        join(a, b)
    }
    if n == 0 {
        return None;
    }
    Some(enter(n.div_ceil(CHUNK), |threaded| tree(0..n, threaded, &map, &join)))
}

/// Calls `map(first row, chunk)` for every chunk of [`CHUNK`] rows of columns of equal length, like
/// [`each`](super::each), and joins the results along a fixed tree; `None` if there are no rows.
pub fn reduce_each<S: Split, T: Send>(
    columns: S,
    map: impl Fn(usize, S) -> T + Sync,
    join: impl Fn(T, T) -> T + Sync,
) -> Option<T> {
    fn tree<S: Split, T: Send>(
        start: usize,
        columns: S,
        threaded: bool,
        map: &(impl Fn(usize, S) -> T + Sync),
        join: &(impl Fn(T, T) -> T + Sync),
    ) -> T {
        let n = columns.rows();
        if n <= CHUNK {
            return map(start, columns);
        }
        let mid = n.div_ceil(CHUNK).div_ceil(2) * CHUNK;
        let (low, high) = columns.cut(mid);
        if threaded {
            let (a, b) =
                pool::join(|| tree(start, low, true, map, join), || tree(start + mid, high, true, map, join));
            return join(a, b);
        }
        // From the end: the data that the previous loop accessed last is still in cache.
        let b = tree(start + mid, high, false, map, join);
        join(tree(start, low, false, map, join), b)
    }
    let n = columns.rows();
    (n > 0).then(|| enter(n.div_ceil(CHUNK), |threaded| tree(0, columns, threaded, &map, &join)))
}

/// Joins the results of chunks along the tree of [`reduce`]; `None` if there are no chunks.
pub fn along_tree<T: Copy>(came: &[T], join: impl Fn(T, T) -> T) -> Option<T> {
    fn tree<T: Copy>(came: &[T], join: &impl Fn(T, T) -> T) -> Option<T> {
        if came.len() < 2 {
            return came.first().copied();
        }
        let (low, high) = came.split_at(came.len().div_ceil(2));
        tree(low, join).zip(tree(high, join)).map(|(a, b)| join(a, b))
    }
    tree(came, &join)
}

/// Element-wise a + b: joins sums of several numbers.
pub fn add<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// The sum of `term(i)` for `i` below `n`: in order within a chunk, chunks along a fixed tree.
pub fn sum(n: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    reduce(n, |range| range.fold(0.0, |sum, i| sum + term(i)), |a, b| a + b).unwrap_or(0.0)
}

/// The largest `term(i)` for `i` below `n`; negative infinity if `n` is 0. NaNs are ignored.
pub fn max(n: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    reduce(n, |range| range.fold(f64::NEG_INFINITY, |m, i| m.max(term(i))), f64::max)
        .unwrap_or(f64::NEG_INFINITY)
}

/// Reduces `first` and a list of numbers by `better`, which must be independent of the order: eight at a
/// time.
pub fn best(list: &[f64], first: f64, better: impl Fn(f64, f64) -> f64 + Sync) -> f64 {
    let of = |range: Range<usize>| {
        let (eights, rest) = list[range].as_chunks::<8>();
        let mut best = [first; 8];
        for eight in eights {
            best.iter_mut().zip(eight).for_each(|(best, a)| *best = better(*best, *a));
        }
        best.into_iter().chain(rest.iter().copied()).fold(first, &better)
    };
    reduce(list.len(), of, &better).unwrap_or(first)
}

#[cfg(test)]
mod tests {
    use super::super::set_threads;
    use super::*;

    #[test]
    fn sums_have_the_same_bits_for_any_thread_count() {
        let term = |i: usize| ((i * 7919) % 1013) as f64 * 0.1 - 37.0 / (i as f64 + 1.0);
        let n = 11 * CHUNK + 17;
        let bits: Vec<u64> = [1, 2, 8]
            .map(|t| {
                set_threads(t);
                sum(n, term).to_bits()
            })
            .into();
        set_threads(1);
        assert!(bits.windows(2).all(|b| b[0] == b[1]));
        // Rounding of the plain sum: n terms of size 100, 1e-16 each, as a random walk.
        let plain: f64 = (0..n).map(term).sum();
        assert!((sum(n, term) - plain).abs() < 1e-8 * plain.abs().max(1.0));
        assert_eq!(sum(0, term), 0.0);
        let mut rows = vec![0.0; n];
        let write = |start: usize, chunk: &mut [f64]| {
            chunk.iter_mut().enumerate().fold(0.0, |sum, (k, row)| {
                *row = term(start + k);
                sum + *row
            })
        };
        assert_eq!(reduce_each(&mut rows[..], write, |a, b| a + b), Some(sum(n, term)));
        assert_eq!(rows[n - 1], term(n - 1));
        for n in [1, CHUNK, 3 * CHUNK, n] {
            let chunk = |start: usize| (start..n.min(start + CHUNK)).fold(0.0, |sum, i| sum + term(i));
            let came: Vec<f64> = (0..n).step_by(CHUNK).map(chunk).collect();
            assert_eq!(along_tree(&came, |a, b| a + b), Some(sum(n, term)));
        }
        assert_eq!(along_tree(&[] as &[f64], |a, b| a + b), None);
        assert_eq!(max(n, |i| i as f64), (n - 1) as f64);
        for n in [0, 1, 7, 8, 9, n] {
            let list: Vec<f64> = (0..n).map(term).collect();
            assert_eq!(best(&list, -50.0, f64::max), list.iter().copied().fold(-50.0, f64::max));
            let least_above = |a: f64, b: f64| if b > 0.5 && b < a { b } else { a };
            assert_eq!(best(&list, 60.0, least_above), list.iter().copied().fold(60.0, least_above));
        }
    }
}
