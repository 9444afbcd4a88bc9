//! Grains that overlap too deeply for contact laws.

use super::lists::List;
use super::near::Places;
use super::{Fast, NOWHERE};
use crate::driver::{DEEP, Grains};
use perigrain_base::math::lanes::{PLACE_BITS, place};

impl Fast {
    /// The pair of smallest ids in these lists that overlaps by more than [`DEEP`] of the smaller radius,
    /// with the overlap as a fraction of that radius.
    pub(super) fn find_deep(&self, grains: &Grains, lists: &[List]) -> Option<([u32; 2], f64)> {
        let at = Places::new(grains, &self.shifts);
        let of = |i: u32, w: u32| {
            let (i, j) = (i as usize, place(w));
            let d = at.between(i, w);
            let (ri, rj) = (grains.radius[i], grains.radius[j]);
            let (sum, least) = (ri + rj, ri.min(rj));
            let deep = sum - DEEP * least;
            let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if square >= deep * deep {
                return None;
            }
            let (p, q) = (self.tag[i], self.tag[j]);
            Some(([p.min(q), p.max(q)], (sum - square.sqrt()) / least))
        };
        let pairs = lists.iter().flat_map(|l| l.short.i.iter().zip(&l.short.w));
        // Padding entries of the lists have no valid indices.
        let pairs = pairs.filter(|(_, w)| **w >> PLACE_BITS != NOWHERE);
        pairs.filter_map(|(&i, &w)| of(i, w)).min_by_key(|(ids, _)| *ids)
    }
}
