//! A chart as PNG, drawn with the pens of the program's other pictures.

use super::{Chart, End, INK, Shape, WIDTH};
use perigrain_output::image::{Colour, Image};

/// Pixels per unit of the drawing.
const SCALE: f64 = 2.0;
/// Height of text.
const TEXT: f64 = 13.0;

impl Chart {
    /// The chart as a PNG file.
    ///
    /// # Errors
    /// Those of the encoder.
    pub fn png(&self) -> std::io::Result<Vec<u8>> {
        let drawing = self.drawing();
        let pixels = |length: f64| (length * SCALE).ceil() as usize;
        let mut image = Image::blank(pixels(WIDTH), pixels(drawing.height), Colour::hex(0xff_ffff));
        drawing.shapes.iter().for_each(|shape| shape.paint(&mut image));
        image.png()
    }
}

impl Shape {
    fn paint(&self, image: &mut Image) {
        let pixel = |[x, y]: [f64; 2]| [(SCALE * x) as f32, (SCALE * y) as f32];
        let size = (SCALE * TEXT) as f32;
        match self {
            Self::Path { points, width, colour } => {
                let places: Vec<[f32; 2]> = points.iter().map(|p| pixel(*p)).collect();
                image.stroke(&places, (0.5 * SCALE * width) as f32, Colour::hex(*colour));
            }
            Self::Dot { at, radius, colour } => {
                image.stroke(&[pixel(*at), pixel(*at)], (SCALE * radius) as f32, Colour::hex(*colour));
            }
            Self::Words { at, end, text } => {
                let width = Image::text_width(text, size);
                let [x, base] = pixel(*at);
                let left = match end {
                    End::Left => x,
                    End::Middle => x - 0.5 * width,
                    End::Right => x - width,
                };
                image.words(text, left, base - 0.87 * size, size, Colour::hex(INK));
            }
            Self::Upright { at, text } => {
                let width = Image::text_width(text, size).ceil();
                let mut flat =
                    Image::blank(width as usize + 2, (1.3 * size) as usize, Colour::hex(0xff_ffff));
                flat.words(text, 1.0, 0.0, size, Colour::hex(INK));
                let [x, y] = pixel(*at);
                image.put_upright(&flat, (x - 0.87 * size) as i64, (y + 0.5 * width) as i64);
            }
        }
    }
}
