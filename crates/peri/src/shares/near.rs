//! Near pairs on ranks: each pushes its own particles.

use crate::energy::Sums;
use crate::families::shares::Shares;
use crate::shares::agreed::to_all;
use perigrain_base::comm::numbers::{next, put};

/// Has the sums that ranks have found of their own particles, which are listed in ascending order, on all of them.
pub(crate) fn sums_everywhere(particles: &[u32], sums: &mut [Sums], shares: &Shares) {
    let mut bytes = vec![];
    for (p, sums) in particles.iter().zip(&*sums) {
        let alone = usize::from(shares.owner[*p as usize]) == shares.me;
        // Most touch nothing.
        if alone && sums.iter().any(|sum| *sum != 0.0) {
            put(&mut bytes, &[*p]);
            put(&mut bytes, sums);
        }
    }
    for (_, bytes) in to_all(&bytes) {
        let mut bytes = &bytes[..];
        while let (Some([p]), Some(own)) = (next(&mut bytes), next(&mut bytes)) {
            if let Ok(at) = particles.binary_search(&p) {
                sums[at] = own;
            }
        }
    }
}
