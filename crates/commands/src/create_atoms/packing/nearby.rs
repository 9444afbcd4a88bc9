//! Neighbour lists of spheres: for each sphere the others within touch and a skin, valid until a sphere has moved half the skin.

use super::room::Room;
use perigrain_base::math::vec3::{Vec3, add};
use perigrain_base::par;
use perigrain_neigh::grid::Grid;

/// Rows of neighbours of some consecutive spheres.
struct Part {
    first: usize,
    /// Where each row ends in `list`.
    ends: Vec<u32>,
    list: Vec<u32>,
}

/// Each sphere's neighbours: of a pair, each stands in the other's row, so that rows can be added up on their own.
pub struct Nearby {
    parts: Vec<Part>,
}

impl Nearby {
    /// Finds pairs whose surfaces are at most `gap` apart; positions lie within a period of the room.
    pub fn find(room: &Room, x: &[Vec3], radius: &[f64], gap: f64) -> Self {
        let all: Vec<u32> = (0..x.len() as u32).collect();
        let largest = radius.iter().copied().fold(0.0, f64::max);
        let mean = radius.iter().sum::<f64>() / radius.len().max(1) as f64;
        let mut grid = Grid::default();
        grid.fill(x, &all, 0.62 * (mean + largest + gap));
        let images = room.images();
        let shortest = room.repeats().into_iter().filter(|l| *l > 0.0).fold(f64::INFINITY, f64::min);
        let rows = |range: std::ops::Range<usize>| {
            let mut part = Part { first: range.start, ends: vec![], list: vec![] };
            for i in range {
                around(
                    (&images, shortest),
                    x,
                    radius,
                    (i, radius[i] + largest + gap, gap),
                    &grid,
                    &mut part.list,
                );
                part.ends.push(part.list.len() as u32);
            }
            vec![part]
        };
        let join = |mut a: Vec<Part>, mut b: Vec<Part>| {
            a.append(&mut b);
            a
        };
        Self { parts: par::reduce(x.len(), rows, join).unwrap_or_default() }
    }

    /// The neighbours of sphere `i`.
    pub fn row(&self, i: usize) -> &[u32] {
        let part = &self.parts[i / par::CHUNK];
        let k = i - part.first;
        let start = if k == 0 { 0 } else { part.ends[k - 1] };
        &part.list[start as usize..part.ends[k] as usize]
    }
}

/// Adds the neighbours of one sphere, images of itself left out: rooms are at least two spheres long where they repeat.
fn around(
    (images, shortest): (&[Vec3], f64),
    x: &[Vec3],
    radius: &[f64],
    (i, far, gap): (usize, f64, f64),
    grid: &Grid,
    list: &mut Vec<u32>,
) {
    let own = list.len();
    for image in images {
        let at = add(x[i], *image);
        grid.near(&at.map(|a| a - far), &at.map(|a| a + far), |run| {
            for &j in run {
                let y = &x[j as usize];
                let reach = radius[i] + radius[j as usize] + gap;
                let square = (at[0] - y[0]).powi(2) + (at[1] - y[1]).powi(2) + (at[2] - y[2]).powi(2);
                if square < reach * reach && j as usize != i {
                    list.push(j);
                }
            }
        });
    }
    // In a short period two images of one sphere may both be near; the nearest alone is meant later.
    if shortest < 2.0 * far {
        let mut kept = own;
        for k in own..list.len() {
            if !list[own..kept].contains(&list[k]) {
                list[kept] = list[k];
                kept += 1;
            }
        }
        list.truncate(kept);
    }
}
