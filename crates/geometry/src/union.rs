//! Volume, centre and inertia of the body that overlapping spheres make together.
//!
//! The body is cut into slices across z. Area and moments of a slice, a union of discs, are exact (Green's theorem along the arcs of its
//! boundary); the integral over z is taken piece by piece, and pieces are halved until it stands: Gauss and Kronrod, seven points and
//! fifteen.

mod arcs;

use arcs::{Disc, Moments};
use perigrain_base::math::vec3::{Vec3, add, length, scale, sub};
use std::f64::consts::PI;

/// What is integrated: volume, first moments, second moments xx yy zz xy xz yz.
type Sums = [f64; 10];

/// A body made of spheres, of the same density everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Union {
    /// Its volume [volume].
    pub volume: f64,
    /// The middle of its mass [length].
    pub centre: Vec3,
    /// Moments of inertia about that for a density of 1: xx yy zz xy xz yz [length⁵].
    pub inertia: [f64; 6],
}

/// Pieces count as settled at this part of the whole.
const TOLERANCE: f64 = 1e-11;
/// Halvings of a piece.
const DEEPEST: usize = 40;
/// So many spheres may be combined in pairs for the first pieces.
const PAIRS: usize = 12;

impl Union {
    /// The union of spheres at these places; nothing without spheres.
    pub fn new(places: &[Vec3], radii: &[f64]) -> Option<Self> {
        let count = places.len().min(radii.len());
        let (places, radii) = (&places[..count], &radii[..count]);
        if count == 0 {
            return None;
        }
        // About a point among them, and in units of their size, so that no digits are lost.
        let middle = scale(1.0 / count as f64, places.iter().fold([0.0; 3], |a, x| add(a, *x)));
        let reach = places.iter().zip(radii).map(|(x, r)| length(sub(*x, middle)) + r).fold(0.0, f64::max);
        let unit = 1.0 / reach;
        let balls: Vec<(Vec3, f64)> =
            places.iter().zip(radii).map(|(x, r)| (scale(unit, sub(*x, middle)), unit * r)).collect();
        let body =
            Slices { balls, weight: 4.0 / 3.0 * PI * radii.iter().map(|r| (unit * r).powi(3)).sum::<f64>() };
        let sums = body.integral();
        let [volume, x, y, z, xx, yy, zz, xy, xz, yz] = sums;
        let [x, y, z] = [x, y, z].map(|a| a / volume);
        let central =
            [xx - volume * x * x, yy - volume * y * y, zz - volume * z * z].map(|a| a * reach.powi(5));
        let mixed =
            [xy - volume * x * y, xz - volume * x * z, yz - volume * y * z].map(|a| a * reach.powi(5));
        let [a, b, c] = central;
        Some(Self {
            volume: volume * reach.powi(3),
            centre: add(middle, scale(reach, [x, y, z])),
            inertia: [b + c, a + c, a + b, -mixed[0], -mixed[1], -mixed[2]],
        })
    }
}

/// The spheres, and the sum of their volumes.
struct Slices {
    balls: Vec<(Vec3, f64)>,
    weight: f64,
}

impl Slices {
    /// All integrals.
    fn integral(&self) -> Sums {
        let ends = self.ends();
        let mut total = [0.0; 10];
        for pair in ends.windows(2).filter(|pair| pair[0] < pair[1]) {
            // At its ends the integrand goes as a square root; in u, with z as a + (b - a) u² (3 - 2u), it is smooth.
            self.settle([pair[0], pair[1]], [0.0, 1.0], 0, &mut total);
        }
        total
    }

    /// Where the slices change their kind: at tops and bottoms of spheres, and of the circles in which few of them meet.
    fn ends(&self) -> Vec<f64> {
        let mut ends: Vec<f64> = self.balls.iter().flat_map(|(x, r)| [x[2] - r, x[2] + r]).collect();
        for (i, (a, p)) in self.balls.iter().enumerate().filter(|_| self.balls.len() <= PAIRS) {
            for (b, q) in &self.balls[i + 1..] {
                let way = sub(*b, *a);
                let d = length(way);
                if d >= p + q || d <= (p - q).abs() {
                    continue;
                }
                let along = 0.5 * (d * d + p * p - q * q) / d;
                let across = (p * p - along * along).max(0.0).sqrt();
                let rise = across * (1.0 - (way[2] / d).powi(2)).max(0.0).sqrt();
                let z = a[2] + along * way[2] / d;
                ends.extend([z - rise, z + rise]);
            }
        }
        ends.sort_by(f64::total_cmp);
        ends
    }

    /// Adds the integral of a piece, in halves where it does not stand yet.
    fn settle(&self, piece: [f64; 2], [from, to]: [f64; 2], depth: usize, total: &mut Sums) {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let (mut kronrod, mut gauss) = ([0.0; 10], [0.0; 10]);
        for (node, weight, seven) in NODES {
            let both = if node == 0.0 { &[0.0][..] } else { &[-1.0, 1.0][..] };
            for sign in both {
                let value = self.slice(piece, middle + sign * half * node);
                for k in 0..10 {
                    kronrod[k] += half * weight * value[k];
                    gauss[k] += half * seven * value[k];
                }
            }
        }
        let off = kronrod.iter().zip(&gauss).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if off <= TOLERANCE * self.weight || depth >= DEEPEST {
            (0..10).for_each(|k| total[k] += kronrod[k]);
            return;
        }
        self.settle(piece, [from, middle], depth + 1, total);
        self.settle(piece, [middle, to], depth + 1, total);
    }

    /// The integrand at a place of a piece.
    fn slice(&self, [from, to]: [f64; 2], u: f64) -> Sums {
        let z = from + (to - from) * u * u * (3.0 - 2.0 * u);
        let stretch = 6.0 * u * (1.0 - u) * (to - from);
        let discs: Vec<Disc> = self.balls.iter().filter_map(|(x, r)| Disc::cut(*x, *r, z)).collect();
        let Moments { area, x, y, xx, yy, xy } = Moments::of(&discs);
        [area, x, y, z * area, xx, yy, z * z * area, xy, z * x, z * y].map(|a| stretch * a)
    }
}

/// Nodes from 0 to 1 with their weights among fifteen and among seven, where they belong to these.
/// Source: Kronrod, Nodes and Weights of Quadrature Formulas, 1965.
const NODES: [(f64, f64, f64); 8] = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_56, 0.129_484_966_168_869_7),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_19, 0.0),
    (0.741_531_185_599_394_5, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_42, 0.381_830_050_505_118_94),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_89, 0.0),
    (0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
];

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::math::body::{apply, matrix, turn};
    use perigrain_base::math::rng::ParkMiller;

    fn near(a: f64, b: f64, size: f64) {
        assert!((a - b).abs() <= 1e-9 * size, "{a} {b}");
    }

    // Specification: r 5 mm at 0, 5 and 10 mm, density 2500. Spheres of radius r whose centres are r apart share the lens
    // 5/12 pi r³, so that the union has 3 (4/3) - 2 (5/12) times pi r³.
    #[test]
    fn three_spheres_in_a_row() {
        let r = 0.005_f64;
        let u = Union::new(&[[0.0; 3], [r, 0.0, 0.0], [2.0 * r, 0.0, 0.0]], &[r; 3]).unwrap();
        near(u.volume, (4.0 - 10.0 / 12.0) * PI * r.powi(3), u.volume);
        near(u.volume, 1.243_547_092e-6, 1e-6);
        near(2500.0 * u.volume, 3.108_867_730e-3, 3e-3);
        near(2500.0 * u.inertia[0], 3.384_984e-8, 1e-5);
        assert!((2500.0 * u.inertia[0] / 3.384_984e-8 - 1.0).abs() < 2e-7); // seven digits
        assert!((2500.0 * u.inertia[1] / 9.597_606e-8 - 1.0).abs() < 2e-7);
        near(u.inertia[1], u.inertia[2], u.inertia[1]);
        near(u.centre[0], r, r);
        assert!(
            u.centre[1].abs() < 1e-12 * r && u.inertia[3..].iter().all(|a| a.abs() < 1e-9 * u.inertia[0])
        );
    }

    // One sphere, the same one twice, one within another, and two apart.
    #[test]
    fn spheres_that_hide_or_do_not_touch() {
        let ball = |r: f64| 4.0 / 3.0 * PI * r.powi(3);
        for (places, radii) in [
            (vec![[1.0, 2.0, 3.0]], vec![2.0]),
            (vec![[1.0, 2.0, 3.0]; 2], vec![2.0; 2]),
            (vec![[1.0, 2.0, 3.0], [1.5, 2.0, 3.0]], vec![2.0, 0.5]),
        ] {
            let u = Union::new(&places, &radii).unwrap();
            near(u.volume, ball(2.0), u.volume);
            near(u.inertia[2], 0.4 * ball(2.0) * 4.0, u.inertia[2]);
            assert!(length(sub(u.centre, [1.0, 2.0, 3.0])) < 1e-9);
        }
        let u = Union::new(&[[0.0; 3], [0.0, 3.0, 0.0]], &[1.0, 2.0_f64.cbrt()]).unwrap();
        near(u.volume, 3.0 * ball(1.0), u.volume);
        near(u.centre[1], 2.0, 1.0);
        assert!(Union::new(&[], &[]).is_none());
    }

    // Turned, all moments turn with it: the slices lie across other directions then.
    #[test]
    fn a_turned_body_has_the_same_moments() {
        let mut stream = ParkMiller::new(4711);
        let mut draw = || stream.uniform();
        let places: Vec<Vec3> = (0..9).map(|_| [draw(), 0.8 * draw(), 0.6 * draw()]).collect();
        let radii: Vec<f64> = (0..9).map(|_| 0.2 + 0.2 * draw()).collect();
        let one = Union::new(&places, &radii).unwrap();
        let m = matrix(turn([0.6, 0.0, 0.8], 1.1));
        let turned: Vec<Vec3> = places.iter().map(|x| apply(&m, *x)).collect();
        let two = Union::new(&turned, &radii).unwrap();
        near(one.volume, two.volume, one.volume);
        (0..3).for_each(|d| near(apply(&m, one.centre)[d], two.centre[d], 1.0));
        let full = |i: [f64; 6]| [[i[0], i[3], i[4]], [i[3], i[1], i[5]], [i[4], i[5], i[2]]];
        let (a, b) = (full(one.inertia), full(two.inertia));
        for i in 0..3 {
            for j in 0..3 {
                let sum: f64 = (0..3)
                    .flat_map(|k| (0..3).map(move |l| (k, l)))
                    .map(|(k, l)| m[i][k] * a[k][l] * m[j][l])
                    .sum();
                near(sum, b[i][j], one.inertia[0]);
            }
        }
    }
}
