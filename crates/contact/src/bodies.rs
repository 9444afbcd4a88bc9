//! Which peridynamic solid each particle belongs to.

use super::driver::NO_BODY;
use perigrain_base::math::forest::{find, join};
use perigrain_peri::families::Families;

/// The solid of each of `n` particles: the smallest index among all particles connected by initial bonds,
/// broken ones included; `NO_BODY` for particles that never had a bond.
pub fn solids(families: &Families, n: usize) -> Vec<u32> {
    let mut root: Vec<u32> = (0..n as u32).collect();
    let mut bonded = vec![false; n];
    families.bonds_as_kept(true, |i, j| {
        (bonded[i as usize], bonded[j as usize]) = (true, true);
        if root[i as usize] != root[j as usize] {
            join(&mut root, i, j);
        }
    });
    (0..n as u32).map(|i| if bonded[i as usize] { find(&mut root, i) } else { NO_BODY }).collect()
}
