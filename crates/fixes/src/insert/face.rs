//! A plane face of triangles from which a stream of grains comes out.

use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::{Vec3, add, cross, dot, length, scale, sub};
use perigrain_mesh::Triangle;
use std::collections::BTreeMap;

/// Corners may be so far off the plane, in sizes of the face: as exactly as files of six digits state them.
const FLAT: f64 = 1e-5;
/// The least part of the mean velocity that leads through the face.
const THROUGH: f64 = 1e-3;

/// Triangles in a plane.
#[derive(Clone, Debug)]
pub struct Face {
    triangles: Vec<Triangle>,
    /// Sums of their areas up to each.
    areas: Vec<f64>,
    /// Edges that border one triangle only.
    rim: Vec<[Vec3; 2]>,
    /// The unit normal on the side to which grains go.
    pub normal: Vec3,
}

/// Why triangles make no face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// They are not in one plane.
    Bent,
    /// Grains do not pass it.
    Along,
}

impl Face {
    /// One that a check does not see: a unit square.
    pub fn unseen() -> Self {
        let square =
            [[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]], [[0.0; 3], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]];
        Self { triangles: square.to_vec(), areas: vec![0.5, 1.0], rim: vec![], normal: [0.0, 0.0, 1.0] }
    }

    /// Of triangles that have areas; `mean`: the mean velocity of the grains.
    ///
    /// # Errors
    /// Triangles that are not in one plane, and grains that do not pass it.
    pub fn new(triangles: Vec<Triangle>, mean: Vec3) -> Result<Self, Fault> {
        let mut sum = 0.0;
        let mut areas = vec![];
        for t in &triangles {
            sum += perigrain_mesh::area(t);
            areas.push(sum);
        }
        let of = |t: &Triangle| cross(sub(t[1], t[0]), sub(t[2], t[0]));
        let largest = triangles.iter().map(of).max_by(|a, b| length(*a).total_cmp(&length(*b)));
        let normal = largest.filter(|n| length(*n) > 0.0).ok_or(Fault::Bent)?;
        let normal = scale(1.0 / length(normal), normal);
        let origin = triangles[0][0];
        let corners = || triangles.as_flattened().iter().map(|p| sub(*p, origin));
        let size = corners().map(length).fold(0.0, f64::max);
        if corners().any(|p| dot(p, normal).abs() > FLAT * size) {
            return Err(Fault::Bent);
        }
        let through = dot(mean, normal);
        if through.abs() < THROUGH * length(mean) || through == 0.0 {
            return Err(Fault::Along);
        }
        let rim = rim(&triangles);
        Ok(Self { triangles, areas, rim, normal: scale(through.signum(), normal) })
    }

    /// A point of the face, each as likely as any other.
    pub fn draw(&self, stream: &mut ParkMiller) -> Vec3 {
        let all = self.areas.last().copied().unwrap_or(0.0);
        let at = stream.uniform() * all;
        let k = self.areas.partition_point(|sum| *sum < at).min(self.triangles.len() - 1);
        let [a, b, c] = self.triangles[k];
        let (mut s, mut t) = (stream.uniform(), stream.uniform());
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        add(a, add(scale(s, sub(b, a)), scale(t, sub(c, a))))
    }

    /// Whether a point of the face is at least so far from its rim.
    pub fn holds(&self, x: Vec3, radius: f64) -> bool {
        self.rim.iter().all(|[a, b]| {
            let along = sub(*b, *a);
            let s = (dot(sub(x, *a), along) / dot(along, along)).clamp(0.0, 1.0);
            length(sub(x, add(*a, scale(s, along)))) >= radius
        })
    }

    /// A box around all points up to `depth` upstream of the face.
    pub fn bounds(&self, depth: f64) -> (Vec3, Vec3) {
        let back = scale(-depth, self.normal);
        let points = self.triangles.as_flattened().iter().flat_map(|p| [*p, add(*p, back)]);
        let none = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        points.fold(none, |(lo, hi), p| {
            ([0, 1, 2].map(|d| lo[d].min(p[d])), [0, 1, 2].map(|d| hi[d].max(p[d])))
        })
    }
}

/// Edges that border one triangle only.
fn rim(triangles: &[Triangle]) -> Vec<[Vec3; 2]> {
    // Zero has two signs.
    let bits = |p: Vec3| p.map(|x| (x + 0.0).to_bits());
    let mut found: BTreeMap<[[u64; 3]; 2], (usize, [Vec3; 2])> = BTreeMap::new();
    for t in triangles {
        for k in 0..3 {
            let edge = [t[k], t[(k + 1) % 3]];
            let mut key = edge.map(bits);
            key.sort_unstable();
            found.entry(key).or_insert((0, edge)).0 += 1;
        }
    }
    found.into_values().filter(|(count, _)| *count == 1).map(|(_, edge)| edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f64) -> Vec<Triangle> {
        let p = |x: f64, y: f64| [x, y, z];
        vec![[p(0.0, 0.0), p(2.0, 0.0), p(2.0, 1.0)], [p(0.0, 0.0), p(2.0, 1.0), p(0.0, 1.0)]]
    }

    #[test]
    fn grains_go_where_the_velocity_leads() {
        let f = Face::new(square(3.0), [5.0, 0.0, -1.0]).unwrap();
        assert_eq!(f.normal, [0.0, 0.0, -1.0]);
        assert_eq!(Face::new(square(3.0), [5.0, 0.0, 1.0]).unwrap().normal, [0.0, 0.0, 1.0]);
        assert_eq!(f.bounds(0.5), ([0.0, 0.0, 3.0], [2.0, 1.0, 3.5]));
        assert_eq!(Face::new(square(3.0), [1.0, 0.0, 0.0]).unwrap_err(), Fault::Along);
        assert_eq!(Face::new(square(3.0), [0.0; 3]).unwrap_err(), Fault::Along);
        let mut bent = square(3.0);
        bent[1][2][2] = 3.1;
        assert_eq!(Face::new(bent, [0.0, 0.0, 1.0]).unwrap_err(), Fault::Bent);
    }

    #[test]
    fn points_cover_the_face_evenly_and_the_diagonal_is_no_rim() {
        let f = Face::new(square(0.0), [0.0, 0.0, 1.0]).unwrap();
        assert_eq!(f.rim.len(), 4);
        // 0.2 from the rim leaves 1.6 x 0.6 of 2 x 1.
        let mut stream = ParkMiller::new(4711);
        let (mut inner, mut mean) = (0, [0.0; 3]);
        for _ in 0..10_000 {
            let x = f.draw(&mut stream);
            inner += usize::from(f.holds(x, 0.2));
            mean = add(mean, scale(1e-4, x));
        }
        // Standard errors: 0.005 of the part, 0.006 and 0.003 of the mean.
        assert!((inner as f64 / 1e4 - 0.48).abs() < 0.02, "{inner}");
        assert!((mean[0] - 1.0).abs() < 0.03 && (mean[1] - 0.5).abs() < 0.015, "{mean:?}");
    }
}
