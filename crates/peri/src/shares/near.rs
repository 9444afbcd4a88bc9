//! Near pairs on ranks: each searches its part of the cells, and pushes its own particles.

use crate::families::NearPair;
use crate::families::shares::Shares;
use crate::families::view::Sums;
use crate::shares::agreed::to_all;
use perigrain_base::comm::numbers::{next, put};

/// What all ranks have found, each in its part of the cells, in the order of these.
pub(crate) fn pairs_everywhere(own: Vec<NearPair>, me: usize) -> Vec<NearPair> {
    let mut bytes = Vec::with_capacity(size_of_val(&own[..]));
    for NearPair { ends: [i, j], after, within } in &own {
        put(&mut bytes, &[*i, *j, after.to_bits(), within.to_bits()]);
    }
    let of_others = to_all(&bytes);
    let (before, behind) = of_others.split_at(of_others.partition_point(|(rank, _)| *rank < me));
    let mut all = vec![];
    let take = |all: &mut Vec<NearPair>, pieces: &[(usize, Vec<u8>)]| {
        for (_, bytes) in pieces {
            let mut bytes = &bytes[..];
            while let Some([i, j, after, within]) = next(&mut bytes) {
                let [after, within] = [after, within].map(f32::from_bits);
                all.push(NearPair { ends: [i, j], after, within });
            }
        }
    };
    take(&mut all, before);
    all.extend(own);
    take(&mut all, behind);
    all
}

/// Has the sums that ranks have found of their own particles, which are members of some list, on all of them.
pub(crate) fn sums_everywhere((particles, member): (&[u32], &[u32]), sums: &mut [Sums], shares: &Shares) {
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
            let p: u32 = p;
            if let Some(sums) = sums.get_mut(member[p as usize] as usize) {
                *sums = own;
            }
        }
    }
}
