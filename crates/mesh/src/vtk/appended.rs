//! Raw appended bytes of VTK XML files, optionally compressed by zlib, read on demand.

use super::numbers::Kind;
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom};

/// Deflate compresses at most about a thousand bytes into one: a higher ratio is forged.
pub const DENSEST: u64 = 1100;

/// Location and encoding of an array in its file.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// First byte of its header.
    pub start: u64,
    /// Number type.
    pub kind: Kind,
    /// Byte order of the numbers and of the header.
    pub big_endian: bool,
    /// Whether header numbers have eight bytes instead of four.
    pub wide: bool,
    /// Whether blocks are compressed by zlib.
    pub packed: bool,
}

/// The bytes of an array, in order.
pub struct Appended<R> {
    file: R,
    /// First byte after the header.
    begin: u64,
    /// Uncompressed size of the array in bytes.
    length: u64,
    /// Compressed size of each block, and uncompressed size of all but the last; `None` without compression.
    blocks: Option<(Vec<u64>, u64)>,
    next: usize,
    /// Bytes still to be read: of the whole array, or of the current block after decompression.
    left: u64,
    block: Vec<u8>,
}

fn damaged(what: &str) -> Error {
    Error::new(ErrorKind::InvalidData, what)
}

impl<R: Read + Seek> Appended<R> {
    /// Reads the header.
    ///
    /// # Errors
    /// I/O errors; files that end before the array, or with invalid headers.
    pub fn open(mut file: R, place: &Place) -> Result<Self> {
        let end = file.seek(SeekFrom::End(0))?;
        file.seek(SeekFrom::Start(place.start))?;
        let kind = if place.wide { Kind::U64 } else { Kind::U32 };
        let mut read = 0;
        let mut word = |file: &mut R| {
            let mut bytes = [0; 8];
            let bytes = &mut bytes[..kind.size()];
            read += bytes.len() as u64;
            file.read_exact(bytes).map(|()| kind.whole(bytes, place.big_endian))
        };
        let cut = || Error::from(ErrorKind::UnexpectedEof);
        let first = word(&mut file)?;
        let room = end.saturating_sub(place.start);
        let (length, blocks) = if place.packed {
            let (size, last) = (word(&mut file)?, word(&mut file)?);
            if first.checked_mul(kind.size() as u64).is_none_or(|n| n > room) {
                return Err(cut());
            }
            let each: Vec<u64> = (0..first).map(|_| word(&mut file)).collect::<Result<_>>()?;
            let whole = first.saturating_sub(u64::from(last > 0));
            let length = size.saturating_mul(whole).saturating_add(if first > 0 { last } else { 0 });
            if each.iter().try_fold(0u64, |n, b| n.checked_add(*b)).is_none_or(|n| n > room) {
                return Err(cut());
            }
            (length, Some((each, size)))
        } else {
            (first, None)
        };
        let begin = place.start + read;
        if blocks.is_none() && length > end.saturating_sub(begin) {
            return Err(cut());
        }
        let left = if blocks.is_none() { length } else { 0 };
        Ok(Self { file, begin, length, blocks, next: 0, left, block: vec![] })
    }

    /// Uncompressed size of the array in bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Returns to the first byte.
    ///
    /// # Errors
    /// I/O errors.
    pub fn rewind(&mut self) -> Result<()> {
        self.next = 0;
        self.left = if self.blocks.is_none() { self.length } else { 0 };
        self.file.seek(SeekFrom::Start(self.begin)).map(drop)
    }

    /// Decompresses the next block; `false` if there is none.
    fn unpack(&mut self) -> Result<bool> {
        let Some((each, size)) = &self.blocks else { return Ok(false) };
        let Some(&packed) = each.get(self.next) else { return Ok(false) };
        // The last block has the remaining bytes.
        let before = size.saturating_mul(self.next as u64);
        let rest = self.length.saturating_sub(before);
        let want = if self.next + 1 == each.len() { rest } else { *size };
        if want > packed.saturating_mul(DENSEST) {
            return Err(damaged("a block is damaged"));
        }
        self.block.clear();
        let mut bytes = vec![0; packed as usize];
        self.file.read_exact(&mut bytes)?;
        let unpacked = flate2::read::ZlibDecoder::new(&bytes[..]).take(want + 1).read_to_end(&mut self.block);
        if unpacked.is_err() || self.block.len() as u64 != want {
            return Err(damaged("a block cannot be unpacked"));
        }
        self.next += 1;
        self.left = want;
        Ok(true)
    }
}

impl<R: Read + Seek> Read for Appended<R> {
    fn read(&mut self, to: &mut [u8]) -> Result<usize> {
        while self.left == 0 {
            if !self.unpack()? {
                return Ok(0);
            }
        }
        let n = to.len().min(usize::try_from(self.left).unwrap_or(usize::MAX));
        let n = match self.blocks {
            None => self.file.read(&mut to[..n])?,
            Some(_) => {
                let at = self.block.len() - self.left as usize;
                to[..n].copy_from_slice(&self.block[at..at + n]);
                n
            }
        };
        self.left -= n as u64;
        Ok(n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Cursor, Write};

    fn zlib(bytes: &[u8]) -> Vec<u8> {
        let mut writer = flate2::write::ZlibEncoder::new(vec![], flate2::Compression::default());
        writer.write_all(bytes).unwrap();
        writer.finish().unwrap()
    }

    fn word(n: usize, wide: bool) -> Vec<u8> {
        if wide { (n as u64).to_le_bytes().to_vec() } else { (n as u32).to_le_bytes().to_vec() }
    }

    /// Three other bytes, then the array.
    fn file(bytes: &[u8], place: &Place) -> Vec<u8> {
        let mut all = vec![b'<', b'>', b'_'];
        if !place.packed {
            all.extend(word(bytes.len(), place.wide));
            all.extend(bytes);
            return all;
        }
        let blocks: Vec<Vec<u8>> = bytes.chunks(16).map(zlib).collect();
        for n in [blocks.len(), 16, bytes.len() % 16].into_iter().chain(blocks.iter().map(Vec::len)) {
            all.extend(word(n, place.wide));
        }
        all.extend(blocks.concat());
        all
    }

    #[test]
    fn arrays_are_read_from_any_way_of_keeping_them() {
        for (packed, wide, count) in [
            (false, false, 50),
            (false, true, 0),
            (true, true, 50),
            (true, false, 48),
            (true, true, 0),
            (true, true, 7),
        ] {
            let place = Place { start: 3, kind: Kind::U8, big_endian: false, wide, packed };
            let bytes: Vec<u8> = (0..count).map(|k| (k * 7) as u8).collect();
            let mut a = Appended::open(Cursor::new(file(&bytes, &place)), &place).unwrap();
            assert_eq!(a.length(), count as u64);
            for _ in 0..2 {
                let mut have = vec![];
                a.read_to_end(&mut have).unwrap();
                assert_eq!(have, bytes, "{place:?}");
                a.rewind().unwrap();
            }
        }
    }

    /// Sizes beyond the file length must not allocate memory.
    #[test]
    fn forged_headers_are_refused() {
        let bytes = [1u8; 40];
        for packed in [false, true] {
            let place = Place { start: 3, kind: Kind::U8, big_endian: false, wide: true, packed };
            let good = file(&bytes, &place);
            for at in 3..if packed { 3 + 6 * 8 } else { 11 } {
                let mut bad = good.clone();
                bad[at] ^= 0x7f;
                let read =
                    Appended::open(Cursor::new(bad), &place).and_then(|mut a| a.read_to_end(&mut vec![]));
                // The number of blocks may become smaller; then so does the array.
                assert!(read.is_err() || read.is_ok_and(|n| n != bytes.len()), "byte {at}");
            }
            let cut = Appended::open(Cursor::new(&good[..good.len() - 5]), &place)
                .and_then(|mut a| a.read_to_end(&mut vec![]));
            assert!(cut.is_err());
        }
    }
}
