//! Packed files (`.gz`): whole ones, and one that grows and can be read after every piece.

use super::file::trouble;
use perigrain_base::diag::Result;
use perigrain_base::gate;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// A member of a gzip file without a name and a time.
const HEAD: [u8; 10] = [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 0xff];
/// What a flushed stream ends in, and the empty last block behind it.
const FLUSHED: [u8; 4] = [0, 0, 0xff, 0xff];
const LAST: [u8; 2] = [3, 0];
/// The last block, checksum and length: what the next piece is written over.
const ENDING: usize = 10;

/// Writes plainly, or as one gzip member packed at a level.
///
/// # Errors
/// The system's.
pub fn pack(
    to: &mut dyn Write,
    level: Option<flate2::Compression>,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> io::Result<()> {
    let Some(level) = level else { return write(to) };
    let mut packer = flate2::write::GzEncoder::new(to, level);
    write(&mut packer)?;
    packer.finish().map(|_| ())
}

/// A packed file that grows by pieces and is one gzip member after each: readers that know one member alone (OVITO) see all of it,
/// and what a killed run has left reads up to the last whole piece.
#[derive(Debug)]
pub struct Growing {
    file: File,
    level: flate2::Compression,
    /// Of all that the member holds unpacked.
    sum: crc32fast::Hasher,
    length: u32,
    /// Where the ending stands; `None` where nothing can be written over (a pipe): a member for each piece.
    end: Option<u64>,
}

impl Growing {
    /// Opens a file, at its end or from scratch.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn open(path: &Path, append: bool, level: flate2::Compression) -> Result<Self> {
        Self::opened(path, append, level).map_err(|e| trouble("write", path, &e).into())
    }

    fn opened(path: &Path, append: bool, level: flate2::Compression) -> io::Result<Self> {
        let mut readable = false;
        let mut file = gate::written(|| {
            gate::pass_written(path)?;
            let mut options = File::options();
            let options = options.create(true).write(true).truncate(!append);
            // What is there is looked at, if that is allowed: else a new member stands behind it.
            let both = options.clone().read(true).open(path);
            readable = both.is_ok();
            both.or_else(|_| options.open(path))
        })?;
        if !file.metadata()?.is_file() {
            return Ok(Self::fresh(file, level, None));
        }
        let size = file.seek(SeekFrom::End(0))?;
        if let Some((sum, length)) = ending(&mut file, size).filter(|_| readable) {
            let sum = crc32fast::Hasher::new_with_initial_len(sum, u64::from(length));
            return Ok(Self { file, level, sum, length, end: Some(size - ENDING as u64) });
        }
        file.seek(SeekFrom::Start(size))?;
        let mut fresh = Self::fresh(file, level, Some(size + HEAD.len() as u64));
        fresh.file.write_all(&HEAD)?;
        fresh.close()?;
        Ok(fresh)
    }

    fn fresh(file: File, level: flate2::Compression, end: Option<u64>) -> Self {
        Self { file, level, sum: crc32fast::Hasher::new(), length: 0, end }
    }

    /// Packs a piece behind the others and hands it to the system.
    ///
    /// # Errors
    /// The system's; the file ends with the piece before then, as far as it can be mended.
    pub fn add(&mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        let Some(end) = self.end else {
            return pack(&mut self.file, Some(self.level), write);
        };
        let (sum, length) = (self.sum.clone(), self.length);
        let outcome = self.written(end, write);
        if outcome.is_err() {
            (self.sum, self.length, self.end) = (sum, length, Some(end));
            // A full or missing disk has been reported already.
            let _ = self
                .file
                .set_len(end)
                .and_then(|()| self.file.seek(SeekFrom::Start(end)))
                .and_then(|_| self.close());
        }
        outcome
    }

    fn written(&mut self, end: u64, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
        self.file.seek(SeekFrom::Start(end))?;
        let at = {
            let packer = flate2::write::DeflateEncoder::new(&mut self.file, self.level);
            let mut counted = Counted { to: packer, sum: &mut self.sum, length: &mut self.length };
            write(&mut counted)?;
            let mut packer = counted.to;
            packer.flush()?;
            let at = packer.get_mut().stream_position()?;
            // The packer's own last block is longer at some levels: ours is written over it.
            packer.finish()?;
            at
        };
        self.file.seek(SeekFrom::Start(at))?;
        self.end = Some(at);
        self.close()
    }

    /// Writes the ending, behind which nothing stands.
    fn close(&mut self) -> io::Result<()> {
        let sum = self.sum.clone().finalize().to_le_bytes();
        let ending = [&LAST[..], &sum, &self.length.to_le_bytes()].concat();
        self.file.write_all(&ending)
    }
}

/// Checksum and length of the member a file ends with, if it can be continued: its last block is empty and begins with a byte.
fn ending(file: &mut File, size: u64) -> Option<(u32, u32)> {
    let mut tail = [0; FLUSHED.len() + ENDING];
    let fresh = size == (HEAD.len() + ENDING) as u64;
    file.seek(SeekFrom::Start(size.checked_sub(tail.len() as u64)?)).ok()?;
    file.read_exact(&mut tail).ok()?;
    let number = |at: usize| u32::from_le_bytes([tail[at], tail[at + 1], tail[at + 2], tail[at + 3]]);
    let flushed = tail[..4] == FLUSHED || fresh && tail[..4] == HEAD[6..];
    (flushed && tail[4..6] == LAST).then(|| (number(6), number(10)))
}

/// Counts and sums up what goes through.
struct Counted<'a, W> {
    to: W,
    sum: &'a mut crc32fast::Hasher,
    length: &'a mut u32,
}

impl<W: Write> Write for Counted<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.to.write(bytes)?;
        self.sum.update(&bytes[..n]);
        *self.length = self.length.wrapping_add(n as u32);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first member alone, which must be all there is.
    fn unpacked(path: &Path) -> String {
        let bytes = std::fs::read(path).unwrap();
        let mut first = flate2::bufread::GzDecoder::new(bytes.as_slice());
        let mut text = String::new();
        first.read_to_string(&mut text).unwrap();
        assert!(first.into_inner().is_empty(), "a second member");
        text
    }

    #[test]
    fn one_member_after_each_piece() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gz");
        for level in [0, 1, 6, 9] {
            let mut growing = Growing::open(&path, false, flate2::Compression::new(level)).unwrap();
            assert_eq!(unpacked(&path), "");
            let mut all = String::new();
            for k in 0..4 {
                // One longer than what packers hold back.
                let piece = format!("{k} ").repeat(if k == 2 { 100_000 } else { 3 });
                growing.add(|to| to.write_all(piece.as_bytes())).unwrap();
                all += &piece;
                assert_eq!(unpacked(&path), all, "level {level}");
                if k == 1 {
                    drop(growing);
                    growing = Growing::open(&path, true, flate2::Compression::new(level)).unwrap();
                    assert_eq!(unpacked(&path), all);
                }
            }
            let torn = growing.add(|to| {
                to.write_all(all.as_bytes())?;
                Err(io::Error::other("full"))
            });
            assert!(torn.is_err());
            assert_eq!(unpacked(&path), all, "a piece that fails leaves the others");
        }
    }

    #[test]
    fn what_others_have_packed_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.gz");
        let mut theirs = vec![];
        pack(&mut theirs, Some(flate2::Compression::default()), |to| to.write_all(b"theirs, ")).unwrap();
        std::fs::write(&path, &theirs).unwrap();
        let mut growing = Growing::open(&path, true, flate2::Compression::default()).unwrap();
        growing.add(|to| to.write_all(b"ours")).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let mut text = String::new();
        flate2::read::MultiGzDecoder::new(bytes.as_slice()).read_to_string(&mut text).unwrap();
        assert_eq!(text, "theirs, ours");
    }
}
