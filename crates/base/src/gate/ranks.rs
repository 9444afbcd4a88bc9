//! Files when several ranks run one deck: the first one reads and writes them, and all get the same bytes and
//! errors.

use super::{Refusal, refuse};
use crate::comm;
use std::fs::File;
use std::io::{Error, ErrorKind, Result, Seek};

/// The last byte of a result sent to other ranks: success, refused by the gate, a system error, another
/// error.
const FINE: u8 = 0;
const REFUSED: u8 = 1;
const OF_SYSTEM: u8 = 2;
const OTHER: u8 = 3;

/// The error kinds that are distinguished; all others become `Other`.
const KINDS: [ErrorKind; 5] = [
    ErrorKind::NotFound,
    ErrorKind::PermissionDenied,
    ErrorKind::InvalidData,
    ErrorKind::OutOfMemory,
    ErrorKind::Other,
];

/// The result of the first rank, on all ranks; the others do not evaluate `own`.
///
/// # Errors
/// The error of the first rank.
pub fn first(own: impl FnOnce() -> Result<Vec<u8>>) -> Result<Vec<u8>> {
    if !comm::several() {
        return own();
    }
    let mut failed = None;
    let mut bytes = comm::broadcast::bytes(|| match own() {
        Ok(mut bytes) => {
            bytes.push(FINE);
            bytes
        }
        Err(e) => {
            let packed = pack(&e);
            failed = Some(e);
            packed
        }
    });
    match (failed, bytes.pop()) {
        (Some(e), _) => Err(e),
        (None, Some(FINE)) => Ok(bytes),
        (None, how) => unpack(&bytes, how.unwrap_or(OTHER)),
    }
}

fn pack(e: &Error) -> Vec<u8> {
    let (mut bytes, how) = match e.raw_os_error() {
        Some(number) => (number.to_le_bytes().to_vec(), OF_SYSTEM),
        None if e.get_ref().is_some_and(|e| e.is::<Refusal>()) => (e.to_string().into_bytes(), REFUSED),
        None => {
            let kind = KINDS.iter().position(|k| *k == e.kind()).unwrap_or(KINDS.len() - 1);
            ([e.to_string().as_bytes(), &[kind as u8]].concat(), OTHER)
        }
    };
    bytes.push(how);
    bytes
}

fn unpack(bytes: &[u8], how: u8) -> Result<Vec<u8>> {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    match (how, bytes) {
        (REFUSED, text_of) => refuse(text(text_of)),
        (OF_SYSTEM, [a, b, c, d]) => Err(Error::from_raw_os_error(i32::from_le_bytes([*a, *b, *c, *d]))),
        (OTHER, [text_of @ .., kind]) if usize::from(*kind) < KINDS.len() => {
            Err(Error::new(KINDS[usize::from(*kind)], text(text_of)))
        }
        _ => Err(Error::other("the first rank has failed")),
    }
}

/// Acts on files on the first rank only; all ranks get the result.
///
/// # Errors
/// The error of the first rank.
pub fn once(act: impl FnOnce() -> Result<()>) -> Result<()> {
    first(|| act().map(|()| vec![])).map(drop)
}

/// A file opened by the first rank for reading, on all ranks: the others have its bytes in memory.
///
/// # Errors
/// The error of the first rank.
pub(super) fn opened(own: impl FnOnce() -> Result<File>) -> Result<File> {
    let mut here = None;
    let bytes = first(|| {
        let file = own()?;
        let mut bytes = vec![];
        crate::memory::read_file(file.try_clone()?, &mut bytes)?;
        // Files that can be read only once have been read.
        here = Some(file).filter(|file| file.metadata().is_ok_and(|m| m.is_file()));
        Ok(bytes)
    })?;
    match here {
        Some(mut file) => file.rewind().map(|()| file),
        None => comm::file_of(&bytes),
    }
}

/// A file opened by the first rank for writing; output of the others is discarded.
///
/// # Errors
/// The error of the first rank.
pub fn written(own: impl FnOnce() -> Result<File>) -> Result<File> {
    if !comm::several() {
        return own();
    }
    let mut here = None;
    first(|| {
        here = Some(own()?);
        Ok(vec![])
    })?;
    here.map_or_else(|| File::options().read(true).write(true).open("/dev/null"), Ok)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diag::Code;
    use crate::gate::{self, code};
    use comm::Local;
    use std::io::{Read, Write};
    use std::path::Path;
    use std::sync::Arc;

    fn on_ranks<T: Send>(body: impl Fn() -> T + Sync) -> Vec<T> {
        let seats = Local::threads(3).unwrap();
        std::thread::scope(|s| {
            let body = &body;
            let start = |seat| s.spawn(move || comm::run_as(Arc::new(seat), body));
            let all: Vec<_> = seats.into_iter().map(start).collect();
            all.into_iter().map(|t| t.join().unwrap()).collect()
        })
    }

    #[test]
    fn all_ranks_have_the_first_ones_bytes_and_errors() {
        let folder = std::env::temp_dir().join(format!("perigrain-ranks-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("a");
        std::fs::write(&path, "some text").unwrap();
        // The others look for a file that only the first rank has.
        let place = || if comm::is_first() { path.clone() } else { folder.join("not here") };
        let read = on_ranks(|| {
            let mut text = String::new();
            gate::open(place()).unwrap().read_to_string(&mut text).unwrap();
            (text, gate::read_to_string(place()).unwrap(), gate::exists(&place()))
        });
        assert_eq!(read, vec![("some text".to_string(), "some text".to_string(), true); 3]);
        let missing = on_ranks(|| gate::open(Path::new("/no/such")).unwrap_err());
        assert!(missing.iter().all(|e| e.kind() == ErrorKind::NotFound && code(e) == Code::NO_FILE));
        assert!(missing.iter().all(|e| e.to_string() == missing[0].to_string()));
        let odd = on_ranks(|| first(|| Err(Error::new(ErrorKind::InvalidData, "odd"))).unwrap_err());
        assert!(odd.iter().all(|e| e.kind() == ErrorKind::InvalidData && e.to_string() == "odd"));
        let refused = on_ranks(|| first(|| refuse("not allowed".into())).unwrap_err());
        assert!(refused.iter().all(|e| code(e) == Code::NOT_ALLOWED && e.to_string() == "not allowed"));
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn one_rank_writes_and_all_believe_to() {
        let folder = std::env::temp_dir().join(format!("perigrain-ranks-w-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join("b");
        on_ranks(|| {
            let mut file = gate::create(&path, true).unwrap();
            file.write_all(b"once").unwrap();
        });
        assert_eq!(std::fs::read(&path).unwrap(), b"once");
        let names = on_ranks(|| gate::names(&folder).unwrap());
        assert_eq!(names, vec![vec![path.clone()]; 3]);
        assert!(on_ranks(|| gate::remove(&path).is_ok()) == [true; 3] && !path.exists());
        assert!(on_ranks(|| gate::create(folder.join("no/such"), false).is_err()) == [true; 3]);
        std::fs::remove_dir_all(folder).unwrap();
    }
}
