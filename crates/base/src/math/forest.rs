//! Disjoint sets (union-find), each named by one of its members.

/// The member that names the set of `k` (the smallest, after [`join`]); `root[k]` leads there, and is
/// initially `k`.
#[inline]
pub fn find(root: &mut [u32], mut k: u32) -> u32 {
    while root[k as usize] != k {
        root[k as usize] = root[root[k as usize] as usize];
        k = root[k as usize];
    }
    k
}

/// Joins the sets of `a` and `b`.
#[inline]
pub fn join(root: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(root, a), find(root, b));
    root[a.max(b) as usize] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_named_by_their_smallest() {
        let mut root: Vec<u32> = (0..6).collect();
        [(4, 5), (1, 4), (2, 3)].into_iter().for_each(|(a, b)| join(&mut root, a, b));
        assert_eq!((0..6).map(|k| find(&mut root, k)).collect::<Vec<_>>(), [0, 1, 2, 2, 1, 1]);
    }
}
