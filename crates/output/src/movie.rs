//! Movies: pictures one after the other, by the program ffmpeg or as an animated PNG.

mod apng;

use crate::file::trouble;
use crate::image::Image;
use apng::Apng;
use perigrain_base::comm::{self, broadcast};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_base::gate;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};

/// Endings of names for which no other program is needed.
pub const OWN: [&str; 2] = [".apng", ".png"];

/// How a movie is played and packed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Pictures a second.
    pub rate: f64,
    /// Kilobits a second, where ffmpeg packs it.
    pub bits: i64,
}

impl Default for Pace {
    /// As LAMMPS has it.
    fn default() -> Self {
        Self { rate: 24.0, bits: 2000 }
    }
}

/// A movie that is being made.
#[derive(Debug)]
pub struct Movie {
    path: PathBuf,
    /// Width and height of its first picture.
    size: Option<[usize; 2]>,
    pace: Pace,
    to: Option<To>,
}

#[derive(Debug)]
enum To {
    File(Apng),
    Program(Child, Option<BufWriter<ChildStdin>>),
}

/// Where ffmpeg is, if it is there and may be called.
pub fn ffmpeg() -> Option<PathBuf> {
    if gate::limits().is_some() {
        return None;
    }
    broadcast::text(|| found()?.into_os_string().into_string().ok()).map(PathBuf::from)
}

/// Where ffmpeg is on this machine.
fn found() -> Option<PathBuf> {
    let name = format!("ffmpeg{}", std::env::consts::EXE_SUFFIX);
    std::env::split_paths(&std::env::var_os("PATH")?)
        .map(|folder| folder.join(&name))
        .find(|path| path.is_file())
}

/// Whether a movie of this name is written without another program.
pub fn is_own(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    OWN.iter().any(|ending| name.ends_with(ending))
}

impl Movie {
    /// A movie without pictures yet; its file is made with the first one.
    pub fn new(path: PathBuf, pace: Pace) -> Self {
        Self { path, size: None, pace, to: None }
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// A file that cannot be written, a program that has ended, a picture of another size.
    pub fn add(&mut self, image: &Image) -> Result<()> {
        let size = [image.width, image.height];
        if *self.size.get_or_insert(size) != size {
            let text =
                format!("the pictures of `{}` change their size, and a movie has one", self.path.display());
            let d = Diagnostic::error(Code::CONFLICT, None, text);
            return Err(d.help("write another movie, by an `undump` and a new `dump`").into());
        }
        if !comm::is_first() {
            return Ok(());
        }
        let to = match &mut self.to {
            Some(to) => to,
            None => self.to.insert(To::open(&self.path, size, self.pace)?),
        };
        let outcome = match to {
            To::File(file) => file.add(image),
            To::Program(_, Some(pipe)) => pipe.write_all(&image.ppm()).and_then(|()| pipe.flush()),
            To::Program(_, None) => Ok(()),
        };
        outcome.map_err(|e| match to {
            To::File(_) => trouble("write", &self.path, &e).into(),
            To::Program(..) => {
                let text = format!("ffmpeg ended before `{}` was whole: {e}", self.path.display());
                Diagnostic::error(Code::NO_FILE, None, text)
                    .help("its output stands above; an ending such as `.mp4` or `.gif` selects the format")
                    .into()
            }
        })
    }
}

impl To {
    fn open(path: &Path, size: [usize; 2], pace: Pace) -> Result<Self> {
        if is_own(&path.to_string_lossy()) {
            let file = gate::create_here(path, false).and_then(|file| Apng::new(file, size, pace.rate));
            return file.map(Self::File).map_err(|e| trouble("write", path, &e).into());
        }
        let start = || -> std::io::Result<Self> {
            let program = found().ok_or(std::io::ErrorKind::NotFound)?;
            let mut command = Command::new(program);
            let rate = pace.rate.to_string();
            command.args([
                "-loglevel",
                "error",
                "-y",
                "-f",
                "image2pipe",
                "-c:v",
                "ppm",
                "-r",
                &rate,
                "-i",
                "-",
            ]);
            // Most players show this format; it needs even numbers of pixels, and a GIF has colours of its own.
            let even = size.iter().all(|n| n.is_multiple_of(2));
            if even && path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("gif")) {
                command.args(["-pix_fmt", "yuv420p"]);
            }
            command.args(["-b:v", &format!("{}k", pace.bits), "-r", &rate]);
            // A name is a name, whatever it looks like.
            let mut name = std::ffi::OsString::from("file:");
            name.push(path);
            let mut child = command.arg(name).stdin(Stdio::piped()).stdout(Stdio::null()).spawn()?;
            let pipe = child.stdin.take().ok_or(std::io::ErrorKind::BrokenPipe)?;
            Ok(Self::Program(child, Some(BufWriter::with_capacity(1 << 16, pipe))))
        };
        start().map_err(|e| {
            let text = format!("ffmpeg, which makes `{}`, cannot be started: {e}", path.display());
            Diagnostic::error(Code::NO_FILE, None, text).into()
        })
    }
}

/// The last picture is in the file when a movie ends.
impl Drop for To {
    fn drop(&mut self) {
        let Self::Program(child, pipe) = self else { return };
        // The program ends with its input; its messages are on the screen.
        drop(pipe.take());
        let _ = child.wait();
    }
}
