//! One pass over all positions: their bounds, particles with no finite place, particles outside a periodic box, and the longest
//! displacement.

use super::Domain;
use perigrain_base::math::vec3::{Vec3, sub};
use perigrain_base::par;

/// The result of a pass over all positions.
#[derive(Clone, Debug)]
pub struct Extent {
    /// The corners of a box around all of them [length]; of a tilted box, around their [`Domain::upright`] places.
    pub corners: [Vec3; 2],
    /// The first one that is not finite.
    pub bad: Option<usize>,
    /// Particles beyond periodic faces, in order.
    pub out: Vec<usize>,
}

impl Extent {
    /// Makes the pass; `None` if there are no positions.
    pub fn of(x: &[Vec3], domain: &Domain) -> Option<Self> {
        let periodic = [0, 1, 2].map(|d| domain.boundary.periodic(d));
        let away = |x: &Vec3| (0..3).any(|d| periodic[d] && (x[d] < domain.lo[d] || x[d] >= domain.hi[d]));
        if domain.tilted() {
            let part = |range: std::ops::Range<usize>| {
                let upright: Vec<Vec3> = x[range.clone()].iter().map(|x| domain.upright(x)).collect();
                let (corners, finite) = corners(&upright);
                let nowhere = |x: &Vec3| !x.iter().all(|a| a.is_finite());
                let bad = if finite { None } else { x[range.clone()].iter().position(nowhere) };
                let out = range.clone().filter(|&i| away(&upright[i - range.start])).collect();
                Self { corners, bad: bad.map(|k| range.start + k), out }
            };
            return par::reduce(x.len(), part, Self::join);
        }
        let part = |range: std::ops::Range<usize>| {
            let some = &x[range.clone()];
            let (corners, finite) = corners(some);
            let bad = if finite { None } else { some.iter().position(|x| !x.iter().all(|a| a.is_finite())) };
            let leaves = corners.iter().any(away);
            let out = if leaves { range.clone().filter(|&i| away(&x[i])).collect() } else { vec![] };
            Self { corners, bad: bad.map(|k| range.start + k), out }
        };
        par::reduce(x.len(), part, Self::join)
    }

    fn join(mut self, mut other: Self) -> Self {
        let [lo, hi] = &mut self.corners;
        for d in 0..3 {
            lo[d] = lo[d].min(other.corners[0][d]);
            hi[d] = hi[d].max(other.corners[1][d]);
        }
        self.bad = self.bad.or(other.bad);
        self.out.append(&mut other.out);
        self
    }
}

/// The corners of a box around some positions, and whether all are finite.
fn corners(x: &[Vec3]) -> ([Vec3; 2], bool) {
    let (mut lo, mut hi, mut zero) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], [0.0; 3]);
    for x in x {
        for d in 0..3 {
            lo[d] = if x[d] < lo[d] { x[d] } else { lo[d] };
            hi[d] = if x[d] > hi[d] { x[d] } else { hi[d] };
            // Not zero any more from the first one on that is not finite.
            zero[d] += x[d] * 0.0;
        }
    }
    ([lo, hi], zero == [0.0; 3])
}

/// The square of the longest displacement from positions `held` to positions `x`, a row for each particle in both [length²]: 0
/// without particles, infinite where a displacement is no finite number.
pub fn farthest(x: &[Vec3], held: &[Vec3]) -> f64 {
    let of = |range: std::ops::Range<usize>| {
        x[range.clone()].iter().zip(&held[range]).fold(0.0, |most, (x, held)| {
            let d = sub(*x, *held);
            // What is no number must not be overlooked: of it and another one the other is the lesser.
            let square = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).min(f64::INFINITY);
            if square > most { square } else { most }
        })
    };
    par::reduce(x.len(), of, f64::max).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Boundary, Face};

    #[test]
    fn one_pass_finds_corners_and_particles_outside_or_nowhere() {
        let domain = Domain::new(
            [0.0; 3],
            [10.0; 3],
            Boundary([[Face::Periodic; 2], [Face::Fixed; 2], [Face::Shrink; 2]]),
        );
        assert!(Extent::of(&[], &domain).is_none());
        let mut x: Vec<Vec3> = (0..5000).map(|i| [f64::from(i % 10), 5.0, f64::from(i) * 0.01]).collect();
        let quiet = Extent::of(&x, &domain).unwrap();
        assert_eq!(
            (quiet.corners, quiet.bad, quiet.out),
            ([[0.0, 5.0, 0.0], [9.0, 5.0, 49.99]], None, vec![])
        );
        // Beyond a face that does not repeat no particle is wrapped.
        (x[7][0], x[4100][0], x[12][1]) = (-0.5, 10.0, 77.0);
        let found = Extent::of(&x, &domain).unwrap();
        assert_eq!((found.corners, found.bad), ([[-0.5, 5.0, 0.0], [10.0, 77.0, 49.99]], None));
        assert_eq!(found.out, [7, 4100]);
        (x[3000][2], x[4000][1]) = (f64::NAN, f64::INFINITY);
        assert_eq!(Extent::of(&x, &domain).unwrap().bad, Some(3000));
    }

    #[test]
    fn the_longest_way_of_all_counts_and_positions_without_a_number_are_found() {
        let held: Vec<Vec3> = (0..5000).map(|i| [f64::from(i), 1.0, -2.0]).collect();
        let mut x = held.clone();
        assert_eq!((farthest(&[], &[]), farthest(&x, &held)), (0.0, 0.0));
        (x[17][0], x[4711][2]) = (18.0, -4.0);
        assert_eq!(farthest(&x, &held), 4.0);
        x[2000][1] = f64::NAN;
        assert_eq!(farthest(&x, &held), f64::INFINITY);
    }
}
