//! Porous aggregates out of dense packings: what lies where a random field of one wavelength is low goes, and what is
//! left without support goes too.

use super::Packing;
use super::nearby::Nearby;
use super::room::Room;
use perigrain_base::math::forest;
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, dot, length};
use perigrain_base::par;
use std::f64::consts::{PI, TAU};

/// Plane waves that make the field: enough that its values are normal.
const WAVES: usize = 64;
/// Spheres hang together whose surfaces are at most so many mean diameters apart: about eight at each in a dense packing.
pub const LINK: f64 = 0.1;

/// What is left of a packing.
pub struct Aggregate {
    /// The spheres that stay, ascending.
    pub kept: Vec<usize>,
    /// How many had no neighbour, or none at one end.
    pub lost: usize,
    /// The direction between the ends, 0 to 2.
    pub axis: usize,
}

/// Keeps spheres of about this volume, then of their connected parts the largest that reaches from end to end, along the
/// longest edge of the room; `None` if there is no such part.
pub fn thin(
    room: &Room,
    p: &Packing,
    volume: f64,
    wavelength: f64,
    stream: &mut ParkMiller,
) -> Option<Aggregate> {
    let values = field(room, &p.x, wavelength, stream);
    let mut order: Vec<usize> = (0..p.x.len()).collect();
    order.sort_by(|a, b| values[*b].total_cmp(&values[*a]).then(a.cmp(b)));
    let mut left = volume;
    let own = |k: usize| 4.0 / 3.0 * PI * p.radius[k].powi(3);
    let count = order.iter().take_while(|&&k| {
        left -= own(k);
        left > -0.5 * own(k)
    });
    let count = count.count();
    let mut high = order[..count].to_vec();
    high.sort_unstable();
    let axis = longest(room);
    let kept = spanning(room, p, &high, axis)?;
    Some(Aggregate { lost: high.len() - kept.len(), kept, axis })
}

/// The longest edge, z of equal ones.
fn longest(room: &Room) -> usize {
    let edge = |d: usize| room.hi[d] - room.lo[d];
    (0..2)
        .filter(|&d| edge(d) > edge(2) * (1.0 + 1e-9))
        .fold(2, |best, d| if edge(d) > edge(best) { d } else { best })
}

/// Values of a random field in places: plane waves with directions and phases at random, which fit into what repeats.
fn field(room: &Room, x: &[Vec3], wavelength: f64, stream: &mut ParkMiller) -> Vec<f64> {
    let waves: Vec<(Vec3, f64)> = (0..WAVES)
        .map(|_| {
            let along: Vec3 = std::array::from_fn(|_| stream.gaussian());
            let number = along.map(|a| a / length(along) * TAU / wavelength);
            let fitting = std::array::from_fn(|d| match room.period[d] {
                l if l > 0.0 => TAU / l * (number[d] * l / TAU).round(),
                _ => number[d],
            });
            (fitting, TAU * stream.uniform())
        })
        .collect();
    let mut values = vec![0.0; x.len()];
    par::each((&mut values[..], x), |_, (values, x)| {
        for (value, x) in values.iter_mut().zip(x) {
            *value = waves.iter().map(|(k, phase)| (dot(*k, *x) + phase).cos()).sum();
        }
    });
    values
}

/// Of the connected parts of `high` the largest that comes within a diameter of both ends.
fn spanning(room: &Room, p: &Packing, high: &[usize], axis: usize) -> Option<Vec<usize>> {
    let x: Vec<Vec3> = high.iter().map(|&k| p.x[k]).collect();
    let radius: Vec<f64> = high.iter().map(|&k| p.radius[k]).collect();
    let mean = 2.0 * radius.iter().sum::<f64>() / radius.len().max(1) as f64;
    let near = Nearby::find(room, &x, &radius, LINK * mean);
    let mut root: Vec<u32> = (0..x.len() as u32).collect();
    for k in 0..x.len() {
        near.row(k).iter().for_each(|&j| forest::join(&mut root, k as u32, j));
    }
    #[derive(Clone, Copy, Default)]
    struct Part {
        size: usize,
        ends: [bool; 2],
    }
    let mut parts = vec![Part::default(); x.len()];
    for k in 0..x.len() {
        let part = &mut parts[forest::find(&mut root, k as u32) as usize];
        part.size += 1;
        part.ends[0] |= x[k][axis] - radius[k] < room.lo[axis] + mean;
        part.ends[1] |= x[k][axis] + radius[k] > room.hi[axis] - mean;
    }
    let reaches = (0..parts.len()).filter(|&k| parts[k].ends == [true; 2]);
    // Of equal ones the first.
    let best = reaches.max_by_key(|&k| (parts[k].size, std::cmp::Reverse(k)))? as u32;
    Some((0..x.len()).filter(|&k| forest::find(&mut root, k as u32) == best).map(|k| high[k]).collect())
}
