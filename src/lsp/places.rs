//! Places as editors count them: lines, and UTF-16 units within them; and files as they name them.

use serde_json::{Value, json};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A text with the beginnings of its lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Text {
    text: String,
    starts: Vec<usize>,
}

impl Text {
    /// Takes a text in.
    pub fn new(text: String) -> Self {
        let bytes = text.as_bytes();
        let breaks =
            |k: &usize| bytes[*k] == b'\n' || (bytes[*k] == b'\r' && bytes.get(k + 1) != Some(&b'\n'));
        let starts = std::iter::once(0).chain((0..bytes.len()).filter(breaks).map(|k| k + 1)).collect();
        Self { text, starts }
    }

    /// All of it.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// The byte at a place; the nearest where the text has no such place.
    pub fn byte(&self, line: u64, unit: u64) -> usize {
        let line = usize::try_from(line).unwrap_or(usize::MAX);
        let Some(&start) = self.starts.get(line) else { return self.text.len() };
        let end = self.starts.get(line + 1).copied().unwrap_or(self.text.len());
        let body = self.text[start..end].trim_end_matches(['\n', '\r']);
        let mut units = 0;
        for (k, c) in body.char_indices() {
            if units >= unit {
                return start + k;
            }
            units += c.len_utf16() as u64;
        }
        start + body.len()
    }

    /// The byte at a position of the protocol; 0 if it is none.
    pub fn byte_at(&self, position: &Value) -> usize {
        let number = |key: &str| position.get(key).and_then(Value::as_u64);
        match (number("line"), number("character")) {
            (Some(line), Some(unit)) => self.byte(line, unit),
            _ => 0,
        }
    }

    /// The bytes of a range of the protocol, in order.
    pub fn bytes_at(&self, range: &Value) -> Range<usize> {
        let end = |key: &str| range.get(key).map_or(0, |position| self.byte_at(position));
        let (a, b) = (end("start"), end("end"));
        a.min(b)..a.max(b)
    }

    /// The position of a byte.
    pub fn position(&self, byte: usize) -> Value {
        let mut byte = byte.min(self.text.len());
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        let line = self.starts.partition_point(|start| *start <= byte).saturating_sub(1);
        let unit = self.text[self.starts[line]..byte].encode_utf16().count();
        json!({"line": line, "character": unit})
    }

    /// The range of bytes.
    pub fn range(&self, bytes: Range<usize>) -> Value {
        json!({"start": self.position(bytes.start), "end": self.position(bytes.end)})
    }

    /// The range of all of it.
    pub fn whole(&self) -> Value {
        self.range(0..self.text.len())
    }

    /// The text with changes of the protocol made one after the other.
    #[must_use]
    pub fn changed(self, changes: &[Value]) -> Self {
        let mut now = self;
        for change in changes {
            let Some(new) = change.get("text").and_then(Value::as_str) else { continue };
            now = match change.get("range").filter(|range| range.is_object()) {
                None => Self::new(new.to_string()),
                Some(range) => {
                    let bytes = now.bytes_at(range);
                    let mut text = now.text;
                    text.replace_range(bytes, new);
                    Self::new(text)
                }
            };
        }
        now
    }
}

/// The file that a URI names, if it names one here.
pub fn path_of(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    let at = rest.find('/')?;
    let mut bytes = vec![];
    let mut left = rest[at..].bytes();
    while let Some(byte) = left.next() {
        let digit = |c: Option<u8>| c.and_then(|c| (c as char).to_digit(16));
        bytes.push(match byte {
            b'%' => (digit(left.next())? * 16 + digit(left.next())?) as u8,
            byte => byte,
        });
    }
    let path = String::from_utf8(bytes).ok().filter(|path| !path.contains('\0'))?;
    // `/c:/decks` is a path of Windows.
    let drive = path.get(2..3) == Some(":") && cfg!(windows);
    Some(PathBuf::from(if drive { &path[1..] } else { &path }))
}

/// The URI of a file.
pub fn uri_of(path: &Path) -> String {
    let path = path.to_string_lossy().replace('\\', if cfg!(windows) { "/" } else { "\\" });
    let mut uri = String::from(if path.starts_with('/') { "file://" } else { "file:///" });
    for byte in path.bytes() {
        match byte {
            b'/' | b'.' | b'-' | b'_' | b'~' => uri.push(byte as char),
            byte if byte.is_ascii_alphanumeric() => uri.push(byte as char),
            byte => uri += &format!("%{byte:02X}"),
        }
    }
    uri
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_those_of_utf_16() {
        let text = Text::new("aä𝕏b\r\nc\rd".to_string());
        assert_eq!((text.byte(0, 2), text.byte(0, 4), text.byte(0, 5), text.byte(0, 99)), (3, 7, 8, 8));
        assert_eq!((text.byte(1, 0), text.byte(2, 0), text.byte(9, 9)), (10, 12, 13));
        // Between the two units of one character the next one begins.
        assert_eq!(text.byte(0, 3), 7);
        assert_eq!(text.position(7), json!({"line": 0, "character": 4}));
        assert_eq!(text.position(12), json!({"line": 2, "character": 0}));
        assert_eq!(text.position(5), json!({"line": 0, "character": 2}));
        assert_eq!(text.byte_at(&json!({"line": -1, "character": "x"})), 0);
    }

    #[test]
    fn changes_are_made_one_after_the_other() {
        let range = |a: u32, b: u32| json!({"start": {"line": 0, "character": a}, "end": {"line": 0, "character": b}});
        let text = Text::new("run 1".to_string());
        let text = text.changed(&[
            json!({"range": range(4, 5), "text": "20"}),
            json!({"range": range(6, 2), "text": "n"}),
            json!(3),
        ]);
        assert_eq!(text.as_str(), "run");
        assert_eq!(text.changed(&[json!({"text": "x"})]).as_str(), "x");
    }

    #[test]
    fn files_have_names_there_and_back() {
        for name in ["/decks/in.größe", "/a b/100%/in.x"] {
            assert_eq!(path_of(&uri_of(Path::new(name))).as_deref(), Some(Path::new(name)));
        }
        assert_eq!(path_of("untitled:Untitled-1"), None);
        assert_eq!(path_of("file:///a%2"), None);
    }
}
