//! VTK's XML images (`.vti`).

use super::super::file::{File, not_read};
use super::{Image, Info, cut_off};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::gate;
use perigrain_lang::Word;
use perigrain_mesh::vtk::appended::{Appended, Place};
use perigrain_mesh::vtk::xml::{Array, Document, Piece};
use perigrain_world::World;
use std::fs;
use std::io::{BufReader, Read};

/// The most bytes of tags that are looked through for appended ones.
const HEAD: u64 = 1 << 20;

/// An image that was read whole.
struct Whole {
    info: Info,
    values: Vec<f64>,
    at: usize,
}

/// An image that is read slice by slice.
struct Streamed {
    info: Info,
    word: Word,
    name: String,
    place: Place,
    voxels: Appended<BufReader<fs::File>>,
    bytes: Vec<u8>,
    slice: usize,
}

/// Opens an image. Raw appended arrays are read as they are needed, other files whole.
pub fn open(w: &World, word: &Word, array: Option<&Word>) -> Result<Box<dyn Image>> {
    if let Some((file, voxels)) = head(w, word)
        && let Some(image) = streamed(&file, voxels, word, array).map_err(|e| file.blame(e))?
    {
        return Ok(Box::new(image));
    }
    let file = File::find(w, word, "image")?;
    let (info, values) = read(&file.bytes, word, array).map_err(|e| file.blame(e))?;
    Ok(Box::new(Whole { info, values, at: 0 }))
}

/// The tags of a file whose arrays stand raw behind them, and the file. Files that cannot be opened or understood are left to the
/// reader of the whole file.
fn head(w: &World, word: &Word) -> Option<(File, fs::File)> {
    if w.promised.get(&word.text).is_some() {
        return None;
    }
    let path = w.to_read(&word.text);
    let mut bytes = vec![];
    gate::open(&path).ok()?.take(HEAD).read_to_end(&mut bytes).ok()?;
    let tag = b"<AppendedData";
    let at = bytes.windows(tag.len()).position(|b| b == tag)?;
    let end = at + bytes[at..].iter().position(|b| *b == b'>')?;
    let begin = end + bytes[end..].iter().position(|b| *b == b'_')?;
    bytes.truncate(begin + 1);
    let raw = bytes[at..end].windows(3).any(|b| b == b"raw");
    if !raw || Document::read(&bytes, "ImageData").is_err() {
        return None;
    }
    let file = File { name: path.display().to_string(), bytes, at: word.span };
    Some((file, gate::open(&path).ok()?))
}

/// The image, unless its array stands among the tags.
fn streamed(file: &File, voxels: fs::File, word: &Word, array: Option<&Word>) -> Result<Option<Streamed>> {
    let document = Document::read(&file.bytes, "ImageData")?;
    let (info, piece, array) = described(&document, word, array)?;
    let Some(place) = document.place(array) else { return Ok(None) };
    let voxels = Appended::open(BufReader::new(voxels), &place).map_err(|e| match e.kind() {
        std::io::ErrorKind::UnexpectedEof => {
            let text = format!("the array `{}` is cut off", array.name);
            Diagnostic::error(Code::BAD_FILE, piece.at, text)
        }
        _ => Diagnostic::error(gate::code(&e), piece.at, format!("the voxels cannot be read: {e}")),
    })?;
    let size = place.kind.size() as u64;
    if voxels.length() % size != 0 {
        let text = format!("the {} bytes of this array are no whole numbers", voxels.length());
        return fail(Code::BAD_FILE, piece.at, text);
    }
    agree(array, voxels.length() / size, &info, piece)?;
    let (name, word) = (file.name.clone(), word.clone());
    Ok(Some(Streamed { info, word, name, place, voxels, bytes: vec![], slice: 0 }))
}

/// Checks that an array has one number for each voxel.
fn agree(array: &Array, numbers: u64, info: &Info, piece: &Piece) -> Result<()> {
    let voxels: usize = info.size.iter().product();
    if numbers == voxels as u64 && array.components == 1 {
        return Ok(());
    }
    let text = format!("the array `{}` has {numbers} numbers, and the image {voxels} voxels", array.name);
    fail(Code::INCOMPLETE, piece.at, text)
}

fn read(bytes: &[u8], word: &Word, chosen: Option<&Word>) -> Result<(Info, Vec<f64>)> {
    let document = Document::read(bytes, "ImageData")?;
    let (info, piece, array) = described(&document, word, chosen)?;
    let values = document.numbers(array)?;
    agree(array, values.len() as u64, &info, piece)?;
    Ok((info, values))
}

/// The image, its piece, and the chosen array, as the tags describe them.
fn described<'d>(
    document: &'d Document,
    word: &Word,
    chosen: Option<&Word>,
) -> Result<(Info, &'d Piece, &'d Array)> {
    let numbers = |name: &str, of: &[(String, String)]| -> Option<Vec<f64>> {
        let (_, text) = of.iter().find(|(n, _)| n == name)?;
        text.split_ascii_whitespace().map(|w| w.parse().ok()).collect()
    };
    let extent = numbers("WholeExtent", &document.attributes).filter(|e| e.len() == 6);
    let Some(extent) = extent.filter(|e| e.iter().all(|x| x.fract() == 0.0 && x.abs() < 1e9)) else {
        return fail(Code::BAD_NUMBER, document.at, "an image needs WholeExtent with six whole numbers");
    };
    let [piece] = &document.pieces[..] else {
        return Err(not_read(document.at, "an image in several pieces").into());
    };
    if numbers("Direction", &document.attributes).is_some_and(|d| d != [1., 0., 0., 0., 1., 0., 0., 0., 1.]) {
        return Err(not_read(document.at, "an image whose axes are turned (Direction)")
            .help("`rotate` turns it in the deck")
            .into());
    }
    let (array, of_cells) = choose(document, piece, word, chosen)?;
    let size = [0, 1, 2].map(|d| (extent[2 * d + 1] - extent[2 * d]).max(0.0) as usize);
    let size = if of_cells { size.map(|n| n.max(1)) } else { size.map(|n| n + 1) };
    let three = |name: &str| {
        numbers(name, &document.attributes).filter(|v| v.len() == 3 && v.iter().all(|x| x.is_finite()))
    };
    let spacing = three("Spacing").map(|s| [s[0], s[1], s[2]]).filter(|s| s.iter().all(|x| *x > 0.0));
    let origin = three("Origin").map_or([0.0; 3], |o| [o[0], o[1], o[2]]);
    let origin = [0, 1, 2].map(|d| origin[d] + extent[2 * d] * spacing.map_or(0.0, |s| s[d]));
    let info = Info { size, spacing, origin, centred: !of_cells };
    info.check(word)?;
    Ok((info, piece, array))
}

/// The array that is meant, and whether it belongs to cells.
fn choose<'p>(
    d: &Document,
    piece: &'p Piece,
    word: &Word,
    chosen: Option<&Word>,
) -> Result<(&'p Array, bool)> {
    let cells = d.arrays(piece, "CellData").map(|a| (a, true));
    let all: Vec<(&Array, bool)> = cells.chain(d.arrays(piece, "PointData").map(|a| (a, false))).collect();
    let names = || all.iter().map(|(a, _)| a.name.as_str()).collect::<Vec<_>>().join(", ");
    match (chosen, &all[..]) {
        (_, []) => fail(Code::INCOMPLETE, word.span, format!("the image `{}` holds no array", word.text)),
        (None, [one]) => Ok(*one),
        (None, _) => {
            let d = Diagnostic::error(Code::INCOMPLETE, word.span, "the image holds several arrays");
            Err(d.help(format!("say which one, `array NAME`: {}", names())).into())
        }
        (Some(name), _) => match all.iter().find(|(a, _)| a.name == name.text) {
            Some(found) => Ok(*found),
            None => {
                let d = Diagnostic::error(
                    Code::UNKNOWN_NAME,
                    name.span,
                    format!("the image has no array `{}`", name.text),
                );
                Err(d.help(format!("it has: {}", names())).into())
            }
        },
    }
}

impl Image for Whole {
    fn info(&self) -> &Info {
        &self.info
    }

    fn rewind(&mut self) -> Result<()> {
        self.at = 0;
        Ok(())
    }

    fn slice(&mut self, values: &mut Vec<f64>) -> Result<()> {
        let n = self.info.size[0] * self.info.size[1];
        values.clear();
        values.extend_from_slice(&self.values[self.at..self.at + n]);
        self.at += n;
        Ok(())
    }
}

impl Image for Streamed {
    fn info(&self) -> &Info {
        &self.info
    }

    fn rewind(&mut self) -> Result<()> {
        self.slice = 0;
        self.voxels.rewind().map_err(|e| cut_off(&self.name, [0, self.info.size[2]], &self.word, &e))
    }

    fn slice(&mut self, values: &mut Vec<f64>) -> Result<()> {
        let [nx, ny, nz] = self.info.size;
        self.bytes.resize(nx * ny * self.place.kind.size(), 0);
        let read = self.voxels.read_exact(&mut self.bytes);
        read.map_err(|e| cut_off(&self.name, [self.slice, nz], &self.word, &e))?;
        self.slice += 1;
        self.place.kind.read_into(&self.bytes, self.place.big_endian, values);
        Ok(())
    }
}
