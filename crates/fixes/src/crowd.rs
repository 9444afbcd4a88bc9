//! Spheres sorted into cells, to test whether a new sphere would overlap any.

use perigrain_world::Domain;

/// Spheres in and around a box, and which cell each is in.
pub struct Crowd<'a> {
    domain: &'a Domain,
    lo: [f64; 3],
    size: [f64; 3],
    cells: [usize; 3],
    /// Directions in which the cells wrap around.
    round: [bool; 3],
    heads: Vec<Vec<u32>>,
    spheres: Vec<([f64; 3], f64)>,
}

/// Maximum number of cells along one direction: more would cost more memory than they save time.
const MOST: f64 = 100.0;
/// So many may always be there, however few spheres come.
const LEAST: f64 = 8.0;

impl<'a> Crowd<'a> {
    /// Without spheres. `reach` is the largest distance at which two of them touch; positions to be tested
    /// lie between `lo` and `hi`. About `expected` spheres come.
    pub fn new(domain: &'a Domain, lo: [f64; 3], hi: [f64; 3], reach: f64, expected: usize) -> Self {
        let round = domain.periodic();
        let lengths = domain.lengths();
        let lo = std::array::from_fn(|d| if round[d] { domain.lo[d] } else { lo[d] - reach });
        let span: [f64; 3] =
            std::array::from_fn(|d| if round[d] { lengths[d] } else { hi[d] + reach - lo[d] });
        let most = (2.0 * expected as f64).cbrt().clamp(LEAST, MOST);
        let cells = span.map(|s| ((s / reach).min(most) as usize).max(1));
        let size = std::array::from_fn(|d| span[d] / cells[d] as f64);
        Self { domain, lo, size, cells, round, heads: vec![vec![]; cells.iter().product()], spheres: vec![] }
    }

    /// The cell index of a coordinate; coordinates beyond the ends belong to the end cells.
    fn cell(&self, d: usize, x: f64) -> usize {
        let k = ((x - self.lo[d]) / self.size[d]).floor();
        if self.round[d] {
            return (k as i64).rem_euclid(self.cells[d] as i64) as usize;
        }
        (k.max(0.0) as usize).min(self.cells[d] - 1)
    }

    fn place(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.cells[1] + j) * self.cells[0] + i
    }

    /// Adds a sphere.
    pub fn add(&mut self, x: [f64; 3], radius: f64) {
        let at = self.place(std::array::from_fn(|d| self.cell(d, x[d])));
        self.heads[at].push(self.spheres.len() as u32);
        self.spheres.push((x, radius));
    }

    /// Whether a sphere at `x` would touch no other sphere.
    pub fn fits(&self, x: [f64; 3], radius: f64) -> bool {
        let [xs, ys, zs] = [0, 1, 2].map(|d| self.near(d, x[d]));
        for &k in &zs {
            for &j in &ys {
                for &i in &xs {
                    let here = &self.heads[self.place([i, j, k])];
                    if here.iter().any(|&s| self.touches(s, x, radius)) {
                        return false;
                    }
                }
            }
        }
        true
    }

    /// The cell of a coordinate and its neighbours.
    fn near(&self, d: usize, x: f64) -> Vec<usize> {
        let (at, n) = (self.cell(d, x), self.cells[d]);
        let mut list = match self.round[d] {
            true => vec![(at + n - 1) % n, at, (at + 1) % n],
            false => vec![at.saturating_sub(1), at, (at + 1).min(n - 1)],
        };
        list.sort_unstable();
        list.dedup();
        list
    }

    fn touches(&self, sphere: u32, x: [f64; 3], radius: f64) -> bool {
        let (y, r) = self.spheres[sphere as usize];
        let d = self.domain.minimum_image(std::array::from_fn(|k| x[k] - y[k]));
        d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= (radius + r) * (radius + r)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use perigrain_base::math::rng::ParkMiller;
    use perigrain_world::{Boundary, Face};

    #[test]
    fn as_all_against_all() {
        let mut faces = Boundary::default();
        faces.0[2] = [Face::Fixed; 2];
        let domain = Domain::new([0.0; 3], [7.0, 3.0, 9.0], faces);
        let mut r = ParkMiller::new(99);
        let mut crowd = Crowd::new(&domain, [0.0, 0.0, 2.0], [7.0, 3.0, 5.0], 1.0, 400);
        let mut all: Vec<([f64; 3], f64)> = vec![];
        let (mut free, mut taken) = (0, 0);
        for _ in 0..400 {
            let (x, radius) =
                ([r.uniform() * 7.0, r.uniform() * 3.0, 1.5 + 4.0 * r.uniform()], 0.5 * r.uniform());
            let fits = !all.iter().any(|(y, s)| {
                let d = domain.minimum_image([0, 1, 2].map(|k| x[k] - y[k]));
                d.map(|a| a * a).iter().sum::<f64>() <= (radius + s) * (radius + s)
            });
            assert_eq!(crowd.fits(x, radius), fits);
            if fits {
                crowd.add(x, radius);
                all.push((x, radius));
            }
            (free, taken) = (free + usize::from(fits), taken + usize::from(!fits));
        }
        assert!(free > 30 && taken > 30, "{free} {taken}");
    }
}
