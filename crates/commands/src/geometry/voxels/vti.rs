//! VTK's XML images (`.vti`).

use super::super::file::{File, not_read};
use super::{Image, Info};
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_lang::Word;
use perigrain_mesh::vtk::xml::{Array, Document, Piece};
use perigrain_world::World;

struct Whole {
    info: Info,
    values: Vec<f64>,
    at: usize,
}

/// Opens an image; the file is read whole.
pub fn open(w: &World, word: &Word, array: Option<&Word>) -> Result<Box<dyn Image>> {
    let file = File::find(w, word, "image")?;
    let (info, values) = read(&file.bytes, word, array).map_err(|e| file.blame(e))?;
    Ok(Box::new(Whole { info, values, at: 0 }))
}

fn read(bytes: &[u8], word: &Word, chosen: Option<&Word>) -> Result<(Info, Vec<f64>)> {
    let document = Document::read(bytes, "ImageData")?;
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
    let (array, of_cells) = choose(&document, piece, word, chosen)?;
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
    let values = document.numbers(array)?;
    let voxels: usize = size.iter().product();
    if values.len() != voxels || array.components != 1 {
        let text =
            format!("the array `{}` has {} numbers, and the image {voxels} voxels", array.name, values.len());
        return fail(Code::INCOMPLETE, piece.at, text);
    }
    Ok((info, values))
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
