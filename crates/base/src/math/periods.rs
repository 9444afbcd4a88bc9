//! The edges of a periodic box, upright or tilted, and its images.

use super::vec3::{Vec3, same};

/// Three edges a = (lx, 0, 0), b = (xy, ly, 0), c = (xz, yz, lz); a length is zero along a direction that is
/// not periodic, which may still be tilted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Periods {
    /// lx, ly, lz [length].
    pub length: Vec3,
    /// xy, xz, yz [length].
    pub tilt: Vec3,
}

impl PartialEq for Periods {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        same(self.length, other.length) && same(self.tilt, other.tilt)
    }
}

impl Periods {
    /// Edges along the axes.
    pub fn upright(length: Vec3) -> Self {
        Self { length, tilt: [0.0; 3] }
    }

    /// Whether some edge is tilted.
    #[inline]
    pub fn tilted(&self) -> bool {
        self.tilt != [0.0; 3]
    }

    /// The three edges.
    pub fn vectors(&self) -> [Vec3; 3] {
        let ([lx, ly, lz], [xy, xz, yz]) = (self.length, self.tilt);
        [[lx, 0.0, 0.0], [xy, ly, 0.0], [xz, yz, lz]]
    }

    /// The displacement of the image that is `n` edges away.
    #[inline]
    pub fn shift(&self, n: [f64; 3]) -> Vec3 {
        let ([lx, ly, lz], [xy, xz, yz]) = (self.length, self.tilt);
        [n[0] * lx + n[1] * xy + n[2] * xz, n[1] * ly + n[2] * yz, n[2] * lz]
    }

    /// [`Periods::shift`] for an image in use; nearly always the unshifted one.
    #[inline]
    pub fn shift_of(&self, image: [i32; 3]) -> Vec3 {
        if image == [0; 3] { [0.0; 3] } else { self.shift(image.map(f64::from)) }
    }

    /// Fractions of the edges for a position `d` from the corner: 0 there and 1 at the other end.
    pub fn fractions(&self, d: Vec3) -> Vec3 {
        let ([lx, ly, lz], [xy, xz, yz]) = (self.length, self.tilt);
        let z = d[2] / lz;
        let y = (d[1] - z * yz) / ly;
        [(d[0] - y * xy - z * xz) / lx, y, z]
    }

    /// The position if the edges from the corner `lo` were upright: between the same faces along each of
    /// them. Edges that are not periodic must be upright ([`Periods::repeats_where_it_leans`]).
    #[inline]
    pub fn straightened(&self, x: Vec3, lo: Vec3) -> Vec3 {
        if !self.tilted() {
            return x;
        }
        let ([_, ly, lz], [xy, xz, yz]) = (self.length, self.tilt);
        let z = over(x[2] - lo[2], lz);
        let y = over(x[1] - lo[1] - z * yz, ly);
        [x[0] - y * xy - z * xz, x[1] - z * yz, x[2]]
    }

    /// Whether all tilted edges are periodic, as LAMMPS requires.
    pub fn repeats_where_it_leans(&self) -> bool {
        let ([_, ly, lz], [xy, xz, yz]) = (self.length, self.tilt);
        (xy == 0.0 || ly > 0.0) && ([xz, yz] == [0.0; 2] || lz > 0.0)
    }

    /// Upper bound of the additional distance along each axis between two positions when the box is made
    /// upright.
    pub fn spread(&self) -> Vec3 {
        let ([_, ly, lz], [xy, xz, yz]) = (self.length, self.tilt);
        // Displacement along x and y per displacement along y and z within the faces.
        let (by_y, by_z) = (over(xy, ly), over(yz, lz));
        let x_by_z = over(xz, lz) - by_y * by_z;
        [(1.0 + by_y * by_y + x_by_z * x_by_z).sqrt(), (1.0 + by_z * by_z).sqrt(), 1.0]
    }

    /// The distance of each pair of faces, zero along directions that are not periodic.
    pub fn heights(&self) -> Vec3 {
        let (length, spread) = (self.length, self.spread());
        [0, 1, 2].map(|k| length[k] / spread[k])
    }

    /// Number of edges to the image that brings a difference close to the shortest one: along z, then y, then
    /// x, as in LAMMPS. If the difference is shorter than half of every height, it is the shortest.
    pub fn turns(&self, mut d: Vec3) -> [f64; 3] {
        let mut turns = [0.0; 3];
        for k in [2, 1, 0] {
            let l = self.length[k];
            if l > 0.0 && d[k].abs() > 0.5 * l {
                turns[k] = (d[k] / l).round();
                let mut one = [0.0; 3];
                one[k] = turns[k];
                let by = self.shift(one);
                (0..3).for_each(|j| d[j] -= by[j]);
            }
        }
        turns
    }

    /// The difference to the image found by [`Periods::turns`]. Called millions of times while bonds are
    /// made: it stays in registers unless edges are tilted and the image is another one.
    #[inline]
    pub fn nearest(&self, mut d: Vec3) -> Vec3 {
        let far = |k: usize, d: &Vec3| self.length[k] > 0.0 && d[k].abs() > 0.5 * self.length[k];
        if self.tilted() && (far(0, &d) || far(1, &d) || far(2, &d)) {
            // Destructured: returned as an array it would go through memory, and 100,000 particles on a
            // lattice would start in 0.35 s instead of 0.23.
            let [x, y, z] = self.brought(d);
            return [x, y, z];
        }
        for k in 0..3 {
            if far(k, &d) {
                d[k] -= self.length[k] * (d[k] / self.length[k]).round();
            }
        }
        d
    }

    #[cold]
    #[inline(never)]
    fn brought(&self, d: Vec3) -> Vec3 {
        let by = self.shift(self.turns(d));
        [d[0] - by[0], d[1] - by[1], d[2] - by[2]]
    }
}

/// A fraction of an edge; zero for an edge that is not periodic.
#[inline]
fn over(a: f64, edge: f64) -> f64 {
    if edge > 0.0 { a / edge } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::rng::ParkMiller;
    use super::*;

    fn square(d: Vec3) -> f64 {
        d.iter().map(|a| a * a).sum()
    }

    #[test]
    fn the_nearest_image_is_that_of_the_search_through_all() {
        let mut random = ParkMiller::new(11);
        let mut met = 0;
        for tilt in [[0.0; 3], [1.5, 0.0, 0.0], [-1.5, 1.2, 0.9], [1.4, -1.5, -1.0]] {
            let edges = Periods { length: [3.0, 2.0, 2.5], tilt };
            let half = 0.5 * edges.heights().into_iter().fold(f64::INFINITY, f64::min);
            for _ in 0..500 {
                let d = edges.shift([0, 1, 2].map(|_| 2.0 * random.uniform() - 1.0));
                let images = (0..125).map(|k| [k % 5, k / 5 % 5, k / 25].map(|n| f64::from(n) - 2.0));
                let all = images.map(|n| {
                    let by = edges.shift(n);
                    square([d[0] - by[0], d[1] - by[1], d[2] - by[2]])
                });
                let shortest = all.fold(f64::INFINITY, f64::min);
                if shortest.sqrt() < half {
                    met += 1;
                    assert!((square(edges.nearest(d)) - shortest).abs() < 1e-12, "{tilt:?} {d:?}");
                }
            }
        }
        assert!(met > 300, "{met}");
    }

    #[test]
    fn fractions_are_the_way_back_from_a_shift() {
        let edges = Periods { length: [4.0, 2.0, 8.0], tilt: [1.0, -2.0, 0.5] };
        let part = [0.25, 0.5, 0.75];
        assert_eq!(edges.fractions(edges.shift(part)), part);
        let lo = [1.0, 2.0, 3.0];
        let at = [0, 1, 2].map(|k| lo[k] + edges.shift(part)[k]);
        assert_eq!(edges.straightened(at, lo), [2.0, 3.0, 9.0]);
        let upright = Periods::upright(edges.length);
        assert_eq!(upright.straightened(at, lo), at);
    }

    #[test]
    fn heights_are_the_distances_of_faces() {
        // A rhombus of edge 2 tilted by 30 degrees.
        let lean = Periods { length: [2.0, 3.0f64.sqrt(), 5.0], tilt: [1.0, 0.0, 0.0] };
        let [x, y, z] = lean.heights();
        assert!((x - 3.0f64.sqrt()).abs() < 1e-15 && y == 3.0f64.sqrt() && z == 5.0);
        // If x is not periodic, a tilt of y along x does not shorten any distance.
        let open = Periods { length: [0.0, 2.0, 0.0], tilt: [7.0, 0.0, 0.0] };
        assert_eq!(open.heights(), [0.0, 2.0, 0.0]);
        assert_eq!(open.shift([0.0, -1.0, 0.0]), [-7.0, -2.0, 0.0]);
        assert_eq!([open.shift_of([0, -1, 0]), open.shift_of([0; 3])], [[-7.0, -2.0, 0.0], [0.0; 3]]);
    }
}
