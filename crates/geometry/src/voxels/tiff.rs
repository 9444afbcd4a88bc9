//! Pages of TIFF files as tomographs and ImageJ write them: grey values in strips that are not packed.

use perigrain_base::gate;
use perigrain_mesh::vtk::numbers::Kind;
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// A page: its size, and where its rows are.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Columns and rows.
    pub size: [usize; 2],
    kind: Kind,
    big_endian: bool,
    /// Offset and length of the strips, from the first row on.
    strips: Vec<(u64, u64)>,
}

/// What is wrong with a file, in words for the user.
type Outcome<T> = Result<T, String>;

/// The most values of one tag.
const MANY: u64 = 1 << 22;

struct Reader {
    file: File,
    length: u64,
    big_endian: bool,
}

impl Reader {
    fn bytes(&mut self, at: u64, count: u64) -> Outcome<Vec<u8>> {
        if at.checked_add(count).is_none_or(|end| end > self.length) {
            return Err("it is cut off".into());
        }
        let mut bytes = vec![0; count as usize];
        let read = self.file.seek(SeekFrom::Start(at)).and_then(|_| self.file.read_exact(&mut bytes));
        read.map_err(|e| e.to_string())?;
        Ok(bytes)
    }

    fn whole(&self, kind: Kind, bytes: &[u8]) -> u64 {
        kind.read(bytes, self.big_endian) as u64
    }

    /// The numbers of an entry of twelve bytes, where they are whole ones.
    fn numbers(&mut self, entry: &[u8]) -> Outcome<Vec<u64>> {
        let kind = match self.whole(Kind::U16, &entry[2..4]) {
            1 | 2 => Kind::U8,
            3 => Kind::U16,
            4 => Kind::U32,
            _ => return Ok(vec![]),
        };
        let count = self.whole(Kind::U32, &entry[4..8]).min(MANY);
        let size = count * kind.size() as u64;
        let bytes = match size {
            0..=4 => entry[8..8 + size as usize].to_vec(),
            _ => self.bytes(self.whole(Kind::U32, &entry[8..12]), size)?,
        };
        Ok(bytes.chunks_exact(kind.size()).map(|b| self.whole(kind, b)).collect())
    }
}

/// The pages of a file.
///
/// # Errors
/// Files that are none, and kinds of TIFF that are not in perigrain, by name.
pub fn pages(path: &Path) -> Outcome<Vec<Page>> {
    let file = gate::open(path).map_err(|e| e.to_string())?;
    let length = file.metadata().map_err(|e| e.to_string())?.len();
    let mut r = Reader { file, length, big_endian: false };
    let head = r.bytes(0, 8)?;
    r.big_endian = &head[..2] == b"MM";
    match (&head[..2], r.whole(Kind::U16, &head[2..4])) {
        (b"II" | b"MM", 42) => {}
        (b"II" | b"MM", 43) => return Err("BigTIFF is not in perigrain yet".into()),
        _ => return Err("it is no TIFF file".into()),
    }
    let mut at = r.whole(Kind::U32, &head[4..8]);
    let mut pages = vec![];
    let mut promised = 0;
    let mut seen = BTreeSet::new();
    while at != 0 {
        if !seen.insert(at) {
            return Err("its pages go round in a circle".into());
        }
        let count = r.bytes(at, 2)?;
        let count = r.whole(Kind::U16, &count);
        let entries = r.bytes(at + 2, 12 * count + 4)?;
        pages.extend(page(&mut r, &entries[..12 * count as usize], &mut promised)?);
        at = r.whole(Kind::U32, &entries[12 * count as usize..]);
    }
    match pages.len() {
        0 => Err("it has no page".into()),
        n if promised > n => {
            Err(format!("ImageJ's stacks of {promised} images in {n} pages are not in perigrain yet"))
        }
        _ => Ok(pages),
    }
}

/// A page by its entries; nothing for a preview of another.
fn page(r: &mut Reader, entries: &[u8], promised: &mut usize) -> Outcome<Option<Page>> {
    let (mut size, mut bits, mut packing, mut samples, mut format, mut preview) = ([0, 0], 1, 1, 1, 1, false);
    let (mut light, mut offsets, mut lengths) = (1, vec![], vec![]);
    for entry in entries.chunks_exact(12) {
        let tag = r.whole(Kind::U16, &entry[..2]);
        let list = r.numbers(entry)?;
        let first = list.first().copied().unwrap_or(0);
        match tag {
            254 => preview = first & 1 == 1,
            256 => size[0] = first as usize,
            257 => size[1] = first as usize,
            258 => bits = first,
            259 => packing = first,
            262 => light = first,
            270 => *promised = images(&list),
            273 => offsets = list,
            277 => samples = first,
            279 => lengths = list,
            322 => return Err("TIFF in tiles is not in perigrain yet".into()),
            339 => format = first,
            _ => {}
        }
    }
    if preview {
        return Ok(None);
    }
    if packing != 1 {
        return Err(format!(
            "packed TIFF (compression {packing}) is not in perigrain yet: save it without compression"
        ));
    }
    if samples != 1 || light != 1 {
        return Err("grey values are needed, with black as zero: it has colours or is a negative".into());
    }
    let kind = match (bits, format) {
        (8, 1) => Kind::U8,
        (8, 2) => Kind::I8,
        (16, 1) => Kind::U16,
        (16, 2) => Kind::I16,
        (32, 1) => Kind::U32,
        (32, 2) => Kind::I32,
        (32, 3) => Kind::F32,
        (64, 3) => Kind::F64,
        _ => return Err(format!("TIFF with {bits} bits of format {format} is not in perigrain yet")),
    };
    let strips: Vec<(u64, u64)> = offsets.into_iter().zip(lengths).collect();
    let wanted = (size[0] as u64).checked_mul(size[1] as u64).and_then(|n| n.checked_mul(kind.size() as u64));
    let have: u64 = strips.iter().map(|s| s.1).fold(0, u64::saturating_add);
    if wanted.is_none_or(|n| n == 0 || n > have || n > r.length) {
        return Err("a page is cut off".into());
    }
    Ok(Some(Page { size, kind, big_endian: r.big_endian, strips }))
}

/// The number of images that ImageJ states for a page.
fn images(text: &[u64]) -> usize {
    let text: String = text.iter().map(|c| char::from(*c as u8)).collect();
    let number = text.strip_prefix("ImageJ=").and_then(|t| t.lines().find_map(|l| l.strip_prefix("images=")));
    number.and_then(|n| n.trim().parse().ok()).unwrap_or(0)
}

/// The grey values of a page.
///
/// # Errors
/// A file that is cut off.
pub fn values(path: &Path, page: &Page) -> Outcome<Vec<f64>> {
    let file = gate::open(path).map_err(|e| e.to_string())?;
    let length = file.metadata().map_err(|e| e.to_string())?.len();
    let mut r = Reader { file, length, big_endian: page.big_endian };
    let count = page.size[0] * page.size[1];
    let mut values = Vec::with_capacity(count);
    for &(at, length) in &page.strips {
        values.extend(page.kind.read_all(&r.bytes(at, length)?, page.big_endian));
        if values.len() >= count {
            break;
        }
    }
    values.truncate(count);
    match values.len() == count {
        true => Ok(values),
        false => Err("a page is cut off".into()),
    }
}
