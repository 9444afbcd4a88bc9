//! Grains that overlap so far that contact laws mean little.

use super::lists::List;
use super::near::Places;
use super::{Fast, NOWHERE};
use crate::driver::{DEEP, Grains};
use perigrain_base::math::lanes::{PLACE_BITS, place};

impl Fast {
    /// The pair of smallest ids that overlaps by more than [`DEEP`] of the smaller radius, in these lists, and by which part.
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
        // What fills lists up is at places that need not be known.
        let pairs = pairs.filter(|(_, w)| **w >> PLACE_BITS != NOWHERE);
        pairs.filter_map(|(&i, &w)| of(i, w)).min_by_key(|(ids, _)| *ids)
    }
}
