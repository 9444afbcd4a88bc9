//! Animated PNG: a PNG file whose further pictures stand in chunks of their own (PNG specification, third edition, 11.3.6).

use crate::image::Image;
use flate2::Crc;
use std::fs::File;
use std::io::{Error, Result, Seek, SeekFrom, Write};

/// What a PNG file begins with.
const SIGNATURE: [u8; 8] = *b"\x89PNG\r\n\x1a\n";
/// Where the chunk stands that counts the pictures: behind the signature and the chunk IHDR.
const COUNT: u64 = 8 + 12 + 13;
/// Bytes of the chunk IEND, over which the next picture is written.
const END: i64 = 12;

/// A file that is whole after each picture.
#[derive(Debug)]
pub struct Apng {
    file: File,
    size: [usize; 2],
    /// How long a picture is shown [ms].
    delay: u16,
    pictures: u32,
    /// The number of the next chunk that has one.
    next: u32,
}

impl Apng {
    /// An empty file that shows so many pictures a second.
    pub fn new(file: File, size: [usize; 2], rate: f64) -> Result<Self> {
        let delay = (1000.0 / rate).round().clamp(1.0, f64::from(u16::MAX)) as u16;
        Ok(Self { file, size, delay, pictures: 0, next: 0 })
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// Those of the file.
    pub fn add(&mut self, image: &Image) -> Result<()> {
        let png = image.png()?;
        let mut out = vec![];
        if self.pictures == 0 {
            out.extend(SIGNATURE);
            for (kind, data) in chunks(&png).filter(|(kind, _)| kind == b"IHDR") {
                chunk(&mut out, &kind, data);
            }
            chunk(&mut out, b"acTL", &self.counted());
        }
        let control = self.control();
        chunk(&mut out, b"fcTL", &control);
        for (_, data) in chunks(&png).filter(|(kind, _)| kind == b"IDAT") {
            if self.pictures == 0 {
                chunk(&mut out, b"IDAT", data);
            } else {
                let number = self.number();
                chunk(&mut out, b"fdAT", &[&number[..], data].concat());
            }
        }
        chunk(&mut out, b"IEND", &[]);
        if self.pictures > 0 {
            self.file.seek(SeekFrom::End(-END))?;
        }
        self.file.write_all(&out)?;
        self.pictures =
            self.pictures.checked_add(1).ok_or(Error::other("more pictures than can be counted"))?;
        let mut count = vec![];
        chunk(&mut count, b"acTL", &self.counted());
        self.file.seek(SeekFrom::Start(COUNT))?;
        self.file.write_all(&count)
    }

    /// How many pictures there are, and that they are shown again and again.
    fn counted(&self) -> Vec<u8> {
        [self.pictures.max(1), 0].iter().flat_map(|n| n.to_be_bytes()).collect()
    }

    fn number(&mut self) -> [u8; 4] {
        self.next += 1;
        (self.next - 1).to_be_bytes()
    }

    /// What stands before a picture: that it is as large as the movie, how long it is shown, and that it replaces what was there.
    fn control(&mut self) -> Vec<u8> {
        let mut data = self.number().to_vec();
        let [width, height] = self.size.map(|n| n as u32);
        [width, height, 0, 0].iter().for_each(|n| data.extend(n.to_be_bytes()));
        data.extend(self.delay.to_be_bytes());
        data.extend(1000u16.to_be_bytes());
        data.extend([0, 0]);
        data
    }
}

/// Kinds and data of the chunks of a PNG file.
fn chunks(png: &[u8]) -> impl Iterator<Item = ([u8; 4], &[u8])> {
    let mut rest = png.get(SIGNATURE.len()..).unwrap_or_default();
    std::iter::from_fn(move || {
        let length = u32::from_be_bytes(rest.get(..4)?.try_into().ok()?) as usize;
        let (kind, data) = (rest.get(4..8)?.try_into().ok()?, rest.get(8..8 + length)?);
        rest = rest.get(12 + length..)?;
        Some((kind, data))
    })
}

fn chunk(out: &mut Vec<u8>, kind: &[u8; 4], data: &[u8]) {
    let mut sum = Crc::new();
    sum.update(kind);
    sum.update(data);
    out.extend((data.len() as u32).to_be_bytes());
    out.extend(kind);
    out.extend(data);
    out.extend(sum.sum().to_be_bytes());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_back_one_after_the_other_and_the_file_is_whole_after_each() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let mut movie = Apng::new(File::create(&path).unwrap(), [5, 3], 25.0).unwrap();
        let picture = |k: u8| Image { width: 5, height: 3, pixels: (0..15).map(|p| [k, p, 7 * p]).collect() };
        for k in 0..4u8 {
            movie.add(&picture(k)).unwrap();
            let file = std::io::BufReader::new(File::open(&path).unwrap());
            let mut reader = png::Decoder::new(file).read_info().unwrap();
            let control = *reader.info().animation_control().unwrap();
            assert_eq!((control.num_frames, control.num_plays), (u32::from(k) + 1, 0));
            for seen in 0..=k {
                let mut pixels = vec![0; 45];
                reader.next_frame(&mut pixels).unwrap();
                assert_eq!(pixels, picture(seen).pixels.as_flattened(), "{seen} of {k}");
                let shown = reader.info().frame_control().unwrap();
                assert_eq!((shown.delay_num, shown.delay_den), (40, 1000));
            }
        }
    }
}
