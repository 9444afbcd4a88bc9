//! Cells of a mesh: their shapes, and the exact volume and centroid of each.

use perigrain_base::math::vec3::{add, cross, dot, length, scale, sub};

/// The shape of a cell with straight edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shape {
    /// Three corners in a plane.
    Triangle,
    /// Four corners around a face.
    Quad,
    /// Four corners.
    Tetrahedron,
    /// Four corners around a base, and the tip.
    Pyramid,
    /// A triangle and the one across.
    Wedge,
    /// A base of four corners and the one across.
    Hexahedron,
}

impl Shape {
    /// All of them.
    pub const ALL: [Shape; 6] =
        [Self::Triangle, Self::Quad, Self::Tetrahedron, Self::Pyramid, Self::Wedge, Self::Hexahedron];

    /// The number of corners.
    pub fn corners(self) -> usize {
        match self {
            Self::Triangle => 3,
            Self::Quad | Self::Tetrahedron => 4,
            Self::Pyramid => 5,
            Self::Wedge => 6,
            Self::Hexahedron => 8,
        }
    }

    /// Whether it has a volume of its own, not only an area.
    pub fn solid(self) -> bool {
        !matches!(self, Self::Triangle | Self::Quad)
    }

    /// What many of them are called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Triangle => "triangles",
            Self::Quad => "quads",
            Self::Tetrahedron => "tetrahedra",
            Self::Pyramid => "pyramids",
            Self::Wedge => "wedges",
            Self::Hexahedron => "hexahedra",
        }
    }
}

/// Why a cell is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// It has no volume, or no area.
    Flat,
    /// It is turned inside out: its volume.
    Negative(f64),
    /// Its edges cross.
    Crossed,
}

/// Below this part of the cube (square) over the largest edge a cell counts as flat: a thousand roundings.
const FLAT: f64 = 1e-13;

/// Volume of a solid cell or area of another, and the centroid.
///
/// The volume is that between faces which are bilinear where they have four corners: the integral of the Jacobian, a polynomial that two Gauss
/// points along each axis integrate exactly, its first moments too. Wedges and pyramids are hexahedra of which corners
/// coincide.
///
/// # Errors
/// Cells without volume, with a negative one, with crossed edges.
pub fn measure(shape: Shape, p: &[[f64; 3]]) -> Result<(f64, [f64; 3]), Fault> {
    let edge = p.iter().map(|x| length(sub(*x, p[0]))).fold(0.0, f64::max);
    let solid = |(v, x): (f64, [f64; 3])| match v {
        v if v.is_nan() || v.abs() <= FLAT * edge.powi(3) => Err(Fault::Flat),
        v if v < 0.0 => Err(Fault::Negative(v)),
        _ => Ok((v, x)),
    };
    match shape {
        Shape::Triangle => {
            let area = 0.5 * length(cross(sub(p[1], p[0]), sub(p[2], p[0])));
            if area.is_nan() || area <= FLAT * edge.powi(2) {
                return Err(Fault::Flat);
            }
            Ok((area, scale(1.0 / 3.0, add(add(p[0], p[1]), p[2]))))
        }
        Shape::Quad => quad([p[0], p[1], p[2], p[3]], FLAT * edge.powi(2)),
        Shape::Tetrahedron => {
            let [a, b, c] = [1, 2, 3].map(|k| sub(p[k], p[0]));
            solid((dot(cross(a, b), c) / 6.0, add(p[0], scale(0.25, add(add(a, b), c)))))
        }
        Shape::Pyramid => solid(trilinear([0, 1, 2, 3, 4, 4, 4, 4].map(|k| p[k]))),
        Shape::Wedge => {
            // Which of the two triangles comes first is not the same in all programs that write wedges.
            let (v, x) = trilinear([0, 1, 2, 2, 3, 4, 5, 5].map(|k| p[k]));
            solid((v.abs(), x))
        }
        Shape::Hexahedron => solid(trilinear([0, 1, 2, 3, 4, 5, 6, 7].map(|k| p[k]))),
    }
}

/// Area and centroid of four corners, as two triangles; of a quad that is not flat, the area is that of its projection along its normal.
fn quad(p: [[f64; 3]; 4], least: f64) -> Result<(f64, [f64; 3]), Fault> {
    let normal = scale(0.5, cross(sub(p[2], p[0]), sub(p[3], p[1])));
    let area = length(normal);
    let signed = |a: usize, b: usize, c: usize| {
        0.5 * dot(cross(sub(p[b], p[a]), sub(p[c], p[a])), normal) / area.max(f64::MIN_POSITIVE)
    };
    let halves = [signed(0, 1, 2), signed(0, 2, 3)];
    let others = [signed(1, 2, 3), signed(1, 3, 0)];
    let crosses = |h: [f64; 2]| h[0] * h[1] < 0.0;
    match area {
        area if area.is_nan() || area <= least => Err(Fault::Flat),
        _ if crosses(halves) && crosses(others) => Err(Fault::Crossed),
        _ => {
            let third = |a: usize, b: usize, c: usize, s: f64| {
                scale(s / 3.0 / area, add(add(sub(p[a], p[0]), sub(p[b], p[0])), sub(p[c], p[0])))
            };
            let x = add(third(0, 1, 2, halves[0]), third(0, 2, 3, halves[1]));
            Ok((area, add(p[0], x)))
        }
    }
}

/// Volume and centroid of a trilinear cell.
fn trilinear(p: [[f64; 3]; 8]) -> (f64, [f64; 3]) {
    /// Half of 1 ∓ 1/√3, the Gauss points on an edge of length 1.
    const POINTS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
    let q = p.map(|x| sub(x, p[0]));
    // Corners in the order of the base around, then the top.
    let at = |k: usize| {
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]][k]
    };
    let (mut volume, mut moment) = (0.0, [0.0; 3]);
    for k in 0..8 {
        let u = [0, 1, 2].map(|d| POINTS[k >> d & 1]);
        let (mut x, mut along) = ([0.0; 3], [[0.0; 3]; 3]);
        for (c, corner) in q.iter().enumerate() {
            let side = at(c);
            let shape = [0, 1, 2].map(|d| if side[d] == 1 { u[d] } else { 1.0 - u[d] });
            let slope = [0, 1, 2].map(|d| if side[d] == 1 { 1.0 } else { -1.0 });
            x = add(x, scale(shape[0] * shape[1] * shape[2], *corner));
            along[0] = add(along[0], scale(slope[0] * shape[1] * shape[2], *corner));
            along[1] = add(along[1], scale(shape[0] * slope[1] * shape[2], *corner));
            along[2] = add(along[2], scale(shape[0] * shape[1] * slope[2], *corner));
        }
        let part = 0.125 * dot(cross(along[0], along[1]), along[2]);
        volume += part;
        moment = add(moment, scale(part, x));
    }
    (volume, add(p[0], scale(1.0 / volume, moment)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CUBE: [[f64; 3]; 8] = [
        [0.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [2.0, 2.0, 0.0],
        [0.0, 2.0, 0.0],
        [0.0, 0.0, 2.0],
        [2.0, 0.0, 2.0],
        [2.0, 2.0, 2.0],
        [0.0, 2.0, 2.0],
    ];

    fn near(shape: Shape, p: &[[f64; 3]], volume: f64, x: [f64; 3]) {
        let (v, c) = measure(shape, p).unwrap();
        // A few roundings.
        assert!((v / volume - 1.0).abs() < 1e-14, "{shape:?} {v}");
        assert!((0..3).all(|d| (c[d] - x[d]).abs() < 1e-14), "{shape:?} {c:?}");
    }

    // Volumes and centroids calculated by hand.
    #[test]
    fn volumes_and_centroids_are_exact() {
        let [a, b, c, d, e, ..] = CUBE;
        near(Shape::Hexahedron, &CUBE, 8.0, [1.0; 3]);
        near(Shape::Tetrahedron, &[a, b, d, e], 4.0 / 3.0, [0.5; 3]);
        near(Shape::Pyramid, &[a, b, c, d, [1.0, 1.0, 2.0]], 8.0 / 3.0, [1.0, 1.0, 0.5]);
        let wedge = [a, b, d, e, CUBE[5], CUBE[7]];
        near(Shape::Wedge, &wedge, 4.0, [2.0 / 3.0, 2.0 / 3.0, 1.0]);
        near(Shape::Wedge, &[e, CUBE[5], CUBE[7], a, b, d], 4.0, [2.0 / 3.0, 2.0 / 3.0, 1.0]);
        near(Shape::Triangle, &[a, b, d], 2.0, [2.0 / 3.0, 2.0 / 3.0, 0.0]);
        near(Shape::Quad, &[a, b, [1.0, 2.0, 0.0], d], 3.0, [7.0 / 9.0, 8.0 / 9.0, 0.0]);
    }

    /// A cube whose upper face is raised at one corner: its height there is 2 + u v with u, v from 0 to 1, so that the volume is
    /// 4 (2 + 1/4).
    #[test]
    fn a_bent_face_is_bilinear() {
        let mut bent = CUBE;
        bent[6][2] = 3.0;
        let (v, _) = measure(Shape::Hexahedron, &bent).unwrap();
        assert!((v - 9.0).abs() < 1e-13, "{v}");
    }

    #[test]
    fn cells_that_are_none() {
        let [a, b, c, d, e, ..] = CUBE;
        assert_eq!(measure(Shape::Tetrahedron, &[a, b, c, d]), Err(Fault::Flat));
        assert_eq!(measure(Shape::Tetrahedron, &[a, d, b, e]), Err(Fault::Negative(-4.0 / 3.0)));
        assert_eq!(measure(Shape::Triangle, &[a, b, b]), Err(Fault::Flat));
        assert_eq!(measure(Shape::Quad, &[a, b, [0.0, 2.5, 0.0], [3.0, 2.0, 0.0]]), Err(Fault::Crossed));
        assert_eq!(measure(Shape::Hexahedron, &[a; 8]), Err(Fault::Flat));
    }
}
