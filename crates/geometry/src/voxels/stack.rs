//! Stacks of PNG and TIFF images: one file a slice, or one file with several.

use super::tiff::{self, Page};
use super::{Image, Info, locate, passable, unreadable};
use crate::text::absent;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::gate;
use perigrain_lang::Word;
use perigrain_world::World;
use std::io::BufReader;
use std::path::{Path, PathBuf};

struct Stack {
    info: Info,
    word: Word,
    slices: Vec<(PathBuf, Source)>,
    next: usize,
}

/// Where in a file a slice is.
enum Source {
    Png,
    Tiff(Page),
}

/// Opens a stack: a name with a `*` for the numbers of its slices, or one file.
pub fn open(w: &World, word: &Word) -> Result<Box<dyn Image>> {
    let files = if word.text.contains('*') { find(w, word)? } else { vec![locate(w, word)?] };
    let lower = word.text.to_ascii_lowercase();
    let tiff = lower.ends_with(".tif") || lower.ends_with(".tiff");
    let mut slices = vec![];
    for file in files {
        if !tiff {
            slices.push((file, Source::Png));
            continue;
        }
        let pages = tiff::pages(&file).map_err(|why| damaged(&file, word, why))?;
        slices.extend(pages.into_iter().map(|page| (file.clone(), Source::Tiff(page))));
    }
    let size = match &slices[..] {
        [(_, Source::Tiff(page)), ..] => page.size,
        [(file, Source::Png), ..] => png_slice(file, word)?.0,
        [] => [0, 0],
    };
    let info =
        Info { size: [size[0], size[1], slices.len()], spacing: None, origin: [0.0; 3], centred: false };
    info.check(word)?;
    Ok(Box::new(Stack { info, word: word.clone(), slices, next: 0 }))
}

/// The error of an image that is not what it should be.
fn damaged(path: &Path, word: &Word, why: impl std::fmt::Display) -> Diagnostic {
    let text = format!("the image `{}` cannot be read: {why}", path.display());
    Diagnostic::error(Code::BAD_FILE, word.span, text)
}

/// The files whose names fit, in the order of their numbers.
fn find(w: &World, word: &Word) -> Result<Vec<PathBuf>> {
    let pattern = Path::new(&word.text);
    let name = pattern.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
    let folder = pattern.parent().unwrap_or(Path::new(""));
    let Some((begin, end)) = name.split_once('*').filter(|(_, end)| !end.contains('*')) else {
        return fail(Code::BAD_VALUE, word.span, "one `*` in the name of a slice stands for its number");
    };
    for base in [folder.to_path_buf(), w.folder.join(folder)] {
        let base = if base.as_os_str().is_empty() { PathBuf::from(".") } else { base };
        passable(&base, word)?;
        let Ok(list) = gate::names(&base) else { continue };
        let mut found: Vec<(u64, PathBuf)> = vec![];
        for path in list {
            let name = path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned());
            let middle = name.strip_prefix(begin).and_then(|n| n.strip_suffix(end));
            if let Some(number) =
                middle.filter(|m| m.bytes().all(|b| b.is_ascii_digit())).and_then(|m| m.parse().ok())
            {
                found.push((number, path));
            }
        }
        found.sort();
        if let Some(k) = found.windows(2).position(|f| f[0].0 == f[1].0) {
            let text =
                format!("`{}` and `{}` have the same number", found[k].1.display(), found[k + 1].1.display());
            return fail(Code::CONFLICT, word.span, text);
        }
        if !found.is_empty() {
            found.iter().for_each(|(_, path)| w.read_files.note(path));
            return Ok(found.into_iter().map(|(_, path)| path).collect());
        }
    }
    if w.promised.anything {
        return Err(perigrain_base::diag::unseen(word.span, &word.text));
    }
    Err(absent(word, &format!("no image `{}` is there, with digits for the `*`", word.text)))
}

/// Size and grey values of a PNG image.
fn png_slice(path: &Path, word: &Word) -> Result<([usize; 2], Vec<f64>)> {
    let file = gate::open(path).map_err(|e| unreadable(path, word, &e))?;
    let mut reader =
        png::Decoder::new(BufReader::new(file)).read_info().map_err(|e| damaged(path, word, e))?;
    let info = reader.info();
    let (width, height) = (info.width as usize, info.height as usize);
    if info.color_type != png::ColorType::Grayscale {
        let text =
            format!("the image `{}` has colours or transparency: grey values are needed", path.display());
        let d = Diagnostic::error(Code::BAD_FILE, word.span, text);
        return Err(d.help("save it as greyscale; ranges of colours are nothing to go by").into());
    }
    let Some(size) = reader.output_buffer_size() else {
        return fail(Code::TOO_LARGE, word.span, format!("the image `{}` is too large", path.display()));
    };
    if let Some(d) = perigrain_world::memory::lacking(9.0 * size as f64, "one slice of the image") {
        return Err(d.at(word.span).into());
    }
    let mut bytes = vec![0; size];
    let frame = reader.next_frame(&mut bytes).map_err(|e| damaged(path, word, e))?;
    let bits = frame.bit_depth as usize;
    let mut values = Vec::with_capacity(width * height);
    for row in bytes.chunks(frame.line_size.max(1)).take(height) {
        values.extend((0..width).map(|x| match bits {
            16 => f64::from(u16::from_be_bytes([row[2 * x], row[2 * x + 1]])),
            8 => f64::from(row[x]),
            // Several pixels in a byte, the first in the highest bits.
            _ => {
                let bit = x * bits;
                f64::from(row[bit / 8] >> (8 - bits - bit % 8) & ((1 << bits) - 1) as u8)
            }
        }));
    }
    Ok(([width, height], values))
}

impl Image for Stack {
    fn info(&self) -> &Info {
        &self.info
    }

    fn rewind(&mut self) -> Result<()> {
        self.next = 0;
        Ok(())
    }

    fn slice(&mut self, values: &mut Vec<f64>) -> Result<()> {
        let (path, source) = &self.slices[self.next];
        let (size, read) = match source {
            Source::Png => png_slice(path, &self.word)?,
            Source::Tiff(page) => {
                (page.size, tiff::values(path, page).map_err(|why| damaged(path, &self.word, why))?)
            }
        };
        let [nx, ny, _] = self.info.size;
        if size != [nx, ny] {
            let text = format!(
                "the image `{}` has {} x {} pixels, the first one {nx} x {ny}",
                path.display(),
                size[0],
                size[1]
            );
            return fail(Code::BAD_FILE, self.word.span, text);
        }
        self.next += 1;
        *values = read;
        Ok(())
    }
}
