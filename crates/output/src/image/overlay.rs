//! What is drawn over the spheres: box edges, legend, title and caption.

use super::raster::Raster;
use super::{Colour, Frame, Image, Look, Map, Scene, text};
use perigrain_base::math::cformat::general;

/// The scale beside a picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Legend {
    /// Colours of a range of values.
    Scale {
        /// What is shown, with its unit.
        title: String,
        /// The colour map.
        map: &'static Map,
        /// Values at the ends of the map.
        range: [f64; 2],
    },
    /// A few named colours.
    Names {
        /// What is shown.
        title: String,
        /// Colour and name, from top to bottom.
        entries: Vec<(Colour, String)>,
    },
}

impl Legend {
    fn title(&self) -> &str {
        match self {
            Self::Scale { title, .. } | Self::Names { title, .. } => title,
        }
    }

    /// What stands beside the colours.
    fn labels(&self) -> Vec<String> {
        match self {
            Self::Scale { range, .. } => ticks(*range).1,
            Self::Names { entries, .. } => entries.iter().map(|e| e.1.clone()).collect(),
        }
    }

    /// The room it takes on the right, in pixels.
    pub(super) fn width(&self, look: &Look) -> usize {
        let size = text_size(look);
        let longest = self.labels().iter().map(|l| text::width(l, size)).fold(0.0, f32::max);
        let body = 3.2 * size + longest;
        (body.max(text::width(self.title(), size) + 0.5 * size) + 1.5 * size) as usize
    }
}

/// Round values within a range and their text.
pub fn ticks(range: [f64; 2]) -> (Vec<f64>, Vec<String>) {
    let (lo, hi) = (range[0].min(range[1]), range[0].max(range[1]));
    let width = hi - lo;
    if !(width > 0.0 && width.is_finite()) {
        return (vec![lo], vec![general(lo, 4)]);
    }
    let rough = width / 5.0;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0].map(|f| f * power).into_iter().find(|s| *s >= 0.999 * rough);
    let step = step.unwrap_or(10.0 * power);
    let first = (lo / step - 1e-6).ceil() as i64;
    let last = (hi / step + 1e-6).floor() as i64;
    // `+ 0.0` turns -0 into 0.
    let values: Vec<f64> = (first..=last).map(|k| k as f64 * step + 0.0).collect();
    let labels = values.iter().map(|v| general(*v, 6)).collect();
    (values, labels)
}

/// Height of text in pixels.
pub(super) fn text_size(look: &Look) -> f32 {
    (0.019 * look.height as f32).clamp(9.0, 40.0).round()
}

/// Height of a line of title or caption with its margins.
pub(super) fn line_height(look: &Look) -> usize {
    (2.6 * text_size(look)) as usize
}

/// Title, caption and legend.
pub(super) fn words(image: &mut Image, scene: &Scene<'_>, look: &Look) {
    let size = text_size(look);
    let below = look.height as f32 - 2.0 * size;
    for (words, y, size) in [(scene.title, size, 1.15 * size), (scene.caption, below, size)] {
        let x = text_size(look);
        if !words.is_empty() {
            panel(
                image,
                look,
                [0.6 * x, x + text::width(words, size) + 0.4 * x],
                [y - 0.4 * x, y + size + 0.4 * x],
            );
        }
        text::draw(image, words, x, y, size, look.ink);
    }
    if let Some(legend) = scene.legend {
        draw_legend(image, legend, look, size);
    }
}

fn draw_legend(image: &mut Image, legend: &Legend, look: &Look, size: f32) {
    let left = look.width.saturating_sub(legend.width(look)) as f32;
    let height = (0.5 * look.height as f32).round();
    let top = (0.27 * look.height as f32).round();
    let rows = match legend {
        Legend::Scale { .. } => height + size,
        Legend::Names { entries, .. } => 2.0 * size * entries.len() as f32,
    };
    panel(image, look, [left - 0.6 * size, look.width as f32 - 0.4 * size], [top - 2.6 * size, top + rows]);
    text::draw(image, legend.title(), left, top - 2.0 * size, size, look.ink);
    match legend {
        Legend::Scale { map, range, .. } => draw_scale(image, map, *range, [left, top, height], look, size),
        Legend::Names { entries, .. } => {
            for (k, (colour, name)) in entries.iter().enumerate() {
                let y = top + 2.0 * size * k as f32;
                swatch(image, [left, left + 1.4 * size], [y, y + 1.4 * size], *colour, look.ink);
                text::draw(image, name, left + 2.2 * size, y + 0.2 * size, size, look.ink);
            }
        }
    }
}

/// A vertical bar with ticks; `place` is left, top and height.
fn draw_scale(image: &mut Image, map: &Map, range: [f64; 2], place: [f32; 3], look: &Look, size: f32) {
    let [left, top, height] = place;
    let right = left + 1.4 * size;
    swatch(image, [left, right], [top, top + height], map.at(0.5), look.ink);
    for row in 1..height as i64 - 1 {
        let t = 1.0 - row as f64 / f64::from(height - 1.0);
        image.fill([left as i64 + 1, right as i64 - 1], [top as i64 + row, top as i64 + row + 1], map.at(t));
    }
    let (values, labels) = ticks(range);
    for (value, label) in values.iter().zip(labels) {
        let t = if range[1] == range[0] { 0.5 } else { (value - range[0]) / (range[1] - range[0]) };
        let y = top + (1.0 - t as f32) * (height - 1.0);
        let tick = (0.4 * size) as i64;
        image.fill([right as i64, right as i64 + tick], [y as i64, y as i64 + 1], look.ink);
        text::draw(image, &label, right + 0.8 * size, y - 0.5 * size, size, look.ink);
    }
}

/// Lets the background through a rectangle, so that words can be read over spheres.
pub(super) fn panel(image: &mut Image, look: &Look, x: [f32; 2], y: [f32; 2]) {
    for row in y[0].max(0.0) as i64..y[1] as i64 {
        let ground = look.background[0].mix(look.background[1], row as f32 / look.height as f32);
        for column in x[0].max(0.0) as i64..x[1] as i64 {
            image.blend(column, row, ground, 0.85);
        }
    }
}

/// A framed rectangle.
fn swatch(image: &mut Image, x: [f32; 2], y: [f32; 2], colour: Colour, ink: Colour) {
    let ([x0, x1], [y0, y1]) = (x.map(|c| c as i64), y.map(|c| c as i64));
    image.fill([x0, x1], [y0, y1], ink);
    image.fill([x0 + 1, x1 - 1], [y0 + 1, y1 - 1], colour);
}

/// Straight lines that spheres in front of them hide.
pub(super) fn lines(image: &mut Image, lines: &[[[f64; 3]; 2]], raster: &Raster, look: &Look, frame: &Frame) {
    let projection = &raster.projection;
    let n = look.samples.max(1) as f32;
    let half = (0.0007 * look.height as f32).max(0.7);
    for [a, b] in lines {
        let (Some((p, pz, _)), Some((q, qz, _))) = (projection.point(*a), projection.point(*b)) else {
            continue;
        };
        let (p, q) = (p.map(|c| c / n), q.map(|c| c / n));
        let along = [q[0] - p[0], q[1] - p[1]];
        let square = (along[0] * along[0] + along[1] * along[1]).max(1e-6);
        let (lo, hi) = (|k: usize| p[k].min(q[k]) - half - 1.0, |k: usize| p[k].max(q[k]) + half + 1.0);
        let range = |k: usize, most: usize| (lo(k).max(0.0) as i64, hi(k).min(most as f32) as i64);
        // Lines end where the legend begins.
        let ((x0, x1), (y0, y1)) = (range(0, (frame.room[0] / n) as usize), range(1, look.height));
        for y in y0..y1 {
            for x in x0..x1 {
                let d = [x as f32 + 0.5 - p[0], y as f32 + 0.5 - p[1]];
                let t = ((d[0] * along[0] + d[1] * along[1]) / square).clamp(0.0, 1.0);
                let off = ((d[0] - t * along[0]).powi(2) + (d[1] - t * along[1]).powi(2)).sqrt();
                let cover = (half + 0.5 - off).clamp(0.0, 1.0);
                let sample = |c: i64| ((c as f32 + 0.5) * n) as i32;
                let depth = raster.depth_at(sample(x), sample(y)).unwrap_or(f32::NEG_INFINITY);
                if cover > 0.0 && pz + t * (qz - pz) >= depth {
                    image.blend(x, y, look.ink, 0.75 * cover);
                }
            }
        }
    }
}
