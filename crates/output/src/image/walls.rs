//! Walls as glass: triangles through which one sees, in front of spheres and behind them.

use super::raster::Raster;
use super::{Colour, Frame, Image, Look};
use std::collections::BTreeMap;

/// The colour of walls.
const GLASS: u32 = 0x5f7d95;
/// How much a wall covers that faces the viewer, and how much more one that is seen from its edge.
const COVER: [f32; 2] = [0.13, 0.22];
/// Neighbours whose normals differ by more than this (25°) have an edge that is drawn.
const CREASE: f64 = 0.906;

type Triangle = [[f64; 3]; 3];

/// Puts walls over a picture: all of one colour, so that it does not matter which comes first.
pub(super) fn draw(image: &mut Image, walls: &[Triangle], raster: &Raster, look: &Look, frame: &Frame) {
    let n = look.samples.max(1);
    // Walls end where the legend begins.
    let width = look.width.min((frame.room[0] / n as f32) as usize);
    let mut through = vec![1.0f32; width * look.height];
    for wall in walls {
        let corners = wall.map(|p| raster.projection.point(p));
        let [Some(a), Some(b), Some(c)] = corners else { continue };
        let facing = raster.projection.facing(across(wall)).abs() as f32;
        let left = 1.0 - (COVER[0] + COVER[1] * (1.0 - facing));
        let corner = |(p, z, _): ([f32; 2], f32, f32)| [p[0] / n as f32, p[1] / n as f32, z];
        fill([a, b, c].map(corner), [width, look.height], |x, y, z| {
            let seen = (0..n * n).filter(|s| z >= raster.depth(x * n + s % n, y * n + s / n)).count();
            through[y * width + x] *= 1.0 - (1.0 - left) * seen as f32 / (n * n) as f32;
        });
    }
    let glass = Colour::hex(GLASS);
    for (k, through) in through.iter().enumerate().filter(|(_, t)| **t < 1.0) {
        let pixel = &mut image.pixels[k / width * look.width + k % width];
        *pixel = Colour::from_bytes(*pixel).mix(glass, 1.0 - through).bytes();
    }
}

/// Calls `put` with pixel and depth for the pixels whose middles lie in a triangle; those on a common side of two belong to one.
fn fill([a, b, c]: [[f32; 3]; 3], [width, height]: [usize; 2], mut put: impl FnMut(usize, usize, f32)) {
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let [lo, hi] = [f32::min as fn(f32, f32) -> f32, f32::max].map(|f| f(a[1], f(b[1], c[1])));
    // Row by row: from the side that comes first to the last one.
    for y in (lo - 0.5).ceil().max(0.0) as usize..((hi - 0.5).ceil().max(0.0) as usize).min(height) {
        let level = y as f32 + 0.5;
        let (mut from, mut to) = (f32::INFINITY, f32::NEG_INFINITY);
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let (p, q) = if p[1] <= q[1] { (p, q) } else { (q, p) };
            if p[1] <= level && level < q[1] {
                let x = p[0] + (level - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
                (from, to) = (from.min(x), to.max(x));
            }
        }
        if from > to {
            continue;
        }
        let (first, end) = ((from - 0.5).ceil().max(0.0) as usize, (to - 0.5).ceil().max(0.0) as usize);
        for x in first..end.min(width) {
            let p = [x as f32 + 0.5, level];
            let weight = |u: [f32; 3], v: [f32; 3]| {
                ((u[0] - p[0]) * (v[1] - p[1]) - (u[1] - p[1]) * (v[0] - p[0])) / area
            };
            put(x, y, weight(b, c) * a[2] + weight(c, a) * b[2] + weight(a, b) * c[2]);
        }
    }
}

/// The unit vector across a triangle; nothing sensible for one without area.
fn across([a, b, c]: &Triangle) -> [f64; 3] {
    let [u, v] = [b, c].map(|p| [0, 1, 2].map(|d| p[d] - a[d]));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = n.iter().map(|x| x * x).sum::<f64>().sqrt();
    n.map(|x| x / length)
}

/// The edges that make the form of walls plain: rims, and those where faces meet at an angle.
pub fn edges(walls: &[Triangle]) -> Vec<[[f64; 3]; 2]> {
    let mut sides: BTreeMap<[[u64; 3]; 2], Vec<(usize, usize)>> = BTreeMap::new();
    let key = |p: [f64; 3]| p.map(|x| (x + 0.0).to_bits());
    for (k, wall) in walls.iter().enumerate() {
        for side in 0..3 {
            let [p, q] = [wall[side], wall[(side + 1) % 3]].map(key);
            sides.entry([p.min(q), p.max(q)]).or_default().push((k, side));
        }
    }
    let normals: Vec<[f64; 3]> = walls.iter().map(across).collect();
    let plain = |of: &&Vec<(usize, usize)>| match of.as_slice() {
        [(a, _), (b, _)] => {
            let along: f64 = (0..3).map(|d| normals[*a][d] * normals[*b][d]).sum();
            along.abs() < CREASE
        }
        _ => true,
    };
    sides.values().filter(plain).map(|of| of[0]).map(|(k, s)| [walls[k][s], walls[k][(s + 1) % 3]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_halves_of_a_square_fill_each_pixel_once() {
        let corners = [[1.3, 1.2, 5.0], [8.6, 1.2, 5.0], [8.6, 7.7, 5.0], [1.3, 7.7, 5.0]];
        let mut times = [0; 100];
        for half in [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]] {
            fill(half, [10, 10], |x, y, z| {
                times[10 * y + x] += 1;
                assert!((z - 5.0).abs() < 1e-4, "{z}");
            });
        }
        // Middles from 1.5 to 8.5 across and 1.5 to 7.5 down.
        let wanted = |k: usize| usize::from((1..9).contains(&(k % 10)) && (1..8).contains(&(k / 10)));
        assert!((0..100).all(|k| times[k] == wanted(k)), "{times:?}");
    }

    #[test]
    fn rims_and_creases_are_edges_and_the_rest_is_none() {
        let [a, b, c, d] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let square = [[a, b, c], [a, c, d]];
        assert_eq!(edges(&square).len(), 4);
        let up = [[b, c, [1.0, 1.0, 1.0]], [b, [1.0, 1.0, 1.0], [1.0, 0.0, 1.0]]];
        assert_eq!(edges(&[square, up].concat()).len(), 7);
    }
}
