//! Triangle surfaces: file formats, checks, inside tests, nearest points and cuts.
//!
//! Independent of decks, the world and units.

// Units stand in brackets in doc comments, as [length]; they are not links.
#![allow(rustdoc::broken_intra_doc_links)]

mod check;
mod columns;
mod exact;
mod facets;
mod legacy;
mod obj;
mod ply;
mod read;
mod seams;
#[cfg(test)]
mod shapes;
mod sheet;
mod sides;
mod solid;
mod stl;
#[cfg(test)]
mod tests;
mod tree;
pub mod vtk;
mod vtp;

pub use check::Fault;
pub use columns::Columns;
pub use facets::{Facets, Near, area};
pub use read::{Error, Format, Surface, read};
pub use sheet::Sheet;
pub use solid::Solid;

use perigrain_base::math::vec3::{cross, sub};

/// Three corners.
pub type Triangle = [[f64; 3]; 3];

/// Numbers the corners so that equal positions have equal numbers.
fn weld(triangles: &[Triangle]) -> Vec<[u32; 3]> {
    // Adding zero turns −0 into 0.
    let key = |p: &[f64; 3]| p.map(|a| (a + 0.0).to_bits());
    let mut all: Vec<([u64; 3], u32)> =
        triangles.as_flattened().iter().zip(0..).map(|(p, k)| (key(p), k)).collect();
    all.sort_unstable();
    let mut corners = vec![[0; 3]; triangles.len()];
    let mut number = 0;
    for (k, (place, at)) in all.iter().enumerate() {
        if k > 0 && all[k - 1].0 != *place {
            number += 1;
        }
        corners.as_flattened_mut()[*at as usize] = number;
    }
    corners
}

/// The axis along which the projection of a triangle is largest.
fn widest(t: &Triangle) -> usize {
    let n = cross(sub(t[1], t[0]), sub(t[2], t[0]));
    (0..3).max_by(|a, b| n[*a].abs().total_cmp(&n[*b].abs())).unwrap_or(0)
}

/// A point projected along an axis.
fn seen_along(p: &[f64; 3], axis: usize) -> [f64; 2] {
    [p[(axis + 1) % 3], p[(axis + 2) % 3]]
}

/// Corners of a box around points.
fn bounds<'p>(points: impl IntoIterator<Item = &'p [f64; 3]>) -> ([f64; 3], [f64; 3]) {
    let start = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    points
        .into_iter()
        .fold(start, |(lo, hi), p| ([0, 1, 2].map(|d| lo[d].min(p[d])), [0, 1, 2].map(|d| hi[d].max(p[d]))))
}
