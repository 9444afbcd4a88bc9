//! A region into which grains are put, and its volume.

use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::math::rng::ParkMiller;
use perigrain_base::math::vec3::Vec3;
use perigrain_lang::Word;
use perigrain_styles::BuildCx;
use perigrain_styles::common::domain;
use perigrain_world::region::{Look, Near, Shape};
use perigrain_world::{Face as Side, Region};
use std::f64::consts::PI;

/// Draws for one place before it counts as not found.
const DRAWS: usize = 10_000;
/// Points along each axis of the lattice by which volumes without a formula are counted.
const POINTS: usize = 80;

/// A region at rest with an end on all sides.
#[derive(Clone, Debug)]
pub struct Bounded {
    /// The region.
    pub region: Region,
    /// The lower corner of the box around it.
    pub lo: Vec3,
    /// The upper corner.
    pub hi: Vec3,
    /// Its volume within the box of the scene [volume].
    pub volume: f64,
}

impl Bounded {
    /// The region of a word.
    ///
    /// # Errors
    /// Regions that move, have no end, or lie outside of the box.
    pub fn new(word: &Word, cx: &BuildCx) -> Result<Self> {
        let region = cx.region(word)?.clone();
        let wrong = |text: String, help: &str| {
            Err(Diagnostic::error(Code::WRONG_KIND, word.span, text).help(help).into())
        };
        let Some((mut lo, mut hi)) = region.bounds() else {
            let text = format!("region `{}` has no box around it, or moves", word.text);
            return wrong(text, "grains are inserted into a bounded region at rest");
        };
        let domain = domain(cx)?;
        let mut cut = false;
        for (d, [low, high]) in domain.boundary.0.into_iter().enumerate() {
            // Faces that follow the outermost particle make room.
            let stays = |side| matches!(side, Side::Fixed | Side::Periodic);
            if stays(low) && lo[d] < domain.lo[d] {
                (lo[d], cut) = (domain.lo[d], true);
            }
            if stays(high) && hi[d] > domain.hi[d] {
                (hi[d], cut) = (domain.hi[d], true);
            }
        }
        if !cx.checking && (0..3).any(|d| lo[d] >= hi[d]) {
            let text = format!("nothing of region `{}` lies inside the box", word.text);
            return wrong(text, "let the region lie inside the box");
        }
        if cut && !cx.checking {
            let text = format!("region `{}` leaves the box: only what lies inside is filled", word.text);
            cx.note(Diagnostic::warning(Code::SUSPICIOUS, word.span, text).help("let it lie inside the box"));
        }
        let volume = match formula(&region.shape).filter(|_| !cut) {
            Some(volume) => volume,
            None => counted(&region, lo, hi),
        };
        Ok(Self { region, lo, hi, volume })
    }

    /// Whether a grain's centre is in it.
    pub fn contains(&self, x: Vec3) -> bool {
        (0..3).all(|d| x[d] >= self.lo[d] && x[d] <= self.hi[d]) && self.region.contains(x)
    }

    /// A place in it, each as likely as any other, of which its surface is at least so far away.
    pub fn draw(&self, distance: f64, stream: &mut ParkMiller, near: &mut Vec<Near>) -> Option<Vec3> {
        let (lo, hi) = (self.lo.map(|x| x + distance), self.hi.map(|x| x - distance));
        if (0..3).any(|d| lo[d] > hi[d]) {
            return None;
        }
        let look = Look { before: None, lammps: false };
        for _ in 0..DRAWS {
            let x = std::array::from_fn(|d| lo[d] + stream.uniform() * (hi[d] - lo[d]));
            if !self.region.contains(x) {
                continue;
            }
            near.clear();
            if distance > 0.0 {
                self.region.near(x, distance, &look, near);
            }
            if near.is_empty() {
                return Some(x);
            }
        }
        None
    }
}

/// The volume of a shape, where it has a formula.
fn formula(shape: &Shape) -> Option<f64> {
    let edges = |lo: &Vec3, hi: &Vec3| (hi[0] - lo[0]) * (hi[1] - lo[1]) * (hi[2] - lo[2]);
    Some(match shape {
        // What leans has the volume of what stands upright.
        Shape::Block { lo, hi } | Shape::Prism { lo, hi, .. } => edges(lo, hi),
        Shape::Cylinder { radius, lo, hi, .. } => PI * radius * radius * (hi - lo),
        Shape::Cone { radius: [a, b], lo, hi, .. } => PI / 3.0 * (a * a + a * b + b * b) * (hi - lo),
        Shape::Sphere { radius, .. } => 4.0 / 3.0 * PI * radius.powi(3),
        Shape::Ellipsoid { half: [a, b, c], .. } => 4.0 / 3.0 * PI * a * b * c,
        Shape::Mesh(solid) => solid.volume(),
        Shape::Plane { .. } | Shape::Union(_) | Shape::Intersect(_) => return None,
    })
}

/// The volume of a region between two corners, by the points of a lattice that are in it.
fn counted(region: &Region, lo: Vec3, hi: Vec3) -> f64 {
    let step: Vec3 = std::array::from_fn(|d| (hi[d] - lo[d]) / POINTS as f64);
    let at = |d: usize, k: usize| lo[d] + (k as f64 + 0.5) * step[d];
    let count = |i: usize| -> usize {
        let row = |j: usize| (0..POINTS).filter(|&k| region.contains([at(0, i), at(1, j), at(2, k)])).count();
        (0..POINTS).map(row).sum()
    };
    (0..POINTS).map(count).sum::<usize>() as f64 * step[0] * step[1] * step[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    // The formula against the count: points within a lattice spacing of the surface are those it may miss.
    #[test]
    fn volumes() {
        let sphere = Shape::Sphere { center: [1.0, 2.0, 3.0], radius: 0.7 };
        let cone = Shape::Cone { axis: 1, center: [0.0; 2], radius: [0.2, 0.6], lo: -1.0, hi: 0.5 };
        let half = Shape::Ellipsoid { center: [0.0; 3], half: [0.5, 1.0, 0.25] };
        for shape in [sphere, cone, half] {
            let (lo, hi) = shape.bounds().unwrap();
            let region = Region::inside(shape);
            let (a, b) = (formula(&region.shape).unwrap(), counted(&region, lo, hi));
            assert!((a - b).abs() < 2e-3 * a, "{a} {b}");
        }
        let slab = |lo: f64, hi: f64| Region::inside(Shape::Block { lo: [0.0, 0.0, lo], hi: [1.0, 1.0, hi] });
        let both = Region::inside(Shape::Union(vec![slab(0.0, 0.5), slab(0.25, 1.0)]));
        assert!((counted(&both, [0.0; 3], [1.0; 3]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn whole_grains_lie_inside() {
        let region = Region::inside(Shape::Sphere { center: [0.0; 3], radius: 1.0 });
        let b = Bounded { region, lo: [-1.0; 3], hi: [1.0; 3], volume: 1.0 };
        let (mut stream, mut near) = (ParkMiller::new(17), vec![]);
        let r = |x: Vec3| x.iter().map(|a| a * a).sum::<f64>().sqrt();
        let far = (0..500).map(|_| r(b.draw(0.25, &mut stream, &mut near).unwrap())).fold(0.0, f64::max);
        assert!(far > 0.7 && far <= 0.75, "{far}");
        let far = (0..500).map(|_| r(b.draw(0.0, &mut stream, &mut near).unwrap())).fold(0.0, f64::max);
        assert!(far > 0.9 && far <= 1.0, "{far}");
        assert!(b.draw(1.1, &mut stream, &mut near).is_none());
    }
}
