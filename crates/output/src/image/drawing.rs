//! Lines and words on a picture of any kind.

use super::{Colour, Image, text};

impl Image {
    /// A picture of one colour.
    pub fn blank(width: usize, height: usize, ground: Colour) -> Self {
        Self { width, height, pixels: vec![ground.bytes(); width * height] }
    }

    /// Draws a line through these places with a round pen of this radius [pixel].
    pub fn stroke(&mut self, places: &[[f32; 2]], radius: f32, ink: Colour) {
        // Piece by piece, for each is looked for in the rectangle that holds it.
        places.windows(2).for_each(|piece| text::ink_lines(self, &[piece.to_vec()], radius, ink));
    }

    /// Writes a line of text with its upper left corner at (x, y), `size` pixels high.
    pub fn words(&mut self, words: &str, x: f32, y: f32, size: f32, ink: Colour) {
        text::draw(self, words, x, y, size, ink);
    }

    /// Width of a line of text [pixel].
    pub fn text_width(words: &str, size: f32) -> f32 {
        text::width(words, size)
    }

    /// Puts a picture in, turned so that its rows run upwards: its lower left corner comes to the lower right of (x, y).
    pub fn put_upright(&mut self, other: &Self, x: i64, y: i64) {
        for (k, pixel) in other.pixels.iter().enumerate() {
            let (column, row) = ((k % other.width) as i64, (k / other.width) as i64);
            self.blend(x + row, y - column, Colour::from_bytes(*pixel), 1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_and_words_leave_ink_where_they_are() {
        let (white, black) = (Colour::hex(0xff_ffff), Colour::hex(0));
        let mut image = Image::blank(60, 40, white);
        image.stroke(&[[5.0, 5.5], [20.0, 5.5]], 1.0, black);
        let at = |image: &Image, x: usize, y: usize| image.pixels[y * image.width + x];
        assert_eq!((at(&image, 10, 5), at(&image, 10, 20)), ([0; 3], [255; 3]));
        let mut flat = Image::blank(20, 10, white);
        flat.words("I", 2.0, 0.0, 9.0, black);
        let dark = |image: &Image| image.pixels.iter().filter(|p| p[0] < 128).count();
        let (before, ink) = (dark(&image), dark(&flat));
        image.put_upright(&flat, 30, 35);
        assert!(ink > 0 && dark(&image) == before + ink);
        image.put_upright(&flat, 59, 0);
    }
}
