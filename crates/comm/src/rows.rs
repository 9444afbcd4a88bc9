//! Rows of numbers found by ranks, collected on all of them.

use super::numbers::{next, put};
use super::present;

/// A row: a key of integers, and values.
pub type Row<const K: usize, const N: usize> = ([u32; K], [f64; N]);

/// The rows of all ranks, ordered by key; rows of equal key in rank order.
pub fn of_all<const K: usize, const N: usize>(own: impl IntoIterator<Item = Row<K, N>>) -> Vec<Row<K, N>> {
    let mut letter = vec![];
    for (about, numbers) in own {
        put(&mut letter, &about);
        put(&mut letter, &numbers);
    }
    let mut all = vec![];
    for piece in present().pieces(letter) {
        let mut rest = &piece[..];
        while let Some(row) = next(&mut rest).zip(next(&mut rest)) {
            all.push(row);
        }
    }
    all.sort_by_key(|(about, _)| *about);
    all
}

/// Whether `here` is true on all ranks.
pub fn all_agree(here: bool) -> bool {
    let mut against = [if here { 0.0 } else { 1.0 }];
    present().most(&mut against);
    against == [0.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_back_in_order() {
        let own = [([7, 1], [0.5]), ([2, 9], [-0.0]), ([2, 9], [1.5])];
        assert_eq!(of_all(own), [own[1], own[2], own[0]]);
        assert_eq!(of_all([([3], []), ([1], [])]), [([1], []), ([3], [])]);
        assert!(all_agree(true) && !all_agree(false));
    }
}
