//! Text files that grow block by block, or hold the latest block only.

use super::file::{self, trouble};
use perigrain_base::diag::Result;
use perigrain_base::{comm, gate};
use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A text file with a header that is written once and blocks behind it.
#[derive(Debug)]
pub struct Sheet {
    path: PathBuf,
    /// Where the blocks begin, if only the latest is kept.
    keep: Option<u64>,
    file: Option<File>,
}

impl Sheet {
    /// Starts a file, or appends to an existing one, with this header (which ends with a newline); returns its length so far,
    /// which a file of the latest block keeps.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(path: &Path, append: bool, header: &str) -> Result<u64> {
        let mut file = file::open(path, append)?;
        let length = (|| {
            file.write_all(header.as_bytes())?;
            file.flush()?;
            file.get_ref().metadata().map(|m| m.len())
        })();
        length.map_err(|e| trouble("write", path, &e).into())
    }

    /// The file of an earlier `begin`, opened at the first block; `keep` is the header's length where only the latest
    /// block stays.
    pub fn new(path: &Path, keep: Option<u64>) -> Self {
        Self { path: path.to_path_buf(), keep, file: None }
    }

    /// Adds a block, or puts it in the last one's place; it is handed to the system at once.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn block(&mut self, text: &str) -> Result<()> {
        self.write(text).map_err(|e| trouble("write", &self.path, &e).into())
    }

    fn write(&mut self, text: &str) -> std::io::Result<()> {
        let file = match &mut self.file {
            Some(file) => file,
            None => {
                let file = gate::written(|| {
                    gate::pass_written(&self.path)?;
                    let mut options = File::options();
                    // A file of the latest block is cut, which appending files cannot be.
                    match self.keep {
                        None => options.append(true).create(true).open(&self.path),
                        Some(_) => options.write(true).create(true).truncate(false).open(&self.path),
                    }
                })?;
                self.file.insert(file)
            }
        };
        if !comm::is_first() {
            return Ok(());
        }
        if let Some(start) = self.keep {
            file.set_len(start)?;
            file.seek(SeekFrom::Start(start))?;
        }
        file.write_all(text.as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_follow_or_replace_one_another() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a");
        let read = || std::fs::read_to_string(&path).unwrap();
        Sheet::begin(&path, false, "# head\n").unwrap();
        let mut all = Sheet::new(&path, None);
        all.block("one\n").unwrap();
        all.block("two\n").unwrap();
        assert_eq!(read(), "# head\none\ntwo\n");
        let length = Sheet::begin(&path, true, "# more\n").unwrap();
        let mut last = Sheet::new(&path, Some(length));
        last.block("three\n").unwrap();
        last.block("4\n").unwrap();
        assert_eq!(read(), "# head\none\ntwo\n# more\n4\n");
        Sheet::begin(&path, false, "").unwrap();
        assert_eq!(read(), "");
        assert!(Sheet::begin(&dir.path().join("no/such"), false, "").is_err());
    }
}
