//! Tags of VTK's XML files, and bytes as base64.

use perigrain_base::diag::brought::{broken, place};
use perigrain_base::diag::{Result, Span};

/// A tag with its attributes.
#[derive(Clone, Debug, Default)]
pub struct Tag<'a> {
    /// Its name.
    pub name: &'a str,
    /// Names and values.
    pub attributes: Vec<(&'a str, &'a str)>,
    /// It closes an element.
    pub closes: bool,
    /// It opens an element and closes it at once.
    pub empty: bool,
    /// Where it is.
    pub at: Span,
    /// The byte behind it.
    pub end: usize,
}

impl<'a> Tag<'a> {
    /// The value of an attribute.
    pub fn get(&self, name: &str) -> Option<&'a str> {
        self.attributes.iter().find(|(n, _)| *n == name).map(|(_, v)| *v)
    }
}

/// The next tag from this byte on; comments and declarations are passed over.
///
/// # Errors
/// Tags that do not end, or are no text.
pub fn next(bytes: &[u8], mut at: usize) -> Result<Option<Tag<'_>>> {
    loop {
        let Some(start) = bytes[at..].iter().position(|b| *b == b'<').map(|k| at + k) else {
            return Ok(None);
        };
        if bytes[start..].starts_with(b"<!--") {
            let close = bytes[start..].windows(3).position(|w| w == b"-->");
            let Some(close) = close else { return Err(broken(start, "this comment does not end")) };
            at = start + close + 3;
            continue;
        }
        // A > within a quoted value ends no tag.
        let mut quote = None;
        let end = bytes[start..].iter().position(|&b| {
            match quote {
                Some(q) if b == q => quote = None,
                None if b == b'"' || b == b'\'' => quote = Some(b),
                _ => {}
            }
            b == b'>' && quote.is_none()
        });
        let Some(end) = end.map(|k| start + k) else { return Err(broken(start, "this tag does not end")) };
        at = end + 1;
        if matches!(bytes[start + 1], b'?' | b'!') {
            continue;
        }
        let span = place(start, end + 1);
        let Ok(inner) = std::str::from_utf8(&bytes[start + 1..end]) else {
            return Err(broken(start, "this tag is no text"));
        };
        return Ok(Some(tag(inner, span, end + 1)));
    }
}

fn tag(inner: &str, at: Span, end: usize) -> Tag<'_> {
    let (inner, closes) = inner.strip_prefix('/').map_or((inner, false), |i| (i, true));
    let (inner, empty) = inner.strip_suffix('/').map_or((inner, false), |i| (i, true));
    let inner = inner.trim();
    let name_end = inner.find(|c: char| c.is_ascii_whitespace()).unwrap_or(inner.len());
    let (name, mut rest) = inner.split_at(name_end);
    let mut attributes = vec![];
    while let Some((key, after)) = rest.split_once('=') {
        let after = after.trim_start();
        let Some(quote) = after.chars().next().filter(|c| *c == '"' || *c == '\'') else { break };
        let Some((value, more)) = after[1..].split_once(quote) else { break };
        attributes.push((key.trim(), value));
        rest = more;
    }
    Tag { name, attributes, closes, empty, at, end }
}

/// What base64 says, up to the first byte that belongs to none; padding within ends a group, and the next one follows.
pub fn base64(text: &[u8]) -> Vec<u8> {
    let value = |b: u8| match b {
        b'A'..=b'Z' => Some(b - b'A'),
        b'a'..=b'z' => Some(b - b'a' + 26),
        b'0'..=b'9' => Some(b - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let mut out = Vec::with_capacity(text.len() / 4 * 3);
    let (mut group, mut have, mut pad) = (0u32, 0, 0);
    for &b in text.iter().filter(|b| !b.is_ascii_whitespace()) {
        let bits = match (value(b), b) {
            (Some(v), _) => u32::from(v),
            (None, b'=') => {
                pad += 1;
                0
            }
            _ => break,
        };
        group = group << 6 | bits;
        have += 1;
        if have == 4 {
            let three = [(group >> 16) as u8, (group >> 8) as u8, group as u8];
            out.extend(&three[..3 - pad.min(2)]);
            (group, have, pad) = (0, 0, 0);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_groups_may_be_padded_within() {
        // RFC 4648, section 10, and two of them behind each other.
        assert_eq!(base64(b"Zm9vYmFy"), b"foobar");
        assert_eq!(base64(b" Zm9v\nYg==Zm8="), b"foobfo");
        assert_eq!(base64(b"Zm9v</Data"), b"foo");
    }

    #[test]
    fn tags_keep_their_attributes() {
        let text = b"<?xml?><!-- <a> --><VTKFile type=\"A>B\" x = '1'/>";
        let tag = next(text, 0).unwrap().unwrap();
        assert_eq!(
            (tag.name, tag.get("type"), tag.get("x"), tag.empty),
            ("VTKFile", Some("A>B"), Some("1"), true)
        );
        assert!(next(b"<open", 0).is_err() && next(b"text", 0).unwrap().is_none());
    }
}
