//! The bytes of a legacy VTK file as words, numbers and blocks of numbers, of the text and of the binary kind.

use super::super::file::{broken, place};
use perigrain_base::diag::{Code, Result, Span, fail};
use perigrain_mesh::vtk::numbers::Kind;

/// Numbers, and where each stands where the file is a text.
pub type Block = (Vec<f64>, Vec<(u32, u32)>);

/// A cursor over the bytes.
pub struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Numbers of blocks are binary.
    pub binary: bool,
}

impl<'a> Words<'a> {
    /// At the first byte.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, binary: false }
    }

    /// The rest of the line.
    pub fn line(&mut self) -> &'a [u8] {
        let rest = self.bytes.get(self.at..).unwrap_or(&[]);
        let end = rest.iter().position(|b| *b == b'\n').unwrap_or(rest.len());
        self.at += (end + 1).min(rest.len());
        rest[..end].trim_ascii()
    }

    /// The next word, if there is one; blanks and line ends before it are passed over.
    pub fn next(&mut self) -> Option<Word<'a>> {
        while self.bytes.get(self.at).is_some_and(u8::is_ascii_whitespace) {
            self.at += 1;
        }
        let start = self.at;
        while self.bytes.get(self.at).is_some_and(|b| !b.is_ascii_whitespace()) {
            self.at += 1;
        }
        let text = &self.bytes[start..self.at];
        (!text.is_empty()).then_some(Word {
            text: std::str::from_utf8(text).unwrap_or("?"),
            start,
            end: self.at,
        })
    }

    /// The next word, not taken.
    pub fn peek(&self) -> Option<Word<'a>> {
        Words { bytes: self.bytes, at: self.at, binary: self.binary }.next()
    }

    /// The next word, which is a `what`.
    pub fn expect(&mut self, what: &str) -> Result<Word<'a>> {
        let end = self.bytes.len();
        self.next()
            .ok_or_else(|| broken(end.saturating_sub(1), format!("the file ends where {what} must stand")))
    }

    /// A number of things, of which each has a byte at least.
    pub fn count(&mut self, what: &str) -> Result<usize> {
        let word = self.expect(what)?;
        let Ok(n) = word.text.parse::<usize>() else {
            return fail(
                Code::BAD_NUMBER,
                word.span(),
                format!("{what} must be a whole number, not `{}`", word.text),
            );
        };
        if n > self.bytes.len().saturating_mul(8) {
            return fail(
                Code::INCOMPLETE,
                word.span(),
                format!("{what} is {n}: the file is too short for that"),
            );
        }
        Ok(n)
    }

    /// The kind of the numbers of a block; what VTK calls `long` has eight bytes.
    pub fn kind(&mut self) -> Result<Kind> {
        let word = self.expect("a kind of number")?;
        Ok(match word.text.to_ascii_lowercase().as_str() {
            "char" | "vtktypeint8" => Kind::I8,
            "unsigned_char" | "vtktypeuint8" => Kind::U8,
            "short" | "vtktypeint16" => Kind::I16,
            "unsigned_short" | "vtktypeuint16" => Kind::U16,
            "int" | "vtktypeint32" => Kind::I32,
            "unsigned_int" | "vtktypeuint32" => Kind::U32,
            "long" | "vtktypeint64" | "vtkidtype" => Kind::I64,
            "unsigned_long" | "vtktypeuint64" => Kind::U64,
            "float" => Kind::F32,
            "double" => Kind::F64,
            other => {
                let text = format!("numbers of kind `{other}` are not in perigrain yet");
                return fail(Code::NOT_SUPPORTED, word.span(), text);
            }
        })
    }

    /// A block of so many numbers, and where each stands in a text.
    pub fn block(&mut self, kind: Kind, count: usize, what: &str) -> Result<Block> {
        if self.binary {
            self.skip_line_end();
            let size = count.saturating_mul(kind.size());
            let Some(bytes) = self.at.checked_add(size).and_then(|end| self.bytes.get(self.at..end)) else {
                return Err(broken(
                    self.bytes.len().saturating_sub(1),
                    format!("the file ends within {what}"),
                ));
            };
            self.at += size;
            return Ok((kind.read_all(bytes, true), vec![]));
        }
        let (mut numbers, mut places) = (vec![], vec![]);
        for _ in 0..count {
            let word = self.expect(what)?;
            match word.text.parse::<f64>() {
                Ok(x) => numbers.push(x),
                Err(_) => {
                    let text = format!("a number of {what} must stand here, not `{}`", word.text);
                    return fail(Code::BAD_NUMBER, word.span(), text);
                }
            }
            places.push((word.start as u32, word.end as u32));
        }
        Ok((numbers, places))
    }

    /// The one line end between a line and its binary block.
    fn skip_line_end(&mut self) {
        if let Some(end) = self.bytes.get(self.at..).and_then(|r| r.iter().position(|b| *b == b'\n'))
            && self.bytes[self.at..self.at + end].iter().all(u8::is_ascii_whitespace)
        {
            self.at += end + 1;
        }
    }

    /// The place of the end.
    pub fn end(&self) -> usize {
        self.bytes.len().saturating_sub(1)
    }
}

/// A word and where it stands.
#[derive(Clone, Copy)]
pub struct Word<'a> {
    /// Its text.
    pub text: &'a str,
    start: usize,
    end: usize,
}

impl Word<'_> {
    /// Its place.
    pub fn span(&self) -> Span {
        place(self.start, self.end)
    }
}
