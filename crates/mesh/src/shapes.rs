//! Triangulated bodies, for tests.

use super::Triangle;
use std::f64::consts::TAU;

/// A grid of m × n points that closes in both directions, each square cut in two.
fn wrapped(m: usize, n: usize, at: impl Fn(usize, usize) -> [f64; 3]) -> Vec<Triangle> {
    let mut t = vec![];
    for i in 0..m {
        for j in 0..n {
            let (k, l) = ((i + 1) % m, (j + 1) % n);
            let [a, b, c, d] = [at(i, j), at(k, j), at(k, l), at(i, l)];
            t.extend([[a, b, c], [a, c, d]]);
        }
    }
    t
}

/// A torus about z: the radii of the ring and of the tube.
pub fn torus(ring: f64, tube: f64, m: usize, n: usize) -> Vec<Triangle> {
    wrapped(m, n, |i, j| {
        let (u, v) = (TAU * i as f64 / m as f64, TAU * j as f64 / n as f64);
        let r = ring + tube * v.cos();
        [r * u.cos(), r * u.sin(), tube * v.sin()]
    })
}

/// A block with two triangles per face.
pub fn block(lo: [f64; 3], hi: [f64; 3]) -> Vec<Triangle> {
    let p = |k: usize| [0, 1, 2].map(|d| if k >> d & 1 == 0 { lo[d] } else { hi[d] });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    faces.into_iter().flat_map(|[a, b, c, d]| [[p(a), p(b), p(c)], [p(a), p(c), p(d)]]).collect()
}

/// A ball: an octahedron whose faces are quartered `times` times, with corners on the sphere.
pub fn ball(center: [f64; 3], radius: f64, times: usize) -> Vec<Triangle> {
    let e = |d: usize, s: f64| [0, 1, 2].map(|k| if k == d { s } else { 0.0 });
    let mut t = vec![];
    for (x, y, z) in [(1., 1., 1.), (-1., -1., 1.), (-1., 1., -1.), (1., -1., -1.)] {
        t.push([e(0, x), e(1, y), e(2, z)]);
        t.push([e(1, -y), e(0, -x), e(2, -z)]);
    }
    for _ in 0..times {
        let middle = |a: [f64; 3], b: [f64; 3]| {
            let m = [0, 1, 2].map(|d| a[d] + b[d]);
            let l = m.iter().map(|x| x * x).sum::<f64>().sqrt();
            m.map(|x| x / l)
        };
        let quarter = |[a, b, c]: Triangle| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        t = t.into_iter().flat_map(quarter).collect();
    }
    t.iter().map(|t| t.map(|p| [0, 1, 2].map(|d| center[d] + radius * p[d]))).collect()
}
