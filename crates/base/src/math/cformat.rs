//! C's `printf` conversions, character for character: flags, width, precision, `inf`, `nan` and `-0`.

mod digits;

use std::io::Write;

/// Largest width or precision accepted; C has no limit, a log line does.
const LIMIT: usize = 1000;

/// Supported conversions: the letter after flags, width and precision.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conversion {
    /// `d`, `i`: signed decimal.
    Signed,
    /// `u`: unsigned decimal.
    Unsigned,
    /// `o`: octal.
    Octal,
    /// `x`, `X`: hexadecimal.
    Hex,
    /// `e`, `E`: always with exponent.
    Exponent,
    /// `f`, `F`: never an exponent.
    Fixed,
    /// `g`, `G`: the more suitable of the two, without trailing zeros.
    General,
    /// `s`: text.
    Text,
}

/// One conversion, such as `%-10.4g`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spec {
    /// `-`: left-justified.
    pub left: bool,
    /// `+`: sign for positive numbers too.
    pub plus: bool,
    /// Blank: a blank in place of `+`.
    pub space: bool,
    /// `#`: keeps the point and zeros; `0x` before hexadecimal.
    pub alternate: bool,
    /// `0`: pads with zeros after the sign.
    pub zero: bool,
    /// Minimum width.
    pub width: usize,
    /// Digits after the point (`e f`), significant digits (`g`), minimum digits (`d`), maximum characters
    /// (`s`).
    pub precision: Option<usize>,
    /// Whether a length modifier (`l`, `ll`, `z`, `j`, `q`) was given.
    pub long: bool,
    /// The conversion.
    pub conversion: Conversion,
    /// Capital letters.
    pub upper: bool,
}

/// A part of a format string.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Piece {
    /// Literal text (`%%` is already a single `%`).
    Text(String),
    /// The place of a value.
    Value(Spec),
}

/// A parsed format string.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Format {
    /// Text and conversions in order.
    pub pieces: Vec<Piece>,
}

/// Why a format string is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct FormatError {
    /// Byte of the string where the error begins.
    pub at: usize,
    /// The message, lower case, no full stop.
    pub message: String,
}

/// A value for a conversion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// An integer.
    Int(i64),
    /// A number.
    Float(f64),
    /// Text.
    Text(&'a str),
}

impl Format {
    /// Parses a format string.
    pub fn parse(text: &str) -> Result<Self, FormatError> {
        let bytes = text.as_bytes();
        let (mut pieces, mut literal, mut k) = (vec![], Vec::new(), 0);
        while k < bytes.len() {
            if bytes[k] != b'%' {
                literal.push(bytes[k]);
                k += 1;
                continue;
            }
            if bytes.get(k + 1) == Some(&b'%') {
                literal.push(b'%');
                k += 2;
                continue;
            }
            let (spec, length) =
                Spec::read(&bytes[k..]).map_err(|message| FormatError { at: k, message: message.into() })?;
            if !literal.is_empty() {
                pieces.push(Piece::Text(text_of(std::mem::take(&mut literal))));
            }
            pieces.push(Piece::Value(spec));
            k += length;
        }
        if !literal.is_empty() {
            pieces.push(Piece::Text(text_of(literal)));
        }
        Ok(Self { pieces })
    }

    /// The conversions in order.
    pub fn specs(&self) -> impl Iterator<Item = &Spec> {
        self.pieces.iter().filter_map(|p| match p {
            Piece::Value(s) => Some(s),
            Piece::Text(_) => None,
        })
    }

    /// Writes the format with these values; conversions without a value produce nothing, excess values are
    /// ignored.
    pub fn write(&self, out: &mut Vec<u8>, values: &[Value<'_>]) {
        let mut values = values.iter();
        for piece in &self.pieces {
            match piece {
                Piece::Text(t) => out.extend_from_slice(t.as_bytes()),
                Piece::Value(spec) => {
                    if let Some(v) = values.next() {
                        spec.value(out, *v);
                    }
                }
            }
        }
    }

    /// The format with these values as text.
    pub fn text(&self, values: &[Value<'_>]) -> String {
        let mut out = Vec::new();
        self.write(&mut out, values);
        text_of(out)
    }
}

impl Spec {
    /// Parses a single conversion such as `%-8.3f` without surrounding text.
    pub fn parse(text: &str) -> Result<Self, FormatError> {
        if !text.starts_with('%') {
            return Err(FormatError { at: 0, message: "a conversion starts with %".into() });
        }
        match Self::read(text.as_bytes()) {
            Ok((spec, length)) if length == text.len() => Ok(spec),
            Ok((_, length)) => {
                Err(FormatError { at: length, message: "unexpected text after the conversion".into() })
            }
            Err(message) => Err(FormatError { at: 0, message: message.into() }),
        }
    }

    /// Parses a conversion at a `%`; returns it with its length in bytes.
    fn read(bytes: &[u8]) -> Result<(Self, usize), &'static str> {
        let mut spec = Self {
            left: false,
            plus: false,
            space: false,
            alternate: false,
            zero: false,
            width: 0,
            precision: None,
            long: false,
            conversion: Conversion::General,
            upper: false,
        };
        let mut k = 1;
        loop {
            match bytes.get(k) {
                Some(b'-') => spec.left = true,
                Some(b'+') => spec.plus = true,
                Some(b' ') => spec.space = true,
                Some(b'#') => spec.alternate = true,
                Some(b'0') => spec.zero = true,
                _ => break,
            }
            k += 1;
        }
        if bytes.get(k) == Some(&b'*') {
            return Err("a width given by * is not understood");
        }
        spec.width = read_number(bytes, &mut k)?;
        if bytes.get(k) == Some(&b'.') {
            k += 1;
            if bytes.get(k) == Some(&b'*') {
                return Err("a precision given by * is not understood");
            }
            spec.precision = Some(read_number(bytes, &mut k)?);
        }
        while let Some(b'l' | b'h' | b'q' | b'j' | b'z' | b't' | b'L') = bytes.get(k) {
            spec.long |= bytes[k] != b'h';
            k += 1;
        }
        let Some(&letter) = bytes.get(k) else {
            return Err("the conversion breaks off: a letter such as d, g, f, e or s is missing");
        };
        spec.upper = letter.is_ascii_uppercase();
        spec.conversion = match letter {
            b'd' | b'i' => Conversion::Signed,
            b'u' => Conversion::Unsigned,
            b'o' => Conversion::Octal,
            b'x' | b'X' => Conversion::Hex,
            b'e' | b'E' => Conversion::Exponent,
            b'f' | b'F' => Conversion::Fixed,
            b'g' | b'G' => Conversion::General,
            b's' => Conversion::Text,
            _ => return Err("unknown conversion letter: use one of d i u o x e f g s"),
        };
        Ok((spec, k + 1))
    }

    /// Whether the conversion is for integers.
    pub fn is_integer(&self) -> bool {
        use Conversion::{Hex, Octal, Signed, Unsigned};
        matches!(self.conversion, Signed | Unsigned | Octal | Hex)
    }

    /// Whether the conversion is for floating-point numbers.
    pub fn is_float(&self) -> bool {
        matches!(self.conversion, Conversion::Exponent | Conversion::Fixed | Conversion::General)
    }

    /// Writes a value, converted if its type differs: a float is truncated to an integer for `%d`.
    pub fn value(&self, out: &mut Vec<u8>, value: Value<'_>) {
        match value {
            Value::Text(t) => self.string(out, t),
            Value::Int(i) if self.is_float() => self.float(out, i as f64),
            Value::Int(i) if self.is_integer() => self.integer(out, i),
            Value::Int(i) => self.string(out, &i.to_string()),
            Value::Float(x) if self.is_integer() => self.integer(out, x as i64),
            Value::Float(x) if self.is_float() => self.float(out, x),
            Value::Float(x) => self.string(out, &general(x, 6)),
        }
    }

    /// Writes an integer. Unsigned conversions of a negative number without `l` use 32 bits, like C with an
    /// `int`.
    pub fn integer(&self, out: &mut Vec<u8>, value: i64) {
        let start = out.len();
        let unsigned = match i32::try_from(value) {
            Ok(small) if !self.long => u64::from(small as u32),
            _ => value as u64,
        };
        let negative = self.conversion == Conversion::Signed && value < 0;
        // Writing to a Vec cannot fail.
        let _ = match self.conversion {
            Conversion::Octal => write!(out, "{unsigned:o}"),
            Conversion::Hex if self.upper => write!(out, "{unsigned:X}"),
            Conversion::Hex => write!(out, "{unsigned:x}"),
            Conversion::Unsigned => write!(out, "{unsigned}"),
            _ => write!(out, "{}", value.unsigned_abs()),
        };
        if value == 0 && self.precision == Some(0) {
            out.truncate(start);
        }
        let digits = out.len() - start;
        insert(out, start, self.precision.unwrap_or(0).saturating_sub(digits), b'0');
        if self.alternate && self.conversion == Conversion::Octal && out.get(start) != Some(&b'0') {
            insert(out, start, 1, b'0');
        }
        let mut prefix = 0;
        if self.alternate && self.conversion == Conversion::Hex && value != 0 {
            out.splice(start..start, [b'0', if self.upper { b'X' } else { b'x' }]);
            prefix = 2;
        }
        if self.conversion == Conversion::Signed {
            prefix += self.sign(out, start, negative);
        }
        self.pad(out, start, prefix, self.precision.is_none());
    }

    /// Writes a number by `%e`, `%f` or `%g` with C's rounding (exact value, ties to even).
    pub fn float(&self, out: &mut Vec<u8>, x: f64) {
        let start = out.len();
        let size = x.abs();
        if size.is_finite() {
            let precision = self.precision.unwrap_or(6);
            match self.conversion {
                Conversion::Fixed => {
                    digits::fixed(out, size, precision);
                    if self.alternate && precision == 0 {
                        out.push(b'.');
                    }
                }
                Conversion::Exponent => {
                    let exponent = digits::significant(out, size, precision + 1);
                    if self.alternate || precision > 0 {
                        out.insert(start + 1, b'.');
                    }
                    push_exponent(out, exponent, self.upper);
                }
                _ => self.general(out, size, precision.max(1)),
            }
        } else {
            let word = if size.is_nan() { "nan" } else { "inf" };
            out.extend_from_slice(word.as_bytes());
            if self.upper {
                out[start..].make_ascii_uppercase();
            }
        }
        let prefix = self.sign(out, start, x.is_sign_negative());
        self.pad(out, start, prefix, size.is_finite());
    }

    /// `%g` with `digits` significant digits; with an exponent if it is below -4 or not below `digits`.
    fn general(&self, out: &mut Vec<u8>, size: f64, digits: usize) {
        let start = out.len();
        let exponent = digits::significant(out, size, digits);
        if !self.alternate {
            let zeros = out[start + 1..].iter().rev().take_while(|&&b| b == b'0').count();
            out.truncate(out.len() - zeros);
        }
        let wordy = exponent < -4 || exponent >= digits as i32;
        if !wordy && exponent < 0 {
            insert(out, start, exponent.unsigned_abs() as usize, b'0');
        }
        let whole = if wordy { 1 } else { exponent.max(0) as usize + 1 };
        let missing = whole.saturating_sub(out.len() - start);
        out.resize(out.len() + missing, b'0');
        if out.len() - start > whole || self.alternate {
            out.insert(start + whole, b'.');
        }
        if wordy {
            push_exponent(out, exponent, self.upper);
        }
    }

    /// Writes text, truncated to the precision.
    pub fn string(&self, out: &mut Vec<u8>, text: &str) {
        let start = out.len();
        let most = self.precision.unwrap_or(usize::MAX);
        let end = text.char_indices().map(|(k, c)| k + c.len_utf8()).take_while(|&e| e <= most).last();
        out.extend_from_slice(&text.as_bytes()[..end.unwrap_or(0)]);
        self.pad(out, start, 0, false);
    }

    /// Inserts the sign before the output since `start`; returns its length.
    fn sign(&self, out: &mut Vec<u8>, start: usize, negative: bool) -> usize {
        let sign = match (negative, self.plus, self.space) {
            (true, ..) => b'-',
            (_, true, _) => b'+',
            (.., true) => b' ',
            _ => return 0,
        };
        out.insert(start, sign);
        1
    }

    /// Pads to the width; zeros go after the first `prefix` characters.
    fn pad(&self, out: &mut Vec<u8>, start: usize, prefix: usize, zeros: bool) {
        let missing = self.width.saturating_sub(out.len() - start);
        if missing == 0 {
            return;
        }
        if self.left {
            out.resize(out.len() + missing, b' ');
        } else if self.zero && zeros {
            insert(out, start + prefix, missing, b'0');
        } else {
            insert(out, start, missing, b' ');
        }
    }
}

/// A number as by C's `%.{digits}g`.
pub fn general(x: f64, digits: usize) -> String {
    let spec = Spec {
        left: false,
        plus: false,
        space: false,
        alternate: false,
        zero: false,
        width: 0,
        precision: Some(digits.min(LIMIT)),
        long: false,
        conversion: Conversion::General,
        upper: false,
    };
    let mut out = Vec::new();
    spec.float(&mut out, x);
    text_of(out)
}

/// A number in the shortest form that is read back to the same bits.
pub fn shortest(x: f64) -> impl std::fmt::Display {
    struct Shortest(f64);
    impl std::fmt::Display for Shortest {
        fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
            let size = self.0.abs();
            // The range in which C's %g omits the exponent.
            if size == 0.0 || (1e-4..1e16).contains(&size) {
                write!(f, "{}", self.0)
            } else if !size.is_finite() {
                f.write_str(&general(self.0, 6))
            } else {
                let text = format!("{:e}", self.0);
                let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
                let (sign, size) = exponent.strip_prefix('-').map_or(('+', exponent), |size| ('-', size));
                write!(f, "{digits}e{sign}{size:0>2}")
            }
        }
    }
    Shortest(x)
}

/// Writes `e+05`, at least two digits.
fn push_exponent(out: &mut Vec<u8>, exponent: i32, upper: bool) {
    let letter = if upper { 'E' } else { 'e' };
    let sign = if exponent < 0 { '-' } else { '+' };
    let _ = write!(out, "{letter}{sign}{:02}", exponent.unsigned_abs());
}

/// Inserts `count` copies of a byte.
fn insert(out: &mut Vec<u8>, at: usize, count: usize, byte: u8) {
    if count == 0 {
        return;
    }
    let old = out.len();
    out.resize(old + count, byte);
    out.copy_within(at..old, at + count);
    out[at..at + count].fill(byte);
}

/// Parses digits; no digits give zero.
fn read_number(bytes: &[u8], k: &mut usize) -> Result<usize, &'static str> {
    let mut n = 0usize;
    while let Some(d) = bytes.get(*k).filter(|b| b.is_ascii_digit()) {
        n = n.saturating_mul(10).saturating_add(usize::from(d - b'0'));
        *k += 1;
    }
    if n > LIMIT {
        return Err("width and precision go up to 1000");
    }
    Ok(n)
}

/// Bytes from UTF-8 text and ASCII digits, as text.
fn text_of(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).unwrap_or_else(|e| String::from_utf8_lossy(e.as_bytes()).into_owned())
}

#[cfg(test)]
mod tests;
