//! Pictures in the terminal: two pixels per character with half blocks, or shades of characters without colours.

use perigrain_output::image::{Colour, Map};
use std::fmt::Write;

/// What a terminal can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// 16 million colours.
    True,
    /// The 256 colours of xterm.
    Indexed,
    /// None: characters from dark to bright.
    None,
}

/// Characters from nothing to full.
const SHADES: &[u8; 10] = b".:-=+*o#%@";

impl Ink {
    /// What standard output can show, by `COLORTERM` and `NO_COLOR`.
    pub fn of_stdout() -> Self {
        if !std::io::IsTerminal::is_terminal(&std::io::stdout()) || !crate::cli::progress::colors_wanted() {
            return Ink::None;
        }
        let term = std::env::var("COLORTERM").unwrap_or_default();
        if term.contains("truecolor") || term.contains("24bit") { Ink::True } else { Ink::Indexed }
    }

    /// The escape sequence that makes `layer` (38 text, 48 ground) of this colour.
    fn escape(self, layer: u8, [r, g, b]: [u8; 3]) -> String {
        match self {
            Ink::True => format!("\x1b[{layer};2;{r};{g};{b}m"),
            Ink::Indexed => {
                // The colour cube of xterm: 6 levels per channel from index 16.
                let level = |c: u8| (u16::from(c) * 5 + 127) / 255;
                format!("\x1b[{layer};5;{}m", 16 + 36 * level(r) + 6 * level(g) + level(b))
            }
            Ink::None => String::new(),
        }
    }
}

/// A grid of pixels, some of them empty, from the top left.
pub struct Picture {
    width: usize,
    pixels: Vec<Option<Pixel>>,
}

/// A pixel's colour, and how bright it is where there are no colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// sRGB.
    pub rgb: [u8; 3],
    /// From 0 to 1.
    pub shade: f64,
}

impl Pixel {
    /// A colour with its own brightness.
    pub fn plain(rgb: [u8; 3]) -> Self {
        let [r, g, b] = rgb.map(f64::from);
        Self { rgb, shade: (0.299 * r + 0.587 * g + 0.114 * b) / 255.0 }
    }

    /// A value on a colour map.
    pub fn of(map: &Map, value: f64, range: [f64; 2]) -> Self {
        let width = range[1] - range[0];
        let shade = if width > 0.0 { ((value - range[0]) / width).clamp(0.0, 1.0) } else { 0.0 };
        Self { rgb: Colour::bytes(map.of(value, range)), shade }
    }
}

impl Picture {
    /// An empty picture.
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, pixels: vec![None; width * height] }
    }

    /// Pixels from top to bottom.
    pub fn height(&self) -> usize {
        self.pixels.len() / self.width.max(1)
    }

    /// Sets a pixel; those outside are left out.
    pub fn set(&mut self, x: usize, y: usize, pixel: Pixel) {
        if x < self.width
            && let Some(p) = self.pixels.get_mut(y * self.width + x)
        {
            *p = Some(pixel);
        }
    }

    fn get(&self, x: usize, y: usize) -> Option<Pixel> {
        self.pixels.get(y * self.width + x).copied().flatten()
    }

    /// The picture as lines of text, two pixels above each other in one character.
    pub fn text(&self, ink: Ink) -> String {
        let mut out = String::new();
        for y in (0..self.height()).step_by(2) {
            let mut line = String::new();
            for x in 0..self.width {
                line += &character(self.get(x, y), self.get(x, y + 1), ink);
            }
            let end = if ink == Ink::None { "" } else { "\x1b[0m" };
            let _ = writeln!(out, "{}{end}", line.trim_end());
        }
        out
    }
}

/// One character for two pixels.
fn character(top: Option<Pixel>, bottom: Option<Pixel>, ink: Ink) -> String {
    if ink == Ink::None {
        return match (top, bottom) {
            (None, None) => " ".into(),
            (Some(a), Some(b)) => shade((a.shade + b.shade) / 2.0),
            (Some(a), None) | (None, Some(a)) => shade(a.shade),
        };
    }
    match (top, bottom) {
        (None, None) => "\x1b[0m ".into(),
        (Some(a), None) => format!("\x1b[0m{}▀", ink.escape(38, a.rgb)),
        (None, Some(b)) => format!("\x1b[0m{}▄", ink.escape(38, b.rgb)),
        (Some(a), Some(b)) => format!("{}{}▀", ink.escape(38, a.rgb), ink.escape(48, b.rgb)),
    }
}

fn shade(s: f64) -> String {
    let k = (s * SHADES.len() as f64) as usize;
    char::from(SHADES[k.min(SHADES.len() - 1)]).to_string()
}

/// A bar of the map's colours with the ends of the range.
pub fn legend(map: &Map, range: [f64; 2], ink: Ink) -> String {
    const WIDTH: usize = 32;
    let mut bar = Picture::new(WIDTH, 2);
    for x in 0..WIDTH {
        let value = range[0] + (range[1] - range[0]) * (x as f64 + 0.5) / WIDTH as f64;
        (0..2).for_each(|y| bar.set(x, y, Pixel::of(map, value, range)));
    }
    let number = crate::cli::progress::short;
    format!("{} {} {}\n", number(range[0]), bar.text(ink).trim_end(), number(range[1]))
}

/// A PNG file, averaged down to at most `width` × `height` pixels.
///
/// # Errors
/// What is wrong with the file, in words.
pub fn png(bytes: &[u8], width: usize, height: usize) -> Result<Picture, String> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let mut reader = decoder.read_info().map_err(|e| e.to_string())?;
    let size = reader.output_buffer_size().ok_or("it is too large")?;
    let mut data = vec![0; size];
    let info = reader.next_frame(&mut data).map_err(|e| e.to_string())?;
    let (w, h) = (info.width as usize, info.height as usize);
    let channels = info.color_type.samples();
    // Half blocks are about square: as many characters across as pixels, half as many down.
    let scale = (w as f64 / width as f64).max(h as f64 / height as f64).max(1.0);
    let (columns, rows) = ((w as f64 / scale).ceil() as usize, (h as f64 / scale).ceil() as usize);
    let mut picture = Picture::new(columns.max(1), rows.max(1));
    for y in 0..rows {
        for x in 0..columns {
            let mut sum = [0f64; 3];
            let mut count = 0.0;
            let within = |k: usize, n: usize| {
                let from = (k as f64 * scale) as usize;
                from.min(n - 1)..(((k + 1) as f64 * scale) as usize).clamp(from + 1, n.max(from + 1)).min(n)
            };
            for v in within(y, h) {
                for u in within(x, w) {
                    let p = &data[(v * w + u) * channels..];
                    let rgb = if channels < 3 { [p[0]; 3] } else { [p[0], p[1], p[2]] };
                    (0..3).for_each(|c| sum[c] += f64::from(rgb[c]));
                    count += 1.0;
                }
            }
            picture.set(x, y, Pixel::plain(sum.map(|s| (s / f64::max(count, 1.0)) as u8)));
        }
    }
    Ok(picture)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_hold_two_pixels() {
        let mut p = Picture::new(3, 3);
        p.set(0, 0, Pixel::plain([255; 3]));
        p.set(0, 1, Pixel::plain([255; 3]));
        p.set(1, 2, Pixel::plain([0; 3]));
        p.set(7, 7, Pixel::plain([0; 3]));
        assert_eq!(p.text(Ink::None), "@\n .\n");
        let text = p.text(Ink::True);
        assert!(text.starts_with("\x1b[38;2;255;255;255m\x1b[48;2;255;255;255m▀"), "{text:?}");
        assert!(p.text(Ink::Indexed).contains("\x1b[38;5;16m▀"));
    }

    #[test]
    fn a_png_is_averaged_down() {
        let mut bytes = vec![];
        let mut encoder = png::Encoder::new(&mut bytes, 4, 2);
        encoder.set_color(png::ColorType::Grayscale);
        let mut writer = encoder.write_header().unwrap();
        writer.write_image_data(&[0, 100, 255, 255, 100, 200, 255, 255]).unwrap();
        writer.finish().unwrap();
        let p = png(&bytes, 2, 9).unwrap();
        assert_eq!((p.width, p.height()), (2, 1));
        assert_eq!(p.get(0, 0).unwrap().rgb, [100; 3]);
        assert_eq!(p.get(1, 0).unwrap().rgb, [255; 3]);
        assert!(png(b"GIF89a", 2, 2).is_err());
    }
}
