//! XML tags of VTK files.

use perigrain_base::diag::brought::{broken, place};
use perigrain_base::diag::{Result, Span};

/// A tag with its attributes.
#[derive(Clone, Debug, Default)]
pub struct Tag<'a> {
    /// Its name.
    pub name: &'a str,
    /// Names and values.
    pub attributes: Vec<(&'a str, &'a str)>,
    /// Whether it closes an element.
    pub closes: bool,
    /// Whether it opens and closes an element.
    pub empty: bool,
    /// Its span.
    pub at: Span,
    /// The byte after it.
    pub end: usize,
}

impl<'a> Tag<'a> {
    /// The value of an attribute.
    pub fn get(&self, name: &str) -> Option<&'a str> {
        self.attributes.iter().find(|(n, _)| *n == name).map(|(_, v)| *v)
    }
}

/// The next tag from this byte on; comments and declarations are skipped.
///
/// # Errors
/// Unterminated tags, or tags that are not valid text.
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
        // A > within a quoted value does not end the tag.
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

#[cfg(test)]
mod tests {
    use super::*;

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
