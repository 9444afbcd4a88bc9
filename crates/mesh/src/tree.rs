//! Bounding volume hierarchy: triangles that may meet a box, a bond or a ray.

use super::{Triangle, bounds};

/// Largest number of triangles in a leaf.
const LEAF: usize = 4;
/// Depth that no tree over at most 2³² triangles exceeds.
const DEEPEST: usize = 64;

#[derive(Clone, Debug)]
struct Node {
    lo: [f64; 3],
    hi: [f64; 3],
    /// A leaf's first triangle, or the second child; the first child is the next node.
    first: u32,
    /// Number of triangles in a leaf; 0 for inner nodes.
    count: u32,
}

/// A tree over the bounding boxes of triangles.
#[derive(Clone, Debug, Default)]
pub struct Tree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

impl Tree {
    /// A tree over these triangles.
    pub fn new(triangles: &[Triangle]) -> Self {
        let mut tree = Self { nodes: vec![], order: (0..triangles.len() as u32).collect() };
        let middles: Vec<[f64; 3]> =
            triangles.iter().map(|[a, b, c]| [0, 1, 2].map(|d| a[d] + b[d] + c[d])).collect();
        if !triangles.is_empty() {
            let mut order = std::mem::take(&mut tree.order);
            tree.split(&mut order, 0, triangles, &middles);
            tree.order = order;
        }
        tree
    }

    fn split(&mut self, order: &mut [u32], first: usize, triangles: &[Triangle], middles: &[[f64; 3]]) {
        let (lo, hi) = bounds(order.iter().flat_map(|k| &triangles[*k as usize]));
        let here = self.nodes.len();
        self.nodes.push(Node { lo, hi, first: first as u32, count: order.len() as u32 });
        if order.len() <= LEAF {
            return;
        }
        let (from, to) = bounds(order.iter().map(|k| &middles[*k as usize]));
        let axis = (0..3).max_by(|a, b| (to[*a] - from[*a]).total_cmp(&(to[*b] - from[*b]))).unwrap_or(0);
        let half = order.len() / 2;
        let middle = |k: &u32| middles[*k as usize][axis];
        order.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)).then(a.cmp(b)));
        let (low, high) = order.split_at_mut(half);
        self.split(low, first, triangles, middles);
        (self.nodes[here].first, self.nodes[here].count) = (self.nodes.len() as u32, 0);
        self.split(high, first + half, triangles, middles);
    }

    /// The bounding box of all triangles.
    pub fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        self.nodes.first().map(|n| (n.lo, n.hi))
    }

    /// Calls `visit` for every triangle of the leaves that overlap the box, until it returns stop.
    #[inline]
    pub fn meet(&self, lo: [f64; 3], hi: [f64; 3], mut visit: impl FnMut(u32) -> bool) {
        let mut waiting = [0; DEEPEST];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let at = waiting[depth];
            let node = &self.nodes[at];
            if (0..3).any(|d| node.lo[d] > hi[d] || node.hi[d] < lo[d]) {
                continue;
            }
            if node.count == 0 {
                // The first child is visited first.
                (waiting[depth], waiting[depth + 1]) = (node.first as usize, at + 1);
                depth += 2;
                continue;
            }
            let members = node.first as usize..(node.first + node.count) as usize;
            if self.order[members].iter().any(|k| !visit(*k)) {
                return;
            }
        }
    }
}
