//! As much of XML as VTK writes: elements with attributes, and the text between them.

/// An opening tag.
#[derive(Clone, Debug, PartialEq)]
pub struct Tag<'b> {
    /// Its name.
    pub name: &'b [u8],
    attributes: &'b [u8],
    /// Whether it closes itself.
    pub closed: bool,
}

impl Tag<'_> {
    /// An attribute, if it is there.
    pub fn text(&self, wanted: &str) -> Option<String> {
        let mut rest = self.attributes;
        loop {
            rest = rest.trim_ascii_start();
            let equals = rest.iter().position(|b| *b == b'=')?;
            let name = rest[..equals].trim_ascii();
            let value = rest[equals + 1..].trim_ascii_start();
            let quote = *value.first().filter(|q| matches!(q, b'"' | b'\''))?;
            let length = value[1..].iter().position(|b| *b == quote)?;
            if name == wanted.as_bytes() {
                return Some(String::from_utf8_lossy(&value[1..=length]).into_owned());
            }
            rest = &value[length + 2..];
        }
    }

    /// An attribute that is a whole number.
    pub fn number(&self, wanted: &str) -> Option<usize> {
        self.text(wanted)?.trim().parse().ok()
    }
}

/// What comes next in a file.
#[derive(Debug, PartialEq)]
pub enum Event<'b> {
    /// An element begins.
    Open(Tag<'b>),
    /// Text that is not blank.
    Text(&'b [u8]),
    /// An element ends.
    Close(&'b [u8]),
}

/// The elements and texts of a file, one by one; after an error nothing comes.
pub fn events(bytes: &[u8]) -> impl Iterator<Item = Result<Event<'_>, String>> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let (event, after) = next(rest);
        rest = after;
        event
    })
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|w| w == what)
}

fn next(mut rest: &[u8]) -> (Option<Result<Event<'_>, String>>, &[u8]) {
    loop {
        let start = rest.iter().position(|b| *b == b'<').unwrap_or(rest.len());
        let text = rest[..start].trim_ascii();
        if !text.is_empty() {
            return (Some(Ok(Event::Text(text))), &rest[start..]);
        }
        rest = &rest[start..];
        if rest.is_empty() {
            return (None, rest);
        }
        let skipped = match rest {
            [b'<', b'!', b'-', b'-', ..] => Some(&b"-->"[..]),
            [b'<', b'?', ..] => Some(&b"?>"[..]),
            [b'<', b'!', ..] => Some(&b">"[..]),
            _ => None,
        };
        let Some(end) = skipped else { return tag(rest) };
        match find(rest, end) {
            Some(at) => rest = &rest[at + end.len()..],
            None => return (Some(Err("a comment has no end".into())), &[]),
        }
    }
}

/// The tag that begins here, behind its `<`.
fn tag(rest: &[u8]) -> (Option<Result<Event<'_>, String>>, &[u8]) {
    let mut quote = None;
    let end = rest.iter().position(|b| match quote {
        Some(q) => {
            if *b == q {
                quote = None;
            }
            false
        }
        None if matches!(b, b'"' | b'\'') => {
            quote = Some(*b);
            false
        }
        None => *b == b'>',
    });
    let Some(end) = end else { return (Some(Err("a tag has no end".into())), &[]) };
    let (inner, after) = (&rest[1..end], &rest[end + 1..]);
    if let [b'/', name @ ..] = inner {
        return (Some(Ok(Event::Close(name.trim_ascii()))), after);
    }
    let (inner, closed) = match inner {
        [inner @ .., b'/'] => (inner, true),
        inner => (inner, false),
    };
    let length = inner.iter().position(u8::is_ascii_whitespace).unwrap_or(inner.len());
    let tag = Tag { name: &inner[..length], attributes: &inner[length..], closed };
    (Some(Ok(Event::Open(tag))), after)
}

/// Where appended numbers stand.
#[derive(Clone, Copy)]
pub struct Appended {
    /// The first byte behind the underscore.
    pub begins: usize,
    /// Whether they are bytes as they are, not base64.
    pub raw: bool,
}

/// Finds the appended numbers: behind them a file is no XML.
pub fn appended(bytes: &[u8]) -> Result<Option<Appended>, String> {
    let Some(at) = find(bytes, b"<AppendedData") else { return Ok(None) };
    let (Some(Ok(Event::Open(tag))), after) = tag(&bytes[at..]) else {
        return Err("`AppendedData` has no end".into());
    };
    let raw = match tag.text("encoding").as_deref() {
        Some("raw") => true,
        Some("base64") => false,
        _ => return Err("the encoding of `AppendedData` is neither raw nor base64".into()),
    };
    let Some(mark) = after.iter().position(|b| *b == b'_') else {
        return Err("`AppendedData` does not begin with an underscore".into());
    };
    Ok(Some(Appended { begins: bytes.len() - after.len() + mark + 1, raw }))
}
