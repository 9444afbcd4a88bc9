//! NRRD images (`.nrrd`, `.nhdr`), raw or packed by gzip, read as they are needed.

use super::super::file::{File, not_read};
use super::{Image, Info, cut_off, locate, passable, unreadable};
use crate::text::{Line, Lines, whole};
use perigrain_base::diag::{Code, Result, fail};
use perigrain_base::gate;
use perigrain_lang::Word;
use perigrain_mesh::vtk::numbers::Kind;
use perigrain_world::World;
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// The longest header that is looked through.
const HEADER: usize = 1 << 16;

/// The content of a header.
#[derive(Debug)]
pub struct Header {
    info: Info,
    kind: Kind,
    big_endian: bool,
    packed: bool,
    /// The file with the voxels, where it is another.
    data: Option<String>,
}

struct Nrrd {
    header: Header,
    word: Word,
    path: PathBuf,
    /// Where voxels begin.
    start: u64,
    reader: Box<dyn Read>,
    bytes: Vec<u8>,
    slice: usize,
}

/// Opens an image.
pub fn open(w: &World, word: &Word) -> Result<Box<dyn Image>> {
    let path = locate(w, word)?;
    let (bytes, start) = head(&path).map_err(|e| unreadable(&path, word, &e))?;
    let file = File { name: path.display().to_string(), bytes, at: word.span };
    let header =
        file.text().and_then(read).and_then(|h| h.info.check(word).map(|()| h)).map_err(|e| file.blame(e))?;
    let (path, start) = match &header.data {
        None => (path, start),
        Some(name) => {
            let beside = path.parent().unwrap_or(Path::new("")).join(name);
            passable(&beside, word)?;
            w.read_files.note(&beside);
            (beside, 0)
        }
    };
    if !header.packed {
        whole_slices(&path, start, &header, word)?;
    }
    let reader = from(&path, start, header.packed).map_err(|e| unreadable(&path, word, &e))?;
    Ok(Box::new(Nrrd { header, word: word.clone(), path, start, reader, bytes: vec![], slice: 0 }))
}

/// Checks that a file which is not packed holds all slices, before room is made for them.
fn whole_slices(path: &Path, start: u64, header: &Header, word: &Word) -> Result<()> {
    let length =
        gate::open(path).and_then(|file| file.metadata()).map_err(|e| unreadable(path, word, &e))?.len();
    let [nx, ny, nz] = header.info.size;
    let slices = length.saturating_sub(start) / (nx as u64 * ny as u64 * header.kind.size() as u64).max(1);
    if slices < nz as u64 {
        let end = std::io::ErrorKind::UnexpectedEof.into();
        return Err(cut_off(&path.display().to_string(), [slices as usize, nz], word, &end));
    }
    Ok(())
}

/// The header, and where what follows its blank line begins.
fn head(path: &Path) -> std::io::Result<(Vec<u8>, u64)> {
    let mut file = BufReader::new(gate::open(path)?).take(HEADER as u64);
    let mut bytes = vec![];
    loop {
        let before = bytes.len();
        file.read_until(b'\n', &mut bytes)?;
        let line = bytes[before..].trim_ascii();
        if line.is_empty() {
            let start = bytes.len() as u64;
            bytes.truncate(before);
            return Ok((bytes, start));
        }
    }
}

fn from(path: &Path, start: u64, packed: bool) -> std::io::Result<Box<dyn Read>> {
    let mut file = gate::open(path)?;
    file.seek(SeekFrom::Start(start))?;
    Ok(match packed {
        true => Box::new(BufReader::new(flate2::read::MultiGzDecoder::new(file))),
        false => Box::new(BufReader::new(file)),
    })
}

/// Reads a header.
///
/// # Errors
/// What is no NRRD header, and NRRD features that perigrain lacks.
pub fn read(text: &str) -> Result<Header> {
    let mut lines = Lines::new(text);
    let first = lines.take();
    let Some(first) = first.filter(|l| l.text.starts_with("NRRD000")) else {
        return fail(
            Code::BAD_FILE,
            lines.end(),
            "this is no NRRD file: it must begin with NRRD0001 or the like",
        );
    };
    let (mut kind, mut sizes, mut packed, mut endian, mut data) = (None, None, None, None, None);
    let (mut spacing, mut origin, mut dimension) = (None, None, None);
    while let Some(line) = lines.take() {
        // `key:=value` is for programs of their own.
        let Some((name, value)) = line.text.split_once(": ").filter(|_| !line.text.contains(":=")) else {
            continue;
        };
        let value = value.trim();
        match name.trim().to_ascii_lowercase().as_str() {
            "type" => kind = Some(self::kind(&line, value)?),
            "dimension" => dimension = Some(whole(&line, value, "the dimension")?),
            "sizes" => sizes = Some(self::sizes(&line, value)?),
            "spacings" => spacing = some_positive(&numbers(&line, value)?),
            "space directions" => spacing = directions(&line, value)?,
            "space origin" => origin = Some(vector(&line, value)?),
            "endian" => endian = Some(value == "big"),
            "encoding" => packed = Some(encoding(&line, value)?),
            "data file" | "datafile" => match value.contains(['%', ' ']) || value == "LIST" {
                true => return Err(not_read(line.span(), "an NRRD header with several data files").into()),
                false => data = Some(value.to_string()),
            },
            "line skip" | "lineskip" | "byte skip" | "byteskip" if value != "0" => {
                return Err(not_read(line.span(), format!("`{}` of NRRD", name.trim())).into());
            }
            _ => {}
        }
    }
    let need = |what: &str| fail(Code::INCOMPLETE, first.span(), format!("the header has no `{what}`"));
    let Some(kind) = kind else { return need("type") };
    let Some(list) = sizes else { return need("sizes") };
    let Some(packed) = packed else { return need("encoding") };
    if dimension.is_some_and(|d| d != list.len() as i64) || !(2..=3).contains(&list.len()) {
        let d = not_read(first.span(), format!("an NRRD file with {} sizes", list.len()));
        return Err(d.help("images have two or three axes, and one number for each voxel").into());
    }
    if kind.size() > 1 && endian.is_none() {
        return need("endian");
    }
    let size = [list[0], list[1], list.get(2).copied().unwrap_or(1)];
    // In a flat image a voxel is as deep as it is wide.
    let spacing = spacing.map(|s: Vec<f64>| [s[0], s[1], s.get(2).copied().unwrap_or(s[0])]);
    let info = Info { size, spacing, origin: origin.unwrap_or([0.0; 3]), centred: origin.is_some() };
    Ok(Header { info, kind, big_endian: endian.unwrap_or(false), packed, data })
}

fn kind(line: &Line, value: &str) -> Result<Kind> {
    Ok(match value {
        "signed char" | "int8" | "int8_t" => Kind::I8,
        "uchar" | "unsigned char" | "uint8" | "uint8_t" => Kind::U8,
        "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => Kind::I16,
        "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => Kind::U16,
        "int" | "signed int" | "int32" | "int32_t" => Kind::I32,
        "uint" | "unsigned int" | "uint32" | "uint32_t" => Kind::U32,
        "longlong" | "long long" | "long long int" | "int64" | "int64_t" => Kind::I64,
        "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => Kind::U64,
        "float" => Kind::F32,
        "double" => Kind::F64,
        other => return Err(not_read(line.span(), format!("NRRD's type `{other}`")).into()),
    })
}

fn encoding(line: &Line, value: &str) -> Result<bool> {
    match value {
        "raw" => Ok(false),
        "gzip" | "gz" => Ok(true),
        other => {
            let d = not_read(line.span(), format!("NRRD's encoding `{other}`"));
            Err(d.help("raw and gzip are").into())
        }
    }
}

fn sizes(line: &Line, value: &str) -> Result<Vec<usize>> {
    value
        .split_ascii_whitespace()
        .map(|w| {
            let n = whole(line, w, "a size")?;
            match usize::try_from(n) {
                Ok(n) if n > 0 => Ok(n),
                _ => fail(Code::BAD_VALUE, line.span_of(w), format!("a size must be above zero, not {n}")),
            }
        })
        .collect()
}

/// Numbers of a line, `nan` among them.
fn numbers(line: &Line, value: &str) -> Result<Vec<f64>> {
    let words = value.split(|c: char| c.is_ascii_whitespace() || "(),".contains(c)).filter(|w| !w.is_empty());
    words
        .map(|w| match w.parse::<f64>() {
            Ok(x) => Ok(x),
            Err(_) => fail(Code::BAD_NUMBER, line.span_of(w), format!("a number must stand here, not `{w}`")),
        })
        .collect()
}

fn some_positive(list: &[f64]) -> Option<Vec<f64>> {
    (list.len() >= 2 && list.iter().all(|x| x.is_finite() && *x > 0.0)).then(|| list.to_vec())
}

fn vector(line: &Line, value: &str) -> Result<[f64; 3]> {
    let list = numbers(line, value)?;
    if list.len() > 3 || list.len() < 2 || list.iter().any(|x| !x.is_finite()) {
        return fail(Code::BAD_NUMBER, line.span(), "a place of two or three numbers must stand here");
    }
    Ok([list[0], list[1], list.get(2).copied().unwrap_or(0.0)])
}

/// Edges of voxels whose axes lie along x, y, z.
fn directions(line: &Line, value: &str) -> Result<Option<Vec<f64>>> {
    let list = numbers(line, value)?;
    let n = if list.len() == 4 { 2 } else { 3 };
    let along = |k: usize| list[k * n + k];
    let askew = list.len() != n * n || (0..n * n).any(|k| k / n != k % n && list[k] != 0.0);
    if askew || (0..n).any(|k| along(k).is_nan() || along(k) <= 0.0) {
        let d = not_read(line.span(), "an image whose axes do not lie along x, y and z");
        return Err(d.help("`rotate` turns an image in the deck").into());
    }
    Ok(some_positive(&(0..n).map(along).collect::<Vec<_>>()))
}

impl Image for Nrrd {
    fn info(&self) -> &Info {
        &self.header.info
    }

    fn rewind(&mut self) -> Result<()> {
        self.slice = 0;
        self.reader = from(&self.path, self.start, self.header.packed)
            .map_err(|e| unreadable(&self.path, &self.word, &e))?;
        Ok(())
    }

    fn slice(&mut self, values: &mut Vec<f64>) -> Result<()> {
        let h = &self.header;
        let [nx, ny, nz] = h.info.size;
        self.bytes.resize(nx * ny * h.kind.size(), 0);
        let read = self.reader.read_exact(&mut self.bytes);
        let name = self.path.display().to_string();
        read.map_err(|e| cut_off(&name, [self.slice, nz], &self.word, &e))?;
        self.slice += 1;
        h.kind.read_into(&self.bytes, h.big_endian, values);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_have_size_place_and_kind() {
        let text = "NRRD0004\ntype: uint16\ndimension: 3\nsizes: 4 5 6\nendian: big\nencoding: gzip\n\
                    space directions: (2,0,0) (0,3,0) (0,0,4)\nspace origin: (1,1,1)\nkey:=a: b\n";
        let h = read(text).unwrap();
        assert_eq!((h.info.size, h.info.spacing), ([4, 5, 6], Some([2.0, 3.0, 4.0])));
        assert_eq!(h.info.corner([2.0, 3.0, 4.0]), [0.0, -0.5, -1.0]);
        assert!(h.packed && h.big_endian && h.kind == Kind::U16);
        for (from, to, part) in [
            ("uint16", "block", "type `block`"),
            ("gzip", "bzip2", "encoding `bzip2`"),
            ("endian: big\n", "", "no `endian`"),
            ("4 5 6", "4 5 0", "above zero"),
            ("(0,3,0)", "(1,3,0)", "do not lie along"),
            ("4 5 6", "4 5", "2 sizes"),
            ("NRRD", "nrrd", "no NRRD file"),
        ] {
            let e = read(&text.replacen(from, to, 1)).unwrap_err();
            assert!(e.to_string().contains(part), "{e}");
        }
    }
}
