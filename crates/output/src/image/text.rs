//! Text in a picture: strokes of round pens at any size, soft at the edge.

use super::glyphs::strokes;
use super::{Colour, Image};

/// Grid units between two characters.
const GAP: f32 = 2.9;

/// Half the width of the pen in grid units.
const PEN: f32 = 0.86;

/// Pieces that a curve between two points is drawn with.
const PIECES: usize = 6;

/// Pixels per grid unit for a line of text `size` pixels high.
fn scale(size: f32) -> f32 {
    0.74 * size / 14.0
}

/// Width of a line of text in pixels.
pub(super) fn width(text: &str, size: f32) -> f32 {
    scale(size) * text.chars().map(|c| strokes(c).0 + GAP).sum::<f32>()
}

/// Draws a line of text with its upper left corner at (x, y), `size` pixels high.
pub(super) fn draw(image: &mut Image, text: &str, x: f32, y: f32, size: f32, ink: Colour) {
    let scale = scale(size);
    let base = y + 0.87 * size;
    let mut x = x;
    for c in text.chars() {
        let (width, lines) = strokes(c);
        let place = |p: [f32; 2]| [x + scale * p[0], base - scale * p[1]];
        let lines: Vec<Vec<[f32; 2]>> =
            lines.split(';').map(|s| curve(s).into_iter().map(place).collect()).collect();
        ink_lines(image, &lines, (PEN * scale).max(0.55), ink);
        x += scale * (width + GAP);
    }
}

/// The points of a stroke, curves in small pieces.
fn curve(stroke: &str) -> Vec<[f32; 2]> {
    let (closed, smooth) = (stroke.starts_with('o'), stroke.starts_with(['o', '~']));
    let number = |s: &str| s.parse().unwrap_or(0.0);
    let pairs = stroke.trim_start_matches(['o', '~']).split_whitespace();
    let points: Vec<[f32; 2]> =
        pairs.filter_map(|p| p.split_once(',')).map(|(x, y)| [number(x), number(y)]).collect();
    if !smooth || points.len() < 3 {
        return points;
    }
    let n = points.len() as i64;
    let at = |k: i64| points[if closed { k.rem_euclid(n) } else { k.clamp(0, n - 1) } as usize];
    let spans = if closed { n } else { n - 1 };
    let mut fine = vec![at(0)];
    for k in 0..spans {
        let (a, b, c, d) = (at(k - 1), at(k), at(k + 1), at(k + 2));
        for piece in 1..=PIECES {
            let t = piece as f32 / PIECES as f32;
            // Catmull and Rom's spline: through b and c, with the neighbours' directions there.
            fine.push(std::array::from_fn(|i| {
                let (a, b, c, d) = (a[i], b[i], c[i], d[i]);
                let (slope, cubic) = (c - a, 3.0 * (b - c) + d - a);
                b + 0.5 * t * (slope + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * cubic))
            }));
        }
    }
    fine
}

/// Draws lines with a round pen; where they meet, ink is laid only once.
pub(super) fn ink_lines(image: &mut Image, lines: &[Vec<[f32; 2]>], half: f32, ink: Colour) {
    let all = || lines.iter().flatten();
    let reach = |k: usize| {
        let (lo, hi) = all().fold((f32::MAX, f32::MIN), |(lo, hi), p| (lo.min(p[k]), hi.max(p[k])));
        ((lo - half - 1.0).floor() as i64, (hi + half + 1.0).ceil() as i64)
    };
    if all().next().is_none() {
        return;
    }
    let ((x0, x1), (y0, y1)) = (reach(0), reach(1));
    for y in y0..=y1 {
        for x in x0..=x1 {
            let p = [x as f32 + 0.5, y as f32 + 0.5];
            let nearest = lines
                .iter()
                .flat_map(|l| l.windows(2))
                .map(|w| distance(p, w[0], w[1]))
                .fold(f32::MAX, f32::min);
            let cover = (half + 0.5 - nearest).clamp(0.0, 1.0);
            if cover > 0.0 {
                image.blend(x, y, ink, cover);
            }
        }
    }
}

/// Distance of a point from a piece of a line.
fn distance(p: [f32; 2], a: [f32; 2], b: [f32; 2]) -> f32 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let square = along[0] * along[0] + along[1] * along[1];
    let t = if square > 0.0 { ((to[0] * along[0] + to[1] * along[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (to[0] - t * along[0]).hypot(to[1] - t * along[1])
}
