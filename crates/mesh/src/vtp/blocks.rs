//! The numbers of a VTP array in each of the ways they can stand in a file.

use super::xml::Tag;
use std::borrow::Cow;
use std::io::Read;

/// What holds for all arrays of a file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Layout {
    /// Byte order.
    big: bool,
    /// Whether lengths have eight bytes, not four.
    long: bool,
    /// Whether blocks are compressed by zlib.
    zlib: bool,
}

impl Layout {
    /// What the first element of a file says.
    pub fn of(tag: &Tag) -> Result<Self, String> {
        let zlib = match tag.text("compressor").as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => return Err(format!("it is compressed by `{other}`: only zlib is known")),
        };
        let big = tag.text("byte_order").as_deref() == Some("BigEndian");
        Ok(Self { big, long: tag.text("header_type").as_deref() == Some("UInt64"), zlib })
    }

    fn word(&self) -> usize {
        if self.long { 8 } else { 4 }
    }

    /// A length.
    fn length(&self, bytes: &[u8]) -> usize {
        let kind = if self.long { "UInt64" } else { "UInt32" };
        convert(kind, bytes, self.big).map_or(0, |x| x as usize)
    }
}

/// The numbers of an array: `bytes` is the text of the element, or all that is appended, in the encoding it has there.
pub fn array(tag: &Tag, layout: &Layout, bytes: &[u8], appended: Option<bool>) -> Result<Vec<f64>, String> {
    let name = tag.text("Name").unwrap_or_default();
    let about = |what: &str| format!("array `{name}`: {what}");
    let kind = tag.text("type").unwrap_or_default();
    let Some(size) = size(&kind) else { return Err(about(&format!("`{kind}` is no kind of number"))) };
    if appended.is_none() && tag.text("format").as_deref() == Some("ascii") {
        let text = std::str::from_utf8(bytes).map_err(|_| about("it is no text"))?;
        let numbers: Result<Vec<f64>, _> = text.split_ascii_whitespace().map(str::parse).collect();
        return numbers.map_err(|_| about("a word is no number"));
    }
    let from =
        if appended.is_some() { tag.number("offset").ok_or_else(|| about("it has no offset"))? } else { 0 };
    let coded = bytes.get(from..).ok_or_else(|| about("it begins behind the end of the file"))?;
    let source = Source { bytes: coded, raw: appended == Some(true) };
    let plain = if layout.zlib { inflated(&source, layout) } else { counted(&source, layout) };
    let plain = plain.map_err(|what| about(&what))?;
    if plain.len() % size != 0 {
        return Err(about("it ends within a number"));
    }
    Ok(plain.chunks_exact(size).filter_map(|b| convert(&kind, b, layout.big)).collect())
}

struct Source<'b> {
    bytes: &'b [u8],
    raw: bool,
}

impl Source<'_> {
    /// The first `count` bytes.
    fn first(&self, count: usize) -> Result<Cow<'_, [u8]>, String> {
        let cut = || "the file ends within it".to_string();
        if self.raw {
            return Ok(Cow::Borrowed(self.bytes.get(..count).ok_or_else(cut)?));
        }
        let mut found = decoded(self.bytes, count)?;
        if found.len() < count {
            return Err(cut());
        }
        found.truncate(count);
        Ok(Cow::Owned(found))
    }
}

/// Bytes behind their number.
fn counted(source: &Source, layout: &Layout) -> Result<Vec<u8>, String> {
    let head = layout.word();
    let count = layout.length(&source.first(head)?);
    let all = source.first(head.saturating_add(count))?;
    Ok(all[head..].to_vec())
}

/// Blocks of zlib behind their number, their sizes before and after.
fn inflated(source: &Source, layout: &Layout) -> Result<Vec<u8>, String> {
    let word = layout.word();
    let start = source.first(word)?;
    let blocks = layout.length(&start);
    if blocks == 0 {
        return Ok(vec![]);
    }
    let mut head = blocks.saturating_add(3).saturating_mul(word);
    let sizes = source.first(head)?.into_owned();
    let size = |k: usize| layout.length(&sizes[k * word..(k + 1) * word]);
    let total = (0..blocks).fold(head, |sum, k| sum.saturating_add(size(3 + k)));
    let all = source.first(total)?;
    let mut plain = vec![];
    for k in 0..blocks {
        let whole = if k + 1 == blocks && size(2) != 0 { size(2) } else { size(1) };
        let before = plain.len();
        let packed = &all[head..head + size(3 + k)];
        head += packed.len();
        let read = flate2::read::ZlibDecoder::new(packed).take(whole as u64).read_to_end(&mut plain);
        if read.is_err() || plain.len() - before != whole {
            return Err(format!("block {} is no whole zlib block", k + 1));
        }
    }
    Ok(plain)
}

/// At least `count` bytes of base64 text if it has so many; parts that are padded by themselves may follow each other.
fn decoded(text: &[u8], count: usize) -> Result<Vec<u8>, String> {
    let mut out = vec![];
    let (mut four, mut filled, mut padded) = (0u32, 0, 0);
    for b in text {
        let value = match b {
            b'A'..=b'Z' => b - b'A',
            b'a'..=b'z' => b - b'a' + 26,
            b'0'..=b'9' => b - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            b'=' => {
                padded += 1;
                0
            }
            b' ' | b'\n' | b'\r' | b'\t' => continue,
            // What is appended ends with the next element.
            b'<' => break,
            _ => return Err("it is no base64 text".into()),
        };
        four = four << 6 | u32::from(value);
        filled += 1;
        if filled == 4 {
            let kept = 3usize.saturating_sub(padded);
            out.extend_from_slice(&four.to_be_bytes()[1..=kept]);
            (four, filled, padded) = (0, 0, 0);
            if out.len() >= count {
                break;
            }
        }
    }
    Ok(out)
}

/// How many bytes a number has.
fn size(kind: &str) -> Option<usize> {
    Some(match kind {
        "Int8" | "UInt8" => 1,
        "Int16" | "UInt16" => 2,
        "Int32" | "UInt32" | "Float32" => 4,
        "Int64" | "UInt64" | "Float64" => 8,
        _ => return None,
    })
}

fn convert(kind: &str, bytes: &[u8], big: bool) -> Option<f64> {
    let fold = |whole: u64, b: &u8| whole << 8 | u64::from(*b);
    let raw = if big { bytes.iter().fold(0, fold) } else { bytes.iter().rev().fold(0, fold) };
    Some(match kind {
        "Float32" => f64::from(f32::from_bits(raw as u32)),
        "Float64" => f64::from_bits(raw),
        "UInt8" | "UInt16" | "UInt32" | "UInt64" => raw as f64,
        "Int8" => f64::from(raw as i8),
        "Int16" => f64::from(raw as i16),
        "Int32" => f64::from(raw as i32),
        "Int64" => raw as i64 as f64,
        _ => return None,
    })
}
