//! The shapes of regions: which points they hold, what box holds them, and their numbers one by one.

use super::Region;
use perigrain_base::math::vec3::{dot, sub};
use perigrain_mesh::Solid;
use serde::de::{Deserialize, Deserializer, Error};
use std::cell::Cell;

/// The shapes there are. Surfaces belong to the inside.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Shape {
    /// An axis-parallel box.
    Block {
        /// Lower corner.
        lo: [f64; 3],
        /// Upper corner.
        hi: [f64; 3],
    },
    /// A cylinder along an axis.
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
    /// A cone along an axis, its radius linear between the ends.
    Cone {
        /// The axis, 0 to 2.
        axis: usize,
        /// Where the axis passes, in the two other coordinates.
        center: [f64; 2],
        /// Radius at the lower and the upper end.
        radius: [f64; 2],
        /// Lower end.
        lo: f64,
        /// Upper end.
        hi: f64,
    },
    /// A ball.
    Sphere {
        /// Its centre.
        center: [f64; 3],
        /// Its radius.
        radius: f64,
    },
    /// An ellipsoid with its axes along x, y, z.
    Ellipsoid {
        /// Its centre.
        center: [f64; 3],
        /// Half the lengths of its axes.
        half: [f64; 3],
    },
    /// The half-space on the side of a plane to which its normal points.
    Plane {
        /// A point of the plane.
        point: [f64; 3],
        /// Its normal, of any length.
        normal: [f64; 3],
    },
    /// A parallelepiped with edges (hi − lo)x, (xy, (hi − lo)y) and (xz, yz, (hi − lo)z) from its lower corner.
    Prism {
        /// Lower corner.
        lo: [f64; 3],
        /// Upper corner before tilting.
        hi: [f64; 3],
        /// xy, xz, yz.
        tilt: [f64; 3],
    },
    /// Points in at least one.
    Union(#[serde(deserialize_with = "nested")] Vec<Region>),
    /// Points in all.
    Intersect(#[serde(deserialize_with = "nested")] Vec<Region>),
    /// The body within a closed surface of triangles.
    Mesh(Solid),
}

/// The two coordinates across an axis, in LAMMPS' order.
pub fn across(axis: usize) -> [usize; 2] {
    match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}

thread_local!(static LAYERS: Cell<usize> = const { Cell::new(0) });

/// Reads the regions of a region, no deeper than [`Region::DEEPEST`]: a forged file must not use up the stack.
fn nested<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Region>, D::Error> {
    let layers = LAYERS.get() + 1;
    if layers >= Region::DEEPEST {
        return Err(D::Error::custom("regions are made of regions too many times"));
    }
    LAYERS.set(layers);
    let outcome = Vec::deserialize(from);
    LAYERS.set(layers - 1);
    outcome
}

impl Shape {
    /// Whether its axis is one, and how many numbers variables may give it.
    pub(super) fn has(&self) -> (bool, usize) {
        match self {
            Shape::Block { .. } | Shape::Ellipsoid { .. } | Shape::Plane { .. } => (true, 6),
            Shape::Cylinder { axis, .. } => (*axis < 3, 3),
            Shape::Cone { axis, .. } => (*axis < 3, 6),
            Shape::Sphere { .. } => (true, 4),
            Shape::Prism { .. } => (true, 9),
            Shape::Union(_) | Shape::Intersect(_) | Shape::Mesh(_) => (true, 0),
        }
    }

    /// Whether the point belongs to the shape.
    pub(super) fn contains(&self, x: [f64; 3]) -> bool {
        match self {
            Shape::Block { lo, hi } => (0..3).all(|d| x[d] >= lo[d] && x[d] <= hi[d]),
            Shape::Cylinder { axis, center, radius, lo, hi } => {
                from_axis(x, *axis, *center) <= *radius && x[*axis] >= *lo && x[*axis] <= *hi
            }
            Shape::Cone { axis, center, radius, lo, hi } => {
                let here = radius[0] + (x[*axis] - lo) * (radius[1] - radius[0]) / (hi - lo);
                from_axis(x, *axis, *center) <= here && x[*axis] >= *lo && x[*axis] <= *hi
            }
            Shape::Sphere { center, radius } => {
                let d = sub(x, *center);
                dot(d, d).sqrt() <= *radius
            }
            Shape::Ellipsoid { center, half: [a, b, c] } => {
                let d = sub(x, *center);
                let scaled = [b * c * d[0], a * c * d[1], a * b * d[2]];
                dot(scaled, scaled) <= (a * b * c).powi(2)
            }
            Shape::Plane { point, normal } => dot(sub(x, *point), *normal) >= 0.0,
            Shape::Prism { lo, hi, tilt } => {
                fractions(x, *lo, *hi, *tilt).iter().all(|f| (0.0..=1.0).contains(f))
            }
            Shape::Union(parts) => parts.iter().any(|r| r.contains(x)),
            Shape::Intersect(parts) => parts.iter().all(|r| r.contains(x)),
            Shape::Mesh(solid) => solid.contains(x),
        }
    }

    /// A box around the shape; a plane has none.
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Shape::Block { lo, hi } => Some((*lo, *hi)),
            Shape::Cylinder { axis, center, radius, lo, hi } => {
                Some(around_axis(*axis, *center, *radius, *lo, *hi))
            }
            Shape::Cone { axis, center, radius, lo, hi } => {
                Some(around_axis(*axis, *center, radius[0].max(radius[1]), *lo, *hi))
            }
            Shape::Sphere { center, radius } => {
                Some((center.map(|c| c - radius), center.map(|c| c + radius)))
            }
            Shape::Ellipsoid { center, half } => {
                Some(([0, 1, 2].map(|d| center[d] - half[d]), [0, 1, 2].map(|d| center[d] + half[d])))
            }
            Shape::Plane { .. } => None,
            Shape::Prism { lo, hi, tilt: [xy, xz, yz] } => {
                let low = [lo[0] + xy.min(0.0) + xz.min(0.0), lo[1] + yz.min(0.0), lo[2]];
                let high = [hi[0] + xy.max(0.0) + xz.max(0.0), hi[1] + yz.max(0.0), hi[2]];
                Some((low, high))
            }
            Shape::Union(parts) => {
                let all: Option<Vec<_>> = parts.iter().map(Region::bounds).collect();
                all?.into_iter().reduce(|a, b| combine(a, b, f64::min, f64::max))
            }
            Shape::Intersect(parts) => {
                parts.iter().filter_map(Region::bounds).reduce(|a, b| combine(a, b, f64::max, f64::min))
            }
            Shape::Mesh(solid) => solid.bounds().or(Some(([0.0; 3], [0.0; 3]))),
        }
    }

    /// Gives the shape's number `k`, counted as `region` reads them, a new value.
    pub(super) fn set(&mut self, k: usize, value: f64) {
        let corner = |lo: &mut [f64; 3], hi: &mut [f64; 3]| {
            let end = if k.is_multiple_of(2) { lo } else { hi };
            end[k / 2] = value;
        };
        match self {
            Shape::Block { lo, hi } => corner(lo, hi),
            Shape::Prism { lo, hi, .. } if k < 6 => corner(lo, hi),
            Shape::Prism { tilt, .. } => tilt[k - 6] = value,
            Shape::Cylinder { center, radius, .. } => match k {
                0 | 1 => center[k] = value,
                _ => *radius = value,
            },
            Shape::Cone { center, radius, lo, hi, .. } => match k {
                0 | 1 => center[k] = value,
                2 | 3 => radius[k - 2] = value,
                4 => *lo = value,
                _ => *hi = value,
            },
            Shape::Sphere { center, radius } => match k {
                0..3 => center[k] = value,
                _ => *radius = value,
            },
            Shape::Ellipsoid { center: first, half: second }
            | Shape::Plane { point: first, normal: second } => match k {
                0..3 => first[k] = value,
                _ => second[k - 3] = value,
            },
            Shape::Union(_) | Shape::Intersect(_) | Shape::Mesh(_) => {}
        }
    }

    /// The shape's number `k`, counted as `region` reads them; 0 for what `set` does not reach.
    pub(super) fn get(&self, k: usize) -> f64 {
        let corner = |lo: &[f64; 3], hi: &[f64; 3]| if k.is_multiple_of(2) { lo[k / 2] } else { hi[k / 2] };
        let row = |numbers: &[f64]| numbers.get(k).copied().unwrap_or(0.0);
        match self {
            Shape::Block { lo, hi } => corner(lo, hi),
            Shape::Prism { lo, hi, .. } if k < 6 => corner(lo, hi),
            Shape::Prism { tilt, .. } => tilt[k - 6],
            Shape::Cylinder { center: [a, b], radius, .. } => row(&[*a, *b, *radius]),
            Shape::Cone { center: [a, b], radius: [r, s], lo, hi, .. } => row(&[*a, *b, *r, *s, *lo, *hi]),
            Shape::Sphere { center: [x, y, z], radius } => row(&[*x, *y, *z, *radius]),
            Shape::Ellipsoid { center: first, half: second }
            | Shape::Plane { point: first, normal: second } => {
                row(&[first[0], first[1], first[2], second[0], second[1], second[2]])
            }
            Shape::Union(_) | Shape::Intersect(_) | Shape::Mesh(_) => 0.0,
        }
    }

    /// What is wrong with the shape's numbers, if anything.
    pub fn fault(&self) -> Option<&'static str> {
        let wrong = |bad: bool, text: &'static str| bad.then_some(text);
        match self {
            Shape::Block { lo, hi } => {
                wrong((0..3).any(|d| lo[d] > hi[d]), "a lower bound lies above the upper one")
            }
            Shape::Cylinder { radius, lo, hi, .. } => wrong(*radius < 0.0, "the radius is negative")
                .or(wrong(lo > hi, "the lower bound lies above the upper one")),
            Shape::Cone { radius, lo, hi, .. } => {
                wrong(radius[0] < 0.0 || radius[1] < 0.0, "a radius is negative")
                    .or(wrong(*radius == [0.0; 2], "both radii of the cone are zero"))
                    .or(wrong(lo >= hi, "the lower end lies not below the upper one"))
            }
            Shape::Sphere { radius, .. } => wrong(*radius < 0.0, "the radius is negative"),
            Shape::Ellipsoid { half, .. } => wrong(half.iter().any(|a| *a < 0.0), "a half axis is negative"),
            Shape::Plane { normal, .. } => wrong(*normal == [0.0; 3], "the normal of the plane is zero"),
            Shape::Prism { lo, hi, .. } => {
                wrong((0..3).any(|d| lo[d] >= hi[d]), "a lower bound lies not below the upper one")
            }
            Shape::Union(_) | Shape::Intersect(_) | Shape::Mesh(_) => None,
        }
    }
}

/// Distance from an axis-parallel line.
fn from_axis(x: [f64; 3], axis: usize, center: [f64; 2]) -> f64 {
    let [a, b] = across(axis);
    let (da, db) = (x[a] - center[0], x[b] - center[1]);
    (da * da + db * db).sqrt()
}

/// Coordinates along the three edges of a prism, 0 to 1 inside.
fn fractions(x: [f64; 3], lo: [f64; 3], hi: [f64; 3], [xy, xz, yz]: [f64; 3]) -> [f64; 3] {
    let ([dx, dy, dz], [lx, ly, lz]) = (sub(x, lo), sub(hi, lo));
    let c = dz / lz;
    let b = dy / ly - yz / (ly * lz) * dz;
    let a = dx / lx - xy / (lx * ly) * dy + (yz * xy - ly * xz) / (lx * ly * lz) * dz;
    [a, b, c]
}

type Bounds = ([f64; 3], [f64; 3]);

fn around_axis(axis: usize, center: [f64; 2], radius: f64, lo: f64, hi: f64) -> Bounds {
    let [a, b] = across(axis);
    let (mut low, mut high) = ([lo; 3], [hi; 3]);
    (low[a], high[a]) = (center[0] - radius, center[0] + radius);
    (low[b], high[b]) = (center[1] - radius, center[1] + radius);
    (low, high)
}

fn combine(a: Bounds, b: Bounds, low: fn(f64, f64) -> f64, high: fn(f64, f64) -> f64) -> Bounds {
    (std::array::from_fn(|d| low(a.0[d], b.0[d])), std::array::from_fn(|d| high(a.1[d], b.1[d])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cones_ellipsoids_planes_and_prisms_by_hand() {
        let cone = Shape::Cone { axis: 2, center: [0.0; 2], radius: [2.0, 0.0], lo: 0.0, hi: 4.0 };
        assert!(
            cone.contains([1.0, 0.0, 2.0])
                && !cone.contains([1.01, 0.0, 2.0])
                && cone.contains([0.0, 0.0, 4.0])
        );
        let egg = Shape::Ellipsoid { center: [1.0, 0.0, 0.0], half: [2.0, 1.0, 0.5] };
        assert!(
            egg.contains([3.0, 0.0, 0.0]) && egg.contains([1.0, 1.0, 0.0]) && !egg.contains([1.0, 0.9, 0.3])
        );
        let plane = Shape::Plane { point: [1.0, 0.0, 0.0], normal: [2.0, 0.0, 0.0] };
        assert!(
            plane.contains([1.0, 5.0, 5.0]) && !plane.contains([0.9, 5.0, 5.0]) && plane.bounds().is_none()
        );
        let prism = Shape::Prism { lo: [0.0; 3], hi: [2.0, 1.0, 1.0], tilt: [1.0, 0.0, -0.5] };
        // Corner (1, 1, 0) of the second edge and the far corner (3, 0.5, 1).
        assert!(prism.contains([1.0, 1.0, 0.0]) && !prism.contains([0.9, 1.0, 0.0]));
        assert!(prism.contains([2.0, 0.3, 0.5]) && !prism.contains([0.0, 0.3, 0.5]));
        assert_eq!(prism.bounds(), Some(([0.0, -0.5, 0.0], [3.0, 1.0, 1.0])));
    }

    #[test]
    fn numbers_are_counted_as_the_deck_reads_them() {
        let mut cone = Shape::Cone { axis: 2, center: [0.0; 2], radius: [2.0, 0.0], lo: 0.0, hi: 4.0 };
        (0..6).for_each(|k| cone.set(k, k as f64));
        assert_eq!(cone, Shape::Cone { axis: 2, center: [0.0, 1.0], radius: [2.0, 3.0], lo: 4.0, hi: 5.0 });
        let mut prism = Shape::Prism { lo: [0.0; 3], hi: [0.0; 3], tilt: [0.0; 3] };
        (0..9).for_each(|k| prism.set(k, k as f64));
        assert_eq!(prism, Shape::Prism { lo: [0.0, 2.0, 4.0], hi: [1.0, 3.0, 5.0], tilt: [6.0, 7.0, 8.0] });
        cone.set(2, -1.0);
        assert!(cone.fault().is_some() && prism.fault().is_none());
    }
}
