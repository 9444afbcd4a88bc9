//! Surfaces of triangles that a deck names: the file, and the words that put it in its place.

use crate::BuildCx;
use crate::common::about;
use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::gate;
use perigrain_base::math::cformat::general;
use perigrain_lang::{Args, Word};
use perigrain_mesh::{Surface, Triangle};
use perigrain_words::Words;

/// How a file's numbers become places.
#[derive(Clone, Copy, Debug, PartialEq, Words)]
pub struct Placing {
    /// The scale, a factor on the numbers of the file.
    #[word(keyword, name = "S", positive, default = 1.0)]
    pub scale: f64,
    /// The shift, which is added then [length].
    #[word(keyword, name = "X Y Z", what = "a component of the shift", shown = "0 0 0")]
    pub shift: [f64; 3],
}

impl Default for Placing {
    fn default() -> Self {
        Self { scale: 1.0, shift: [0.0; 3] }
    }
}

impl Placing {
    /// The words that it knows.
    pub const KEYWORDS: [&str; 2] = ["scale", "shift"];

    /// Takes what stands behind `scale` or `shift`; `false` if the word is another one.
    ///
    /// # Errors
    /// Numbers that are missing or make no sense.
    pub fn keyword(&mut self, word: &Word, a: &mut Args) -> Result<bool> {
        match word.text.as_str() {
            "scale" => self.scale = a.positive("the scale")?,
            "shift" => self.shift = [a.number("x")?, a.number("y")?, a.number("z")?],
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Puts triangles in their place, in these units of length along the axes.
    pub fn apply(&self, triangles: &mut [Triangle], unit: [f64; 3]) {
        for p in triangles.as_flattened_mut() {
            (0..3).for_each(|d| p[d] = unit[d] * (self.scale * p[d] + self.shift[d]));
        }
    }
}

/// Reads the surface in a file without its triangles that have no area; nothing where [`read`] gives nothing.
///
/// # Errors
/// As [`read`], and a file without any other triangle.
pub fn read_faces(file: &Word, cx: &BuildCx) -> Result<Option<Surface>> {
    let Some(mut surface) = read(file, cx)? else { return Ok(None) };
    surface.leave_out_flat();
    let Some(first) = surface.left_out.first() else { return Ok(Some(surface)) };
    let text = match surface.left_out.len() {
        1 => format!("triangle {} of `{}` has no area", first + 1, file.text),
        n => format!("{n} triangles of `{}` have no area, the first is {}", file.text, first + 1),
    };
    if surface.triangles.is_empty() {
        let d = Diagnostic::error(Code::BAD_VALUE, file.span, format!("{text}, and there are no others"));
        return Err(d.into());
    }
    let note = Diagnostic::warning(Code::SUSPICIOUS, file.span, text + ": left out");
    cx.note(note.help("where corners of neighbours lie on its long side, nothing is missing without it"));
    Ok(Some(surface))
}

/// How many times as large as the box a surface may be before that is doubted; as much smaller, ten times so often.
const TIMES: f64 = 100.0;

/// Warns of a surface in its place whose size has nothing to do with that of the box: files are often in millimetres.
pub fn doubt_size(file: &Word, placed: &[Triangle], cx: &BuildCx) {
    let Some(domain) = cx.world.domain.as_ref().filter(|_| !placed.is_empty() && !cx.world.unseen.space)
    else {
        return;
    };
    let bounds = |d: usize| {
        let along = placed.as_flattened().iter().map(|p| p[d]);
        along.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)])
    };
    let widest = (0..3).map(bounds).map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
    let times = widest / domain.lengths().into_iter().fold(0.0, f64::max);
    if !times.is_finite() || (1.0 / (10.0 * TIMES)..TIMES).contains(&times) {
        return;
    }
    // Units of length differ by thousands; what is left is a fraction of the box to a hundred times it.
    let scale = 10f64.powf(-3.0 * (times.log10() / 3.0).round());
    let (size, other) = if times > 1.0 { (times, "large") } else { (1.0 / times, "small") };
    let text = format!("the mesh `{}` is {} times as {other} as the box", file.text, about(size));
    let help =
        format!("did you mean `scale {}`? its numbers count in the deck's unit of length", general(scale, 9));
    cx.note(Diagnostic::warning(Code::SUSPICIOUS, file.span, text).help(help));
}

/// Reads the surface in a file; nothing where a line above may write it, and it is not there yet (`perigrain check`).
///
/// # Errors
/// Files that cannot be read, are broken, or hold no triangles.
pub fn read(file: &Word, cx: &BuildCx) -> Result<Option<Surface>> {
    let bytes = match gate::read(cx.world.to_read(&file.text)) {
        Ok(bytes) => cx.world.read_files.plain_bytes(&file.text, bytes),
        Err(_) if cx.world.promised.may_come(&file.text) => return Ok(None),
        Err(e) => {
            let text = format!("the file `{}` cannot be read: {e}", file.text);
            return fail(gate::code(&e), file.span, text);
        }
    };
    match perigrain_mesh::read(&file.text, &bytes) {
        Err(bad) => fail(Code::NO_FILE, file.span, format!("`{}` {bad}", file.text)),
        Ok(surface) if surface.triangles.is_empty() => {
            fail(Code::BAD_VALUE, file.span, format!("`{}` holds no triangles", file.text))
        }
        Ok(surface) => {
            if surface.comments > 0 {
                let text = format!(
                    "`{}` has {} lines that begin with `#`, which STL does not know: they are taken for comments",
                    file.text, surface.comments
                );
                cx.note(Diagnostic::note(Code::SUSPICIOUS, file.span, text));
            }
            Ok(Some(surface))
        }
    }
}
