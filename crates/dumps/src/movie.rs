//! Dump `movie`: the pictures of `dump image` as a movie.

use super::base::Base;
use super::image::Declared;
use super::{Dump, DumpStyle};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_lang::Args;
use perigrain_output::dump::Target;
use perigrain_output::file::Pattern;
use perigrain_output::movie::{Pace, ffmpeg, is_own};
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
            syntax: "dump ID group movie N file colour diameter keyword value …",
            summary: "Draws the group's particles every N steps and makes a movie of the pictures.",
            text: "Pictures, keywords and `dump_modify` are those of `dump image`; besides, `framerate F` is how many pictures a second has (24), \
                   and `bitrate K` how many kilobits, where they are packed with losses (2000). There is one file, without `*` in its name, for \
                   all runs until `undump` or the end of the deck.\n\n\
                   A name that ends in `.apng` or `.png` is written as an animated PNG, which browsers show, without any other program; \
                   it is whole after each picture. For all other names (`.mp4`, `.avi`, `.webm`, `.gif` …) the pictures go to the program \
                   ffmpeg, as in LAMMPS. Where ffmpeg is not found, and under `-safe`, which starts no program, a note says so and the movie \
                   is an animated PNG with the ending `.apng`.",
            example: "dump film all movie 10 crack.apng c_damage auto view 70 -60 map damage range 0 1 framerate 12",
        }
    }
}

impl DumpStyle for Movie {
    fn build(&self, args: &mut Args, cx: &BuildCx) -> Result<Box<dyn Dump>> {
        let span = args.here();
        let base = Base::new("movie", args, cx, &[])?;
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
        Ok(Box::new(Declared::read(base, Some(Pace::default()), args, cx)?))
    }
}
