//! Restart files: the whole scene in one portable, versioned, checksummed binary file.
//!
//! ```text
//! magic 8 | format u32 | layout u32 | program: length u8, text | scene (postcard) | length u64 | crc32 u32 | end 8
//! ```
//!
//! All numbers are little-endian. `layout` is a fingerprint of the shapes of all stored types (module `layout`), the checksum
//! covers everything before it. Files are written beside their place and moved there when they are on the disk.

mod layout;
mod scene;
mod sound;

pub use scene::{fingerprint, resume};

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use super::file::{replace_durably, trouble};
use perigrain_base::diag::{Code, Diagnostic, Result};
use perigrain_world::{DeclaredLine, World};

const MAGIC: [u8; 8] = *b"PERIGRN\x1a";
const END: [u8; 8] = *b"\x1aGRNDONE";
/// The number of the arrangement above; higher ones are of later versions.
const FORMAT: u32 = 1;
/// Length of what follows the scene.
const TAIL: u64 = 8 + 4 + 8;
/// What LAMMPS' own restart files begin with.
const LAMMPS: &[u8] = b"LammpS RestartT";

/// What a restart file holds, as it is written.
#[derive(Serialize)]
pub struct Saving<'a> {
    /// The scene.
    pub world: &'a World,
    /// Whether there was a run.
    pub ran: bool,
    /// Whether forces, bonds and contact history are those of the scene as it stands.
    pub standing: bool,
    /// The pair style's lines.
    pub pair: &'a [DeclaredLine],
    /// All lines that decide about forces.
    pub declared: &'a [String],
}

/// What a restart file holds, as it was read.
#[derive(Debug, Deserialize)]
pub struct Saved {
    /// The scene.
    pub world: World,
    /// See [`Saving`].
    pub ran: bool,
    /// See [`Saving`].
    pub standing: bool,
    /// See [`Saving`].
    pub pair: Vec<DeclaredLine>,
    /// See [`Saving`].
    pub declared: Vec<String>,
}

/// Writes a restart file; a file of this name is replaced only by a whole one.
///
/// # Errors
/// The disk's.
pub fn write(path: &Path, saving: &Saving) -> Result<()> {
    replace_durably(path, |out| {
        let mut out = Counted { out, crc: crc32fast::Hasher::new(), count: 0, failed: None };
        let program = env!("CARGO_PKG_VERSION").as_bytes();
        out.write_all(&MAGIC)?;
        out.write_all(&FORMAT.to_le_bytes())?;
        out.write_all(&layout().to_le_bytes())?;
        out.write_all(&[program.len() as u8])?;
        out.write_all(program)?;
        let outcome = postcard::to_io(saving, &mut out).map(|_| ()).map_err(std::io::Error::other);
        // postcard has one word for all that goes wrong with what it writes to.
        outcome.map_err(|e| out.failed.take().unwrap_or(e))?;
        let count = out.count;
        out.write_all(&count.to_le_bytes())?;
        let crc = out.crc.clone().finalize();
        out.write_all(&crc.to_le_bytes())?;
        out.write_all(&END)
    })
}

/// The fingerprint of what is stored, found once: it takes as long as a small file.
fn layout() -> u32 {
    static LAYOUT: OnceLock<u32> = OnceLock::new();
    *LAYOUT.get_or_init(layout::fingerprint::<Saved>)
}

/// Adds up what is written.
struct Counted<'a> {
    out: &'a mut dyn Write,
    crc: crc32fast::Hasher,
    count: u64,
    /// The system's error when it refused.
    failed: Option<std::io::Error>,
}

impl Counted<'_> {
    /// Keeps the system's error; the caller gets its kind.
    fn note<T>(&mut self, outcome: std::io::Result<T>) -> std::io::Result<T> {
        outcome.map_err(|e| {
            let kind = e.kind();
            self.failed = Some(e);
            kind.into()
        })
    }
}

impl Write for Counted<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let outcome = self.out.write(bytes);
        let n = self.note(outcome)?;
        self.crc.update(&bytes[..n]);
        self.count += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        let outcome = self.out.flush();
        self.note(outcome)
    }
}

/// Reads a whole restart file.
///
/// # Errors
/// Files that cannot be read, are truncated, damaged, of another program, of another version.
pub fn read(path: &Path) -> Result<Saved> {
    let failed = |e: std::io::Error| trouble("read the restart file", path, &e);
    let refuse = |why: String| {
        Diagnostic::error(Code::BAD_FILE, None, format!("the restart file `{}` {why}", path.display()))
    };
    let mut file = perigrain_base::gate::open(path).map_err(failed)?;
    let size = file.metadata().map_err(failed)?.len();
    let mut head = Vec::new();
    Read::by_ref(&mut file).take(16).read_to_end(&mut head).map_err(failed)?;
    check_head(&head).map_err(|(why, help)| refuse(why).help(help))?;
    let crc_at =
        check_whole(&mut file, size).map_err(failed)?.map_err(|(why, help)| refuse(why).help(help))?;

    file.seek(SeekFrom::Start(16)).map_err(failed)?;
    let mut reader = BufReader::with_capacity(at_most(size), file.take(crc_at - 16));
    let mut program = [0u8; 1];
    reader.read_exact(&mut program).map_err(failed)?;
    let mut version = vec![0u8; usize::from(program[0])];
    reader.read_exact(&mut version).map_err(failed)?;
    if head.get(12..16) != Some(&layout().to_le_bytes()) {
        let why = format!(
            "was written by perigrain {}, whose scenes are stored otherwise than by this one, {}",
            String::from_utf8_lossy(&version),
            env!("CARGO_PKG_VERSION")
        );
        let help = "read it with the program that wrote it and take `write_data` from there";
        return Err(refuse(why).help(help).into());
    }
    // Room for the longest text in it: names and words of a deck.
    let mut room = vec![0u8; at_most(size)];
    let (mut saved, _): (Saved, _) = postcard::from_io((reader, &mut room)).map_err(|e| {
        refuse(format!("holds no scene: {e}")).help("it was forged or made by another program")
    })?;
    sound::check(&saved.world).map_err(|fault| contradiction(refuse, fault.section, &fault.what))?;
    saved.standing &= sound::stand(&saved.world);
    if !saved.pair.iter().all(|line| line.lattice.is_sound()) {
        return Err(contradiction(refuse, "pair", "a line stands under a lattice that is none").into());
    }
    Ok(saved)
}

/// Bytes of a buffer for a file of this size: small files are many, and a large buffer costs more than they do.
fn at_most(size: u64) -> usize {
    size.min(1 << 20) as usize
}

/// A file that is whole and yet not what a perigrain writes.
fn contradiction(refuse: impl Fn(String) -> Diagnostic, section: &str, what: &str) -> Diagnostic {
    refuse(format!("contradicts itself in its section `{section}`: {what}"))
        .help("its checksum fits, so this is no damage: it was forged or made by another program")
}

/// Why a file is refused, and what to do.
type Refusal = (String, &'static str);

fn check_head(head: &[u8]) -> std::result::Result<(), Refusal> {
    if head.starts_with(LAMMPS) || LAMMPS.starts_with(head) && !head.is_empty() {
        let why = "is one of LAMMPS, which only the LAMMPS that wrote it can read";
        return Err((why.into(), "let that LAMMPS `write_data`, then use `read_data` here"));
    }
    let known = head.len().min(8);
    if head.is_empty() || head[..known] != MAGIC[..known] {
        return Err(("is none of perigrain".into(), "perigrain reads what its own `write_restart` wrote"));
    }
    let Some(&[a, b, c, d]) = head.get(8..12) else { return Err(cut_off(head.len() as u64)) };
    let format = u32::from_le_bytes([a, b, c, d]);
    if format > FORMAT {
        let why = format!("is of format {format}; this perigrain reads formats up to {FORMAT}");
        return Err((why, "use the newer perigrain that wrote it"));
    }
    if head.len() < 16 { Err(cut_off(head.len() as u64)) } else { Ok(()) }
}

fn cut_off(at: u64) -> Refusal {
    (format!("is cut off after {at} bytes"), "an older file of the same run may be whole")
}

/// Compares length and checksum with what stands at the end; returns where the scene ends.
fn check_whole(file: &mut File, size: u64) -> std::io::Result<std::result::Result<u64, Refusal>> {
    let damaged =
        || ("is damaged: its checksum is wrong".to_string(), "an older file of the same run may be whole");
    if size < 17 + TAIL {
        return Ok(Err(cut_off(size)));
    }
    let end = size - TAIL;
    let mut tail = [0u8; TAIL as usize];
    file.seek(SeekFrom::Start(end))?;
    file.read_exact(&mut tail)?;
    let (length, rest) = tail.split_at(8);
    let (crc, mark) = rest.split_at(4);
    if mark != END || length != end.to_le_bytes() {
        return Ok(Err(cut_off(size)));
    }
    let mut hasher = crc32fast::Hasher::new();
    file.seek(SeekFrom::Start(0))?;
    let mut reader = Read::by_ref(file).take(end + 8);
    let mut buffer = vec![0u8; at_most(size)];
    loop {
        match reader.read(&mut buffer)? {
            0 => break,
            n => hasher.update(&buffer[..n]),
        }
    }
    Ok(if crc == hasher.finalize().to_le_bytes() { Ok(end) } else { Err(damaged()) })
}

/// A writer that keeps nothing but the checksum.
#[derive(Default)]
struct Sum(crc32fast::Hasher);

impl Write for Sum {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The checksum of a value as it would be stored.
fn sum_of<T: Serialize>(value: &T) -> u32 {
    let out = BufWriter::with_capacity(1 << 16, Sum::default());
    // Summing up cannot fail; a value that cannot be stored would have failed when the file was written.
    postcard::to_io(value, out).ok().and_then(|out| out.into_inner().ok()).map_or(0, |sum| sum.0.finalize())
}

#[cfg(test)]
mod tests;
