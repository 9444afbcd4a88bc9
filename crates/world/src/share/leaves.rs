//! Sums over the rows of all ranks, leaf by leaf.
//!
//! A leaf is what [`par::CHUNK`] rows give, added up in their order; leaves are added up along a tree. Each rank makes the leaves of its own
//! rows; of leaves that several ranks have rows of, each row's term is handed over. So the bits are those of one process.

use super::{Share, What};
use crate::World;
use perigrain_base::comm::numbers::{put, take};
use perigrain_base::par::{self, CHUNK, add};
use std::ops::Range;

/// The rows of one rank: the first and the last ones, which share their leaf with other ranks' rows, and the leaves in between.
struct Parts {
    first: Range<usize>,
    leaves: Range<usize>,
    last: Range<usize>,
}

impl Parts {
    /// Those of a rank with these rows, of `n`.
    fn of(rows: &Range<usize>, n: usize) -> Self {
        let from = rows.start.next_multiple_of(CHUNK);
        let end = if rows.end == n { n.div_ceil(CHUNK) } else { rows.end / CHUNK };
        // All rows are in the middle of one leaf.
        let leaves = from / CHUNK..end.max(from / CHUNK);
        let first = rows.start..from.min(rows.end);
        let last = (leaves.end * CHUNK).clamp(first.end, rows.end)..rows.end;
        Self { first, leaves, last }
    }

    /// How many terms or sums of terms they give.
    fn len(&self) -> usize {
        self.first.len() + self.leaves.len() + self.last.len()
    }
}

impl World {
    /// Whether sums can be made by ops that act on one rank's rows.
    pub fn sums_by_leaves(&self) -> bool {
        // Rows of a body's tiles lie in many pieces: as many terms would travel as there are rows.
        self.share.as_ref().is_some_and(|share| share.what == What::Grains)
    }

    /// Adds up the term of each row that has one, the same bits for any number of threads and ranks. Where the present op acts on
    /// the rows of one rank, all ranks call this at the same place, and only terms of their own rows are evaluated.
    pub fn sum_rows<const N: usize>(&self, term: impl Fn(usize) -> Option<[f64; N]> + Sync) -> [f64; N] {
        let leaf = |rows: Range<usize>| rows.filter_map(&term).fold([0.0; N], add);
        match self.narrow_share() {
            Some(share) => share.sum_leaves(self.n(), &term, &leaf),
            None => par::reduce(self.n(), leaf, add).unwrap_or([0.0; N]),
        }
    }
}

impl Share {
    fn sum_leaves<const N: usize>(
        &self,
        n: usize,
        term: &(impl Fn(usize) -> Option<[f64; N]> + Sync),
        leaf: &(impl Fn(Range<usize>) -> [f64; N] + Sync),
    ) -> [f64; N] {
        // Grains have one range of rows a rank.
        let rows = self.alone.iter().map(|rows| rows.first().cloned().unwrap_or(0..0));
        let parts: Vec<Parts> = rows.map(|rows| Parts::of(&rows, n)).collect();
        let mut own = vec![];
        let Parts { first, leaves, last } = &parts[self.comm.rank()];
        // A term that is not there changes no sum, and nor does zero, since sums begin with it.
        let terms = |rows: &Range<usize>, own: &mut Vec<u8>| {
            rows.clone().for_each(|i| put(own, &term(i).unwrap_or([0.0; N])));
        };
        terms(first, &mut own);
        let whole = leaves.start * CHUNK..n.min(leaves.end * CHUNK);
        let each = |rows: Range<usize>| vec![leaf(whole.start + rows.start..whole.start + rows.end)];
        for sum in par::reduce(whole.len(), each, |a, b| [a, b].concat()).unwrap_or_default() {
            put(&mut own, &sum);
        }
        terms(last, &mut own);
        self.add_pieces(n, &parts, own)
    }

    /// Has the pieces of all ranks, and adds them up in the order of rows.
    fn add_pieces<const N: usize>(&self, n: usize, parts: &[Parts], own: Vec<u8>) -> [f64; N] {
        let counts: Vec<usize> = parts.iter().map(|parts| parts.len() * size_of::<[f64; N]>()).collect();
        let me = self.comm.rank();
        let mut bytes = vec![0; counts.iter().sum()];
        let before: usize = counts[..me].iter().sum();
        bytes[before..][..own.len()].copy_from_slice(&own);
        self.comm.gather_all(&mut bytes, &counts);
        let mut rest = &bytes[..];
        let mut sums = vec![[0.0; N]; n.div_ceil(CHUNK)];
        for Parts { first, leaves, last } in parts {
            let mut put = |leaf: usize| {
                let mut came = [0.0; N];
                take(&mut rest, &mut came);
                sums[leaf] = add(sums[leaf], came);
            };
            first.clone().for_each(|row| put(row / CHUNK));
            leaves.clone().for_each(&mut put);
            last.clone().for_each(|row| put(row / CHUNK));
        }
        par::along_tree(&sums, add).unwrap_or([0.0; N])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_all_rows_once() {
        let n = 3 * CHUNK + 17;
        for cuts in
            [vec![], vec![5], vec![CHUNK], vec![5, 9, CHUNK + 3], vec![2 * CHUNK, n - 20, n - 3], vec![0, n]]
        {
            let ends: Vec<usize> = [0].into_iter().chain(cuts).chain([n]).collect();
            let mut seen = vec![0; n];
            for rows in ends.windows(2).map(|w| w[0]..w[1]) {
                let Parts { first, leaves, last } = Parts::of(&rows, n);
                let whole = leaves.start * CHUNK..n.min(leaves.end * CHUNK);
                let all = [first, if leaves.is_empty() { 0..0 } else { whole }, last];
                all.into_iter().flatten().for_each(|row| seen[row] += 1);
            }
            assert!(seen.iter().all(|times| *times == 1), "{ends:?}");
        }
    }
}
