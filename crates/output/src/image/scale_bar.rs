//! A bar of a round length at the bottom right of a picture.

use super::camera::Projection;
use super::overlay::{panel, text_size};
use super::{Frame, Image, Look, text};
use perigrain_base::math::cformat::general;

/// What lengths are called.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ScaleBar {
    /// Units and their powers of ten, from small to large; none in reduced units.
    pub units: &'static [(i32, &'static str)],
}

/// The bar takes no more than this part of the width.
const LONGEST: f64 = 0.2;

impl ScaleBar {
    /// The length of the bar where so much of the scene is as wide as the picture, and what stands beside it.
    pub fn of(&self, width: f64) -> Option<(f64, String)> {
        let most = LONGEST * width;
        if !(most.is_finite() && most > 0.0) {
            return None;
        }
        let power = most.log10().floor();
        // Powers below one as quotients, which round as their names do.
        let decade = if power < 0.0 { 1.0 / 10f64.powf(-power) } else { 10f64.powf(power) };
        let length = [5.0, 2.0, 1.0].map(|f| f * decade).into_iter().find(|l| *l <= most)?;
        let unit =
            self.units.iter().rev().find(|(e, _)| length >= 0.999 * 10f64.powi(*e)).or(self.units.first());
        let (exponent, name) = unit.copied().unwrap_or((0, ""));
        let number = general(length / 10f64.powi(exponent), 6);
        Some((length, format!("{number} {name}").trim_end().to_string()))
    }

    pub(super) fn draw(&self, image: &mut Image, projection: &Projection, look: &Look, frame: &Frame) {
        let n = look.samples.max(1) as f64;
        let room = f64::from(frame.room[0]) / n;
        let Some(scale) = projection.scale().map(|s| s / n) else { return };
        let Some((length, words)) = self.of(room / scale) else { return };
        let size = text_size(look);
        let (long, wide) = ((length * scale) as f32, text::width(&words, size));
        let (right, y) = (room as f32 - size, look.height as f32 - 2.0 * size);
        let left = right - wide;
        panel(image, look, [left - long - size, right + 0.4 * size], [y - 0.4 * size, y + 1.4 * size]);
        text::draw(image, &words, left, y, size, look.ink);
        let [from, to] = [left - 0.5 * size - long, left - 0.5 * size];
        let (middle, tick) = (y + 0.5 * size, 0.3 * size);
        let radius = (0.001 * look.height as f32).max(0.7);
        image.stroke(&[[from, middle], [to, middle]], radius, look.ink);
        for end in [from, to] {
            image.stroke(&[[end, middle - tick], [end, middle + tick]], radius, look.ink);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_round_and_no_longer_than_a_fifth() {
        let si = ScaleBar { units: &[(-9, "nm"), (-6, "µm"), (-3, "mm"), (0, "m")] };
        let of = |bar: &ScaleBar, width: f64| bar.of(width).map(|(_, words)| words);
        for (width, words) in [
            (0.3, "50 mm"),
            (1.0, "200 mm"),
            (5.0, "1 m"),
            (3e-6, "500 nm"),
            (0.0499, "5 mm"),
            (1e4, "2000 m"),
        ] {
            assert_eq!(of(&si, width).as_deref(), Some(words), "{width}");
        }
        let (length, _) = si.of(0.3).unwrap();
        assert!((length - 0.05).abs() < 1e-15);
        assert_eq!(of(&ScaleBar { units: &[] }, 30.0).as_deref(), Some("5"));
        assert_eq!([0.0, f64::NAN, f64::INFINITY].map(|w| of(&si, w)), [None, None, None]);
    }
}
