//! Contacts of a powder's grains with walls.

use super::deeds::{Deed, side};
use super::side::{Side, WIDTH};
use super::{Manner, Material, State, TOLD};
use perigrain_base::math::elementary::exp;
use perigrain_world::contacts::Contacts;

/// By which factor a wall pushes more, far beyond what contact laws hold for, so that no grain is pressed through it:
/// 1 + exp(10.7 δ/R − 10) with the depth below the first surface, as LAMMPS has it.
pub fn far_pushed(depth: f64, first: f64) -> f64 {
    1.0 + exp(10.7 * depth / first - 10.0)
}

/// Gathers how much nearer the wall comes to each grain: grains and depths of the contacts `memory` is about.
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

/// Presses grain `k` with the wall; `told` gets what the rest of the law must know.
pub fn press(
    m: &Material,
    s: &State,
    k: usize,
    radius: f64,
    depth: f64,
    memory: &mut [f64],
    told: &mut [f64],
    manner: Manner,
) -> Deed {
    let mut one = Side::read(&memory[..WIDTH]);
    let (force, a, deed) = side(m, &s.grain(m, k, radius), depth, &mut one, 1.0, manner);
    one.write(memory);
    let far = far_pushed(one.first_depth, s.first[k]);
    let force = force * far;
    let damped = if manner.takes_before() { told[1] } else { 0.5 * m.plane() * a };
    told[..TOLD].copy_from_slice(&[force, damped, one.area, deed.energy * far]);
    deed
}
