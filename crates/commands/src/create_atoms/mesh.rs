//! Particles on a surface of triangles from a file.

use super::places::{Maker, New};
use super::words::OnMesh;
use perigrain_base::diag::Result;
use perigrain_base::math::vec3::{add, cross, length, scale, sub};
use perigrain_mesh::{Format, Triangle};
use perigrain_styles::words::Words;
use perigrain_styles::{BuildCx, triangles};

/// A surface to be filled.
pub struct Mesh {
    /// Its triangles.
    pub triangles: Vec<Triangle>,
    /// How.
    pub mode: Mode,
    /// Factor of the radii that follow from the triangles.
    pub radius_scale: f64,
}

/// How triangles are filled.
#[derive(Clone, Copy, Debug, PartialEq, Words)]
#[word(what = "mode")]
pub enum Mode {
    /// Halves triangles at their longest side until their corners are on average no farther than R from the centre, and puts a particle there.
    Bisect(#[word(name = "R", what = "the largest mean distance of the corners", positive)] f64),
    /// D particles per area, at places of a quasi-random sequence.
    #[word("qrand")]
    Quasi(#[word(name = "D", what = "the number of particles per area", positive)] f64),
}

impl Mode {
    /// LAMMPS' name for it.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Bisect(_) => "recursive bisection",
            Mode::Quasi(_) => "quasi-random",
        }
    }
}

impl Mesh {
    /// About how many particles come.
    pub fn expected(&self) -> f64 {
        let area = |t: &Triangle| 0.5 * length(cross(sub(t[1], t[0]), sub(t[2], t[0])));
        let of = |t: &Triangle| match self.mode {
            // Of a triangle that is halved again and again, the corners stand sqrt(area / 1.2) from the centre or a little less.
            Mode::Bisect(threshold) => (area(t) / (1.2 * threshold * threshold)).max(1.0),
            Mode::Quasi(density) => area(t) * density,
        };
        self.triangles.iter().map(of).sum()
    }

    /// The particles inside the box.
    pub fn places(&self, m: &Maker) -> Vec<New> {
        let mut found = vec![];
        for triangle in &self.triangles {
            match self.mode {
                Mode::Bisect(threshold) => halve(*triangle, threshold, &mut found),
                Mode::Quasi(density) => scatter(*triangle, density, &mut found),
            }
        }
        let new = |(x, radius): ([f64; 3], f64)| New::at(x, m.kind, Some(radius * self.radius_scale));
        found.into_iter().filter(|(x, _)| m.domain.holds(x)).map(new).collect()
    }
}

/// Halves a triangle at its longest side until it is small; its centre and mean distance to the corners.
fn halve(t: Triangle, threshold: f64, found: &mut Vec<([f64; 3], f64)>) {
    let mut waiting = vec![t];
    while let Some(t) = waiting.pop() {
        let center = scale(1.0 / 3.0, add(add(t[0], t[1]), t[2]));
        let mean = t.iter().map(|p| length(sub(center, *p))).sum::<f64>() / 3.0;
        if mean <= threshold {
            found.push((center, mean));
            continue;
        }
        let side = |k: usize| sub(t[k], t[(k + 1) % 3]);
        let lengths = [0, 1, 2].map(|k| length(side(k)));
        let longest = match lengths {
            [a, b, c] if a < b => {
                if b < c {
                    2
                } else {
                    1
                }
            }
            [a, _, c] => {
                if a < c {
                    2
                } else {
                    0
                }
            }
        };
        let middle = sub(t[longest], scale(0.5, side(longest)));
        let (mut first, mut second) = (t, t);
        first[longest] = middle;
        second[(longest + 1) % 3] = middle;
        // The first half is processed first.
        waiting.push(second);
        waiting.push(first);
    }
}

/// Roberts' R2 sequence: the powers 1 and 2 of 1/g for the plastic number g, g³ = g + 1, to the seven digits that LAMMPS
/// has: the places depend on them.
const STEPS: [f64; 2] = [0.7548777, 0.5698403];

/// Fills a triangle with the number of particles that a density gives, each at its place of a quasi-random sequence.
fn scatter([a, b, c]: Triangle, density: f64, found: &mut Vec<([f64; 3], f64)>) {
    let (ab, ac, bc) = (sub(b, a), sub(c, a), sub(c, b));
    let (lab, lac, lbc) = (length(ab), length(ac), length(bc));
    // The origin is the corner with the largest angle, opposite the longest side.
    let (origin, ab, ac) = if lac > lab && lac > lbc {
        (b, scale(-1.0, ab), bc)
    } else if lab > lac && lab > lbc {
        (c, scale(-1.0, bc), scale(-1.0, ac))
    } else {
        (a, ab, ac)
    };
    let area = 0.5 * length(cross(ab, ac));
    let count = (density * area).ceil();
    let radius = (area / std::f64::consts::PI / count).sqrt();
    for k in 1..=count as i64 {
        let [mut u, mut v] = STEPS.map(|s| (0.5 + k as f64 * s) % 1.0);
        if u + v >= 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        found.push((add(origin, add(scale(u, ac), scale(v, ab))), radius));
    }
}

/// Reads the file of a line; the surface, and lines for the log about it.
pub fn read(line: &OnMesh, cx: &BuildCx) -> Result<(Mesh, Vec<String>)> {
    let word = &line.file;
    let mesh = |triangles| Mesh { triangles, mode: line.meshmode, radius_scale: line.radscale };
    let Some(read) = triangles::read(word, cx)? else { return Ok((mesh(vec![]), vec![])) };
    triangles::doubt_size(word, &read.triangles, cx);
    let kind = match read.format {
        Format::Stl(true) => "binary ",
        Format::Stl(false) => "text ",
        _ => "",
    };
    let line = format!("Reading {} object {} from {kind}file {}", read.format.name(), read.name, word.text);
    Ok((mesh(read.triangles), vec![line]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_triangles_are_halved() {
        let mut found = vec![];
        halve([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 0.5, &mut found);
        // The right triangle halves at its hypotenuse: centres calculated by hand, first half first.
        assert_eq!(found.len(), 2);
        let third = 1.0 / 3.0;
        for ((x, _), wanted) in found.iter().zip([[0.5 * third, 0.5, 0.0], [0.5, 0.5 * third, 0.0]]) {
            assert!((0..3).all(|d| (x[d] - wanted[d]).abs() < 1e-15), "{x:?}");
        }
    }
}
