//! Images of grey values: what is common to all kinds, and which reader takes which file.

pub mod blocks;
pub mod nrrd;
pub mod ranges;
mod stack;
mod tiff;
mod vti;

use crate::text::absent;
use perigrain_base::diag::{Code, Diagnostic, Result, fail, unseen};
use perigrain_base::gate;
use perigrain_lang::Word;
use perigrain_world::World;
use std::path::{Path, PathBuf};

/// The header of an image.
#[derive(Clone, Debug, PartialEq)]
pub struct Info {
    /// Voxels along x, y, z.
    pub size: [usize; 3],
    /// Their edges, where the file has them.
    pub spacing: Option<[f64; 3]>,
    /// The file's own corner or, if `centred`, the middle of its first voxel.
    pub origin: [f64; 3],
    /// What `origin` is.
    pub centred: bool,
}

/// What is kept of each layer of voxels besides one slice [byte].
const BYTES_PER_LAYER: f64 = 64.0;

impl Info {
    /// The lower corner of the image, its voxels having these edges.
    pub fn corner(&self, spacing: [f64; 3]) -> [f64; 3] {
        let half = if self.centred { 0.5 } else { 0.0 };
        [0, 1, 2].map(|d| self.origin[d] - half * spacing[d])
    }

    /// Checks that the image has voxels, and not more than can be counted.
    ///
    /// # Errors
    /// It has not.
    pub fn check(&self, word: &Word) -> Result<()> {
        let voxels = self.size.iter().try_fold(1usize, |n, s| n.checked_mul(*s));
        // A slice is kept whole, and counts of the materials of each block beside it.
        match voxels.filter(|n| *n > 0 && *n < 1 << 48) {
            None => {
                let text =
                    format!("an image of {} x {} x {} voxels", self.size[0], self.size[1], self.size[2]);
                fail(Code::BAD_FILE, word.span, format!("{text} cannot be"))
            }
            Some(_) => {
                let [nx, ny, nz] = self.size.map(|n| n as f64);
                let slice = perigrain_world::memory::lacking(40.0 * nx * ny, "one slice of the image");
                let all = || {
                    perigrain_world::memory::lacking(
                        BYTES_PER_LAYER * (nx + ny + nz),
                        "an image of so many layers",
                    )
                };
                slice.or_else(all).map_or(Ok(()), |d| Err(d.at(word.span).into()))
            }
        }
    }
}

/// An image that is read slice by slice, from the lowest z on.
pub trait Image {
    /// Its header.
    fn info(&self) -> &Info;

    /// Back to the first slice.
    ///
    /// # Errors
    /// The system's.
    fn rewind(&mut self) -> Result<()>;

    /// The grey values of the next slice, x fastest.
    ///
    /// # Errors
    /// A file that is cut off or damaged.
    fn slice(&mut self, values: &mut Vec<f64>) -> Result<()>;
}

/// Opens an image in the format of its name's extension; `array` chooses among several.
///
/// # Errors
/// Other extensions, missing files, and errors in them.
pub fn open(w: &World, word: &Word, array: Option<&Word>) -> Result<Box<dyn Image>> {
    let lower = word.text.to_ascii_lowercase();
    let ends = |endings: &[&str]| endings.iter().any(|e| lower.ends_with(e));
    if let Some(array) = array.filter(|_| !ends(&[".vti"])) {
        return fail(Code::CONFLICT, array.span, "`array` goes only with .vti files: others hold one array");
    }
    if ends(&[".vti"]) {
        return vti::open(w, word, array);
    }
    if ends(&[".nrrd", ".nhdr"]) {
        return nrrd::open(w, word);
    }
    if ends(&[".png", ".tif", ".tiff"]) {
        return stack::open(w, word);
    }
    let text = format!(
        "`{}` is no image that can be read: its name must end in .vti, .nrrd, .nhdr, .png, .tif or .tiff",
        word.text
    );
    Err(Diagnostic::error(Code::BAD_FILE, word.span, text)
        .help("a `*` in the name stands for the numbers of slices")
        .into())
}

/// Where a file is that is read as it is needed.
fn locate(w: &World, word: &Word) -> Result<PathBuf> {
    if w.promised.get(&word.text).is_some() {
        return Err(unseen(word.span, &word.text));
    }
    let path = w.to_read(&word.text);
    passable(&path, word)?;
    if gate::exists(&path) {
        return Ok(path);
    }
    if w.promised.anything {
        return Err(unseen(word.span, &word.text));
    }
    Err(absent(word, &format!("the image `{}` cannot be read: it is not there", word.text)))
}

fn passable(path: &Path, word: &Word) -> Result<()> {
    match gate::refuses(path) {
        false => Ok(()),
        true => {
            let text = format!("the image `{}` is not one that -safe lets a deck read", path.display());
            fail(Code::NOT_ALLOWED, word.span, text)
        }
    }
}

/// The error of a file that the system does not give.
fn unreadable(path: &Path, word: &Word, e: &std::io::Error) -> perigrain_base::diag::Diagnostics {
    let text = format!("the image `{}` cannot be read: {e}", path.display());
    Diagnostic::error(gate::code(e), word.span, text).into()
}

/// The error of a slice that cannot be read: which one, counted from 0, of how many.
fn cut_off(
    name: &str,
    [slice, of]: [usize; 2],
    word: &Word,
    e: &std::io::Error,
) -> perigrain_base::diag::Diagnostics {
    let slice = slice + 1;
    let text = match e.kind() {
        std::io::ErrorKind::UnexpectedEof => {
            format!("the image `{name}` is cut off: it ends within slice {slice} of {of}")
        }
        _ => format!("the image `{name}` cannot be read in slice {slice}: {e}"),
    };
    Diagnostic::error(Code::BAD_FILE, word.span, text).into()
}
