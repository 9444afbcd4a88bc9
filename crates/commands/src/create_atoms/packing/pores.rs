//! The pores of an inverse opal: balls on a face-centred cubic lattice, which may cut into each other.

use perigrain_base::math::vec3::{Vec3, add, dot, scale, sub};

/// Which direction of the lattice lies along z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// \[111\]: layers of pores on each other, x along a row of touching ones.
    Layers,
    /// \[100\]: the edges of the cubic cell along x, y, z.
    Cube,
}

/// Pores on a lattice without end.
#[derive(Clone, Debug)]
pub struct Pores {
    /// The middle of one of them.
    origin: Vec3,
    /// Edges of the rectangular cell that repeats.
    cell: Vec3,
    /// Their reciprocals.
    per_cell: Vec3,
    /// Middles within the cell.
    basis: Vec<Vec3>,
    radius: f64,
}

impl Pores {
    /// Pores of this diameter, those beside each other `spacing` diameters apart, one of them in the origin.
    pub fn new(origin: Vec3, diameter: f64, spacing: f64, axis: Axis) -> Self {
        // Distance of neighbours.
        let near = spacing * diameter;
        let (cell, basis): (Vec3, &[Vec3]) = match axis {
            Axis::Cube => (
                [near * 2f64.sqrt(); 3],
                &[[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]],
            ),
            // Three layers of rows: each next one a third of the cell further along y.
            Axis::Layers => (
                [near, near * 3f64.sqrt(), near * 6f64.sqrt()],
                &[
                    [0.0, 0.0, 0.0],
                    [0.5, 0.5, 0.0],
                    [0.0, 1.0 / 3.0, 1.0 / 3.0],
                    [0.5, 5.0 / 6.0, 1.0 / 3.0],
                    [0.0, 2.0 / 3.0, 2.0 / 3.0],
                    [0.5, 1.0 / 6.0, 2.0 / 3.0],
                ],
            ),
        };
        let basis = basis.iter().map(|b| std::array::from_fn(|d| b[d] * cell[d])).collect();
        Self { origin, cell, per_cell: cell.map(|l| 1.0 / l), basis, radius: 0.5 * diameter }
    }

    /// Edges of the cell that repeats [length].
    pub fn cell(&self) -> Vec3 {
        self.cell
    }

    /// The vector from the middle of the nearest pore to a place, and its square.
    fn nearest(&self, x: Vec3) -> (Vec3, f64) {
        let from = sub(x, self.origin);
        let mut nearest = ([0.0; 3], f64::INFINITY);
        for b in &self.basis {
            let mut d = sub(from, *b);
            for k in 0..3 {
                let cells = d[k] * self.per_cell[k];
                // Rounding by a cast: what the library does is slow where a processor's own must not be counted on.
                d[k] -= self.cell[k] * ((cells + 0.5f64.copysign(cells)) as i64 as f64);
            }
            if dot(d, d) < nearest.1 {
                nearest = (d, dot(d, d));
            }
        }
        nearest
    }

    /// How far a place is from the nearest pore's surface; negative inside of one [length].
    pub fn distance(&self, x: Vec3) -> f64 {
        self.nearest(x).1.sqrt() - self.radius
    }

    /// Pushes a sphere out of all pores that it reaches into, the deepest first.
    pub fn keep(&self, x: &mut Vec3, radius: f64) {
        let least = self.radius + radius;
        for _ in 0..self.basis.len() {
            let (from, square) = self.nearest(*x);
            let far = square.sqrt();
            // A little is rounding.
            if far >= least * (1.0 - 1e-12) {
                return;
            }
            let out = if far > 0.0 { scale(1.0 / far, from) } else { [1.0, 0.0, 0.0] };
            *x = add(*x, scale(least - far, out));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_stand_at_the_corners_of_a_cuboctahedron() {
        for axis in [Axis::Cube, Axis::Layers] {
            let pores = Pores::new([0.1, 0.2, 0.3], 2.0, 0.97, axis);
            // Of each pore twelve others are a spacing away: places there lie in the middle of pores.
            for b in &pores.basis {
                let mut near = 0;
                for k in 0..343 {
                    let cell: [i32; 3] = [k % 7 - 3, k / 7 % 7 - 3, k / 49 - 3];
                    for c in &pores.basis {
                        let d: Vec3 =
                            std::array::from_fn(|k| f64::from(cell[k]) * pores.cell[k] + c[k] - b[k]);
                        let far = dot(d, d).sqrt();
                        near += usize::from((far - 1.94).abs() < 1e-12);
                        assert_eq!(far > 1e-12, far > 1.93);
                    }
                }
                assert_eq!(near, 12);
                assert!((pores.distance(add(*b, pores.origin)) + 1.0).abs() < 1e-12);
            }
        }
    }
}
