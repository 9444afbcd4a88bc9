//! Pictures as JPEG, read back by a decoder that others have written.

use std::io::Cursor;

use perigrain::output::image::Image;

/// A picture with slopes, edges and noise; neither side a multiple of eight.
fn picture(width: usize, height: usize) -> Vec<[u8; 3]> {
    let pixel = |k: usize| {
        let (x, y) = (k % width, k / width);
        let disc = (x as f64 - 20.0).hypot(y as f64 - 15.0) < 11.0;
        let shade = (200.0 * x as f64 / width as f64) as u8;
        match disc {
            true => [220, 40 + shade / 2, (k * 37 % 23) as u8],
            false => [250 - shade, 240, 255 - (y * 3) as u8],
        }
    };
    (0..width * height).map(pixel).collect()
}

#[test]
fn others_read_the_picture() {
    for (width, height) in [(53, 37), (8, 8), (1, 1), (64, 16)] {
        let pixels = picture(width, height);
        let file = Image { width, height, pixels: pixels.clone() }.file("a.jpg").unwrap();
        let mut reader = zune_jpeg::JpegDecoder::new(Cursor::new(file));
        let read = reader.decode().unwrap();
        assert_eq!(reader.dimensions(), Some((width, height)));
        let differences = read.iter().zip(pixels.as_flattened()).map(|(a, b)| f64::from(a.abs_diff(*b)));
        let (sum, most) = differences.fold((0.0, 0.0), |(sum, most): (f64, f64), d| (sum + d, most.max(d)));
        // Steps of the coarsest terms are 30: edges and noise are off by some of them, all else by one or two.
        let mean = sum / read.len() as f64;
        assert!(mean < 3.5 && most < 64.0, "{width} {height}: {mean} {most}");
    }
}
