//! Pictures of spheres: depth, light and shade, colour maps with a legend, written as PNG, JPEG or PPM.

mod camera;
mod colour;
mod drawing;
mod gaps;
mod glyphs;
mod overlay;
mod raster;
mod scale_bar;
mod shade;
mod text;
mod walls;

pub use camera::{Camera, View};
pub use colour::{Colour, MAPS, Map, by_kind, colour_by_name, colour_names};
pub use overlay::{Legend, ticks};
pub use scale_bar::ScaleBar;
pub use walls::edges;

use raster::Raster;

/// How the picture looks apart from what is in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Pixels from left to right.
    pub width: usize,
    /// Pixels from top to bottom.
    pub height: usize,
    /// Samples per pixel along each side: 1 is fast and jagged, 2 is good, 3 is for print.
    pub samples: usize,
    /// Colours at the top and the bottom of the background.
    pub background: [Colour; 2],
    /// Strength of the shade in gaps and cracks, 0 to 1.
    pub occlusion: f32,
    /// Strength of the highlight, 0 to 1.
    pub shiny: f32,
    /// How much the far end fades into the background, 0 to 1.
    pub haze: f32,
    /// Colour of lines and text.
    pub ink: Colour,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 960,
            samples: 2,
            background: [Colour::hex(0xffffff), Colour::hex(0xe6ebf0)],
            occlusion: 0.8,
            shiny: 0.25,
            haze: 0.15,
            ink: Colour::hex(0x30363d),
        }
    }
}

/// What is in a picture. Slices of one length, one entry per sphere.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// Centres.
    pub positions: &'a [[f64; 3]],
    /// Radii.
    pub radii: &'a [f64],
    /// Colours.
    pub colours: &'a [Colour],
    /// Straight lines, such as the edges of the box.
    pub lines: &'a [[[f64; 3]; 2]],
    /// Triangles of walls, through which one sees.
    pub walls: &'a [[[f64; 3]; 3]],
    /// The length that stands at the bottom right.
    pub scale: Option<&'a ScaleBar>,
    /// The scale beside the picture.
    pub legend: Option<&'a Legend>,
    /// A line of text at the top left.
    pub title: &'a str,
    /// A line of text at the bottom left.
    pub caption: &'a str,
}

/// A finished picture, three bytes per pixel, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Pixels from left to right.
    pub width: usize,
    /// Pixels from top to bottom.
    pub height: usize,
    /// Red, green, blue.
    pub pixels: Vec<[u8; 3]>,
}

/// Draws a scene. Same bits for any number of threads. A picture without pixels if the present work was requested to end.
pub fn render(scene: &Scene<'_>, view: &View, look: &Look) -> Image {
    let frame = Frame::new(scene, look);
    let raster = Raster::new(scene, view, &frame);
    if raster.cut {
        return Image { width: 0, height: 0, pixels: vec![] };
    }
    let mut image = shade::shade(scene, &raster, look, &frame);
    walls::draw(&mut image, scene.walls, &raster, look, &frame);
    overlay::lines(&mut image, scene.lines, &raster, look, &frame);
    overlay::words(&mut image, scene, look);
    if let Some(bar) = scene.scale {
        bar.draw(&mut image, &raster.projection, look, &frame);
    }
    image
}

/// The part of the picture that the spheres get; the rest is for the legend.
#[derive(Clone, Copy, Debug)]
struct Frame {
    /// Pixels of the whole picture, supersampled.
    width: usize,
    height: usize,
    /// Where the centre of the view lies, in supersampled pixels.
    centre: [f32; 2],
    /// Height and width that the view's span is fitted into, in supersampled pixels.
    room: [f32; 2],
}

impl Frame {
    fn new(scene: &Scene<'_>, look: &Look) -> Self {
        let n = look.samples.max(1);
        let legend = scene.legend.map_or(0, |l| l.width(look)) * n;
        let top = if scene.title.is_empty() { 0 } else { overlay::line_height(look) * n };
        let below = !scene.caption.is_empty() || scene.scale.is_some();
        let bottom = if below { overlay::line_height(look) * n } else { 0 };
        let (width, height) = (look.width * n, look.height * n);
        let room =
            [width.saturating_sub(legend).max(1) as f32, (height.saturating_sub(top + bottom)).max(1) as f32];
        Self { width, height, centre: [room[0] / 2.0, top as f32 + room[1] / 2.0], room }
    }
}

/// Of JPEG files on the usual scale to 100, as of LAMMPS 22Jul2025's.
const QUALITY: u8 = 85;

/// A kind of picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Exact and small.
    Png,
    /// Small, colours nearly as they were.
    Jpeg,
    /// Exact and plain.
    Ppm,
}

/// File extensions and the kinds of file they stand for.
pub const ENDINGS: &[(&str, Kind)] = &[
    (".png", Kind::Png),
    (".PNG", Kind::Png),
    (".jpg", Kind::Jpeg),
    (".JPG", Kind::Jpeg),
    (".jpeg", Kind::Jpeg),
    (".JPEG", Kind::Jpeg),
    (".ppm", Kind::Ppm),
];

impl Image {
    /// The picture as a file of the kind that its name's extension stands for; PNG by default.
    pub fn file(&self, name: &str) -> std::io::Result<Vec<u8>> {
        match ENDINGS.iter().find(|(ending, _)| name.ends_with(ending)).map(|(_, kind)| kind) {
            Some(Kind::Jpeg) => self.jpeg(),
            Some(Kind::Ppm) => Ok(self.ppm()),
            _ => self.png(),
        }
    }

    /// The picture as a JPEG file, all colours at full resolution.
    ///
    /// # Errors
    /// More than 65,535 pixels along a side.
    fn jpeg(&self) -> std::io::Result<Vec<u8>> {
        let side = |n: usize| u16::try_from(n).map_err(std::io::Error::other);
        let mut bytes = vec![];
        let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, QUALITY);
        encoder.set_sampling_factor(jpeg_encoder::SamplingFactor::F_1_1);
        let (width, height) = (side(self.width)?, side(self.height)?);
        encoder
            .encode(self.pixels.as_flattened(), width, height, jpeg_encoder::ColorType::Rgb)
            .map_err(std::io::Error::other)?;
        Ok(bytes)
    }

    /// The picture as a binary PPM file.
    pub fn ppm(&self) -> Vec<u8> {
        let head = format!("P6\n{} {}\n255\n", self.width, self.height);
        [head.as_bytes(), self.pixels.as_flattened()].concat()
    }

    /// The picture as a PNG file.
    pub fn png(&self) -> std::io::Result<Vec<u8>> {
        let mut bytes = vec![];
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let mut writer = encoder.write_header().map_err(std::io::Error::other)?;
        writer.write_image_data(self.pixels.as_flattened()).map_err(std::io::Error::other)?;
        writer.finish().map_err(std::io::Error::other)?;
        Ok(bytes)
    }

    /// Mixes a colour over a pixel; outside the picture nothing happens.
    fn blend(&mut self, x: i64, y: i64, colour: Colour, cover: f32) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x >= self.width || y >= self.height {
            return;
        }
        let pixel = &mut self.pixels[y * self.width + x];
        let under = Colour::from_bytes(*pixel);
        *pixel = under.mix(colour, cover).bytes();
    }

    /// Fills a rectangle.
    fn fill(&mut self, x: [i64; 2], y: [i64; 2], colour: Colour) {
        for row in y[0]..y[1] {
            for column in x[0]..x[1] {
                self.blend(column, row, colour, 1.0);
            }
        }
    }
}

#[cfg(test)]
mod tests;
