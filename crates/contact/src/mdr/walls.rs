//! Contacts of plastic grains with walls.

use super::deeds::{Deed, side};
use super::side::{Side, WIDTH};
use super::{Manner, Material, PRECOMPUTED, State};
use perigrain_base::math::elementary::exp;
use perigrain_world::contacts::Contacts;

/// Factor on a wall's force far beyond the validity of contact laws, so that no grain is pressed through it:
/// 1 + exp(10.7 δ/R − 10) with the depth below the original surface, as in LAMMPS.
pub fn far_pushed(depth: f64, first: f64) -> f64 {
    1.0 + exp(10.7 * depth / first - 10.0)
}

/// Collects the approach of the wall to each grain: indices and depths for the contacts in `memory`.
pub fn gather(
    s: &mut State,
    memory: &Contacts,
    keys: &[[u32; 2]],
    contacts: impl Iterator<Item = (usize, f64)>,
) {
    for (key, (k, depth)) in keys.iter().zip(contacts) {
        if s.area_before[k] > 0.0 {
            let side = memory.get(*key).map(Side::read).unwrap_or_default();
            s.mean[k] += side.area * (depth - side.depth) / s.area_before[k];
        }
    }
}

/// Presses grain `k` with the wall; `precomputed` receives the results that the rest of the law needs.
pub fn press(
    m: &Material,
    s: &State,
    k: usize,
    radius: f64,
    depth: f64,
    memory: &mut [f64],
    precomputed: &mut [f64],
    manner: Manner,
) -> Deed {
    let mut one = Side::read(&memory[..WIDTH]);
    let (force, a, deed) = side(m, &s.grain(m, k, radius), depth, &mut one, 1.0, manner);
    one.write(memory);
    let far = far_pushed(one.first_depth, s.first[k]);
    let force = force * far;
    let damped = if manner.takes_before() { precomputed[1] } else { 0.5 * m.plane() * a };
    precomputed[..PRECOMPUTED].copy_from_slice(&[force, damped, one.area, deed.energy * far]);
    deed
}
