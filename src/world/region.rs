//! Regions: volumes of space by shape, side and union, tested point by point.

/// What stands for an infinite face.
pub const INFINITE: f64 = 1.0e20;

/// A named volume.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Region {
    /// Its shape.
    pub shape: Shape,
    /// Whether the volume is what lies outside the shape (`side out`).
    pub outside: bool,
    /// Faces left open for walls, bit `k` for LAMMPS' face `k + 1`.
    pub open: u8,
}

/// The shapes there are.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Shape {
    /// An axis-parallel box, faces included.
    Block {
        /// Lower corner.
        lo: [f64; 3],
        /// Upper corner.
        hi: [f64; 3],
    },
    /// A cylinder along an axis, surface included.
    Cylinder {
        /// The axis, 0 to 2.
        axis: usize,
        /// Where the axis passes, in the two other coordinates (for axis y: x and z).
        center: [f64; 2],
        /// Its radius.
        radius: f64,
        /// Lower end.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
    /// A ball, surface included.
    Sphere {
        /// Its centre.
        center: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// Points in at least one.
    Union(Vec<Region>),
    /// Points in all.
    Intersect(Vec<Region>),
}

impl Region {
    /// The inside of a shape, all faces closed.
    pub fn inside(shape: Shape) -> Self {
        Self { shape, outside: false, open: 0 }
    }

    /// Whether the point belongs to the region.
    pub fn contains(&self, x: [f64; 3]) -> bool {
        self.shape.contains(x) != self.outside
    }

    /// A box that holds the region, if a finite description gives one (`side out` does not).
    pub fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        if self.outside {
            return None;
        }
        self.shape.bounds()
    }
}

/// The two coordinates across an axis, in LAMMPS' order.
pub fn across(axis: usize) -> [usize; 2] {
    match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}

impl Shape {
    /// Faces that `open` can name.
    pub fn faces(&self) -> u8 {
        match self {
            Shape::Block { .. } => 6,
            Shape::Cylinder { .. } => 3,
            _ => 0,
        }
    }

    fn contains(&self, x: [f64; 3]) -> bool {
        match self {
            Shape::Block { lo, hi } => (0..3).all(|d| x[d] >= lo[d] && x[d] <= hi[d]),
            Shape::Cylinder { axis, center, radius, lo, hi } => {
                let [a, b] = across(*axis);
                let (da, db) = (x[a] - center[0], x[b] - center[1]);
                (da * da + db * db).sqrt() <= *radius && x[*axis] >= *lo && x[*axis] <= *hi
            }
            Shape::Sphere { center, radius } => {
                let [dx, dy, dz] = [x[0] - center[0], x[1] - center[1], x[2] - center[2]];
                (dx * dx + dy * dy + dz * dz).sqrt() <= *radius
            }
            Shape::Union(parts) => parts.iter().any(|r| r.contains(x)),
            Shape::Intersect(parts) => parts.iter().all(|r| r.contains(x)),
        }
    }

    fn bounds(&self) -> Option<([f64; 3], [f64; 3])> {
        match self {
            Shape::Block { lo, hi } => Some((*lo, *hi)),
            Shape::Cylinder { axis, center, radius, lo, hi } => {
                let [a, b] = across(*axis);
                let (mut low, mut high) = ([*lo; 3], [*hi; 3]);
                (low[a], high[a]) = (center[0] - radius, center[0] + radius);
                (low[b], high[b]) = (center[1] - radius, center[1] + radius);
                Some((low, high))
            }
            Shape::Sphere { center, radius } => {
                Some((center.map(|c| c - radius), center.map(|c| c + radius)))
            }
            Shape::Union(parts) => {
                let all: Option<Vec<_>> = parts.iter().map(Region::bounds).collect();
                all?.into_iter().reduce(|a, b| combine(a, b, f64::min, f64::max))
            }
            Shape::Intersect(parts) => {
                parts.iter().filter_map(Region::bounds).reduce(|a, b| combine(a, b, f64::max, f64::min))
            }
        }
    }
}

type Bounds = ([f64; 3], [f64; 3]);

fn combine(a: Bounds, b: Bounds, low: fn(f64, f64) -> f64, high: fn(f64, f64) -> f64) -> Bounds {
    (std::array::from_fn(|d| low(a.0[d], b.0[d])), std::array::from_fn(|d| high(a.1[d], b.1[d])))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(x: f64, r: f64) -> Region {
        Region::inside(Shape::Sphere { center: [x, 0.0, 0.0], radius: r })
    }

    #[test]
    fn surfaces_belong_to_the_inside() {
        let b = Region::inside(Shape::Block { lo: [0.0; 3], hi: [1.0; 3] });
        assert!(b.contains([0.0, 1.0, 0.5]) && !b.contains([0.0, 1.0 + 1e-15, 0.5]));
        let out = Region { outside: true, ..b };
        assert!(!out.contains([0.0, 1.0, 0.5]) && out.contains([2.0, 0.0, 0.0]) && out.bounds().is_none());
        assert!(ball(0.0, 5.0).contains([3.0, 4.0, 0.0]));
    }

    #[test]
    fn cylinder_along_each_axis() {
        for axis in 0..3 {
            let shape = Shape::Cylinder { axis, center: [1.0, 2.0], radius: 0.5, lo: -1.0, hi: 3.0 };
            let c = Region::inside(shape);
            let [a, b] = across(axis);
            let mut x = [0.0; 3];
            (x[a], x[b], x[axis]) = (1.5, 2.0, 3.0);
            assert!(c.contains(x), "axis {axis}");
            let (lo, hi) = c.bounds().unwrap();
            assert_eq!((lo[a], hi[b], lo[axis], hi[axis]), (0.5, 2.5, -1.0, 3.0));
        }
    }

    #[test]
    fn unions_and_intersections_bound_themselves() {
        let (near, far) = (ball(0.0, 1.0), ball(1.5, 1.0));
        let both = Region::inside(Shape::Intersect(vec![near.clone(), far.clone()]));
        let any = Region::inside(Shape::Union(vec![near, far.clone()]));
        assert!(both.contains([0.75, 0.0, 0.0]) && !both.contains([0.0; 3]) && any.contains([0.0; 3]));
        assert_eq!(both.bounds().unwrap().0[0], 0.5);
        assert_eq!(any.bounds().unwrap().1[0], 2.5);
        let hole = Region { outside: true, ..far };
        let rest = Region::inside(Shape::Intersect(vec![ball(0.0, 1.0), hole.clone()]));
        assert_eq!(rest.bounds().unwrap().1[0], 1.0);
        assert!(Region::inside(Shape::Union(vec![ball(0.0, 1.0), hole])).bounds().is_none());
    }
}
