//! VTK XML files: tags, and arrays as text, base64 or raw bytes, optionally compressed by zlib.

use super::appended::{Appended, DENSEST, Place};
use super::numbers::Kind;
use super::tags::{Tag, next};
use perigrain_base::base64;
use perigrain_base::diag::brought::{broken, not_read, place};
use perigrain_base::diag::{Code, Diagnostic, Result, Span, fail};
use perigrain_base::memory;
use std::io::{Cursor, ErrorKind, Read};

/// An array of the file that is not read yet.
#[derive(Clone, Debug)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// Number of components per point or cell.
    pub components: usize,
    kind: Kind,
    format: Format,
    /// The parent element: `Points`, `CellData` …
    of: String,
    at: Span,
}

#[derive(Clone, Copy, Debug)]
enum Format {
    Text(usize, usize),
    Base64(usize, usize),
    Appended(usize),
}

/// A piece of the data set.
#[derive(Clone, Debug)]
pub struct Piece {
    attributes: Vec<(String, String)>,
    arrays: Vec<Array>,
    /// Span of its opening tag.
    pub at: Span,
}

impl Piece {
    /// An attribute.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str())
    }

    /// An attribute that is an integer.
    ///
    /// # Errors
    /// The attribute is missing or not an integer.
    pub fn count(&self, name: &str) -> Result<usize> {
        match self.get(name).and_then(|v| v.trim().parse::<u32>().ok()) {
            Some(n) => Ok(n as usize),
            None => fail(Code::BAD_NUMBER, self.at, format!("this piece needs a whole number {name}")),
        }
    }
}

/// A file.
pub struct Document<'a> {
    bytes: &'a [u8],
    big_endian: bool,
    wide: bool,
    packed: bool,
    /// Start of appended bytes, and whether they are raw.
    appended: Option<(usize, bool)>,
    /// Attributes of the data set.
    pub attributes: Vec<(String, String)>,
    /// Span of its tag.
    pub at: Span,
    /// Its pieces.
    pub pieces: Vec<Piece>,
}

impl<'a> Document<'a> {
    /// Reads the tags of a file with a data set of this type.
    ///
    /// # Errors
    /// Other files, and invalid tags.
    pub fn read(bytes: &'a [u8], set: &str) -> Result<Self> {
        let mut d = Document {
            bytes,
            big_endian: false,
            wide: false,
            packed: false,
            appended: None,
            attributes: vec![],
            at: place(0, 1),
            pieces: vec![],
        };
        let mut at = 0;
        let mut open: Vec<String> = vec![];
        while let Some(tag) = next(bytes, at)? {
            at = tag.end;
            if tag.closes {
                if open.pop().as_deref() != Some(tag.name) {
                    return fail(Code::SYNTAX, tag.at, format!("</{}> closes nothing here", tag.name));
                }
                continue;
            }
            if open.is_empty() && tag.name != "VTKFile" {
                break;
            }
            match tag.name {
                "VTKFile" => d.head(&tag, set)?,
                name if name == set => {
                    d.attributes = owned(&tag);
                    d.at = tag.at;
                }
                "Piece" => d.pieces.push(Piece { attributes: owned(&tag), arrays: vec![], at: tag.at }),
                "DataArray" | "Array" => at = d.note(&tag, open.last().map_or("", |o| o.as_str()), at)?,
                "AppendedData" => {
                    let raw = tag.get("encoding") == Some("raw");
                    let start = bytes[at..].iter().position(|b| *b == b'_');
                    let Some(start) = start else {
                        return fail(Code::SYNTAX, tag.at, "the bytes must begin behind a `_`");
                    };
                    d.appended = Some((at + start + 1, raw));
                    return d.done(set);
                }
                _ => {}
            }
            if !tag.empty {
                open.push(tag.name.to_string());
            }
        }
        match open.last() {
            Some(name) => {
                Err(broken(bytes.len().saturating_sub(1), format!("the file ends within <{name}>")))
            }
            None => d.done(set),
        }
    }

    fn done(self, set: &str) -> Result<Self> {
        match self.pieces.is_empty() {
            true => Err(broken(0, format!("this is no VTK XML file with an {set}: it has no <Piece>"))),
            false => Ok(self),
        }
    }

    fn head(&mut self, tag: &Tag, set: &str) -> Result<()> {
        let kind = tag.get("type").unwrap_or("?");
        if kind != set {
            let text = format!("the file holds data of type `{kind}`; `{set}` is needed here");
            return fail(Code::BAD_FILE, tag.at, text);
        }
        self.big_endian = tag.get("byte_order") == Some("BigEndian");
        self.wide = tag.get("header_type") == Some("UInt64");
        match tag.get("compressor") {
            None => {}
            Some("vtkZLibDataCompressor") => self.packed = true,
            Some(other) => {
                let d = not_read(tag.at, format!("a file packed by {other}"));
                return Err(d.help("zlib is, and files that are not packed").into());
            }
        }
        Ok(())
    }

    /// Records an array; returns the end of its content.
    fn note(&mut self, tag: &Tag, of: &str, at: usize) -> Result<usize> {
        let end = match tag.empty {
            true => at,
            false => self.bytes[at..].iter().position(|b| *b == b'<').map_or(self.bytes.len(), |k| at + k),
        };
        // Arrays of the file as a whole, and strings, are ignored.
        let Some(piece) = self.pieces.last_mut().filter(|_| tag.name == "DataArray") else { return Ok(end) };
        let kind = match tag.get("type") {
            Some("Int8") => Kind::I8,
            Some("UInt8") => Kind::U8,
            Some("Int16") => Kind::I16,
            Some("UInt16") => Kind::U16,
            Some("Int32") => Kind::I32,
            Some("UInt32") => Kind::U32,
            Some("Int64") => Kind::I64,
            Some("UInt64") => Kind::U64,
            Some("Float32") => Kind::F32,
            Some("Float64") => Kind::F64,
            Some("String") => return Ok(end),
            other => {
                return fail(
                    Code::BAD_VALUE,
                    tag.at,
                    format!("`{}` is no type of array", other.unwrap_or("")),
                );
            }
        };
        let format = match tag.get("format") {
            Some("ascii") | None => Format::Text(at, end),
            Some("binary") => Format::Base64(at, end),
            Some("appended") => match tag.get("offset").and_then(|o| o.trim().parse().ok()) {
                Some(offset) => Format::Appended(offset),
                None => return fail(Code::BAD_NUMBER, tag.at, "an appended array needs its offset"),
            },
            Some(other) => {
                return fail(Code::BAD_VALUE, tag.at, format!("`{other}` is no format of an array"));
            }
        };
        piece.arrays.push(Array {
            name: tag.get("Name").unwrap_or("").to_string(),
            components: tag.get("NumberOfComponents").and_then(|n| n.trim().parse().ok()).unwrap_or(1),
            kind,
            format,
            of: of.to_string(),
            at: tag.at,
        });
        Ok(end)
    }

    /// The arrays of an element of a piece.
    pub fn arrays<'p>(&self, piece: &'p Piece, of: &'p str) -> impl Iterator<Item = &'p Array> + use<'p> {
        piece.arrays.iter().filter(move |a| a.of == of)
    }

    /// The array of this name, or the first one for an empty name.
    pub fn array<'p>(&self, piece: &'p Piece, of: &str, name: &str) -> Option<&'p Array> {
        piece.arrays.iter().find(|a| a.of == of && (name.is_empty() || a.name == name))
    }

    /// Location of an array that can be read on demand: appended raw data.
    pub fn place(&self, a: &Array) -> Option<Place> {
        let (Format::Appended(offset), Some((start, true))) = (a.format, self.appended) else { return None };
        Some(self.place_at(a, (start as u64).checked_add(offset as u64)?))
    }

    fn place_at(&self, a: &Array, start: u64) -> Place {
        let (big_endian, wide, packed) = (self.big_endian, self.wide, self.packed);
        Place { start, kind: a.kind, big_endian, wide, packed }
    }

    /// The numbers of an array.
    ///
    /// # Errors
    /// Invalid or truncated data.
    pub fn numbers(&self, a: &Array) -> Result<Vec<f64>> {
        let bytes = match a.format {
            Format::Text(from, to) => return self.text(from, to),
            Format::Base64(from, to) => self.unpacked(a, &base64::decode(&self.bytes[from..to]))?,
            Format::Appended(offset) => {
                let Some((start, raw)) = self.appended else {
                    return fail(Code::INCOMPLETE, a.at, "the file has no <AppendedData>");
                };
                let Some(rest) = start.checked_add(offset).and_then(|s| self.bytes.get(s..)) else {
                    return fail(Code::INCOMPLETE, a.at, "the file ends before this array's offset");
                };
                if raw { self.unpacked(a, rest)? } else { self.unpacked(a, &base64::decode(rest))? }
            }
        };
        if bytes.len() % a.kind.size() != 0 {
            return fail(
                Code::BAD_FILE,
                a.at,
                format!("the {} bytes of this array are no whole numbers", bytes.len()),
            );
        }
        Ok(a.kind.read_all(&bytes, self.big_endian))
    }

    fn text(&self, from: usize, to: usize) -> Result<Vec<f64>> {
        let mut numbers = vec![];
        let mut at = from;
        for word in self.bytes[from..to].split(u8::is_ascii_whitespace) {
            let start = at;
            at += word.len() + 1;
            if word.is_empty() {
                continue;
            }
            match std::str::from_utf8(word).ok().and_then(|w| w.parse::<f64>().ok()) {
                Some(x) => numbers.push(x),
                None => {
                    return fail(
                        Code::BAD_NUMBER,
                        place(start, start + word.len()),
                        "a number must stand here",
                    );
                }
            }
        }
        Ok(numbers)
    }

    /// The bytes after their header, decompressed.
    fn unpacked(&self, a: &Array, bytes: &[u8]) -> Result<Vec<u8>> {
        let blamed = |e: &std::io::Error| match e.kind() {
            ErrorKind::UnexpectedEof => {
                broken(a.at.start as usize, format!("the array `{}` is cut off", a.name))
            }
            _ => {
                let text = format!("the array `{}` cannot be unpacked: it is damaged", a.name);
                Diagnostic::error(Code::BAD_FILE, a.at, text).into()
            }
        };
        let mut file = Appended::open(Cursor::new(bytes), &self.place_at(a, 0)).map_err(|e| blamed(&e))?;
        let all = file.length();
        if all > (bytes.len() as u64).saturating_mul(DENSEST) {
            let text = format!("the array `{}` says it has {all} bytes: it is damaged", a.name);
            return fail(Code::BAD_FILE, a.at, text);
        }
        if let Some(d) = memory::lacking(all as f64, &format!("the array `{}`", a.name)) {
            return Err(d.into());
        }
        let mut out = Vec::with_capacity(all as usize);
        file.read_to_end(&mut out).map_err(|e| blamed(&e))?;
        Ok(out)
    }
}

fn owned(tag: &Tag) -> Vec<(String, String)> {
    tag.attributes.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect()
}
