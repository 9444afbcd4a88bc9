//! Text in a picture: an 8 × 8 bitmap font, smoothed to any size.

use font8x8::legacy::BASIC_LEGACY;

use super::{Colour, Image};

/// Width of a character for a height of text, in pixels; the glyphs are set a little closer than drawn.
fn advance(size: f32) -> f32 {
    0.94 * size
}

/// Width of a line of text in pixels.
pub(super) fn width(text: &str, size: f32) -> f32 {
    advance(size) * text.chars().count() as f32
}

/// Draws a line of text with its upper left corner at (x, y), `size` pixels high.
pub(super) fn draw(image: &mut Image, text: &str, x: f32, y: f32, size: f32, ink: Colour) {
    for (k, c) in text.chars().enumerate() {
        glyph(image, c, x + k as f32 * advance(size), y, size, ink);
    }
}

fn glyph(image: &mut Image, c: char, x: f32, y: f32, size: f32, ink: Colour) {
    let code = if c.is_ascii() { c as usize } else { spelled(c) as usize };
    let bits = BASIC_LEGACY[code.min(127)];
    let scale = size / 8.0;
    // The edge is as soft as one pixel.
    let soft = (0.55 / scale).min(0.5);
    for py in y.floor() as i64..(y + size).ceil() as i64 {
        for px in x.floor() as i64..(x + size).ceil() as i64 {
            let gx = (px as f32 + 0.5 - x) / scale;
            let gy = (py as f32 + 0.5 - y) / scale;
            let cover = ((field(bits, gx, gy) - 0.5) / soft + 0.5).clamp(0.0, 1.0);
            if cover > 0.0 {
                image.blend(px, py, ink, cover);
            }
        }
    }
}

/// The bitmap as a smooth field: a Gaussian over the dots, about one where ink is and zero where not.
fn field(bits: [u8; 8], gx: f32, gy: f32) -> f32 {
    let (mut sum, mut weights) = (0.0, 0.0);
    let (cx, cy) = (gx.floor() as i32, gy.floor() as i32);
    for y in cy - 1..=cy + 1 {
        for x in cx - 1..=cx + 1 {
            let (dx, dy) = (x as f32 + 0.5 - gx, y as f32 + 0.5 - gy);
            let weight = (-(dx * dx + dy * dy) * 1.9).exp();
            let on = (0..8).contains(&x) && (0..8).contains(&y) && bits[y as usize] >> x & 1 == 1;
            sum += if on { weight } else { 0.0 };
            weights += weight;
        }
    }
    sum / weights
}

/// An ASCII stand-in.
fn spelled(c: char) -> char {
    match c {
        'µ' | 'μ' => 'u',
        '×' => 'x',
        '–' | '−' => '-',
        _ => '?',
    }
}
