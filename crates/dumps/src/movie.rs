//! Dump `movie`: the pictures of `dump image` as a movie.

use super::base::{Base, Files};
use super::image::{Declared, Line};
use super::picture::{Later, foreign};
use super::{Dump, DumpStyle, MODIFY};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_output::dump::Target;
use perigrain_output::file::Pattern;
use perigrain_output::movie::{Pace, ffmpeg, is_own};
use perigrain_styles::words::{Form, Syntax, Words, read_or};
use perigrain_styles::{BuildCx, Doc, Style};
use std::path::Path;

/// The style.
pub struct Movie;

impl Style for Movie {
    fn name(&self) -> &'static str {
        "movie"
    }

    fn doc(&self) -> Doc {
        Doc {
            syntax: Syntax::Forms(
                const {
                    &[Form::behind(<(Line, Paces)>::GRAMMAR), Form::headed(MODIFY, <(Later, Paces)>::GRAMMAR)]
                },
            ),
            summary: "Draws the group's particles every N steps and makes a movie of the pictures.",
            text: "Pictures and their keywords are those of `dump image`. There is one file, without `*` in its name, for \
                   all runs until `undump` or the end of the deck.\n\n\
                   A name that ends in `.apng` or `.png` is written as an animated PNG, which browsers show, without any other program; \
                   it is whole after each picture. For all other names (`.mp4`, `.avi`, `.webm`, `.gif` …) the pictures go to the program \
                   ffmpeg, as in LAMMPS. Where ffmpeg is not found, and under `-safe`, which starts no program, a note says so and the movie \
                   is an animated PNG with the ending `.apng`.",
            example: "dump film all movie 10 crack.apng c_damage auto view 70 -60 map damage range 0 1 framerate 12",
        }
    }
}

/// How a movie is played and packed.
#[derive(Words)]
pub struct Paces {
    /// The number of pictures a second.
    #[word(keyword, name = "F", positive, shown = "24")]
    framerate: Option<f64>,
    /// Kilobits a second, where pictures are packed with losses.
    #[word(keyword, name = "K", what = "kilobits a second", from = 1, shown = "2000")]
    bitrate: Option<i64>,
}

impl Paces {
    /// What holds where it held otherwise before.
    pub fn of(&self, before: Pace) -> Pace {
        Pace { rate: self.framerate.unwrap_or(before.rate), bits: self.bitrate.unwrap_or(before.bits) }
    }
}

impl DumpStyle for Movie {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let (line, paces): (Line, Paces) = read_or(args, cx, foreign)?;
        let span = line.target.file.span;
        let base = Base::new(Files::any("movie"), &line.target.file, cx)?;
        let name = base.state().target.pattern.text().to_string();
        if base.state().target.pattern.many() {
            let d = Diagnostic::error(
                Code::BAD_VALUE,
                span,
                "a movie is one file: `*` has no meaning in its name",
            );
            return Err(d.help("`dump image` writes a file for each picture").into());
        }
        if !is_own(&name) && ffmpeg().is_none() {
            let apng = Path::new(&name).with_extension("apng").to_string_lossy().into_owned();
            let text = format!(
                "ffmpeg, which would make `{name}`, is not to be had: the movie is written as `{apng}`"
            );
            let note = Diagnostic::note(Code::SUSPICIOUS, span, text);
            cx.note(note.help("browsers show animated PNG; install ffmpeg for other kinds of movies"));
            base.state().target = Target::new(Pattern::new(&apng).map_err(|e| e.at(span))?);
        }
        Ok(Box::new(Declared::new(base, Some(paces.of(Pace::default())), line, cx)?))
    }
}
