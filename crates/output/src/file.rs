//! File names with a step in them, and files that appear whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File, TryLockError};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use perigrain_base::diag::{Code, Diagnostic, Result, fail};
use perigrain_base::gate;

/// Endings that LAMMPS writes compressed or binary and perigrain does not; some dumps are binary.
const REFUSED_ENDINGS: &[&str] = &[".zst", ".bz2", ".xz", ".lz4", ".bin", ".lammpsbin"];

/// A file name in which `*` stands for the step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    text: String,
    /// Least number of digits of the step.
    pub pad: usize,
}

impl Pattern {
    /// Checks a name: one `*` at most, no `%` (one file per processor), no compressed or binary ending.
    pub fn new(text: &str) -> Result<Self> {
        if let Some(ending) = REFUSED_ENDINGS.iter().find(|e| text.ends_with(**e)) {
            let d = Diagnostic::error(Code::NOT_SUPPORTED, None, format!("files that end in `{ending}`"));
            return Err(d.help("write plain text or `.gz`").into());
        }
        Self::of_any_kind(text)
    }

    /// The name of a dump that several processes could share: `%` becomes the number of the only one here. Also binary files
    /// where `binary` allows it.
    ///
    /// # Errors
    /// As for [`Pattern::new`].
    pub fn shared(text: &str, binary: bool) -> Result<Self> {
        let text = text.replacen('%', "0", 1);
        match binary && super::binary::ENDINGS.iter().any(|e| text.ends_with(e)) {
            true => Self::of_any_kind(&text),
            false => Self::new(&text),
        }
    }

    /// As [`Pattern::new`], with any ending.
    ///
    /// # Errors
    /// As there.
    pub fn of_any_kind(text: &str) -> Result<Self> {
        if text.is_empty() {
            return fail(Code::BAD_VALUE, None, "the file name is empty");
        }
        if text.contains('%') {
            let d =
                Diagnostic::error(Code::NOT_SUPPORTED, None, "`%` in a file name, one file per processor");
            return Err(d.help("one process writes the file here: leave the % out").into());
        }
        if text.matches('*').count() > 1 {
            return fail(Code::BAD_VALUE, None, "more than one `*` in the file name");
        }
        Ok(Self { text: text.into(), pad: 0 })
    }

    /// The name as it was written in the deck.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Whether what is written is compressed (`.gz`).
    pub fn packed(&self) -> bool {
        self.text.ends_with(".gz")
    }

    /// Whether it is a binary dump.
    pub fn binary(&self) -> bool {
        super::binary::ENDINGS.iter().any(|e| self.text.ends_with(e))
    }

    /// Whether every snapshot gets a file of its own.
    pub fn many(&self) -> bool {
        self.text.contains('*')
    }

    /// The name for a step.
    pub fn at(&self, step: i64) -> PathBuf {
        PathBuf::from(self.text.replacen('*', &format!("{step:0pad$}", pad = self.pad), 1))
    }

    /// The name with `*` and a separator before it taken out: the base of a series file.
    pub fn stem(&self) -> PathBuf {
        let mut text = self.text.clone();
        for star in [".*", "_*", "-*", "*"] {
            text = text.replacen(star, "", 1);
        }
        PathBuf::from(text)
    }
}

/// What a failing operation on a file is reported as.
pub fn trouble(doing: &str, path: &Path, error: &std::io::Error) -> Diagnostic {
    let d =
        Diagnostic::error(gate::code(error), None, format!("cannot {doing} `{}`: {error}", path.display()));
    match path.parent() {
        Some(folder) if error.kind() == std::io::ErrorKind::NotFound && !folder.as_os_str().is_empty() => {
            d.help(format!("create the folder `{}` first", folder.display()))
        }
        _ => d,
    }
}

/// Opens a file for writing, at its end or from scratch.
pub fn open(path: &Path, append: bool) -> Result<BufWriter<File>> {
    match gate::create(path, append) {
        Ok(file) => Ok(BufWriter::with_capacity(1 << 16, file)),
        Err(e) => Err(trouble("write", path, &e).into()),
    }
}

/// As [`open`], and marks the file as being written for as long as it is open; whether another process has marked it before.
pub fn claim(path: &Path, append: bool) -> Result<(BufWriter<File>, bool)> {
    let mut shared = false;
    let claimed = gate::written(|| {
        gate::pass_written(path)?;
        let file = File::options().create(true).write(true).append(append).truncate(false).open(path)?;
        // Elsewhere a lock would keep readers away; a file system without locks gives no warning.
        shared = cfg!(unix) && matches!(file.try_lock(), Err(TryLockError::WouldBlock));
        if !append && file.metadata()?.is_file() {
            file.set_len(0)?;
        }
        Ok(file)
    });
    match claimed {
        Ok(file) => Ok((BufWriter::with_capacity(1 << 16, file), shared)),
        Err(e) => Err(trouble("write", path, &e).into()),
    }
}

/// Writes a whole file beside its place and moves it there at the end: readers see the old or the new file,
/// never half of one.
pub fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    put(path, false, write)
}

/// As [`replace`], and the new file is on the disk before the old one goes: not even a power cut leaves half a file.
pub fn replace_durably(path: &Path, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    put(path, true, write)
}

fn put(path: &Path, durably: bool, write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
    gate::once(|| put_here(path, durably, write)).map_err(|e| trouble("write", path, &e).into())
}

fn put_here(
    path: &Path,
    durably: bool,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<()> {
    gate::pass_written(path)?;
    let (part, file) = beside(path)?;
    let outcome = (|| {
        let mut file = BufWriter::with_capacity(1 << 20, file);
        write(&mut file)?;
        file.flush()?;
        if durably {
            file.get_ref().sync_all()?;
        }
        drop(file);
        fs::rename(&part, path)?;
        match path.parent().filter(|_| durably) {
            // The folder has the new name on the disk, too; not every system can open folders.
            Some(folder) => {
                let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
                File::open(folder).and_then(|f| f.sync_all()).or(Ok(()))
            }
            None => Ok(()),
        }
    })();
    outcome.inspect_err(|_| {
        // The half-written file is of no use; that it may not exist is fine.
        let _ = fs::remove_file(&part);
    })
}

/// A new file `.NAME.PROCESS.part` in the same folder: no other process writes into it, even one of this number on another machine.
fn beside(path: &Path) -> std::io::Result<(PathBuf, File)> {
    let (process, mut more) = (std::process::id(), 0);
    loop {
        let mut name = OsString::from(".");
        name.push(path.file_name().unwrap_or_default());
        name.push(if more == 0 { format!(".{process}.part") } else { format!(".{process}-{more}.part") });
        let part = path.with_file_name(name);
        match File::create_new(&part) {
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => more += 1,
            Err(e) => return Err(e),
            Ok(file) => return Ok((part, file)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names() {
        let mut p = Pattern::new("run/d.*.atom").unwrap();
        assert!(p.many());
        assert_eq!(p.at(5), PathBuf::from("run/d.5.atom"));
        p.pad = 6;
        // As LAMMPS 22Jul2025 names it under `dump_modify pad 6`.
        assert_eq!(p.at(5), PathBuf::from("run/d.000005.atom"));
        assert_eq!(p.stem(), PathBuf::from("run/d.atom"));
        assert_eq!(Pattern::new("plate_*.vtu").unwrap().stem(), PathBuf::from("plate.vtu"));
        for bad in ["", "a.%.b", "a.*.*", "d.zst", "x.bin"] {
            assert!(Pattern::new(bad).is_err(), "{bad}");
        }
        // As LAMMPS 22Jul2025 on one process: the first `%` alone.
        assert_eq!(Pattern::shared("a.%.*.bin", true).unwrap().at(5), PathBuf::from("a.0.5.bin"));
        assert!(Pattern::shared("a.%.bin", false).is_err());
        assert!(Pattern::shared("a.%.%", true).is_err());
    }

    #[test]
    fn whole_or_not_at_all() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.txt");
        replace(&path, |w| w.write_all(b"one")).unwrap();
        let failing = replace(&path, |w| {
            w.write_all(b"two")?;
            Err(std::io::Error::other("disk full"))
        });
        assert!(failing.unwrap_err().to_string().contains("disk full"));
        // A file that another process is writing beside the same place is left alone.
        let theirs = dir.path().join(format!(".a.txt.{}.part", std::process::id()));
        fs::write(&theirs, b"theirs").unwrap();
        replace(&path, |w| w.write_all(b"one")).unwrap();
        assert_eq!(fs::read(&theirs).unwrap(), b"theirs");
        fs::remove_file(&theirs).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 1);
        let nowhere = replace(&dir.path().join("no/such.txt"), |_| Ok(())).unwrap_err();
        assert!(nowhere.0[0].help[0].contains("create the folder"));
    }
}
