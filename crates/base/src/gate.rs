//! Access limits for untrusted decks (`-safe`): the files of one folder, and bounded resources.
//!
//! Every file named in a deck is opened here. Without `-safe` the gate is open and nothing is checked. When
//! several ranks run one deck, the first one opens the files, and all get its data: see [`first`] and
//! [`written`].

mod ranks;

pub use ranks::{first, once, written};

use crate::comm;
use crate::diag::{Code, Diagnostic};
use crate::memory;
use std::collections::BTreeSet;
use std::fs::{self, File, ReadDir};
use std::io::{Error, ErrorKind, Result};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// Resource limits of a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Memory of the program [MB].
    pub memory: u64,
    /// Steps of all runs, including iterations of minimizations.
    pub steps: u64,
    /// Lines executed, counting every iteration of a loop.
    pub lines: u64,
    /// Files written.
    pub files: u64,
    /// Pixels per picture.
    pub pixels: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { memory: 4000, steps: 10_000_000, lines: 10_000_000, files: 1000, pixels: 4_000_000 }
    }
}

impl Limits {
    /// The limits by name, for the command line.
    pub fn named(&mut self) -> [(&'static str, &mut u64); 5] {
        [
            ("memory", &mut self.memory),
            ("steps", &mut self.steps),
            ("lines", &mut self.lines),
            ("files", &mut self.files),
            ("pixels", &mut self.pixels),
        ]
    }
}

struct Gate {
    folder: PathBuf,
    limits: Limits,
    written: Mutex<BTreeSet<PathBuf>>,
}

static GATE: RwLock<Option<Arc<Gate>>> = RwLock::new(None);

fn closed() -> Option<Arc<Gate>> {
    GATE.read().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Closes the gate around the folder of the next deck; it cannot be opened again.
///
/// # Errors
/// The folder does not exist.
pub fn close(folder: &Path, limits: Limits) -> Result<()> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let gate = Gate { folder: folder.canonicalize()?, limits, written: Mutex::default() };
    *GATE.write().unwrap_or_else(PoisonError::into_inner) = Some(Arc::new(gate));
    memory::limit(1e6 * limits.memory as f64);
    Ok(())
}

/// The limits, if the gate is closed.
pub fn limits() -> Option<Limits> {
    closed().map(|gate| gate.limits)
}

/// Reason for refusing access to a file.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
struct Refusal(String);

fn refuse<T>(why: String) -> Result<T> {
    Err(Error::new(ErrorKind::PermissionDenied, Refusal(why)))
}

/// The code of a file error: refused here, out of memory, or a system error.
pub fn code(error: &Error) -> Code {
    match error.get_ref().is_some_and(|e| e.is::<Refusal>()) {
        true => Code::NOT_ALLOWED,
        false if error.kind() == ErrorKind::OutOfMemory => Code::TOO_LARGE,
        false => Code::NO_FILE,
    }
}

/// Whether a file exists but must not be read: a copy in another place must not be used instead.
pub fn final_word(error: &Error) -> bool {
    code(error) != Code::NO_FILE
}

/// The error for actions that decks may not perform at all, if the gate is closed.
pub fn forbids(what: &str) -> Option<Diagnostic> {
    let gate = closed()?;
    let text = format!("-safe: {what}");
    let help =
        format!("without `-safe` it may; files of `{}` are all it may touch now", gate.folder.display());
    Some(Diagnostic::error(Code::NOT_ALLOWED, None, text).help(help))
}

/// The error for exceeding a limit.
pub fn beyond(wanted: f64, limit: impl Fn(&Limits) -> u64, name: &str, what: &str) -> Option<Diagnostic> {
    let most = limit(&limits()?);
    if wanted <= most as f64 {
        return None;
    }
    let text = format!("-safe: {what} would be more than the {most} {name} that are allowed");
    Some(Diagnostic::error(Code::NOT_ALLOWED, None, text).help(format!("`-limit {name} N` allows more")))
}

/// The error for a program that uses more memory than allowed.
pub fn too_much_memory() -> Option<Diagnostic> {
    let most = limits()?.memory;
    let used = memory::resident()? / 1e6;
    if used <= most as f64 {
        return None;
    }
    let text = format!("-safe: {used:.0} MB of memory are used, {most} are allowed");
    Some(Diagnostic::error(Code::NOT_ALLOWED, None, text).help("`-limit memory MB` allows more"))
}

/// Bytes that may still be used; `None` if the gate is open.
pub(crate) fn memory_left() -> Option<f64> {
    let left = memory_of_limit()?;
    Some(memory::limited().map_or(left, |counted| counted.min(left)))
}

/// Bytes left by the limit according to the system, which lags behind allocations.
pub(crate) fn memory_of_limit() -> Option<f64> {
    Some((1e6 * limits()?.memory as f64 - memory::resident().unwrap_or(0.0)).max(0.0))
}

/// Whether a path leads to a regular file or folder inside the gate, or would after creation; links are
/// followed.
fn inside(gate: &Gate, path: &Path) -> Result<PathBuf> {
    let outside = || refuse(format!("-safe: it is outside of the deck's folder `{}`", gate.folder.display()));
    let there = fs::symlink_metadata(path).is_ok();
    let found = match (there, path.file_name()) {
        (false, Some(name)) => folder_of(path).canonicalize().map(|folder| folder.join(name)),
        _ => path.canonicalize(),
    };
    let whole = match found {
        Ok(whole) => whole,
        // Nothing outside is inspected: the message does not reveal whether a folder exists there.
        Err(_) if !way_in(gate, path) => return outside(),
        // Writing there would create the file that the link names.
        Err(_) if there => return refuse("-safe: it is a link that leads nowhere".into()),
        Err(e) => return Err(e),
    };
    if !whole.starts_with(&gate.folder) {
        return outside();
    }
    match fs::metadata(&whole) {
        Ok(m) if !m.is_file() && !m.is_dir() => refuse("-safe: it is no plain file".into()),
        Ok(m) if m.len() / 1_000_000 >= gate.limits.memory => refuse(format!(
            "-safe: it is larger than the {} MB of memory that are allowed",
            gate.limits.memory
        )),
        _ => Ok(whole),
    }
}

/// The parent folder of a path.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether the existing part of a path leads inside.
fn way_in(gate: &Gate, path: &Path) -> bool {
    let mut part = folder_of(path);
    loop {
        if let Ok(whole) = part.canonicalize() {
            return whole.starts_with(&gate.folder);
        }
        if part == Path::new(".") {
            return false;
        }
        part = folder_of(part);
    }
}

/// Refuses a path that leads outside.
///
/// # Errors
/// A path to the outside or to something other than a regular file; a missing folder on the way.
pub fn pass(path: &Path) -> Result<()> {
    let Some(gate) = closed() else { return Ok(()) };
    once(|| inside(&gate, path).map(drop))
}

/// [`pass`] for this process alone.
fn passes(path: &Path) -> Result<()> {
    closed().map_or(Ok(()), |gate| inside(&gate, path).map(drop))
}

/// Whether [`pass`] refuses a path for another reason than that it does not exist.
pub fn refuses(path: &Path) -> bool {
    pass(path).is_err_and(|e| code(&e) == Code::NOT_ALLOWED)
}

/// Like [`pass`], for a file to be written, whose number is limited.
///
/// # Errors
/// As for `pass`, and too many files.
pub fn pass_written(path: &Path) -> Result<()> {
    let Some(gate) = closed() else { return Ok(()) };
    let whole = inside(&gate, path)?;
    let mut written = gate.written.lock().unwrap_or_else(PoisonError::into_inner);
    if written.contains(&whole) {
        return Ok(());
    }
    if written.len() as u64 >= gate.limits.files {
        let text = format!("-safe: {} files have been written, as many as are allowed", written.len());
        return refuse(text);
    }
    written.insert(whole);
    Ok(())
}

/// Opens a file for reading.
///
/// # Errors
/// As for [`pass`], and system errors.
pub fn open(path: impl AsRef<Path>) -> Result<File> {
    let path = path.as_ref();
    let own = || passes(path).and_then(|()| File::open(path));
    if comm::several() { ranks::opened(own) } else { own() }
}

/// Opens a file for writing, appending or truncating.
///
/// # Errors
/// As for [`pass_written`], and system errors.
pub fn create(path: impl AsRef<Path>, append: bool) -> Result<File> {
    let path = path.as_ref();
    written(|| create_here(path, append))
}

/// Like [`create`], on this rank only.
///
/// # Errors
/// As for [`create`].
pub fn create_here(path: &Path, append: bool) -> Result<File> {
    pass_written(path)?;
    File::options().create(true).write(true).append(append).truncate(!append).open(path)
}

/// Reads a file.
///
/// # Errors
/// As for [`open`].
pub fn read(path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let path = path.as_ref();
    first(|| {
        let mut bytes = vec![];
        passes(path)?;
        memory::read_file(File::open(path)?, &mut bytes)?;
        Ok(bytes)
    })
}

/// Reads a text file.
///
/// # Errors
/// As for [`open`], and bytes that are not UTF-8.
pub fn read_to_string(path: impl AsRef<Path>) -> Result<String> {
    let odd = |_| Error::new(ErrorKind::InvalidData, "stream did not contain valid UTF-8");
    String::from_utf8(read(path)?).map_err(odd)
}

/// Whether the file or folder exists.
pub fn exists(path: &Path) -> bool {
    comm::broadcast::truth(|| path.exists())
}

/// The paths of a folder's entries, sorted.
///
/// # Errors
/// As for [`open`].
pub fn names(folder: &Path) -> Result<Vec<PathBuf>> {
    let bytes = first(|| {
        passes(folder)?;
        let entries = fs::read_dir(folder)?.collect::<Result<Vec<_>>>()?;
        let names = entries.iter().map(|e| e.file_name().into_encoded_bytes());
        Ok(names.collect::<Vec<_>>().join(&0))
    })?;
    let named = |name: &[u8]| folder.join(String::from_utf8_lossy(name).as_ref());
    let mut paths: Vec<_> = bytes.split(|b| *b == 0).filter(|n| !n.is_empty()).map(named).collect();
    paths.sort();
    Ok(paths)
}

/// The entries of a folder, for one process.
///
/// # Errors
/// As for [`open`].
pub fn list(folder: &Path) -> Result<ReadDir> {
    pass(folder)?;
    fs::read_dir(folder)
}

/// Deletes a file.
///
/// # Errors
/// As for [`open`].
pub fn remove(path: &Path) -> Result<()> {
    once(|| {
        passes(path)?;
        fs::remove_file(path)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_followed_to_where_they_lead() {
        let outer = std::env::temp_dir().join(format!("perigrain-gate-{}", std::process::id()));
        let folder = outer.join("deck");
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("in"), "").unwrap();
        fs::write(outer.join("out"), "").unwrap();
        let gate = Gate {
            folder: folder.canonicalize().unwrap(),
            limits: Limits::default(),
            written: Mutex::default(),
        };
        let passes = |name: &str| inside(&gate, &folder.join(name)).is_ok();
        assert!(passes("in") && passes("new") && passes("."));
        assert!(!passes("../out") && !passes("../new") && !passes("..") && !passes("/dev/null"));
        assert!(passes("../deck/in") && !passes("no/such"));
        // The refusal does not reveal whether a file outside exists.
        let refusal = |name: &str| inside(&gate, &folder.join(name)).unwrap_err().to_string();
        assert!(
            refusal("../out/x") == refusal("../out") && refusal("../no/such/folder") == refusal("../out")
        );
        assert!(!refusal("no/such").contains("outside") && refusal("/no/such/folder") == refusal("../out"));
        let largest = Limits { memory: 0, ..Limits::default() };
        let small = Gate { folder: gate.folder.clone(), limits: largest, written: Mutex::default() };
        assert!(inside(&small, &folder.join("in")).is_err() && inside(&small, &folder.join("new")).is_ok());
        #[cfg(unix)]
        {
            let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, folder.join(name)).unwrap();
            link("../out", "there");
            link("../new", "nowhere");
            link("..", "up");
            link("in", "back");
            assert!(!passes("there") && !passes("nowhere") && !passes("up/out") && !passes("up/new"));
            assert!(passes("back"));
        }
        fs::remove_dir_all(outer).unwrap();
    }

    #[test]
    fn an_open_gate_looks_at_nothing() {
        assert!(pass(Path::new("/dev/null")).is_ok() && limits().is_none() && forbids("anything").is_none());
        assert!(beyond(1e99, |l| l.steps, "steps", "all").is_none() && too_much_memory().is_none());
        assert_eq!(code(&Error::other("disk")), Code::NO_FILE);
    }
}
