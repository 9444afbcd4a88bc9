//! Lattices: a unit cell with basis points, scaled, turned and shifted into the box, and the sites it has there.

use std::ops::ControlFlow;

/// The unit cell before it is scaled and turned into the box.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// The three edge vectors, dimensionless.
    pub edges: [[f64; 3]; 3],
    /// Points of the cell as fractions of the edges.
    pub basis: Vec<[f64; 3]>,
}

impl Cell {
    /// A cell with orthogonal edges of the given lengths.
    pub fn orthogonal(lengths: [f64; 3], basis: &[[f64; 3]]) -> Self {
        let [a, b, c] = lengths;
        Self { edges: [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]], basis: basis.to_vec() }
    }

    /// The cell of a named style (`sc bcc fcc hcp diamond`, in two dimensions `sq sq2 hex`); `None` for other words.
    pub fn named(style: &str) -> Option<Self> {
        const CUBE: [f64; 3] = [1.0, 1.0, 1.0];
        const FACES: [[f64; 3]; 3] = [[0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];
        let corner = [0.0; 3];
        let [yz, xz, xy] = FACES;
        Some(match style {
            "sc" => Self::orthogonal(CUBE, &[corner]),
            "bcc" => Self::orthogonal(CUBE, &[corner, [0.5, 0.5, 0.5]]),
            "fcc" => Self::orthogonal(CUBE, &[corner, xy, xz, yz]),
            "hcp" => Self::orthogonal(
                [1.0, 3f64.sqrt(), (8.0f64 / 3.0).sqrt()],
                &[corner, [0.5, 0.5, 0.0], [0.5, 5.0 / 6.0, 0.5], [0.0, 1.0 / 3.0, 0.5]],
            ),
            "diamond" => Self::orthogonal(
                CUBE,
                &[
                    corner,
                    yz,
                    xz,
                    xy,
                    [0.25, 0.25, 0.25],
                    [0.25, 0.75, 0.75],
                    [0.75, 0.25, 0.75],
                    [0.75, 0.75, 0.25],
                ],
            ),
            "sq" => Self::orthogonal(CUBE, &[corner]),
            "sq2" => Self::orthogonal(CUBE, &[corner, xy]),
            "hex" => Self::orthogonal([1.0, 3f64.sqrt(), 1.0], &[corner, xy]),
            _ => return None,
        })
    }

    /// Volume of the cell, dimensionless.
    pub fn volume(&self) -> f64 {
        let [[a, b, c], p, q] = self.edges;
        let cross = [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        (a * cross[0] + b * cross[1] + c * cross[2]).abs()
    }
}

/// The options of a `lattice` command besides its cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Placing {
    /// Lattice constant in length units, or reduced density ρ* when `reduced`.
    pub scale: f64,
    /// Whether `scale` is a reduced density (units lj).
    pub reduced: bool,
    /// Shift as fractions of the spacings.
    pub origin: [f64; 3],
    /// Lattice directions along the axes of the box.
    pub orient: [[i32; 3]; 3],
    /// Spacings in units of the scale, where the cell's own extent is not wanted.
    pub spacing: Option<[f64; 3]>,
    /// Whether a reduced density counts points per area.
    pub flat: bool,
}

impl Placing {
    /// No shift, no turn, spacings from the cell.
    pub fn plain(scale: f64, reduced: bool) -> Self {
        let orient = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        Self { scale, reduced, origin: [0.0; 3], orient, spacing: None, flat: false }
    }
}

/// A lattice as the box sees it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Lattice {
    /// Lengths along x, y, z that `units lattice` stands for.
    pub spacing: [f64; 3],
    /// Points of the unit cell; empty for `lattice none`.
    pub basis: Vec<[f64; 3]>,
    scale: f64,
    /// Cell edges as columns, and the inverse.
    edges: [[f64; 3]; 3],
    inverse: [[f64; 3]; 3],
    /// Unit vectors of the box axes in the lattice, as rows.
    turn: [[f64; 3]; 3],
    shift: [f64; 3],
    /// Whether there are sites in the plane z = 0 only.
    flat: bool,
}

impl Default for Lattice {
    fn default() -> Self {
        Self::none(1.0)
    }
}

impl Lattice {
    /// Whether all its lengths and directions are numbers, and spacings more than nothing.
    pub fn is_sound(&self) -> bool {
        let matrices = [self.edges, self.inverse, self.turn];
        let vectors = matrices.as_flattened().iter().chain(&self.basis).chain([&self.shift]);
        self.spacing.iter().all(|l| l.is_finite() && *l > 0.0)
            && self.scale.is_finite()
            && vectors.into_iter().flatten().all(|x| x.is_finite())
    }

    /// `lattice none`: a unit of length only.
    pub fn none(scale: f64) -> Self {
        Self {
            basis: vec![],
            spacing: [scale; 3],
            ..Self::new(&Cell::orthogonal([1.0; 3], &[]), &Placing::plain(1.0, false))
        }
    }

    /// Turns cell and placing into a lattice; every length and determinant must be checked before.
    pub fn new(cell: &Cell, placing: &Placing) -> Self {
        let scale = if placing.reduced {
            let dimension = if placing.flat { 2.0 } else { 3.0 };
            (cell.basis.len() as f64 / cell.volume() / placing.scale).powf(1.0 / dimension)
        } else {
            placing.scale
        };
        let edges = transposed(cell.edges);
        let mut lattice = Self {
            spacing: [0.0; 3],
            basis: cell.basis.clone(),
            scale,
            edges,
            inverse: inverted(edges),
            turn: placing.orient.map(unit),
            shift: [0.0; 3],
            flat: placing.flat,
        };
        lattice.spacing = match placing.spacing {
            Some(s) => s.map(|s| s * scale),
            None => lattice.extent(),
        };
        lattice.shift = std::array::from_fn(|d| lattice.spacing[d] * placing.origin[d]);
        lattice
    }

    /// Lattice coordinates (multiples of the cell's edges) to a place in the box.
    pub fn to_box(&self, q: [f64; 3]) -> [f64; 3] {
        let scaled = times(&self.edges, q).map(|x| x * self.scale);
        let turned = times(&self.turn, scaled);
        std::array::from_fn(|d| turned[d] + self.shift[d])
    }

    /// A place in the box to lattice coordinates.
    pub fn from_box(&self, x: [f64; 3]) -> [f64; 3] {
        let shifted = std::array::from_fn(|d| x[d] - self.shift[d]);
        let turned = times(&transposed(self.turn), shifted).map(|x| x / self.scale);
        times(&self.inverse, turned)
    }

    /// Visits every site whose cell may touch the box `lo … hi`, in LAMMPS' order (third edge slowest, basis
    /// fastest), with its basis number; sites a little outside are visited too.
    pub fn sites<B>(
        &self,
        lo: [f64; 3],
        hi: [f64; 3],
        mut visit: impl FnMut(usize, [f64; 3]) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let (first, last) = self.cells(lo, hi);
        for k in first[2]..=last[2] {
            for j in first[1]..=last[1] {
                for i in first[0]..=last[0] {
                    for (m, b) in self.basis.iter().enumerate() {
                        visit(m, self.to_box([i as f64 + b[0], j as f64 + b[1], k as f64 + b[2]]))?;
                    }
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// About how many sites lie in the box `lo … hi`: by its volume, and no more than [`Self::sites`] would visit.
    pub fn expected(&self, lo: [f64; 3], hi: [f64; 3]) -> f64 {
        let (first, last) = self.span(lo, hi);
        let bound = (0..3).map(|d| last[d] - first[d] + 1.0).product::<f64>();
        let origin = self.from_box(lo);
        let edge = |d: usize| {
            let mut at = lo;
            at[d] = hi[d];
            let at = self.from_box(at);
            [at[0] - origin[0], at[1] - origin[1], at[2] - origin[2]]
        };
        let [a, b, c] = [edge(0), edge(1), if self.flat { [0.0, 0.0, 1.0] } else { edge(2) }];
        let cells = (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]))
            .abs();
        bound.min(cells) * self.basis.len() as f64
    }

    /// First and last cell along each edge that the box `lo … hi` can touch.
    pub fn cells(&self, lo: [f64; 3], hi: [f64; 3]) -> ([i64; 3], [i64; 3]) {
        let (first, last) = self.span(lo, hi);
        (first.map(|x| x as i64), last.map(|x| x as i64))
    }

    /// The same as whole numbers of any size.
    fn span(&self, lo: [f64; 3], hi: [f64; 3]) -> ([f64; 3], [f64; 3]) {
        let (min, max) = bounds(corners(lo, hi).map(|x| self.from_box(x)));
        let (mut first, mut last) = (min.map(|x| x.floor() - 1.0), max.map(f64::ceil));
        if self.flat {
            (first[2], last[2]) = (0.0, 0.0);
        }
        (first, last)
    }

    /// Size along the axes of one unit cell in the box.
    fn extent(&self) -> [f64; 3] {
        let (min, max) = bounds(corners([0.0; 3], [1.0; 3]).map(|q| self.to_box(q)));
        std::array::from_fn(|d| max[d] - min[d])
    }
}

/// Whether three lattice directions can be box axes: none zero, orthogonal, right-handed.
pub fn is_frame(orient: [[i32; 3]; 3]) -> bool {
    let [x, y, z] = orient.map(|v| v.map(i64::from));
    let dot = |a: [i64; 3], b: [i64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross = [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]];
    dot(x, y) == 0 && dot(y, z) == 0 && dot(x, z) == 0 && dot(cross, z) > 0
}

fn unit(v: [i32; 3]) -> [f64; 3] {
    let length = f64::from(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
    v.map(|x| f64::from(x) / length)
}

fn times(m: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|r| m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2])
}

fn transposed(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|r| std::array::from_fn(|c| m[c][r]))
}

fn inverted(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let minor = |r: usize, c: usize| {
        let (r1, r2, c1, c2) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant = (0..3).map(|c| m[0][c] * minor(0, c)).sum::<f64>();
    std::array::from_fn(|r| std::array::from_fn(|c| minor(c, r) / determinant))
}

fn corners(lo: [f64; 3], hi: [f64; 3]) -> [[f64; 3]; 8] {
    std::array::from_fn(|k| std::array::from_fn(|d| if k >> d & 1 == 0 { lo[d] } else { hi[d] }))
}

fn bounds(points: [[f64; 3]; 8]) -> ([f64; 3], [f64; 3]) {
    let low = |d: usize| points.iter().fold(f64::INFINITY, |m, p| m.min(p[d]));
    let high = |d: usize| points.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p[d]));
    (std::array::from_fn(low), std::array::from_fn(high))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::{Region, Shape};

    // Spacings: golden misc_lattice is built on sc 0.9 in lj units; (1/0.9)^(1/3) by hand.
    #[test]
    fn expected_sites_are_those_of_the_volume() {
        let placing = |flat| Placing { flat, ..Placing::plain(2.0, false) };
        let cell = |name: &str| Lattice::new(&Cell::named(name).unwrap(), &placing(name == "sq2"));
        // Cells of 2 by 2 by 2, four sites in each; of 2 by 2, two.
        let near =
            |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 1e-12, "{found} {wanted}");
        near(cell("fcc").expected([1.0; 3], [41.0, 21.0, 11.0]), 4.0 * 20.0 * 10.0 * 5.0);
        near(cell("sq2").expected([1.0, 1.0, 0.0], [41.0, 21.0, 0.0]), 2.0 * 20.0 * 10.0);
    }

    #[test]
    fn reduced_density_sets_the_spacing() {
        let l = Lattice::new(&Cell::named("sc").unwrap(), &Placing::plain(0.9, true));
        assert!((l.spacing[0] - 1.0357441686512862).abs() < 1e-15);
    }

    // A turned cell, oracle: `lattice bcc 2.0 orient x 1 1 0 orient y -1 1 0 orient z 0 0 1` prints the
    // spacings 2.8284271 2.8284271 2 (8 digits).
    #[test]
    fn turned_cell_spacing() {
        let mut p = Placing::plain(2.0, false);
        p.orient = [[1, 1, 0], [-1, 1, 0], [0, 0, 1]];
        let l = Lattice::new(&Cell::named("bcc").unwrap(), &p);
        for (s, oracle) in l.spacing.into_iter().zip([2.8284271, 2.8284271, 2.0]) {
            assert!((s - oracle).abs() < 5e-8);
        }
    }

    #[test]
    fn from_box_undoes_to_box() {
        let cell = Cell {
            edges: [[1.0, 0.1, 0.2], [0.3, 1.2, 0.0], [0.1, 0.2, 0.8]],
            basis: vec![[0.0; 3], [0.5, 0.5, 0.25]],
        };
        let mut p = Placing::plain(1.7, false);
        (p.orient, p.origin) = ([[1, 1, 0], [-1, 1, 0], [0, 0, 1]], [0.25, 0.1, 0.3]);
        let l = Lattice::new(&cell, &p);
        let q = [1.3, -2.4, 0.7];
        // Twenty roundings of numbers below 10.
        assert!(l.from_box(l.to_box(q)).iter().zip(q).all(|(a, b)| (a - b).abs() < 2e-14));
    }

    // Golden misc_lattice.csv, column Atoms: six lattices × regions b, s, cx, in, so in a box -12 … 12.
    #[test]
    fn sites_in_regions_are_lammps_count() {
        let counts = [
            [294, 489, 572, 161, 11916],
            [224, 433, 499, 148, 11153],
            [245, 379, 468, 143, 8560],
            [165, 318, 383, 112, 8776],
            [80, 158, 188, 46, 4418],
            [152, 269, 308, 87, 6762],
        ];
        for (lattice, counts) in golden_lattices().iter().zip(counts) {
            for (region, count) in golden_regions().iter().zip(counts) {
                assert_eq!(sites_in(lattice, region).len(), count);
            }
        }
    }

    // Golden misc_lattice.csv, row 19 (bcc, turned; block): mean place and mean squares, printed with 15 digits;
    // the golden sums run in another order, hence 1e-12.
    #[test]
    fn sites_have_lammps_moments() {
        let sites = sites_in(&golden_lattices()[2], &golden_regions()[0]);
        let n = sites.len() as f64;
        let mean = |d: usize| sites.iter().map(|x| x[d]).sum::<f64>() / n;
        let square = |d: usize| sites.iter().map(|x| x[d] * x[d]).sum::<f64>() / n;
        let oracle = [
            (mean(0), -3.62521803959235e-18),
            (mean(1), 1.00337279299548),
            (mean(2), 2.47598125966261),
            (square(0), 4.02702784689423),
            (square(1), 5.03378480861779),
            (square(2), 10.2833032518906),
        ];
        for (ours, golden) in oracle {
            assert!((ours - golden).abs() < 1e-12, "{ours} {golden}");
        }
    }

    fn golden_lattices() -> Vec<Lattice> {
        let plain = |scale| Placing::plain(scale, true);
        let custom = Cell::orthogonal([1.0, 1.2, 0.8], &[[0.0; 3], [0.5, 0.5, 0.25]]);
        let named = |style: &str| Cell::named(style).unwrap();
        vec![
            Lattice::new(&named("sc"), &plain(0.9)),
            Lattice::new(&named("fcc"), &Placing { origin: [0.25, 0.1, 0.0], ..plain(0.8) }),
            Lattice::new(
                &named("bcc"),
                &Placing { orient: [[1, 1, 0], [-1, 1, 0], [0, 0, 1]], ..plain(0.7) },
            ),
            Lattice::new(&named("hcp"), &plain(0.6)),
            Lattice::new(&named("diamond"), &Placing { spacing: Some([2.5; 3]), ..plain(0.3) }),
            Lattice::new(&custom, &plain(0.5)),
        ]
    }

    fn golden_regions() -> Vec<Region> {
        let ball = |center, radius| Region::inside(Shape::Sphere { center, radius });
        let block = Region::inside(Shape::Block { lo: [-3.2, -2.1, -1.0], hi: [3.4, 4.4, 5.7] });
        let s = ball([0.2, 0.3, -0.4], 5.05);
        let so = Region { outside: true, ..ball([0.0; 3], 4.0) };
        let cx = Shape::Cylinder { axis: 0, center: [0.5, -0.25], radius: 4.2, lo: -6.1, hi: 5.2 };
        let cx = Region::inside(cx);
        let all = Region::inside(Shape::Intersect(vec![s.clone(), so.clone(), cx.clone()]));
        vec![block, s, cx, all, so]
    }

    fn sites_in(lattice: &Lattice, region: &Region) -> Vec<[f64; 3]> {
        let (lo, hi) = ([-12.0; 3], [12.0; 3]);
        let mut found = vec![];
        let _ = lattice.sites(lo, hi, |_, x| {
            if region.contains(x) && (0..3).all(|d| x[d] >= lo[d] && x[d] < hi[d]) {
                found.push(x);
            }
            ControlFlow::<()>::Continue(())
        });
        found
    }

    #[test]
    fn frames_must_be_right_handed() {
        assert!(is_frame([[1, 1, 0], [-1, 1, 0], [0, 0, 1]]));
        assert!(!is_frame([[1, 1, 0], [-1, 1, 0], [0, 0, -1]]));
        assert!(!is_frame([[1, 1, 0], [1, 1, 0], [0, 0, 0]]));
    }
}
